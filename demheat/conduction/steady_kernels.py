"""Compiled conjugate gradients on a network, and its heat flows.

Sums are taken over fixed blocks of rows and added in order, so that bits do not depend on the number of threads.
"""

import numpy as np
from numba import njit, prange

BLOCK = 2048


@njit(cache=True, parallel=True)
def direct(beta, z, p):
    """p = z + beta p."""
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
    """Sum of a b."""
    partial = np.empty((len(a) + BLOCK - 1) // BLOCK)
    _dots(a, b, partial)
    return partial.sum()


@njit(cache=True, parallel=True)
def _apply(indptr, indices, conductance, diagonal, p, q, partial):
    """q = A p and the block sums of p.q."""
    n = len(p)
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
def apply(indptr, indices, conductance, diagonal, p, q):
    """q = A p with A = diag(diagonal) - conductance; returns p.q."""
    partial = np.empty((len(p) + BLOCK - 1) // BLOCK)
    _apply(indptr, indices, conductance, diagonal, p, q, partial)
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
    """x += alpha p and r -= alpha q; returns r.r."""
    partial = np.empty((len(p) + BLOCK - 1) // BLOCK)
    _steps(alpha, p, q, x, r, partial)
    return partial.sum()


@njit(cache=True, parallel=True)
def _advance(alpha, p, q, inverse, x, r, z, partial_rz, partial_rr):
    """Step of length alpha, and the block sums of r.z and r.r."""
    n = len(p)
    for block in prange(len(partial_rz)):
        rz, rr = 0.0, 0.0
        for i in range(block * BLOCK, min(n, (block + 1) * BLOCK)):
            x[i] += alpha * p[i]
            r[i] -= alpha * q[i]
            z[i] = inverse[i] * r[i]
            rz += r[i] * z[i]
            rr += r[i] * r[i]
        partial_rz[block] = rz
        partial_rr[block] = rr


@njit(cache=True)
def conjugate_gradients(indptr, indices, conductance, diagonal, r, x, limit, most):
    """Solve A dx = r by Jacobi-preconditioned conjugate gradients, adding dx to x in place.

    A = diag(diagonal) - conductance; r is overwritten. Stops when |r| <= limit; returns the iterations done.
    """
    n = len(x)
    blocks = (n + BLOCK - 1) // BLOCK
    partial, partial_rr = np.empty(blocks), np.empty(blocks)
    inverse = np.empty(n)
    for i in range(n):
        inverse[i] = 1.0 / diagonal[i] if diagonal[i] > 0.0 else 0.0
    z = inverse * r
    p = z.copy()
    q = np.empty(n)
    rz = np.sum(r * z)
    if np.sqrt(np.sum(r * r)) <= limit:
        return 0
    for iteration in range(1, most + 1):
        _apply(indptr, indices, conductance, diagonal, p, q, partial)
        pq = partial.sum()
        if pq <= 0.0:
            return -iteration
        _advance(rz / pq, p, q, inverse, x, r, z, partial, partial_rr)
        if np.sqrt(partial_rr.sum()) <= limit:
            return iteration
        before, rz = rz, partial.sum()
        direct(rz / before, z, p)
    return -most


@njit(cache=True, parallel=True)
def row_sums(indptr, conductance, total):
    """Write the sum of each row's conductances to total."""
    for i in prange(len(total)):
        here = 0.0
        for e in range(indptr[i], indptr[i + 1]):
            here += conductance[e]
        total[i] = here


@njit(cache=True)
def spread(indptr, indices, conductance, reached):
    """Mark, in place, all particles that conducting links join to those already marked."""
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
def residual(indptr, indices, conductance, diagonal, b, x, r):
    """Write b - A x to r."""
    for i in prange(len(x)):
        flow = b[i] - diagonal[i] * x[i]
        for e in range(indptr[i], indptr[i + 1]):
            flow += conductance[e] * x[indices[e]]
        r[i] = flow


@njit(cache=True)
def _step(i, e, centers, size, indices, image, branch):
    """Vector from particle i to its neighbour (image) along link e, into branch; its squared length."""
    code = np.int64(image[e])
    j = indices[e]
    branch[0] = centers[j, 0] - centers[i, 0] + (code // 9 - 1) * size[0]
    branch[1] = centers[j, 1] - centers[i, 1] + (code // 3 % 3 - 1) * size[1]
    branch[2] = centers[j, 2] - centers[i, 2] + (code % 3 - 1) * size[2]
    return branch[0] ** 2 + branch[1] ** 2 + branch[2] ** 2


@njit(cache=True, parallel=True)
def flows(centers, size, indptr, indices, image, conductance, gradient, x, received, throughput):
    """Heat received by each particle over its links, and the sum of the sizes of those flows.

    Temperatures are x plus the linear field of the gradient.
    """
    for i in prange(len(x)):
        branch = np.empty(3)
        heat, passing = 0.0, 0.0
        for e in range(indptr[i], indptr[i + 1]):
            _step(i, e, centers, size, indices, image, branch)
            rise = x[indices[e]] - x[i]
            for k in range(3):
                rise += gradient[k] * branch[k]
            heat += conductance[e] * rise
            passing += abs(conductance[e] * rise)
        received[i] = heat
        throughput[i] = passing


@njit(cache=True, parallel=True)
def moments(centers, size, indptr, indices, image, conductance, gradient, x, first):
    """Write sum over links of W b / 2 to first (n, 3): W heat received by the row, b the branch vector.

    Temperatures are x plus the linear field of the gradient.
    """
    for i in prange(len(x)):
        branch = np.empty(3)
        for k in range(3):
            first[i, k] = 0.0
        for e in range(indptr[i], indptr[i + 1]):
            _step(i, e, centers, size, indices, image, branch)
            rise = x[indices[e]] - x[i]
            for k in range(3):
                rise += gradient[k] * branch[k]
            for k in range(3):
                first[i, k] += 0.5 * conductance[e] * rise * branch[k]


@njit(cache=True, parallel=True)
def reconstruct(centers, size, indptr, indices, image, area, conductance, gradient, x, shape, flow):
    """Write sum S e e to shape (n, 3, 3) and sum e W to flow (n, 3), e the unit vector and W the heat received."""
    for i in prange(len(x)):
        branch = np.empty(3)
        for k in range(3):
            flow[i, k] = 0.0
            for m in range(3):
                shape[i, k, m] = 0.0
        for e in range(indptr[i], indptr[i + 1]):
            length = np.sqrt(_step(i, e, centers, size, indices, image, branch))
            rise = x[indices[e]] - x[i]
            for k in range(3):
                rise += gradient[k] * branch[k]
            for k in range(3):
                flow[i, k] += conductance[e] * rise * branch[k] / length
                for m in range(3):
                    shape[i, k, m] += area[e] * branch[k] * branch[m] / length**2
