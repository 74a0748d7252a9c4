"""Which integrator, by estimated cost for the asked accuracy."""

import math

from demheat.integrators import rkl2
from demheat.integrators.linear import jacobi_iterations

INTEGRATORS = ("auto", "euler", "rkl2", "tr-bdf2", "tr-bdf2-multigrid")
# Steps of equal size that a second-order method needs for an error of 1e-3 of the span, and what growing from small
# first steps costs besides; found on slabs of 3e3 to 1e5 particles.
STEPS, GRADED = 5.0, 2.0
# Work of one stage, or of one iteration, in passes over the network.
STAGE, ITERATION, SOLVES, MULTIGRID = 1.2, 1.5, 2.5, 100.0


def costs(spectrum, interval, accuracy, outputs):
    """Estimated work of each integrator, in passes over the network.

    Parameters
    ----------
    spectrum : Spectrum
    interval : float, s
    accuracy : float
        Of the temperature span.
    outputs : int
        Number of asked times, each of which ends a step.

    Returns
    -------
    dict
    """
    count = max(outputs, math.ceil(STEPS * math.sqrt(1e-3 / accuracy)))
    size = interval / count
    # First order: about half an accuracy's inverse steps, whatever the stable step is.
    euler = max(interval / spectrum.limit, 0.5 / accuracy, outputs)
    solves = GRADED * count * SOLVES
    work = {
        "euler": euler,
        "rkl2": GRADED * count * STAGE * rkl2.stages_of(size, spectrum.radius, rkl2.LEAST_ESTIMATED),
        "tr-bdf2": solves * ITERATION * jacobi_iterations(size / 3, spectrum),
    }
    return work | {"tr-bdf2-multigrid": MULTIGRID * (1.5 + solves)}


def chosen(spectrum, interval, accuracy, outputs):
    """Name of the cheapest integrator."""
    work = costs(spectrum, interval, accuracy, outputs)
    return min(work, key=work.get)
