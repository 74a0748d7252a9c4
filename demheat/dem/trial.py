"""A trial with few particles, before anything is packed, where rounding may drown the heat that passes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from demheat.conduction.steady import HIGH_CONTRAST, Unsolved, contrast_of
from demheat.dem.options import Particles
from demheat.error import quietly
from demheat.runtime.progress import stage
from demheat.scene import Scene

# Particles of a trial, its iterations at most (found: 700), and by how much it may miss the tolerance, as more of them
# may do a little better: .1 to 1 s. On 16 scenes of contrasts from 1e7 to 1e12, at the usual tolerance, all that it
# refused failed with 10 000 particles, and it refused all that failed from 1e9 on.
FEW, MOST, LENIENT = 3000, 2000, 2.0
# A tolerance at most, as that of any solve.
LOOSEST = 9e-3


def check_contrast(scene: Scene, wanted: Particles, tolerance: float, answer: Callable) -> None:
    """Refuse a scene of high contrast whose equations a trial shows not to be solvable.

    Rounding of the temperatures in what conducts well leaves heat there of about 1e-16 of the contrast, of that which
    passes. That is nothing where heat passes through what conducts well from end to end, or where its temperature is
    that of the middle: a limit of the contrast alone would refuse such scenes.
    """
    number = wanted.particles if wanted.packing is None else len(wanted.packing.radii)
    if contrast_of(scene) < HIGH_CONTRAST or number <= FEW:
        return
    how = {"tolerance": min(LENIENT * tolerance, LOOSEST), "max_iterations": MOST}
    few = replace(wanted, particles=FEW, packing=None, replicas=None, allow_few=True)
    try:
        with stage("trial"):
            quietly(partial(answer, **how), few)
    except Unsolved as error:
        raise NotImplementedError(
            f"solve: a trial with {FEW} particles fails already: {error} (from 1e6 on the effective conductivity "
            "hardly changes), conductivity 0 for what hardly conducts, or another method, such as references.fem"
        ) from error
    except (ValueError, RuntimeError):
        # With so few only, perhaps: what all are asked for says so itself.
        return
