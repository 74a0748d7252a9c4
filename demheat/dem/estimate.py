"""How far the discrete element method is off: fewer particles, or conforming cells beside a law that has no limit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from demheat.dem.options import Particles
from demheat.error import Estimate, Refinement, beside, by_refinement
from demheat.laws import Calibrated, Laguerre, Platonic

# Twins in gaps stand so much closer in a run besides; there the error goes with their distance.
CLOSER = 0.7
# A run has a quarter of the particles of the one before.
RATIO = 4 ** (1 / 3)
CONFORMING = Refinement(RATIO, 2, 2.0, 1.0, 2.0, 1.0, also=1 / (1 - CLOSER), coats=1.5)
PLAIN = Refinement(RATIO, 2, 1.0, 1.3, 1.0, 1.0)


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
    if law.cells and law.interface == "harmonic":
        return partial(_by_fewer, law=law, wanted=wanted, answer=answer, steps=steps)
    return partial(_by_cells, wanted=wanted, answer=answer)


def _by_fewer(field, *, law, wanted, answer, steps) -> Estimate:
    """Radical cells converge: runs with fewer particles tell how far, one with closer twins how far in gaps."""
    number = wanted.particles if wanted.packing is None else len(wanted.packing.radii)

    def coarser(level, law=law):
        fewer = max(1, number // 4**level)
        return answer(law, replace(wanted, particles=fewer, packing=None, replicas=None, allow_few=True))

    rule = CONFORMING if law.conforming else PLAIN

    def closer(first):
        return coarser(1, replace(law, gap_spacing=CLOSER * law.gap_spacing)) if _in_gaps(first) else None

    left = {"residual": field.stats["residual"], "steps": steps}
    return by_refinement(field, coarser, rule, how="fewer particles", also=closer, **left)


def _in_gaps(field):
    """Whether twins stand closer than even ones anywhere: fewer particles leave these as they are."""
    packing = field.stats["packing"]
    made = packing.get("of", packing)
    return made.get("twins", 0) > made.get("even_twins", 0)


def _by_cells(field, *, wanted, answer) -> Estimate:
    """Networks of contacts have no limit of many particles, or a far one: conforming cells show what they miss."""
    return beside(field, answer(Laguerre(), wanted), "conforming cells beside it")
