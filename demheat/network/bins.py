"""Points filed in the cells of a regular grid."""

import numpy as np
from scipy import sparse


def bin_points(points, size, counts):
    """Sort points, (n, 3), into as many cells of the box from 0 to `size` along each axis as counts say.

    Cells are numbered along the last axis first; what lies outside of the box goes to the nearest one. Returned are
    where each cell begins among the items, (cells + 1,) int64 array, and the items, (n,) uint32 array: the numbers of
    the points, those of one cell side by side and ascending.
    """
    cell, n = np.zeros(len(points), np.int64), len(points)
    for k in range(3):
        x = (points[:, k] / size[k] * counts[k]).astype(np.int64)
        cell = cell * counts[k] + np.clip(x, 0, counts[k] - 1)
    # One entry for each point, in the row of its cell: SciPy turns columns to rows by counting.
    shape = int(np.prod(counts)), n
    rows = sparse.csc_matrix((np.ones(n, np.int8), cell, np.arange(n + 1)), shape=shape).tocsr()
    return rows.indptr.astype(np.int64), rows.indices.astype(np.uint32)
