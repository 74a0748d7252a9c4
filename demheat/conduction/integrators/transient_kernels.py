"""Compiled passes over a network in time: rates, explicit steps, stages, and the heat that held nodes give.

Every loop gathers: row i alone writes entry i, so that bits do not depend on the number of threads. Sums over the links
of a row may be reassociated, which lets the compiler use wide registers; the order is fixed when it compiles.
"""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

FAST = {"reassoc", "contract"}


class Ties(NamedTuple):
    """Links from free particles to held nodes."""

    # row, node: (t,) int64 arrays: The particle and the held node of each
    row: np.ndarray
    node: np.ndarray
    conductance: np.ndarray  # (t,) float array, W/K
    side: np.ndarray  # (t,) int64 array: Which side holds the node


@njit(cache=True, parallel=True, fastmath=FAST)
def rates(links, inverse, heat, x, out):
    """Rate of change of each node: heat received over capacity.

    links : Links; of N nodes, held ones included
    inverse : (N,) float array, K/J; 1 / capacity, 0 for held nodes
    heat : (N,) float array, W; what sources and imposed fluxes give
    x : (N,) float array, K
    out : (N,) float array, K/s, out
    """
    indptr, indices, conductance = links
    for i in prange(len(x)):
        here, flow = x[i], 0.0
        for e in range(indptr[i], indptr[i + 1]):
            flow += conductance[e] * (x[indices[e]] - here)
        out[i] = inverse[i] * (flow + heat[i])


@njit(cache=True, parallel=True, fastmath=FAST)
def forward(links, inverse, heat, step, x, out):
    """One step of explicit Euler: x + step times the rate of change.

    links, inverse, heat, x: as in `rates`
    step : float, s
    out : (N,) float array, K, out
    """
    indptr, indices, conductance = links
    for i in prange(len(x)):
        here, flow = x[i], 0.0
        for e in range(indptr[i], indptr[i + 1]):
            flow += conductance[e] * (x[indices[e]] - here)
        out[i] = here + step * inverse[i] * (flow + heat[i])


@njit(cache=True, parallel=True, fastmath=FAST)
def stage(links, inverse, heat, weights, start, first, last, other):
    """Three-term recurrence of a stabilised method, in place of the stage before the last.

    other becomes start + mu (last - start) + nu (other - start) + a rate(last) + b first.

    links, inverse, heat: as in `rates`
    weights : (mu, nu, a, b); four floats; a and b in seconds
    start : (N,) float array, K; at the start of the step
    first : (N,) float array, K/s; rate of change there
    last : (N,) float array, K; the last stage
    other : (N,) float array, K, in and out; the stage before it, then the new one
    """
    indptr, indices, conductance = links
    mu, nu, a, b = weights
    for i in prange(len(last)):
        here, flow, base = last[i], 0.0, start[i]
        for e in range(indptr[i], indptr[i + 1]):
            flow += conductance[e] * (last[indices[e]] - here)
        rate = inverse[i] * (flow + heat[i])
        other[i] = base + mu * (here - base) + nu * (other[i] - base) + a * rate + b * first[i]


@njit(cache=True)
def received(ties, x, out):
    """Add the heat flow from held nodes into their neighbours to the account of each side.

    ties : Ties
    x : (N,) float array, K
    out : (sides,) float array, W, in and out
    """
    for k in range(len(ties.row)):
        out[ties.side[k]] += ties.conductance[k] * (x[ties.node[k]] - x[ties.row[k]])
