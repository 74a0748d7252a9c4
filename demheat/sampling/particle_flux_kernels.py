"""Compiled sums of the heat flows of each particle over parts of its links."""

import numpy as np
from numba import njit

from demheat.network.links_kernels import IN_PIECES, rise_along

HALF, RADII, CELL = 0, 1, 2


@njit(**IN_PIECES)
def shared_moments(first, last, links, places, gradient, x, radii, distance, split, flow):
    """Sum over the links of each particle of s W b: W the heat it receives, b the branch vector, s its own part of it.

    first, last : int; rows
    links : Links
    places : Places
    gradient : (3,) float array, K/m
    x : (n,) float array, K; temperatures less the linear field of the gradient
    radii : (n,) float array, m
    distance : (m,) float array, m; from the row's centre to the facet of each link
    split : {HALF, RADII, CELL}; s is 1/2, R_p / (R_p + R_q), or distance over length
    flow : (n, 3) float array, W m, out
    """
    indptr, indices, conductance = links
    for i in range(first, last):
        for k in range(3):
            flow[i, k] = 0.0
        for e in range(indptr[i], indptr[i + 1]):
            rise, u, v, w = rise_along(i, e, links, places, gradient, x)
            share = 0.5
            if split == RADII:
                share = radii[i] / (radii[i] + radii[indices[e]])
            elif split == CELL:
                share = distance[e] / np.sqrt(u * u + v * v + w * w)
            heat = share * conductance[e] * rise
            flow[i, 0] += heat * u
            flow[i, 1] += heat * v
            flow[i, 2] += heat * w
