"""Products and sums over the rows of a network, shared out to threads."""

import numpy as np

from demheat.conduction import steady_kernels as kernels
from demheat.network.links_kernels import links_of, places_of
from demheat.runtime.threads import shared_out

# Rows, and blocks of them, that a thread does at a time: half a millisecond or so of what links have to do with.
ROWS = 16 * kernels.BLOCK


def _of_blocks(kernel, count, *arguments):
    """Sum over all blocks of what a kernel finds of each."""
    partial = np.empty(-(-count // kernels.BLOCK))
    shared_out(kernel, len(partial), *arguments, partial, piece=ROWS // kernels.BLOCK)
    return float(partial.sum())


def dot(a, b) -> float:
    """Sum of a b."""
    # Not by BLAS, whose order of sums is that of its threads.
    return float(np.einsum("i,i->", a, b))


def apply(links, diagonal, p, q) -> float:
    """Multiply by the matrix, q becomes A p; p.q."""
    return _of_blocks(kernels.apply, len(q), links, diagonal, p, q)


def advance(alpha, p, q, x, r) -> float:
    """Go along a direction, x grows by alpha p, r falls by alpha q; r.r after the step."""
    return _of_blocks(kernels.advance, len(p), alpha, p, q, x, r)


def flows(network, gradient, x):
    """Heat that each particle receives over its links, (n,), W, how much passes, (n,), W, and moments, (n, 3), W m."""
    n = len(x)
    found = np.empty(n), np.empty(n), np.empty((n, 3))
    shared_out(kernels.flows, n, links_of(network), places_of(network), gradient, x, *found, piece=ROWS)
    return found


def reconstruct(network, gradient, x):
    """Sums over the links of each particle of S e e, (n, 3, 3), m2, and of e W, (n, 3), W."""
    n = len(x)
    found = np.empty((n, 3, 3)), np.empty((n, 3))
    where = links_of(network), places_of(network), network.area
    shared_out(kernels.reconstruct, n, *where, gradient, x, *found, piece=ROWS)
    return found


def row_sums(indptr, values):
    """Sums over each row, (n,) float array."""
    total, some = np.zeros(len(indptr) - 1), np.flatnonzero(np.diff(indptr))
    if len(some):
        total[some] = np.add.reduceat(values[: indptr[-1]], indptr[some])
    return total


def spread(links, reached) -> None:
    """Mark all particles that conducting links join, over any number of others, to those already marked."""
    marked = np.flatnonzero(reached)
    queue = np.empty(len(reached), np.uint32)
    queue[: len(marked)] = marked
    kernels.spread(links, reached, queue, len(marked))
