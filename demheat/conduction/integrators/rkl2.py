"""Second-order Runge-Kutta-Legendre super-steps: explicit, stable over a step that grows with the stages squared.

Source: Meyer, Balsara and Aslam, J. Comput. Phys. 257 (2014) 594-626. The stages' stability polynomials are
a + b P_j(1 + w z), P_j the Legendre polynomials; every stage from the second on is second-order accurate at its time.
"""

import math

import numpy as np

from demheat.conduction.integrators import transient_kernels as kernels
from demheat.conduction.integrators.step import Step

ORDER = 2
ESTIMATES = True
# The error estimate takes the solution at four times of the step.
LEAST, LEAST_ESTIMATED = 3, 5
# Stages of a step at most: some minutes of work on the smallest networks, where implicit steps take a fraction of a
# second whatever their size.
MOST = 100_000


def stages_of(step, radius, least=LEAST):
    """Least odd number of stages s that is stable: step <= (s^2 + s - 2) / (2 radius); odd ones damp more."""
    s = math.ceil(0.5 * (math.sqrt(9.0 + 8.0 * step * radius) - 1.0) - 1e-12)
    return max(least, s + 1 - s % 2)


def largest_step(spectrum):
    """No step is too large: stages are added."""
    return math.inf


def stepper(system, spectrum):
    """Super-steps on a system, each with as few stages as are stable."""

    def advance(x, time, step, memory, estimate):
        s = stages_of(step, spectrum.radius, LEAST_ESTIMATED if estimate else LEAST)
        marks = ((s + 1) // 2, (3 * s + 3) // 4) if estimate else ()
        new, inflow, kept = _stages(system, x, time, step, s, marks)
        return Step(new, inflow, _error(s, marks, (x, *kept, new)) if estimate else None, s)

    return advance


def _stages(system, x, time, step, s, marks):
    """Last stage, heat that came in, and copies of the marked stages."""
    heat, totals = system.heat(x, time)
    first, before, last = np.empty_like(x), x.copy(), None
    kernels.rates(system.links, system.inverse, heat, x, first)
    flow = system.inflow(x, totals)
    a = step * _b(1) * _w(s)
    last = x + a * first
    heat_before, heat_last = np.zeros_like(flow), a * flow
    kept = []
    for j in range(1, s):
        now = time + step * _c(j, s)
        system.hold(last, now)
        if j in marks:
            kept.append(last.copy())
        heat, totals = system.heat(last, now)
        mu, nu, a, b = _weights(j + 1, s, step)
        came = mu * heat_last + nu * heat_before + a * system.inflow(last, totals) + b * flow
        kernels.stage(system.links, system.inverse, heat, (mu, nu, a, b), x, first, last, before)
        before, last = last, before
        heat_before, heat_last = heat_last, came
    system.hold(last, time + step)
    return last, heat_last, kept


def _weights(j, s, step):
    """Factors mu, nu, mu~ step, gamma~ step of stage j >= 2."""
    mu = (2 * j - 1) / j * _b(j) / _b(j - 1)
    nu = -(j - 1) / j * _b(j) / _b(j - 2)
    return mu, nu, mu * _w(s) * step, -(1 - _b(j - 1)) * mu * _w(s) * step


def _b(j):
    return (j * j + j - 2) / (2 * j * (j + 1)) if j > 2 else 1 / 3


def _w(s):
    return 4 / (s * s + s - 2)


def _c(j, s):
    """Time of stage j >= 1 as a part of the step."""
    return _w(s) / 3 if j == 1 else (j * j + j - 2) / (s * s + s - 2)


def _cubic(j, s):
    """Third-order coefficient of the stability polynomial of stage j; 1/6 would be exact at the step's end."""
    third = (j - 2) * (j - 1) * j * (j + 1) * (j + 2) * (j + 3) / 48
    return _b(j) * _w(s) ** 3 * third / 6


def _error(s, marks, values):
    """Error of the step from the third divided difference of start, marked stages and end.

    It sees third-order terms only, to which stage j contributes its coefficient. Unlike an estimate from rates it does
    not amplify what is stiff.
    """
    at = [0.0, *(_c(j, s) for j in marks), 1.0]
    factors = [1 / math.prod(t - u for u in at if u != t) for t in at]
    seen = sum(f * _cubic(j, s) for f, j in zip(factors[1:], (*marks, s), strict=True))
    scale = (1 / 6 - _cubic(s, s)) / seen
    error = np.zeros_like(values[0])
    for factor, value in zip(factors, values, strict=True):
        error += scale * factor * value
    return error
