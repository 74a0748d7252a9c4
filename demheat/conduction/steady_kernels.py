"""Compiled conjugate gradients on a network, and its heat flows.

The matrix of a network is A = diag(diagonal) - conductance. Sums are taken over fixed blocks of rows and added in
order, so that bits do not depend on the number of threads.
"""

import numpy as np
from numba import njit, prange

from demheat.network.links_kernels import rise_along

BLOCK = 2048


@njit(cache=True, parallel=True)
def direct(beta, z, p):
    """Turn a direction of descent: p becomes z + beta p.

    Parameters
    ----------
    beta : float
    z : (n,) float array, K
        Preconditioned residual.
    p : (n,) float array, K, in and out
    """
    for i in prange(len(p)):
        p[i] = z[i] + beta * p[i]


@njit(cache=True, parallel=True)
def _dots(a, b, partial):
    for block in prange(len(partial)):
        total = 0.0
        for i in range(block * BLOCK, min(len(a), (block + 1) * BLOCK)):
            total += a[i] * b[i]
        partial[block] = total


@njit(cache=True)
def dot(a, b):
    """Sum of a b.

    Parameters
    ----------
    a, b : (n,) float arrays

    Returns
    -------
    float
    """
    partial = np.empty((len(a) + BLOCK - 1) // BLOCK)
    _dots(a, b, partial)
    return partial.sum()


@njit(cache=True, parallel=True)
def _apply(links, diagonal, p, q, partial):
    """q = A p and the block sums of p.q."""
    indptr, indices, conductance = links
    n = len(q)
    for block in prange(len(partial)):
        total = 0.0
        for i in range(block * BLOCK, min(n, (block + 1) * BLOCK)):
            flow = diagonal[i] * p[i]
            for e in range(indptr[i], indptr[i + 1]):
                flow -= conductance[e] * p[indices[e]]
            q[i] = flow
            total += p[i] * flow
        partial[block] = total


@njit(cache=True)
def apply(links, diagonal, p, q):
    """Multiply by the matrix: q becomes A p.

    Parameters
    ----------
    links : Links
    diagonal : (n,) float array, W/K
    p : (n,) float array, K
        Or longer, where links lead beyond the rows.
    q : (n,) float array, W, out

    Returns
    -------
    float, W K
        p.q.
    """
    partial = np.empty((len(q) + BLOCK - 1) // BLOCK)
    _apply(links, diagonal, p, q, partial)
    return partial.sum()


@njit(cache=True, parallel=True)
def _steps(alpha, p, q, x, r, partial):
    for block in prange(len(partial)):
        rr = 0.0
        for i in range(block * BLOCK, min(len(p), (block + 1) * BLOCK)):
            x[i] += alpha * p[i]
            r[i] -= alpha * q[i]
            rr += r[i] * r[i]
        partial[block] = rr


@njit(cache=True)
def advance(alpha, p, q, x, r):
    """Go along a direction: x grows by alpha p, r falls by alpha q.

    Parameters
    ----------
    alpha : float
    p : (n,) float array, K
    q : (n,) float array, W
        A p.
    x : (n,) float array, K, in and out
    r : (n,) float array, W, in and out
        Residual.

    Returns
    -------
    float, W2
        r.r after the step.
    """
    partial = np.empty((len(p) + BLOCK - 1) // BLOCK)
    _steps(alpha, p, q, x, r, partial)
    return partial.sum()


@njit(cache=True, parallel=True)
def _advance(alpha, p, q, inverse, x, r, z, sums):
    """Step of length alpha, and the block sums of r.z and r.r as the rows of `sums`."""
    n = len(p)
    for block in prange(sums.shape[1]):
        rz, rr = 0.0, 0.0
        for i in range(block * BLOCK, min(n, (block + 1) * BLOCK)):
            x[i] += alpha * p[i]
            r[i] -= alpha * q[i]
            z[i] = inverse[i] * r[i]
            rz += r[i] * z[i]
            rr += r[i] * r[i]
        sums[0, block] = rz
        sums[1, block] = rr


@njit(cache=True)
def conjugate_gradients(links, diagonal, r, x, limit, most, p, rz):
    """Solve A dx = r by Jacobi-preconditioned conjugate gradients, adding dx to x in place, or go on with it.

    Parameters
    ----------
    links : Links
    diagonal : (n,) float array, W/K
        Rows with zero have no equation: r must be zero there.
    r : (n,) float array, W
        Overwritten.
    x : (n,) float array, K, in and out
    limit : float, W
        Stop when |r| is at most this.
    most : int
        Iterations at most.
    p : (n,) float array, K, in and out
        Direction of the next iteration.
    rz : (1,) float array, W K, in and out
        0 to begin; else p, rz, r and x are those of the call before.

    Returns
    -------
    int
        Iterations done; negative if r is still larger than the limit.
    """
    n = len(x)
    blocks = (n + BLOCK - 1) // BLOCK
    partial, sums = np.empty(blocks), np.empty((2, blocks))
    inverse = np.empty(n)
    for i in range(n):
        inverse[i] = 1.0 / diagonal[i] if diagonal[i] > 0.0 else 0.0
    z, q = np.empty(n), np.empty(n)
    if rz[0] == 0.0:
        for i in range(n):
            p[i] = inverse[i] * r[i]
        rz[0] = np.sum(r * p)
        if np.sqrt(np.sum(r * r)) <= limit:
            return 0
    for iteration in range(1, most + 1):
        _apply(links, diagonal, p, q, partial)
        pq = partial.sum()
        if pq <= 0.0:
            return -iteration
        _advance(rz[0] / pq, p, q, inverse, x, r, z, sums)
        if np.sqrt(sums[1].sum()) <= limit:
            return iteration
        before = rz[0]
        rz[0] = sums[0].sum()
        direct(rz[0] / before, z, p)
    return -most


@njit(cache=True, parallel=True)
def row_sums(links, total):
    """Add up the conductances of each row.

    Parameters
    ----------
    links : Links
    total : (n,) float array, W/K, out
    """
    indptr, _, conductance = links
    for i in prange(len(total)):
        here = 0.0
        for e in range(indptr[i], indptr[i + 1]):
            here += conductance[e]
        total[i] = here


@njit(cache=True)
def spread(links, reached):
    """Mark all particles that conducting links join, over any number of others, to those already marked.

    Parameters
    ----------
    links : Links
    reached : (n,) bool array, in and out
    """
    indptr, indices, conductance = links
    front = np.flatnonzero(reached).astype(np.uint32)
    while len(front):
        following = np.empty(len(front) + 1024, np.uint32)
        number = 0
        for i in front:
            for e in range(indptr[i], indptr[i + 1]):
                j = indices[e]
                if reached[j] or conductance[e] <= 0.0:
                    continue
                reached[j] = True
                if number == len(following):
                    following = np.concatenate((following, np.empty(number, np.uint32)))
                following[number] = j
                number += 1
        front = following[:number]


@njit(cache=True, parallel=True)
def residual(links, diagonal, b, x, r):
    """Find what is left of an equation: r becomes b - A x.

    Parameters
    ----------
    links : Links
    diagonal : (n,) float array, W/K
    b : (n,) float array, W
    x : (n,) float array, K
    r : (n,) float array, W, out
    """
    indptr, indices, conductance = links
    for i in prange(len(x)):
        flow = b[i] - diagonal[i] * x[i]
        for e in range(indptr[i], indptr[i + 1]):
            flow += conductance[e] * x[indices[e]]
        r[i] = flow


@njit(cache=True, parallel=True)
def flows(links, places, gradient, x, received, throughput):
    """Heat that each particle receives over its links, and how much passes.

    Parameters
    ----------
    links : Links
    places : Places
    gradient : (3,) float array, K/m
    x : (n,) float array, K
        Temperatures less the linear field of the gradient.
    received : (n,) float array, W, out
    throughput : (n,) float array, W, out
        Sum of the sizes of those flows.
    """
    indptr, conductance = links.indptr, links.conductance
    for i in prange(len(x)):
        branch = np.empty(3)
        heat, passing = 0.0, 0.0
        for e in range(indptr[i], indptr[i + 1]):
            rise, _ = rise_along(i, e, links, places, gradient, x, branch)
            heat += conductance[e] * rise
            passing += abs(conductance[e] * rise)
        received[i] = heat
        throughput[i] = passing


@njit(cache=True, parallel=True)
def moments(links, places, gradient, x, first):
    """Sum over the links of each particle of W b / 2: W the heat it receives, b the branch vector.

    Parameters
    ----------
    links : Links
    places : Places
    gradient : (3,) float array, K/m
    x : (n,) float array, K
        Temperatures less the linear field of the gradient.
    first : (n, 3) float array, W m, out
    """
    indptr, conductance = links.indptr, links.conductance
    for i in prange(len(x)):
        branch = np.empty(3)
        for k in range(3):
            first[i, k] = 0.0
        for e in range(indptr[i], indptr[i + 1]):
            rise, _ = rise_along(i, e, links, places, gradient, x, branch)
            for k in range(3):
                first[i, k] += 0.5 * conductance[e] * rise * branch[k]


@njit(cache=True, parallel=True)
def reconstruct(links, places, area, gradient, x, shape, flow):
    """Sums over the links of each particle of S e e and of e W: e the unit vector, W the heat it receives.

    Parameters
    ----------
    links : Links
    places : Places
    area : (m,) float array, m2
        S of each link.
    gradient : (3,) float array, K/m
    x : (n,) float array, K
        Temperatures less the linear field of the gradient.
    shape : (n, 3, 3) float array, m2, out
    flow : (n, 3) float array, W, out
    """
    indptr, conductance = links.indptr, links.conductance
    for i in prange(len(x)):
        branch = np.empty(3)
        for k in range(3):
            flow[i, k] = 0.0
            for m in range(3):
                shape[i, k, m] = 0.0
        for e in range(indptr[i], indptr[i + 1]):
            rise, square = rise_along(i, e, links, places, gradient, x, branch)
            length = np.sqrt(square)
            for k in range(3):
                flow[i, k] += conductance[e] * rise * branch[k] / length
                for m in range(3):
                    shape[i, k, m] += area[e] * branch[k] * branch[m] / length**2
