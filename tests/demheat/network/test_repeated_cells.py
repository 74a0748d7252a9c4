"""Only here: cells that are taken from a tile and are not those that would be cut."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial import Voronoi, cKDTree

from demheat import Box, Layer, Material, Scene, Sphere
from demheat.network import repeated
from demheat.network.base import row_numbers
from demheat.network.laguerre import LINKS, laguerre
from demheat.network.laguerre_kernels import Cut
from demheat.network.repeated import farthest_of, known_cells
from demheat.network.repeated_kernels import Known, repeat_cell
from demheat.packing import tile
from demheat.packing.tile import FARTHEST, FIRST, PHI, numbers, places_of, tiled
from demheat.packing.twins.conforming import Conformed, conformed

OTHER = Material(10.0)
BODIES = {
    "sphere": [Sphere((0.3, 0.5, 0.35), 0.17, OTHER)],
    "spheres": [Sphere((0.2, 0.4, 0.1), 0.12, OTHER), Sphere((0.21, 0.4, 0.37), 0.12, OTHER)],
    "layers": [Layer(1, 0.3, 0.33, OTHER), Layer(1, 0.33, 0.6, Material(2.0))],
    "box": [Box((0.4, 0.5, 0.4), (0.2, 0.3, 0.1), OTHER)],
    "none": [],
}


def made(name, *, periodic=True, size=(1.0, 1.1, 0.8), number=8000, seed=3):
    """A packing of tiles, what has become of it beside interfaces, and what is known of its cells."""
    load = {"gradient": (0.0, 1.0, 0.0)} if periodic else {"walls": {"y-": 0.0, "y+": 1.0}}
    asked = tiled(number, size=size, periodic=periodic, seed=seed)
    conform = conformed(asked, Scene(size, Material(1.0), BODIES[name], **load), farthest=farthest_of(asked))
    return asked, conform, known_cells(asked, conform)


def by_place(facets):
    """Links in one order: row, other, image, area, distance."""
    row = row_numbers(facets.indptr)
    order = np.lexsort((facets.image, facets.indices, row))
    return row[order], *(getattr(facets, name)[order] for name in ("indices", "image", "area", "distance"))


def cells(packing, known=None):
    return laguerre(packing.centers, packing.radii**2, packing.size, periodic=packing.periodic, known=known)


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("name", BODIES)
def test_networks_are_the_same(name, periodic):
    _, conform, known = made(name, periodic=periodic)
    share = np.mean(known.place >= 0)
    assert share == 1.0 if periodic and name == "none" else 0.2 < share < 0.95
    packing = conform.packing
    spacing, cut, found = np.cbrt(packing.volume / packing.number), cells(packing), cells(packing, known)
    assert_allclose(found.volumes, cut.volumes, atol=1e-12 * spacing**3)  # rounding of places in the box
    (*where, area, distance), (*there, areas, distances) = by_place(cut), by_place(found)
    assert all(map(np.array_equal, where, there))
    assert_allclose(areas, area, atol=1e-12 * spacing**2)
    assert_allclose(distances, distance, atol=1e-12 * spacing)
    for column in ("wall_particle", "wall_side", "wall_area", "wall_distance"):
        assert_allclose(getattr(found, column), getattr(cut, column), rtol=1e-12)  # rounding


def test_cells_that_are_known_are_not_cut(monkeypatch):
    """Were they, none would be taken from a tile that is drawn twice as large."""
    _, conform, known = made("sphere")
    monkeypatch.setattr("demheat.network.laguerre._check_filled", lambda *_: None)
    larger = known._replace(volume=8.0 * known.volume)
    found, right, there = cells(conform.packing, larger).volumes, cells(conform.packing).volumes, known.place >= 0
    taken = found > 4.0 * right
    # Those beside a particle that has gone or become lighter are cut all the same.
    assert 0.95 < np.mean(taken[there]) < 1.0 and not taken[~there].any()
    # Rounding of places in the box, over cells of any size.
    assert_allclose(found, np.where(taken, 8.0, 1.0) * right, rtol=1e-9)


def test_cells_that_a_wall_may_reach_are_not_known():
    """Sites of the first layer are not in their places, and a cell that one may reach is cut."""
    asked, conform, known = made("none", periodic=False)
    centers = conform.packing.centers
    room = np.minimum(centers, conform.packing.size - centers).min(axis=1)
    assert room[known.place >= 0].min() > (FIRST + 2.0 * FARTHEST) * asked.radii[0]


def test_what_is_taken_for_known_and_is_not_is_cut():
    """Some site for all that have gone: it knows nothing of their facets."""
    asked, conform, _ = made("sphere")
    rash = known_cells(asked, Conformed(conform.packing, conform.origin, conform.origin >= 0))
    assert np.any(rash.site < 0)
    found = cells(conform.packing, rash._replace(site=np.maximum(rash.site, 0)))
    assert all(map(np.array_equal, found, cells(conform.packing)))


def test_packings_that_are_no_tiles_have_no_places():
    packing = tiled(6000, size=(1.0, 1.1, 0.8), seed=3)
    assert len(places_of(packing).place) == packing.number
    moved = packing.centers.copy()
    moved[7, 0] += 1e-9
    lie = packing.provenance | {"seed": 4}
    for other in (
        packing._replace(centers=moved),
        packing._replace(provenance=lie),
        packing._replace(provenance={"algorithm": "tile"}),
        packing._replace(provenance=packing.provenance | {"asked": "8000"}),
        packing._replace(provenance=packing.provenance | {"asked": -1, "seed": -1}),
        packing._replace(radii=packing.radii * 1.01),
        packing._replace(centers=packing.centers[1:], radii=packing.radii[1:]),
    ):
        assert places_of(other) is None
    assert farthest_of(packing._replace(provenance={})) == np.inf


def test_places_are_those_of_the_points():
    for periodic in (True, False):
        packing = tiled(6000, size=(1.0, 1.1, 0.8), periodic=periodic, seed=3)
        where = places_of(packing)
        number, count = np.divmod(where.place, len(where.points))
        there = where.points[count] + np.stack(np.unravel_index(np.maximum(number, 0), where.counts), 1) * where.edges
        off = np.abs(there - packing.centers).max(axis=1)
        assert off[where.place >= 0].max() < 1e-14 and np.all(where.place >= 0) == periodic


def drawn(gone):
    """Three tiles by one by two of four points with drawn facets; sites stand in order, but for one that is gone."""
    rng, counts = np.random.default_rng(5), np.array([3, 1, 2])
    indptr = np.array([0, 5, 9, 9, 15])
    columns = rng.integers(0, 4, 15).astype(np.uint32), rng.integers(0, 27, 15).astype(np.uint8), *rng.random((2, 15))
    site = np.arange(24, dtype=np.int32)
    site[gone] = -1
    place = np.where(np.arange(24) == 6, -1, np.arange(24)).astype(np.int32)  # that of one is not known
    return Known(place, site, counts, indptr, *columns, rng.random(4))


@pytest.mark.twin
def test_a_cell_that_is_repeated():
    """From tile to tile, and through the box: its facets, those that fit, and what it adds to its chunk."""
    known, taken = drawn(gone=17), 0
    for i in range(26):
        rows = [np.zeros(1, kind) for kind in (np.int8, np.uint8, float, np.int32, np.int32)]
        columns = [np.full((1, 9), 77, kind) for kind in LINKS]
        out = Cut(*rows, np.array([[2, 1]]), *columns)
        tile, point = divmod(i, 4)
        here, facets = np.array(np.unravel_index(min(tile, 5), known.counts)), []
        for e in range(known.indptr[point], known.indptr[point + 1]) if i < 24 else ():
            there = here + np.array(np.unravel_index(known.image[e], (3, 3, 3))) - 1
            turn = there // known.counts
            number = np.ravel_multi_index(there - turn * known.counts, known.counts)
            code = np.ravel_multi_index(turn + 1, (3, 3, 3))
            facets.append((known.site[4 * number + known.neighbour[e]], code, known.area[e], known.distance[e]))
        good = i < 24 and i != 6 and all(site >= 0 for site, *_ in facets)
        assert repeat_cell(i, 0, 0, known, out) == good
        taken += good
        assert out.used.tolist() == [[2 + good * len(facets), 1]]
        if good:
            assert (out.times[0], out.volume[0], out.links[0]) == (1, known.volume[point], len(facets))
            for column, value in zip((out.neighbour, out.image, out.area, out.distance), range(4), strict=True):
                values = [facet[value] for facet in facets[:6]]
                assert column[0, 2 : 2 + len(values)].tolist() == values and column[0, 8] == 77
    assert 6 < taken < 20


@pytest.mark.slow
def test_no_place_of_a_tile_is_far_from_its_particles():
    for number in numbers():
        points, reach = tile._tile(number), 3.2 / np.cbrt(number)
        images = (points + np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 1, 3)).reshape(-1, 3)
        images = images[np.all((images > -reach) & (images < 1.0 + reach), axis=1)]
        corners = Voronoi(images).vertices
        corners = corners[np.all((corners >= 0.0) & (corners < 1.0), axis=1)]
        farthest, _ = cKDTree(images).query(corners)
        assert farthest.max() < FARTHEST * np.cbrt(0.75 / np.pi * PHI / number)


def test_few_tiles_are_not_looked_at():
    _, conform, known = made("none", size=(1.0, 1.0, 1.0), number=150)
    assert known is None and not np.isfinite(farthest_of(conform.packing))
    assert repeated.LEAST > 1
