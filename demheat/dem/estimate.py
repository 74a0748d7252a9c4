"""How far the discrete element method is off: fewer particles, or conforming cells beside a law that has no limit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from demheat.dem.options import Particles
from demheat.error import Estimate, Refinement, beside, by_refinement
from demheat.laws import Calibrated, Laguerre, Platonic

# A run has a quarter of the particles of the one before.
RATIO = 4 ** (1 / 3)
CONFORMING = Refinement(RATIO, 2, 2.0, 1.0, 1.5, 1.0)
PLAIN = Refinement(RATIO, 2, 1.0, 1.0, 1.0, 1.0)


def estimator_of(law: Laguerre | Calibrated | Platonic, wanted: Particles, answer: Callable, *, steps: float = 0.0):
    """What tells a field of the DEM its error.

    Parameters
    ----------
    law : Laguerre, Calibrated or Platonic
    wanted : Particles
    answer : callable (law, Particles) -> Field
        Solves the scene again.
    steps : float
        What steps in time may have left, of the span of temperatures.

    Returns
    -------
    callable (Field) -> Estimate
    """
    if law.cells:
        return partial(_by_fewer, law=law, wanted=wanted, answer=answer, steps=steps)
    return partial(_by_cells, wanted=wanted, answer=answer)


def _by_fewer(field, *, law, wanted, answer, steps) -> Estimate:
    """Radical cells converge: runs with fewer particles tell how far."""
    number = wanted.particles if wanted.packing is None else len(wanted.packing.radii)

    def coarser(level):
        fewer = max(1, number // 4**level)
        return answer(law, replace(wanted, particles=fewer, packing=None, replicas=None, allow_few=True))

    rule = CONFORMING if law.conforming else PLAIN
    return by_refinement(field, coarser, rule, how="fewer particles", residual=field.stats["residual"], steps=steps)


def _by_cells(field, *, wanted, answer) -> Estimate:
    """Networks of contacts have no limit of many particles: what they miss is seen beside conforming cells."""
    return beside(field, answer(Laguerre(), wanted), "conforming cells beside it")
