from itertools import product

import numpy as np
import pytest
from brute_polyhedron import measured
from numpy.testing import assert_allclose

import demheat.threads  # noqa: F401 (chooses the threading layer)
from demheat.network import laguerre_kernels as kernels
from demheat.network.bins_kernels import bin_points
from demheat.network.curved import round_wall, tangents_within
from demheat.scene import ROUND_AXES, domain_volume

SIZE = np.array([2.0, 1.0, 1.0])
# Facets that are smaller may be dropped; none of these clouds has any between this and 1e-6.
TINY = 1e-9


def cut_all(points, weights, size, periodic, wall):
    """Cells of all points: the cutter sees all of them, and across a periodic side one image each way."""
    n, counts = len(points), np.array([3, 2, 2])
    grid = counts, *bin_points(points, size, counts)
    sites = kernels.Sites(points, weights, weights.max(), size, periodic, *grid)
    shape = (n, 60)
    out = kernels.Cut(
        np.full(n, -1, np.int8),
        np.full(n, np.nan),
        np.zeros(n, np.int64),
        *(np.zeros(shape, kind) for kind in (np.int64, np.uint8, float, float)),
    )
    reach = size[periodic].min() if periodic.any() else 2 * size.max()
    limits = kernels.Limits(reach, 300, 60, 1e-12)
    near = tangents_within(wall, points, limits.reach)
    kernels.cut_cells(np.arange(n), sites, wall, near, limits, out)
    return out


def half_spaces(i, points, weights, size, periodic, wall):
    """All planes around point i as labels (neighbour, image), normals and distances; none where it is hidden."""
    labels, normals, distances = [], [], []
    for shift in product(*((-1, 0, 1) if wraps else (0,) for wraps in periodic)):
        for j in range(len(points)):
            offset = points[j] + np.array(shift) * size - points[i]
            length = np.linalg.norm(offset)
            if length > 0:
                labels.append((j, int(np.dot(np.array(shift) + 1, (9, 3, 1)))))
                normals.append(offset / length)
                distances.append((length**2 + weights[i] - weights[j]) / (2 * length))
    for side, (axis, end) in enumerate(product(range(3), (0, 1))):
        if not periodic[axis] and wall.across[axis] == 0.0:
            labels.append((-1 - side, 13))
            normals.append((2 * end - 1) * np.eye(3)[axis])
            distances.append(size[axis] - points[i, axis] if end else points[i, axis])
    for q, normal in enumerate(wall.normals):
        labels.append((-7 - q, 13))
        normals.append(normal)
        distances.append(wall.radius - normal @ (points[i] - wall.middle))
    return labels, np.array(normals), np.array(distances)


@pytest.mark.twin
@pytest.mark.parametrize("periodic, domain", [(False, "box"), (True, "box"), (False, "sphere"), (False, "cylinder-x")])
def test_cells_are_those_of_all_half_spaces(periodic, domain):
    rng, size = np.random.default_rng(3), SIZE if domain != "sphere" else np.ones(3)
    points = rng.random((60, 3)) * size
    axes = list(ROUND_AXES[domain])
    points = points[np.linalg.norm((points - size / 2)[:, axes], axis=1) < 0.45][: 14 if periodic else 24]
    weights = rng.uniform(0.0, 0.03, len(points))
    points[-1], weights[-1] = points[0] + 0.02, weights[0] - 0.2  # hidden behind its neighbour
    periodic = np.array([periodic, False, False])
    wall = round_wall(domain, size, 0.6)
    out = cut_all(points, weights, size, periodic, wall)
    assert out.volume[-1] == 0.0 and out.number[-1] == 0
    # A cell at a round wall may be too wide, before the wall cuts it, to know that no other point matters.
    secured = out.status == kernels.OK
    assert np.all(secured if domain == "box" else secured | (out.status == kernels.UNSECURED)) and secured.mean() > 0.8
    for i in np.flatnonzero(secured)[:-1:2]:
        labels, normals, distances = half_spaces(i, points, weights, size, periodic, wall)
        areas, volume = measured(normals, distances)
        right = {label: (a, d) for label, a, d in zip(labels, areas, distances, strict=True) if a > TINY}
        facets = slice(0, out.number[i])
        found = {
            (int(j), int(code)): (a, d)
            for j, code, a, d in zip(
                out.neighbour[i, facets],
                out.image[i, facets],
                out.area[i, facets],
                out.distance[i, facets],
                strict=True,
            )
            if a > TINY
        }
        assert set(found) == set(right)
        # Rounding of coordinates of order one, in planes that meet at small angles.
        assert_allclose([found[label] for label in right], list(right.values()), atol=1e-12)
        assert_allclose(out.volume[i], volume, rtol=1e-12)
    if secured.all():
        # They fill the body: a check of the twin as well.
        assert_allclose(out.volume.sum(), domain_volume(domain, size), rtol=1e-12)


@pytest.mark.twin
def test_cells_that_need_more_say_so():
    rng = np.random.default_rng(0)
    points, size = rng.random((30, 3)) * SIZE, SIZE
    flat = round_wall("box", size, 0.5)
    counts, none = np.array([3, 2, 2]), np.zeros(30)
    sites = kernels.Sites(points, none, 0.0, size, np.zeros(3, bool), counts, *bin_points(points, size, counts))
    for limits, facets, state in (
        (kernels.Limits(0.1, 300, 60, 1e-12), 60, kernels.UNSECURED),
        (kernels.Limits(2.0, 5, 60, 1e-12), 60, kernels.OVERFLOW),  # sites within reach
        (kernels.Limits(2.0, 300, 8, 1e-12), 60, kernels.OVERFLOW),  # planes
        (kernels.Limits(2.0, 300, 60, 1e-12), 3, kernels.OVERFLOW),
    ):
        out = kernels.Cut(
            np.zeros(30, np.int8),
            np.zeros(30),
            np.zeros(30, np.int64),
            *(np.zeros((30, facets), kind) for kind in (np.int64, np.uint8, float, float)),
        )
        near = tangents_within(flat, points, limits.reach)
        kernels.cut_cells(np.arange(30), sites, flat, near, limits, out)
        assert np.all(out.status == state)
