"""Which voxels and links a sphere fills or cuts, beside whole arrays of distances and chords."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from references.voxels import kernels

# Shape, spacing, centre, radius: no symmetry; cut by the grid's ends; symmetric about a voxel's centre, so that axes
# tie; a radius below half a voxel's diagonal; flat voxels, one of which is cut between its columns of quadrature; a
# sphere smaller than a voxel across an edge; one that is smaller along one axis only.
SPHERES = [
    ((5, 6, 4), (0.2, 0.15, 0.26), (0.47, 0.52, 0.55), 0.34),
    ((4, 4, 4), (0.25, 0.25, 0.25), (0.05, 0.9, 0.4), 0.33),
    ((5, 5, 5), (0.2, 0.2, 0.2), (0.5, 0.5, 0.5), 0.3),
    ((3, 3, 3), (1 / 3, 1 / 3, 1 / 3), (0.5, 0.5, 0.5), 0.27),
    ((3, 3, 9), (1.0, 1.0, 0.1), (1.5, 1.5, 0.45), 0.41),
    ((3, 3, 3), (1.0, 1.0, 1.0), (1.03, 1.95, 1.4), 0.22),
    ((3, 4, 3), (1.0, 0.5, 1.1), (1.6, 0.9, 1.4), 0.37),
]


def case(sphere):
    """The same as kernels take it."""
    shape, spacing, center, radius = sphere
    return np.array(shape), np.array(spacing), np.array(center), radius


def corners(shape, spacing, center):
    """Lowest corner of each voxel relative to the centre, m."""
    return np.moveaxis(np.indices(shape), 0, -1) * spacing - center


def surface(corner, spacing, radius, axis):
    """Part of a voxel inside a sphere about 0, and the integral of n n over its surface, by columns along an axis."""
    nodes = np.polynomial.legendre.leggauss(2)[0] / 2 + 0.5
    nodes = (np.arange(kernels.INTERVALS)[:, None] + nodes).ravel() / kernels.INTERVALS
    a, b = (axis + 1) % 3, (axis + 2) % 3
    # Columns reach no further than a sphere that is smaller than the voxel.
    small = 2 * radius < spacing
    start, end = np.where(
        small, [np.maximum(corner, -radius), np.minimum(corner + spacing, radius)], [corner, corner + spacing]
    )
    wide = np.maximum(end - start, 0)
    u, v = np.meshgrid(start[a] + nodes * wide[a], start[b] + nodes * wide[b], indexing="ij")
    h2 = radius**2 - u**2 - v**2
    u, v, h = u[h2 > 0], v[h2 > 0], np.sqrt(h2[h2 > 0])
    low, high = corner[axis], corner[axis] + spacing[axis]
    length = np.clip(np.minimum(h, high) - np.maximum(-h, low), 0, None).sum()
    moment = np.zeros((3, 3))
    for w in (h, -h):
        met = (w > low) & (w < high)
        normal = np.empty((met.sum(), 3))
        normal[:, a], normal[:, b], normal[:, axis] = u[met], v[met], w[met]
        normal /= radius
        # A column of this width meets an area larger by 1 / cos of the normal.
        area = wide[a] * wide[b] / len(nodes) ** 2 / np.abs(normal[:, axis])
        moment += np.einsum("m,ma,mb->ab", area, normal, normal)
    return length / (len(nodes) ** 2 * spacing[axis]) * wide[a] * wide[b] / (spacing[a] * spacing[b]), moment


def slow_cuts(shape, spacing, center, radius):
    """Flat index, fraction and moment of every voxel that the surface cuts."""
    found = []
    for index, corner in enumerate(corners(shape, spacing, center).reshape(-1, 3)):
        middle = np.abs(corner + 0.5 * spacing)
        axes = np.flatnonzero(middle >= (1 - kernels.TIE) * middle.max())
        parts, moments = zip(*(surface(corner, spacing, radius, axis) for axis in axes), strict=True)
        if kernels.FULL < np.mean(parts) < 1 - kernels.FULL:
            found.append((index, np.mean(parts), np.mean(moments, axis=0)))
    return (np.array(column) for column in zip(*found, strict=True))


def fast_cuts(shape, spacing, center, radius):
    """Painted grid, bound of the number of cut voxels, and what the kernel tells of them; with room to spare."""
    grid, low, high = np.zeros(tuple(shape), np.uint16), np.zeros(3, int), shape
    count = kernels.paint_sphere(grid, 3, center, radius, spacing, low, high)
    index, fraction, moment = np.full(grid.size, -1), np.full(grid.size, np.nan), np.full((grid.size + 1, 6), np.nan)
    n = kernels.cut_sphere(high, center, radius, spacing, low, high, index, fraction, moment)
    assert np.all(index[n:] == -1)
    return grid, count, index[:n], fraction[:n], moment[:n]


@pytest.mark.twin
def test_count():
    phase = np.random.default_rng(0).integers(0, 4, 50).astype(np.uint16)
    assert np.array_equal(kernels.count(phase, 6), np.bincount(phase, minlength=6))


@pytest.mark.twin
@pytest.mark.parametrize("sphere", SPHERES)
def test_paint_sphere(sphere):
    shape, spacing, center, radius = case(sphere)
    grid, count, index, _, _ = fast_cuts(shape, spacing, center, radius)
    distance = np.linalg.norm(corners(shape, spacing, center) + 0.5 * spacing, axis=-1)
    assert np.array_equal(grid, np.where(distance <= radius, 3, 0))
    reach = 0.5 * np.linalg.norm(spacing)
    assert count == np.sum((distance > radius - reach) & (distance < radius + reach))
    assert len(index) <= count


@pytest.mark.twin
def test_paint_sphere_looks_at_its_window_only():
    grid, low, high = np.zeros((4, 5, 6), np.uint16), np.array([1, 0, 2]), np.array([3, 4, 5])
    kernels.paint_sphere(grid, 3, np.full(3, 2.0), 99.0, np.ones(3), low, high)
    expected = np.zeros_like(grid)
    expected[1:3, 0:4, 2:5] = 3
    assert np.array_equal(grid, expected)


@pytest.mark.twin
@pytest.mark.parametrize("sphere", SPHERES)
def test_cut_sphere(sphere):
    shape, spacing, center, radius = case(sphere)
    index, fraction, moment = slow_cuts(shape, spacing, center, radius)
    _, _, found, part, second = fast_cuts(shape, spacing, center, radius)
    assert np.array_equal(found, index)
    # Rounding of 64 columns, the thinnest of which are 1e-3 of a voxel.
    assert_allclose(part, fraction, rtol=1e-12)
    second, size = second[:, [[0, 5, 4], [5, 1, 3], [4, 3, 2]]], spacing.max() ** 2
    # Where no column meets the surface, the normal is that at the voxel's centre, and weighs next to nothing.
    bare = np.trace(moment, axis1=1, axis2=2) == 0
    assert_allclose(second[~bare], moment[~bare], rtol=1e-10, atol=1e-14 * size)
    assert_allclose(second[bare], 0, atol=1e-8 * size)
    middle = (corners(shape, spacing, center).reshape(-1, 3) + 0.5 * spacing)[index[bare]]
    normal = middle / np.linalg.norm(middle, axis=1, keepdims=True)
    direction = second[bare] / np.trace(second[bare], axis1=1, axis2=2)[:, None, None]
    assert_allclose(direction, np.einsum("ma,mb->mab", normal, normal), atol=1e-12)


@pytest.mark.parametrize("voxels", [3, 7, 25, 49])
@pytest.mark.parametrize(("radius", "cut"), [(0.51, 7), (0.75, 19), (0.8, 19), (0.86, 18)])
def test_a_sphere_on_the_centre_of_a_voxel(voxels, radius, cut):
    # Rounding puts the centre on the voxel's or 1e-17 beside it: more voxels were cut than counted, and written beyond
    # the end of the arrays.
    _, count, index, fraction, _ = fast_cuts(
        np.full(3, voxels), np.full(3, 1 / voxels), np.full(3, 0.5), radius / voxels
    )
    # The voxel in the middle, unless the columns of quadrature find it full; the six beside it, and those at its edges.
    assert len(index) == cut <= count
    whole = voxels**3 // 2 not in index
    # Quadrature in voxels as large as the sphere: found 2.5e-3.
    assert_allclose(fraction.sum() + whole, 4 / 3 * np.pi * radius**3, rtol=5e-3)


@pytest.mark.twin
@pytest.mark.parametrize(
    "center", [(0.4, 0.5, 0.55), (0.4, 0.5, 0.1), (0.4, 0.5, 0.95), (0.05, 0.1, 0.5), (0.95, 0.9, 0.5)]
)
def test_cut_links(center):
    (na, nb, n), spacing, radius = (5, 4, 6), np.array([0.2, 0.25, 0.18]), 0.33
    resistance = np.random.default_rng(0).random((na, nb, n + 1))
    a, b = (np.arange(na) + 0.5) * spacing[0] - center[0], (np.arange(nb) + 0.5) * spacing[1] - center[1]
    half = np.sqrt(np.clip(radius**2 - a[:, None] ** 2 - b**2, 0, None))[..., None]
    # Links reach from the middle of a voxel to that of the next one, or to the end of the box.
    ends = np.r_[0, np.arange(n) + 0.5, n] * spacing[2]
    chord = np.minimum(ends[1:], center[2] + half) - np.maximum(ends[:-1], center[2] - half)
    expected = resistance + 0.7 * np.clip(chord, 0, None) / spacing[2]
    kernels.cut_links(resistance, 0.7, np.array(center), radius, spacing)
    assert_allclose(resistance, expected, rtol=1e-14)  # Rounding.


@pytest.mark.twin
@pytest.mark.parametrize("periodic", [False, True])
def test_keep_off(periodic):
    rng = np.random.default_rng(0)
    phase, least = rng.integers(0, 3, (4, 3, 5)).astype(np.uint16), np.array([0.2, 0.9, 0.5])
    resistance = rng.random((4, 3, 6))
    expected = resistance.copy()
    for k in range(0 if periodic else 1, 5):
        before, after = phase[..., k - 1], phase[..., k]
        least_here = np.where(before == after, 0.0, np.maximum(least[before], least[after]))
        expected[..., k] = np.maximum(expected[..., k], least_here)
    if periodic:
        expected[..., 5] = expected[..., 0]
    kernels.keep_off(resistance, phase, least, periodic)
    assert np.array_equal(resistance, expected)
