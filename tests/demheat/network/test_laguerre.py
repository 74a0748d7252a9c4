"""Only here: cells that leave gaps, facets that one side alone sees, hidden points that stay; beside Voro++."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial import ConvexHull
from test_curved import closure

from demheat.network.base import branches, row_numbers
from demheat.network.laguerre import _matched, drop_empty_cells, laguerre, tessellated
from demheat.packing.base import make_packing
from demheat.packing.twins.interfaces import fibonacci_sphere


def cloud(n=600, *, spread=0.6, seed=0, size=(1.0, 1.0, 1.0)):
    """Random weighted points: harder than any packing, some are hidden."""
    rng = np.random.default_rng(seed)
    return rng.random((n, 3)) * size, (rng.uniform(1 - spread, 1 + spread, n) * 0.5 * n ** (-1 / 3)) ** 2


@pytest.mark.parametrize("periodic", [True, False, (True, False, True)])
@pytest.mark.parametrize("size", [(1.0, 1.0, 1.0), (1.0, 2.0, 0.5)])
def test_cells_close_and_fill_the_box(periodic, size):
    centers, weights = cloud(size=size)
    facets = laguerre(centers, weights, size, periodic=periodic)
    # Rounding: positions carry 1e-16 of the box, facets 1e-11 of a squared spacing are dropped.
    assert_allclose(facets.volumes.sum(), np.prod(size), rtol=1e-12)
    assert_allclose(closure(facets, centers, size), 0.0, atol=1e-10 * 600 ** (-2 / 3))
    walls = 2.0 * (np.prod(size) / np.array(size))[~np.broadcast_to(periodic, 3)].sum()
    assert_allclose(facets.wall_area.sum(), walls, rtol=1e-12)


def test_links_stand_in_both_rows_with_one_area():
    centers, weights = cloud()
    facets = laguerre(centers, weights, (1, 1, 1))
    rows = row_numbers(facets.indptr)
    there = {
        (p, q, s): (a, h)
        for p, q, s, a, h in zip(rows, facets.indices, facets.image, facets.area, facets.distance, strict=True)
    }
    length = np.linalg.norm(branches(centers, np.ones(3), facets.indptr, facets.indices, facets.image), axis=1)
    for p, q, s, d in zip(rows, facets.indices, facets.image, length, strict=True):
        area, height = there[p, q, s]
        back_area, back_height = there[q, p, 26 - s]
        assert area == back_area
        # Both ends measure the same plane: their distances add up to the link, to rounding of the box's coordinates.
        assert abs(height + back_height - d) < 1e-12


def test_simple_cubic_crystal():
    """Four planes meet in every corner of a cube: the most degenerate case there is."""
    n = 6
    centers = (np.stack(np.meshgrid(*[np.arange(n) + 0.5] * 3, indexing="ij"), -1) / n).reshape(-1, 3)
    facets = laguerre(centers, np.zeros(n**3), (1, 1, 1))
    assert np.all(np.diff(facets.indptr) == 6)
    assert_allclose(facets.area, n**-2, rtol=1e-12)
    assert_allclose(facets.volumes, n**-3, rtol=1e-12)


def test_hidden_points_are_dropped():
    centers, weights = cloud(300)
    centers = np.vstack([centers, centers[:2] + 1e-3])
    weights = np.append(weights, weights[:2] - 0.01)
    packing = make_packing(centers, np.sqrt(weights + 0.02), (1, 1, 1), True, {})
    facets = laguerre(packing.centers, packing.radii**2, packing.size)
    seen, kept = drop_empty_cells(packing, facets)
    assert 2 <= packing.number - seen.number == np.sum(facets.volumes == 0)
    assert kept.volumes.min() > 0 and kept.indices.max() < seen.number == len(kept.indptr) - 1
    assert_allclose(closure(kept, seen.centers, seen.size), 0.0, atol=1e-10 * 300 ** (-2 / 3))


def test_of_coincident_points_the_heaviest_has_the_cell_and_of_equals_the_first():
    centers, weights = cloud(200)
    weights[:3] = weights.max()  # not hidden by others
    twice = laguerre(np.vstack([centers, centers[:3]]), np.append(weights, weights[:3] + [0.0, 1e-3, -1e-3]), (1, 1, 1))
    assert (twice.volumes[:3] > 0).tolist() == [True, False, True]
    assert (twice.volumes[200:] > 0).tolist() == [False, True, False]
    # The cells are those of the heaviest alone; rounding of their volumes.
    weights[1] += 1e-3
    assert_allclose(
        twice.volumes[[0, 201, 2]], laguerre(centers, weights, (1, 1, 1)).volumes[:3], rtol=1e-12
    )  # rounding


@pytest.mark.parametrize("height, seen", [(1e-7, False), (1e-3, True)])
def test_cells_of_slivers_only_count_as_hidden(height, seen):
    """Amid eight sites of a cubic lattice, a light one whose planes lie at that height, in edges of the lattice."""
    lattice = (np.stack(np.meshgrid(*[np.arange(4)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) + 0.25) / 4
    away = np.sqrt(0.75) / 4
    centers = np.vstack([lattice, lattice[21] + 0.125])
    weights = np.append(np.zeros(64), 2 * away * height / 4 - away**2)
    facets = laguerre(centers, weights, (1, 1, 1))
    packing = make_packing(centers, np.sqrt(weights + 0.1), (1, 1, 1), True, {})
    assert (facets.volumes[-1] > 0) == seen and np.diff(facets.indptr)[-1] == 8 * seen
    assert drop_empty_cells(packing, facets)[0].number == 64 + seen


def test_a_facet_that_one_of_its_cells_does_not_see_is_rounding_or_an_error():
    spacing = 0.01

    def matched(area):
        """Two cells joined by a facet, of which the first sees one more, to itself through a face of the box."""
        indices, image = np.array([0, 1, 0], np.uint32), np.array([22, 13, 13], np.uint8)
        columns = [indices, image, np.array([area, 1e-4, 1e-4]), np.full(3, 0.005)]
        return _matched(np.array([2, 1], np.int32), columns, spacing)

    indptr, indices, image, area, distance = matched(0.9e-7 * spacing**2)
    assert indptr.tolist() == [0, 1, 2] and indices.tolist() == [1, 0] and image.tolist() == [13, 13]
    assert len(area) == len(distance) == 2
    with pytest.raises(RuntimeError, match="is seen by one of its two cells only"):
        matched(1.1e-7 * spacing**2)


def graded(ratio, n, *, seed=0):
    """Random points with weights of spheres, one of them large, in which none of the others lies."""
    rng = np.random.default_rng(seed)
    small = 0.5 * n ** (-1 / 3)
    points, radii = rng.random((n, 3)), rng.uniform(0.7, 1.3, n) * small
    points[0], radii[0] = 0.5, ratio * small
    kept = np.linalg.norm(points - 0.5, axis=1) > radii[0]
    kept[0] = True
    return points[kept], radii[kept] ** 2


@pytest.mark.parametrize("ratio, n, periodic", [(1, 1000, True), (10, 6000, False)])
def test_cells_are_rarely_begun_again(ratio, n, periodic):
    """The large one may be, for want of room."""
    centers, weights = graded(ratio, n)
    facets, again = tessellated(centers, weights, (1, 1, 1), periodic=periodic)
    assert again < 0.01
    assert_allclose(facets.volumes.sum(), 1.0, rtol=1e-12)
    if ratio > 1:
        assert np.diff(facets.indptr)[0] > 80  # the large one touches very many


def test_chunks_without_room_are_cut_again(monkeypatch):
    centers, weights = cloud()
    right = laguerre(centers, weights, (1, 1, 1))
    monkeypatch.setattr("demheat.network.laguerre.ROOM", 14)
    monkeypatch.setattr("demheat.network.laguerre.BLOCK", 256)
    facets, again = tessellated(centers, weights, (1, 1, 1))
    assert 0 < again < 1
    assert all(np.array_equal(a, b) for a, b in zip(right, facets, strict=True))


@pytest.mark.parametrize("periodic", [True, False])
def test_against_voro(periodic):
    multivoro = pytest.importorskip("multivoro")
    centers, weights = cloud(500, spread=0.3)
    radii = np.sqrt(weights)
    cells = multivoro.compute_voronoi(
        centers, radii=radii, limits=np.array([[0.0] * 3, [1.0] * 3]), periodic_boundaries=(periodic,) * 3
    )
    facets = laguerre(centers, weights, (1, 1, 1), periodic=periodic)
    for p, cell in enumerate(cells):
        ours = sorted(facets.indices[facets.indptr[p] : facets.indptr[p + 1]])
        if cell is None or len(cell.get_vertices()) == 0:
            assert not ours
            continue
        # The hull is taken of vertices printed relative to the box: rounding of 1e-16 against cells of 1e-3.
        assert_allclose(facets.volumes[p], ConvexHull(cell.get_vertices()).volume, rtol=1e-9)
        # Voro++ also lists facets of rounding size.
        theirs = {q for q in cell.get_neighbors() if q >= 0}
        assert set(ours) <= theirs and len(theirs) - len(set(ours)) <= 1


def test_too_few_points_in_a_periodic_box():
    with pytest.raises(RuntimeError, match="reach across the periodic box"):
        laguerre(np.array([[0.5, 0.5, 0.5], [0.2, 0.3, 0.4]]), np.zeros(2), (1, 1, 1))


def test_many_light_points_in_one_place_leave_far_cells_secured():
    """Cells of the few heavy ones reach farther than the light ones tell: those of their own size are looked at first.

    Any cell that is not secured is refused; so are cells that do not fill the box.
    """
    rng = np.random.default_rng(5)
    places = np.concatenate([0.5 + 0.1 * fibonacci_sphere(4000), rng.random((150, 3))])
    weights = np.concatenate([np.zeros(4000), np.full(150, 0.02)])
    facets = laguerre(places, weights, np.ones(3))
    assert_allclose(facets.volumes.sum(), 1.0, rtol=1e-12)  # rounding of some thousand cells
