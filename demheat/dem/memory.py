"""Memory that a solve is expected to take, told before it begins."""

from __future__ import annotations

import numpy as np

from demheat.dem.options import Particles
from demheat.laws import Calibrated, Laguerre, Platonic
from demheat.packing.conforming import faces
from demheat.scene import Scene

MIB = 2**20
# Bytes at the peak for each unknown, and for each of the rows that are worked on at once. Found between walls with a
# sphere of contrast 5, by law "laguerre": 929 an unknown of 212 thousand, 678 of 1.03 million.
EACH, ROW, ROWS = 613, 1020, 65536
# Twins less the particles that give way to them, for each squared mean radius of the faces of an inclusion's bounds.
TWINS = 0.37
# Of the volume, that spheres fill.
PHI = 0.64


def unknowns(scene: Scene, law: Laguerre | Calibrated | Platonic, wanted: Particles) -> float:
    """How many unknowns a packing is expected to have with its twins; those in narrow gaps are not foreseen."""
    number = float(wanted.particles if wanted.packing is None else wanted.packing.number)
    if not (law.conforming and scene.inclusions):
        return number
    unit = np.cbrt(0.75 / np.pi * PHI * scene.volume / number)
    return number + TWINS * float(faces(scene).sum() / unit**2)


def expected(number: float) -> float:
    """Bytes that a steady solve is expected to take at its peak, besides Python and libraries."""
    return EACH * number + ROW * min(number, ROWS)
