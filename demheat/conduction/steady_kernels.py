"""Compiled products and sums over the rows of a network.

The matrix of a network is A = diag(diagonal) - conductance. Threads do rows, or blocks of rows, from `first` to `last`
(`demheat.conduction.products` shares them out); sums over all are those of blocks, so that bits do not depend on the
number of threads. Numbers that count rows and links are unsigned: of others Numba asks whether they count from the end,
a third of the time.
"""

import numpy as np
from numba import njit

from demheat.network.links_kernels import IN_PIECES, rise_along

BLOCK = 2048


@njit(**IN_PIECES)
def apply(first, last, links, diagonal, p, q, partial):
    """Multiply by the matrix: q becomes A p.

    first, last : int; blocks
    links : Links
    diagonal : (n,) float array, W/K
    p : (n,) float array, K; or longer, where links lead beyond the rows
    q : (n,) float array, W, out
    partial : (blocks,) float array, W K, out; sums of p q
    """
    indptr, indices, conductance = links
    for block in range(first, last):
        total = 0.0
        for i in range(np.uint64(block * BLOCK), np.uint64(min(len(q), (block + 1) * BLOCK))):
            flow = diagonal[i] * p[i]
            for e in range(np.uint64(indptr[i]), np.uint64(indptr[i + np.uint64(1)])):
                flow -= conductance[e] * p[indices[e]]
            q[i] = flow
            total += p[i] * flow
        partial[block] = total


@njit(**IN_PIECES)
def advance(first, last, alpha, p, q, x, r, partial):
    """Go along a direction: x grows by alpha p, r falls by alpha q.

    first, last : int; blocks
    alpha : float
    p : (n,) float array, K
    q : (n,) float array, W; A p
    x : (n,) float array, K, in and out
    r : (n,) float array, W, in and out; residual
    partial : (blocks,) float array, W2, out; sums of r r after the step
    """
    for block in range(first, last):
        rr = 0.0
        for i in range(np.uint64(block * BLOCK), np.uint64(min(len(p), (block + 1) * BLOCK))):
            x[i] += alpha * p[i]
            r[i] -= alpha * q[i]
            rr += r[i] * r[i]
        partial[block] = rr


@njit(**IN_PIECES)
def spread(links, reached, queue, number):
    """Mark all particles that conducting links join, over any number of others, to those already marked.

    links : Links
    reached : (n,) bool array, in and out
    queue : (n,) uint32 array, in and out; at first those marked
    number : int; of them
    """
    indptr, indices, conductance = links
    head = 0
    while head < number:
        i = queue[head]
        head += 1
        for e in range(indptr[i], indptr[i + 1]):
            j = indices[e]
            if not reached[j] and conductance[e] > 0.0:
                reached[j] = True
                queue[number] = j
                number += 1


@njit(**IN_PIECES)
def flows(first, last, links, places, gradient, x, received, throughput, moment):
    """Heat that each particle receives over its links, how much passes, and their moments.

    first, last : int; rows
    links : Links
    places : Places
    gradient : (3,) float array, K/m
    x : (n,) float array, K; temperatures less the linear field of the gradient
    received : (n,) float array, W, out
    throughput : (n,) float array, W, out; sum of the sizes of those flows
    moment : (n, 3) float array, W m, out; sum of W b / 2: W the heat received over a link, b its vector from the
      particle to its neighbour
    """
    indptr, conductance = links.indptr, links.conductance
    for i in range(np.uint64(first), np.uint64(last)):
        heat, passing, along_x, along_y, along_z = 0.0, 0.0, 0.0, 0.0, 0.0
        for e in range(np.uint64(indptr[i]), np.uint64(indptr[i + np.uint64(1)])):
            rise, u, v, w = rise_along(i, e, links, places, gradient, x)
            flow = conductance[e] * rise
            heat += flow
            passing += abs(flow)
            along_x += flow * u
            along_y += flow * v
            along_z += flow * w
        received[i], throughput[i] = heat, passing
        moment[i, 0], moment[i, 1], moment[i, 2] = 0.5 * along_x, 0.5 * along_y, 0.5 * along_z


@njit(**IN_PIECES)
def reconstruct(first, last, links, places, area, gradient, x, shape, flow):
    """Sums over the links of each particle of S e e and of e W: e the unit vector, W the heat it receives.

    first, last : int; rows
    links : Links
    places : Places
    area : (m,) float array, m2; S of each link
    gradient : (3,) float array, K/m
    x : (n,) float array, K; temperatures less the linear field of the gradient
    shape : (n, 3, 3) float array, m2, out
    flow : (n, 3) float array, W, out
    """
    indptr, conductance = links.indptr, links.conductance
    for i in range(np.uint64(first), np.uint64(last)):
        xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        along_x, along_y, along_z = 0.0, 0.0, 0.0
        for e in range(np.uint64(indptr[i]), np.uint64(indptr[i + np.uint64(1)])):
            rise, u, v, w = rise_along(i, e, links, places, gradient, x)
            square = u * u + v * v + w * w
            heat, part = conductance[e] * rise / np.sqrt(square), area[e] / square
            along_x += heat * u
            along_y += heat * v
            along_z += heat * w
            xx += part * u * u
            xy += part * u * v
            xz += part * u * w
            yy += part * v * v
            yz += part * v * w
            zz += part * w * w
        flow[i, 0], flow[i, 1], flow[i, 2] = along_x, along_y, along_z
        shape[i, 0, 0], shape[i, 0, 1], shape[i, 0, 2] = xx, xy, xz
        shape[i, 1, 0], shape[i, 1, 1], shape[i, 1, 2] = xy, yy, yz
        shape[i, 2, 0], shape[i, 2, 1], shape[i, 2, 2] = xz, yz, zz
