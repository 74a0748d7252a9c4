"""TR-BDF2: an implicit, L-stable step of second order.

Source: Bank et al., IEEE Trans. Electron Devices 32 (1985) 1992-2007; as a Runge-Kutta method, Hosea and Shampine,
Appl. Numer. Math. 20 (1996) 21-37.
"""

import math
from typing import NamedTuple

import numpy as np

from demheat.conduction.integrators import transient_kernels as kernels
from demheat.conduction.integrators.linear import solver
from demheat.conduction.integrators.step import Step

ORDER = 2
ESTIMATES = True
GAMMA = 2.0 - math.sqrt(2.0)
# Weights of the rates at the start, at the middle and at the end; the last is also that of each implicit solve.
W, D = math.sqrt(2.0) / 4.0, GAMMA / 2.0
LONG = 1e90  # s
# Errors of the values at the middle and at the end, in units of the step cubed times the third derivative.
MIDDLE_ERROR, END_ERROR = GAMMA**3 / 12.0, W * GAMMA**2 / 2.0 + D / 2.0 - 1.0 / 6.0


class _Memory(NamedTuple):
    """Rate at the end of the last step, and times and values at its start, middle and end."""

    rate: np.ndarray
    times: tuple
    values: tuple


def largest_step(spectrum):
    """No step is too large."""
    return math.inf


def stepper(system, spectrum, *, limit, preconditioner="jacobi"):
    """Implicit steps on a system."""
    solve = solver(system, preconditioner)

    def advance(x, time, step, memory, estimate):
        g, middle, end = D * step, time + GAMMA * step, time + step
        heat, totals = system.heat_at(time)
        rate = _rate(system, heat, x) if memory is None else memory.rate
        start_flow = system.inflow(x, totals)
        known, y = x + g * rate, x.copy() if memory is None else _extrapolated(memory.times, memory.values, middle)
        middle_flow, count, left = _stage(system, solve, g, known, y, middle, limit())
        known = x + W * step * (rate + (y - known) / g)
        # The start of the step before, if there was one, then this step's own times.
        times, values = ((), ()) if memory is None else (memory.times[:1], memory.values[:1])
        times, values = (*times, time, middle), (*values, x, y)
        z = _extrapolated(times, values, end)
        end_flow, more, still = _stage(system, solve, g, known, z, end, limit())
        inflow = step * (W * start_flow + W * middle_flow + D * end_flow)
        error = _error((*times, end), (*values, z), step) if estimate else None
        kept = _Memory((z - known) / g, (time, middle, end), (x, y, z))
        return Step(z, inflow, error, 3, count + more, kept, max(left, still))

    return advance


def _rate(system, heat, x):
    rate = np.empty_like(x)
    kernels.rates(system.links, system.inverse, heat, x, rate)
    return rate


def _stage(system, solve, g, known, y, time, limit):
    """Solve one implicit stage from the guess y, in place; the heat flow then, the iterations and the error left."""
    heat, totals = system.heat_at(time)
    system.hold(y, time)
    iterations, left = solve(g, known, heat, y, limit)
    return system.inflow(y, totals), iterations, left


def _extrapolated(times, values, time):
    """Polynomial through the given values, at another time (Lagrange)."""
    out = np.zeros_like(values[0])
    for t, value in zip(times, values, strict=True):
        out += math.prod((time - u) / (t - u) for u in times if u != t) * value
    return out


def _error(times, values, step):
    """Error of the step from the third divided difference over it and the start of the step before.

    The two new values carry errors of third order themselves, in known proportion. Unlike an estimate from rates it
    does not amplify what is stiff, and it takes no solve. None for a first step.
    """
    if len(times) < 4:
        return None
    # The cube of a step must not overflow; times have no unit here.
    unit = step if step > LONG else 1.0
    times, step = [t / unit for t in times], step / unit
    factors = [1.0 / math.prod(t - u for u in times if u != t) for t in times]
    # Per third derivative: 1/6 from the exact solution, the rest from the errors of the middle and the end.
    seen = 1.0 / 6.0 + step**3 * (factors[2] * MIDDLE_ERROR + factors[3] * END_ERROR)
    error = np.zeros_like(values[0])
    for factor, value in zip(factors, values, strict=True):
        error += step**3 * END_ERROR / seen * factor * value
    return error
