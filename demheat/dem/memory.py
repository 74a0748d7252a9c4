"""Memory that a solve is expected to take, told before it begins."""

from __future__ import annotations

import numpy as np

from demheat.dem.options import Particles
from demheat.laws import Calibrated, Laguerre, Platonic
from demheat.packing.conforming import faces
from demheat.scene import Scene

MIB = 2**20
# Bytes at the peak for each unknown, besides Python and libraries, by law.
BYTES = {"laguerre": 750, "calibrated": 750, "platonic": 750}
# Twins less the particles that give way to them, for each squared mean radius of the faces of an inclusion's bounds.
TWINS = 0.37
# Of the volume, that spheres fill.
PHI = 0.64


def expected(
    scene: Scene, law: Laguerre | Calibrated | Platonic, wanted: Particles, each: float | None = None
) -> float:
    """Bytes that a steady solve is expected to take at its peak, besides Python and libraries.

    Twins in narrow gaps are not foreseen.

    Parameters
    ----------
    scene : Scene
    law : Laguerre, Calibrated or Platonic
    wanted : Particles
    each : float, optional
        Of one unknown; default that of the law.
    """
    number = wanted.particles if wanted.packing is None else wanted.packing.number
    unknowns = float(number)
    if law.conforming and scene.inclusions:
        unit = np.cbrt(0.75 / np.pi * PHI * scene.volume / number)
        unknowns += TWINS * float(faces(scene).sum()) / unit**2
    return float((BYTES[law.name] if each is None else each) * unknowns)
