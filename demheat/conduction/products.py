"""Products and sums over the rows of a network: of many compiled and shared out to threads, of few by NumPy.

Of few rows both take as long, and to compile takes longer than to solve.
"""

from functools import partial

import numpy as np
from scipy import sparse

from demheat.conduction import steady_kernels as kernels
from demheat.network.base import FEW, branches, row_numbers
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
    if len(q) <= FEW:
        return multiplier(links, diagonal, len(p))(p, q)
    return _of_blocks(kernels.apply, len(q), links, diagonal, p, q)


def multiplier(links, diagonal, columns):
    """A function that multiplies vectors of so many columns by the matrix again and again, as `apply` does once."""
    n = len(diagonal)
    if n > FEW:
        return partial(apply, links, diagonal)
    rows = (each.astype(np.int32) for each in (links.indices, links.indptr))
    matrix = sparse.csr_matrix((links.conductance, *rows), shape=(n, columns))

    def multiply(p, q):
        np.subtract(diagonal * p[:n], matrix @ p, out=q)
        return dot(p[:n], q)

    return multiply


def advance(alpha, p, q, x, r) -> float:
    """Go along a direction, x grows by alpha p, r falls by alpha q; r.r after the step."""
    if len(p) <= FEW:
        x += alpha * p
        r -= alpha * q
        return dot(r, r)
    return _of_blocks(kernels.advance, len(p), alpha, p, q, x, r)


def flows(network, gradient, x):
    """Heat that each particle receives over its links, (n,), W, how much passes, (n,), W, and moments, (n, 3), W m."""
    n = len(x)
    if n <= FEW:
        return _few_flows(network, gradient, x)
    found = np.empty(n), np.empty(n), np.empty((n, 3))
    shared_out(kernels.flows, n, links_of(network), places_of(network), gradient, x, *found, piece=ROWS)
    return found


def _few_flows(network, gradient, x):
    heat, way = _few_links(network, gradient, x)
    moments = [row_sums(network.indptr, 0.5 * heat * along) for along in way.T]
    return row_sums(network.indptr, heat), row_sums(network.indptr, np.abs(heat)), np.stack(moments, axis=1)


def _few_links(network, gradient, x):
    """Heat that is received over each link, and the vector along it."""
    indptr, indices = network.indptr, network.indices
    way = branches(network.centers, network.size, indptr, indices, network.image)
    rise = x[indices] - x[row_numbers(indptr)]
    for k in range(3):
        rise += gradient[k] * way[:, k]
    return network.conductance * rise, way


def reconstruct(network, gradient, x):
    """Sums over the links of each particle of S e e, (n, 3, 3), m2, and of e W, (n, 3), W."""
    n = len(x)
    if n <= FEW:
        heat, way = _few_links(network, gradient, x)
        unit = way / np.sqrt(np.einsum("ij,ij->i", way, way))[:, None]
        shape = [[row_sums(network.indptr, network.area * a * b) for a in unit.T] for b in unit.T]
        flow = [row_sums(network.indptr, heat * a) for a in unit.T]
        return np.ascontiguousarray(np.moveaxis(shape, 2, 0)), np.stack(flow, axis=1)
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
