"""Only here: points filed in other cells than they lie in."""

import numpy as np

from demheat.network.bins import bin_points


def test_points_are_filed_by_cell_and_number():
    rng = np.random.default_rng(0)
    size, counts = np.array([1.0, 2.0, 0.5]), np.array([3, 4, 2])
    points = rng.random((80, 3)) * size
    points[:3] = size, -0.01 * size, 1.01 * size  # on the far corner, and beyond the box: the nearest cell
    start, items = bin_points(points, size, counts)
    x, y, z = np.clip(np.floor(points / size * counts), 0, counts - 1).astype(int).T
    cell = (x * 4 + y) * 2 + z
    assert start[0] == 0 and len(start) == 25 and start[-1] == 80
    for c in range(24):
        assert np.array_equal(items[start[c] : start[c + 1]], np.flatnonzero(cell == c))
