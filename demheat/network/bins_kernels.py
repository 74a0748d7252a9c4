"""Points filed in the cells of a regular grid, compiled."""

import numpy as np
from numba import njit


@njit(cache=True)
def bin_points(points, size, counts):
    """Sort points into the cells of a grid by counting.

    Parameters
    ----------
    points : (n, 3) float array, m
        What lies outside the box goes to the nearest cell.
    size : (3,) float array, m
        The box is 0 to size.
    counts : (3,) int64 array
        Cells along each axis; they are numbered along the last axis first.

    Returns
    -------
    start : (cells + 1,) int64 array
        Where each cell begins among the items.
    items : (n,) uint32 array
        Numbers of the points, those of one cell side by side and ascending.
    """
    n = len(points)
    cell = np.empty(n, np.int64)
    start = np.zeros(counts[0] * counts[1] * counts[2] + 1, np.int64)
    for i in range(n):
        c = np.int64(0)
        for k in range(3):
            x = np.int64(points[i, k] / size[k] * counts[k])
            c = c * counts[k] + min(max(x, 0), counts[k] - 1)
        cell[i] = c
        start[c + 1] += 1
    start = np.cumsum(start)
    fill = start[:-1].copy()
    items = np.empty(n, np.uint32)
    for i in range(n):
        items[fill[cell[i]]] = i
        fill[cell[i]] += 1
    return start, items
