"""Compiled passes over a network in time: rates, explicit steps, stages, and the heat that held nodes give.

Every loop gathers: row i alone writes entry i, so that bits do not depend on the number of threads. Sums over the links
of a row may be reassociated, which lets the compiler use wide registers; the order is fixed when it compiles.
"""

from numba import njit, prange

FAST = {"reassoc", "contract"}


@njit(cache=True, parallel=True, fastmath=FAST)
def rates(indptr, indices, conductance, inverse, heat, x, out):
    """Write the rate of change (heat received over capacity) to out; inverse is 1 / capacity, 0 for held nodes."""
    for i in prange(len(x)):
        here, flow = x[i], 0.0
        for e in range(indptr[i], indptr[i + 1]):
            flow += conductance[e] * (x[indices[e]] - here)
        out[i] = inverse[i] * (flow + heat[i])


@njit(cache=True, parallel=True, fastmath=FAST)
def forward(indptr, indices, conductance, inverse, heat, step, x, out):
    """Write x + step * rate to out."""
    for i in prange(len(x)):
        here, flow = x[i], 0.0
        for e in range(indptr[i], indptr[i + 1]):
            flow += conductance[e] * (x[indices[e]] - here)
        out[i] = here + step * inverse[i] * (flow + heat[i])


@njit(cache=True, parallel=True, fastmath=FAST)
def stage(indptr, indices, conductance, inverse, heat, weights, start, first, last, other):
    """Three-term recurrence of a stabilised method, in place of the stage before the last.

    other = start + mu (last - start) + nu (other - start) + a rate(last) + b first, with weights (mu, nu, a, b).
    """
    mu, nu, a, b = weights
    for i in prange(len(last)):
        here, flow, base = last[i], 0.0, start[i]
        for e in range(indptr[i], indptr[i + 1]):
            flow += conductance[e] * (last[indices[e]] - here)
        rate = inverse[i] * (flow + heat[i])
        other[i] = base + mu * (here - base) + nu * (other[i] - base) + a * rate + b * first[i]


@njit(cache=True)
def received(row, node, conductance, wall, x, out):
    """Add the heat flow from held nodes into their neighbours to out, wall by wall."""
    for k in range(len(row)):
        out[wall[k]] += conductance[k] * (x[node[k]] - x[row[k]])
