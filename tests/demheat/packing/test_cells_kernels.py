"""Only here: cells of a grid that hold other points than lie in them, beside a look at all pairs."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat.packing import cells_kernels as kernels
from demheat.packing.neighbours import build_grid

pytestmark = pytest.mark.twin
SIZE, REACH = np.array([1.0, 0.7, 0.8]), kernels.Reach(1.2, 0.05)


def some_points(number, seed=0):
    """Centres and radii of two size levels."""
    rng = np.random.default_rng(seed)
    radii = np.where(rng.random(number) < 0.1, 0.2, 0.03) * rng.uniform(0.8, 1.0, number)
    return np.column_stack((rng.random((number, 3)) * SIZE, radii))


def offsets(points, others, period):
    """Vectors from each point to the nearest image of each other, (n, m, 3)."""
    d = others[None, :, :3] - points[:, None, :3]
    return d - np.where(period > 0, period * np.rint(d / np.where(period > 0, period, 1.0)), 0.0)


def near(points, others, period, reach):
    """Which are near, (n, m) bool array."""
    distance = np.linalg.norm(offsets(points, others, period), axis=2)
    return distance < reach.scale * (points[:, None, 3] + others[:, 3]) + reach.skin


def compressed(matrix):
    """Rows of a bool matrix."""
    return np.concatenate(([0], np.cumsum(matrix.sum(axis=1)))), np.nonzero(matrix)[1]


def some_rows(number, seed=0):
    """Rows of up to three numbers, unsorted."""
    rng = np.random.default_rng(seed)
    rows = [rng.permutation(number)[:length].astype(np.uint32) for length in rng.integers(0, 4, number)]
    return rows, np.concatenate(([0], np.cumsum([len(row) for row in rows])))


def test_fill_cells():
    points, rng = some_points(80), np.random.default_rng(1)
    # On two faces and, as walls let them, a little beyond.
    points[0, :3], points[1, :3], points[2, :3] = SIZE, 0.0, SIZE * 1.01
    level, dims = rng.integers(0, 2, 80), np.array([[2, 1, 3], [4, 3, 5]])
    cells = dims.prod(axis=1)
    first, start = np.array([0, cells[0]]), np.empty(cells.sum() + 1, dtype=np.int64)
    order, slots = np.empty(80, dtype=np.uint32), np.empty((80, 4))
    grid = kernels.Grid(dims, SIZE / dims, np.zeros(2), first, start, order, slots, np.zeros(3))
    kernels.fill_cells(points, level, grid)
    place = np.clip(np.floor(points[:, :3] / grid.cell[level]).astype(int), 0, dims[level] - 1)
    keys = [first[k] + np.ravel_multi_index(p, dims[k]) for k, p in zip(level, place, strict=True)]
    expected = np.argsort(keys, kind="stable")
    assert_array_equal(order, expected)
    assert_array_equal(slots, points[expected])
    assert_array_equal(start, np.searchsorted(np.sort(keys), np.arange(len(start))))


@pytest.mark.parametrize("periodic", [(True, True, True), (False, True, False)])
def test_near_rows(periodic):
    points, period = some_points(70), np.where(periodic, SIZE, 0.0)
    grid = build_grid(points, SIZE, np.array(periodic), REACH)
    assert len(grid.largest) == 2
    expected = near(points, points, period, REACH)
    np.fill_diagonal(expected, False)
    for axis in np.flatnonzero(period):
        walled = near(points, points, period * (np.arange(3) != axis), REACH)
        assert walled.sum() - 70 < expected.sum()  # some cross it; each is near itself
    buffer, lengths = np.empty((1, expected.sum() + 1), dtype=np.uint32), np.empty(70, dtype=np.int64)
    kernels.near_rows(points, grid, REACH, 0, buffer, lengths)
    assert_array_equal(lengths, expected.sum(axis=1))
    rows = np.split(buffer[0, :-1], np.cumsum(lengths)[:-1])
    assert_array_equal(np.concatenate([np.sort(row) for row in rows]), np.nonzero(expected)[1])
    lengths[:] = 0
    kernels.near_rows(points, grid, REACH, 0, np.empty((1, 4), dtype=np.uint32), lengths)
    assert_array_equal(lengths, expected.sum(axis=1))  # counted on in a buffer that is too short


def test_append_row():
    points = some_points(70)
    grid = build_grid(points, SIZE, np.ones(3, dtype=bool), REACH)
    place, out = np.array([0.99, 0.01, 0.5, 0.1]), np.full(71, 99, dtype=np.uint32)
    k = kernels.append_row(-1, place, grid, REACH, out, 2)
    assert_array_equal(out[:2], 99)
    assert_array_equal(np.sort(out[2:k]), np.flatnonzero(near(place[None], points, SIZE, REACH)[0]))


def test_compact_rows():
    number = kernels.CHUNK + 44
    rows, indptr = some_rows(number)
    buffer = np.full((2, 4 * kernels.CHUNK), number, dtype=np.uint32)
    for chunk, part in enumerate((rows[: kernels.CHUNK], rows[kernels.CHUNK :])):
        filled = np.concatenate(part)
        buffer[chunk, : len(filled)] = filled
    indices = np.empty(indptr[-1], dtype=np.uint32)
    kernels.compact_rows(buffer, indptr, indices)
    assert_array_equal(indices, np.concatenate(rows))


def test_sort_rows():
    rows, indptr = some_rows(60, seed=2)
    indices = np.concatenate(rows)
    kernels.sort_rows(indptr, indices)
    assert_array_equal(indices, np.concatenate([np.sort(row) for row in rows]))


def test_row_distances():
    points, period = some_points(40), np.where((True, False, True), SIZE, 0.0)
    indptr, indices = compressed(~np.eye(40, dtype=bool))
    out = np.empty(len(indices))
    kernels.row_distances(points, period, indptr, indices.astype(np.uint32), out)
    expected = np.linalg.norm(offsets(points, points, period), axis=2) / (points[:, 3] + points[:, None, 3])
    assert_allclose(out, expected[~np.eye(40, dtype=bool)], rtol=1e-14)  # rounding of a sum of three squares
