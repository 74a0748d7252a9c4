"""Compiled sums of the heat flows of each particle over parts of its links."""

import numpy as np
from numba import njit, prange

from demheat.conduction.steady_kernels import _step

HALF, RADII, CELL = 0, 1, 2


@njit(cache=True, parallel=True)
def shared_moments(centers, size, indptr, indices, image, conductance, gradient, x, radii, distance, split, flow):
    """Write sum over links of W s b to flow (n, 3): W heat received by the row, b the branch vector, s its part of it.

    Temperatures are x plus the linear field of the gradient. s is 1/2, R_p / (R_p + R_q), or distance over length.
    """
    for i in prange(len(x)):
        branch = np.empty(3)
        for k in range(3):
            flow[i, k] = 0.0
        for e in range(indptr[i], indptr[i + 1]):
            j = indices[e]
            length = np.sqrt(_step(i, e, centers, size, indices, image, branch))
            rise = x[j] - x[i]
            for k in range(3):
                rise += gradient[k] * branch[k]
            share = 0.5
            if split == RADII:
                share = radii[i] / (radii[i] + radii[j])
            elif split == CELL:
                share = distance[e] / length
            for k in range(3):
                flow[i, k] += share * conductance[e] * rise * branch[k]
