"""Only here: cells cut by fewer planes than cut them, beside all half-spaces; cells that find no room."""

from itertools import product

import numpy as np
import pytest
from brute_polyhedron import measured
from numpy.testing import assert_allclose

import demheat.runtime.threads  # noqa: F401 (chooses the threading layer)
from demheat.network import laguerre_kernels as kernels
from demheat.network.curved import round_wall, tangents_within
from demheat.network.laguerre import FACETS, LINKS, filed
from demheat.network.polyhedron_kernels import empty_polyhedron
from demheat.network.repeated_kernels import nothing_known
from demheat.network.sites_kernels import empty_candidates
from demheat.scene import ROUND_AXES, domain_volume

SIZE = np.array([2.0, 1.0, 1.0])
# Facets that are smaller may be dropped; none of these clouds has any between this and 1e-6.
TINY = 1e-9


def cut_all(points, weights, size, periodic, wall, *, room=60 * kernels.CHUNK, reach=9.0, box=0.5):
    """Cells of all points, in chunks."""
    n, spacing = len(points), (size.prod() / len(points)) ** (1 / 3)
    sites = filed(points, weights, size, periodic, spacing)
    chunks = np.arange(-(-n // kernels.CHUNK))
    kinds = (np.int8, np.uint8, float, np.int32, np.int32)
    shape = (len(chunks), room)
    cut = kernels.Cut(
        *(np.zeros(n, kind) for kind in kinds),
        np.zeros((len(chunks), 2), np.int64),
        *(np.zeros(shape, kind) for kind in LINKS),
    )
    limits = kernels.Limits(box, 2 * size.max(), 1e-12, 1e-9, reach, weights.min(), ~periodic & (wall.across == 0), 0.0)
    round_wall = (wall, tangents_within(wall, points, reach)) if len(wall.normals) else (None, None)
    at, end, more = 0, len(chunks) * kernels.CHUNK, 1
    while at < end:
        scratch = empty_candidates(more * kernels.ROOM), empty_polyhedron(more * kernels.PLANES)
        at, more = (
            kernels.cut_cells(at, end, chunks, 0, sites, nothing_known(), *round_wall, limits, *scratch, cut),
            4 * more,
        )
    return cut


def facets_of(i, cut):
    """Facets of a cell of the first chunk: (area, distance) by neighbour and image."""
    e, w = (slice(number[:i].sum(), number[: i + 1].sum()) for number in (cut.links, cut.ends))
    found = zip(*(getattr(cut, name)[0, e] for name in FACETS), strict=True)
    walls = zip(*(getattr(cut, name)[0, ::-1][w] for name in FACETS), strict=True)
    there = {(int(j), int(code)): (a, d) for j, code, a, d in found}
    return there | {(-1 - int(s), 13): (a, d) for s, _, a, d in walls}


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
    assert out.volume[-1] == 0.0 and out.links[-1] == out.ends[-1] == 0
    assert np.all(out.status == kernels.OK)
    for i in range(0, len(points) - 1, 2):
        labels, normals, distances = half_spaces(i, points, weights, size, periodic, wall)
        areas, volume = measured(normals, distances)
        right = {label: (a, d) for label, a, d in zip(labels, areas, distances, strict=True) if a > TINY}
        found = {label: pair for label, pair in facets_of(i, out).items() if pair[0] > TINY}
        assert set(found) == set(right)
        # Rounding of coordinates of order one, in planes that meet at small angles.
        assert_allclose([found[label] for label in right], list(right.values()), atol=1e-12)
        assert_allclose(out.volume[i], volume, rtol=1e-12)
    # They fill the body: a check of the twin as well.
    assert_allclose(out.volume.sum(), domain_volume(domain, size), rtol=1e-12)


@pytest.mark.twin
def test_cells_that_need_more_say_so():
    rng = np.random.default_rng(0)
    points = rng.random((30, 3)) * SIZE
    box, ball = (round_wall(domain, np.ones(3), 0.3) for domain in ("box", "sphere"))
    whole = cut_all(points, np.zeros(30), SIZE, np.zeros(3, bool), box)
    short = cut_all(points, np.zeros(30), SIZE, np.zeros(3, bool), box, room=20)
    # All facets are counted where there is no room to note them.
    assert np.array_equal(short.used, whole.used) and whole.used[0].sum() > 20 and np.all(short.status == kernels.OK)
    # A start box that is too narrow is widened.
    narrow = cut_all(points, np.zeros(30), SIZE, np.zeros(3, bool), box, box=0.05)
    assert np.all(narrow.times > whole.times)
    assert_allclose(narrow.volume, whole.volume, rtol=1e-12)
    pair = cut_all(points[:2], np.zeros(2), SIZE, np.ones(3, bool), box)
    assert np.all(pair.status == kernels.UNSECURED)
    points = points[np.linalg.norm(points - 0.5, axis=1) < 0.45]
    blind = cut_all(points, np.zeros(len(points)), np.ones(3), np.zeros(3, bool), ball, reach=0.01)
    assert np.any(blind.status == kernels.UNSECURED)


@pytest.mark.twin
def test_large_cells_find_room():
    """A heavy site among many light ones has more neighbours than there is room for at first."""
    rng = np.random.default_rng(0)
    points, weights = rng.random((3000, 3)), np.zeros(3000)
    points = points[np.linalg.norm(points - 0.5, axis=1) > 0.32]
    points[0], weights = 0.5, np.zeros(len(points))
    weights[0] = 0.3**2
    out = cut_all(points, weights, np.ones(3), np.ones(3, bool), round_wall("box", np.ones(3), 0.3))
    assert np.all(out.status == kernels.OK)
    assert out.times[0] > 1 and out.links[0] > kernels.PLANES
    assert_allclose(out.volume.sum(), 1.0, rtol=1e-12)
