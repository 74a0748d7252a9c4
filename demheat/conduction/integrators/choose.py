"""Which integrator, by estimated cost for the asked accuracy."""

import math

from demheat.conduction.integrators import rkl2

INTEGRATORS = ("auto", "euler", "rkl2", "tr-bdf2", "tr-bdf2-multigrid")
# Their stages are sets of linear equations, once set up for many steps: what depends on the state has no place there.
IMPLICIT = ("tr-bdf2", "tr-bdf2-multigrid")
# Steps of equal size that a second-order method needs for an error of 1e-3 of the span, and what growing from small
# first steps costs besides; found on slabs of 3e3 to 1e5 particles.
STEPS, GRADED = 5.0, 2.0
# Work in passes over the network: of a stage of Legendre polynomials, of an iteration of conjugate gradients, of an
# implicit solve besides its iterations, of one by multigrid; and the solves of a step, those of rejected and of short
# first steps included. Found on the slab and the sphere, 3e3 to 1e6 particles (study time_integrators).
STAGE, ITERATION, SOLVE, MULTIGRID, SOLVES = 1.2, 1.5, 3.0, 70.0, 4.0
# Iterations of an implicit solve over the square root of its condition, from the good guesses that old steps give.
JACOBI = 0.6


def steps_of(accuracy, outputs):
    """Steps of equal size that a second-order method takes at least."""
    return max(outputs, math.ceil(STEPS * math.sqrt(1e-3 / accuracy)))


def costs(spectrum, interval, accuracy, outputs):
    """Estimated work of each integrator, in passes over the network."""
    count = steps_of(accuracy, outputs)
    size = interval / count
    solves = GRADED * count * SOLVES
    iterations = JACOBI * math.sqrt(1.0 + size / 3.0 * spectrum.mean_row)
    return {
        # First order: about half an accuracy's inverse steps, whatever the stable step is.
        "euler": max(interval / spectrum.limit, 0.5 / accuracy, outputs),
        "rkl2": GRADED * count * STAGE * rkl2.stages_of(size, spectrum.radius, rkl2.LEAST_ESTIMATED),
        "tr-bdf2": solves * (SOLVE + ITERATION * iterations),
        "tr-bdf2-multigrid": solves * MULTIGRID,
    }


def chosen(spectrum, interval, accuracy, outputs, *, moving=False, linear=True):
    """Name of the cheapest integrator that meets the accuracy.

    Explicit Euler takes its stable steps, or those between outputs, whatever the error: they must be enough. It is left
    out where loads change in time.
    """
    work = costs(spectrum, interval, accuracy, outputs)
    if moving or max(interval / spectrum.limit, outputs) < 0.5 / accuracy:
        del work["euler"]
    for name in () if linear else IMPLICIT:
        del work[name]
    return min(work, key=work.get)


def check_linear(integrator):
    """Raise NotImplementedError if an integrator cannot march what is not linear, as radiation is not."""
    if integrator in IMPLICIT:
        raise NotImplementedError(
            f"integrator = {integrator!r} and a wall that radiates: its stages are linear equations, and the fourth "
            "power is not; use 'rkl2' or 'euler', which ask for the heat at each stage, or 'auto'"
        )
