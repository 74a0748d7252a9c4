"""A multigrid preconditioner that reads the network as it is and takes little memory.

The finest level is ours: aggregates with values of their own (no smoothed prolongation), and Gauss-Seidel sweeps in
single precision. Everything coarser is pyamg's classical multigrid (Ruge and Stueben 1987), on an eighth of the
unknowns: there it took fewer iterations than smoothed aggregation (contrast 7.7: 18 and 24, 1e6: 38 and more than 150).
"""

import numpy as np
from scipy import sparse

from demheat.conduction import multigrid_kernels as kernels
from demheat.conduction.products import ROWS
from demheat.runtime.process_state import seeded
from demheat.runtime.threads import shared_out

# Particles of an aggregate at most; found 8 on average. With 6 the iterations are as many and the set-up twice as long.
MOST = 16
# What aggregates of equal values return is too small, by the energy that their jumps cost: it is enlarged by this
# factor (Braess, Computing 55 (1995) 379, has 1.8). Found on 83 spheres, 1e5 particles, contrasts 0.001 to 100: 2 to 4
# iterations fewer than at 1.
ENLARGED = 1.6
# pyamg's levels: what makes a cycle symmetric, and how many unknowns are solved for directly.
CYCLE = {
    "presmoother": ("gauss_seidel", {"sweep": "forward"}),
    "postsmoother": ("gauss_seidel", {"sweep": "backward"}),
    "max_coarse": 500,
}


def preconditioner(links, diagonal, coarse=np.float64):
    """One symmetric cycle for A = diag(diagonal) - conductance."""
    scale = 1.0 / diagonal.max()
    aggregates = aggregated(links, len(diagonal))
    below = _below(kernels.galerkin(links, diagonal, scale, aggregates), coarse)
    return cycle(links, diagonal, scale, aggregates, below)


def cycle(links, diagonal, scale, aggregates, coarse, *, seen=None, beside=None):
    """One symmetric cycle on the finest level, by what solves on the aggregates."""
    level, n, single = level_of(links, diagonal, scale), len(diagonal), np.float32
    blocks = -(-n // kernels.ROWS)
    load, y, x = np.empty(n, single), np.empty(n, single), np.zeros(n if seen is None else seen, single)
    received = np.empty(len(aggregates.start) - 1)

    def apply(r, norm, z):
        np.multiply(r, 1.0 / norm, out=load, casting="same_kind")
        shared_out(kernels.forward, blocks, level, load, x, piece=1)
        if beside:
            beside(x)
        shared_out(kernels.defect, n, level, x, y, piece=ROWS)
        shared_out(kernels.restrict, len(received), aggregates, y, received, piece=ROWS)
        shared_out(kernels.correct, n, aggregates, coarse(received), ENLARGED, x, piece=4 * ROWS)
        if beside:
            beside(x)
        shared_out(kernels.backward, blocks, level, load, x, y, piece=1)
        np.multiply(y, scale * norm, out=z, dtype=float)

    return apply


def aggregated(links, n):
    """Join the particles of n rows to aggregates."""
    top, owner = np.empty(n), np.empty(n, np.int32)
    shared_out(kernels.strongest, n, links, top, piece=ROWS)
    return kernels.members(owner, kernels.aggregate(links, top, MOST, owner))


def level_of(links, diagonal, scale):
    """The matrix times a scale, arranged for sweeps."""
    n, inverse = len(diagonal), np.zeros(len(diagonal), np.float32)
    inverse[diagonal > 0] = 1.0 / (scale * diagonal[diagonal > 0])
    small, m = np.min_scalar_type(int(np.diff(links.indptr).max(initial=0))), len(links.indices)
    ends, place, values = np.empty((n, 2), small), np.empty(m, small), np.empty(m, np.float32)
    level = kernels.Level(links.indptr, links.indices, ends, place, values, inverse)
    shared_out(kernels.arrange, -(-n // kernels.ROWS), links, scale, level, piece=1)
    return level


def _below(rows, precision):
    """A cycle of pyamg's on the aggregates, of the rows of their matrix."""
    import pyamg

    pointers, columns, values = rows
    count = len(pointers) - 1
    a = sparse.csr_matrix((values, columns, pointers), shape=(count, count))
    with seeded():
        hierarchy = pyamg.ruge_stuben_solver(a, **CYCLE)
    if precision == np.float64:
        return lambda r: _cycle(hierarchy, 0, r)
    # What is solved directly stays as it is: it is small, and nearly singular.
    for level in hierarchy.levels[:-1]:
        level.A, level.P, level.R = (matrix.astype(precision) for matrix in (level.A, level.P, level.R))
    return lambda r: _cycle(hierarchy, 0, r.astype(precision)).astype(float)


def _cycle(hierarchy, depth, r):
    """One V-cycle from zero; pyamg's own solver computes norms besides."""
    level = hierarchy.levels[depth]
    if depth == len(hierarchy.levels) - 1:
        return hierarchy.coarse_solver(level.A, r.astype(float, copy=False)).astype(r.dtype, copy=False)
    x = np.zeros_like(r)
    level.presmoother(level.A, x, r)
    x += level.P @ _cycle(hierarchy, depth + 1, level.R @ (r - level.A @ x))
    level.postsmoother(level.A, x, r)
    return x
