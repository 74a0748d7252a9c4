"""Only here: surfaces and fractions other than the paper's, and what lone or dropped particles carry."""

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import demheat
from demheat import Material, Scene
from demheat.laws import Platonic
from demheat.network.base import branches, row_numbers
from demheat.network.laguerre import drop_empty_cells
from demheat.network.platonic import (
    CRYSTALS,
    count_neighbours,
    crystal_packing,
    fraction_factors,
    platonic_facets,
    surface_factors,
)
from demheat.packing.base import make_packing
from demheat.packing.neighbours import contacts
from demheat.packing.relax import relax

# Terreros et al. (2013), table 1: neighbours, surface, packing fraction; digits cut off, not rounded.
PRINTED = ((1, 19.98076, 0.08502), (5, 7.19615, 0.43184), (10, 1.99282, 0.71032), (20, 0.75810, 0.86109))
ONE = Material(1.0, density=2.0, heat_capacity=3.0)


@pytest.fixture(scope="module")
def packing():
    return relax(1000, seed=3)


def crystal(cells, name="simple cubic", *, periodic=True, edge=1.0):
    """Touching spheres of a crystal in a box of so many cubic cells."""
    counts = np.broadcast_to(cells, 3)
    sites = np.array(CRYSTALS[name])
    apart = np.linalg.norm(sites[1:], axis=1).min() if len(sites) > 1 else 1.0
    corners = np.array(list(product(*map(range, counts))))
    centers = (corners[:, None] + sites[None]).reshape(-1, 3) * edge + 0.5 * edge * (not periodic)
    return make_packing(centers, np.full(len(centers), apart * edge / 2), counts * edge, periodic, {})


@pytest.mark.parametrize(("number", "surface", "fraction"), PRINTED)
def test_the_printed_rows(number, surface, fraction):
    # One unit of the last printed digit.
    assert 0 <= surface_factors(np.array([number]))[0] - surface < 1e-5
    assert abs(fraction_factors(np.array([number]))[0] - fraction) < 1e-5


def test_surfaces_are_those_of_the_polyhedra():
    """Of one face over the squared radius of the sphere inside: textbook values of the five solids."""
    dodecahedron, icosahedron = 2.5 * (130 - 58 * 5**0.5) ** 0.5, 1.5 * 3**0.5 * (7 - 3 * 5**0.5)
    known = [6 * 3**0.5, 4.0, 1.5 * 3**0.5, dodecahedron, icosahedron]
    assert_allclose(surface_factors(np.array([4, 6, 8, 12, 20])), known, rtol=1e-12)


def test_fractions_are_those_of_the_crystals():
    # Diamond, simple cubic, body- and face-centred cubic: textbook values.
    known = {4: 3**0.5 / 16, 6: 1 / 6, 8: 3**0.5 / 8, 12: 2**0.5 / 6}
    assert dict(crystal_packing(sites) for sites in CRYSTALS.values()) == pytest.approx(
        {number: np.pi * value for number, value in known.items()}, rel=1e-14
    )
    for number, value in known.items():
        assert_allclose(fraction_factors(np.array([number])), np.pi * value, rtol=1e-14)
    assert fraction_factors(np.array([0]))[0] == 0


def test_lines_beyond_the_solids_and_where_they_end():
    surface, fraction = surface_factors(np.arange(30)), fraction_factors(np.arange(30))
    for part in (slice(0, 7), slice(20, 30)):
        assert_allclose(np.diff(surface[part], 2), 0, atol=1e-13)  # rounding
    assert_allclose(np.diff(fraction[8:], 2), 0, atol=1e-14)
    assert surface[29] > 0 and fraction[29] < 1
    for factors in (surface_factors, fraction_factors):
        with pytest.raises(ValueError, match="neighbours = 30: .* at most 29"):
            factors(np.array([3, 30]))
        with pytest.raises(ValueError, match="integers >= 0"):
            factors(np.array([-1]))


def test_links_and_volumes_are_the_papers(packing):
    facets = platonic_facets(packing, Platonic(coordination=7.5, sparse="keep"))
    number = np.diff(facets.indptr)
    assert number.min() < 2 and number.max() > 12
    for p in range(0, 1000, 50):
        for e in range(*facets.indptr[p : p + 2]):
            q = facets.indices[e]
            s = [
                np.interp(number[i], range(30), surface_factors(np.arange(30))) * packing.radii[i] ** 2 for i in (p, q)
            ]
            assert_allclose(facets.area[e], (s[0] * s[1]) ** 0.5, rtol=1e-13)
    linked = number > 0
    f = fraction_factors(number)[linked]
    assert_allclose(facets.volumes[linked] * f, 4 / 3 * np.pi * packing.radii[linked] ** 3, rtol=1e-13)
    back = {(p, q): a for p, q, a in zip(row_numbers(facets.indptr), facets.indices, facets.area, strict=True)}
    assert all(back[q, p] == a for (p, q), a in back.items())


def test_lone_particles_take_no_part():
    """A chain from wall to wall, a lone sphere inside and one that touches only a wall, its neighbour."""
    centers = [(5.0, y, 5.0) for y in (1, 3, 5, 7, 9)] + [(1.5, 5.0, 1.5), (8.0, 1.0, 8.0)]
    packing = make_packing(centers, np.ones(7), (10, 10, 10), (True, False, True), {})
    facets = platonic_facets(packing, Platonic(gap=0.02, sparse="keep"))
    lone = packing.centers[:, 0] == 1.5
    assert_array_equal(facets.volumes == 0, lone)
    number = np.where(packing.centers[:, 0] == 5.0, 2, 1)[~lone]
    # Walls count: two neighbours all along the chain, one for the sphere at the wall.
    assert_allclose(facets.volumes[~lone], 4 / 3 * np.pi / fraction_factors(number), rtol=1e-14)
    assert_allclose(facets.area, surface_factors(np.array([2]))[0], rtol=1e-14)
    assert_array_equal(np.sort(facets.wall_side), (2, 2, 3))
    rest, facets = drop_empty_cells(packing, facets)
    assert rest.number == 6 and facets.wall_particle.max() < 6


def test_what_is_dropped_carries_no_heat(packing):
    """Particles at walls, too, of which links alone do not tell whether they have neighbours."""
    between = packing._replace(periodic=np.zeros(3, dtype=bool))
    for each in (packing, between):
        facets = platonic_facets(each, Platonic(coordination=4.0, sparse="drop"))
        linked = np.diff(facets.indptr) > 0
        assert 10 < np.sum(~linked) < 500
        assert_array_equal(facets.volumes > 0, linked)
        assert linked[facets.wall_particle].all()


def test_walls_are_neighbours():
    centers = np.array([(1.0, 2.0, 2.0), (1.0, 1.0, 1.0), (2.0, 2.0, 2.0), (3.0, 2.0, 2.2)])
    at = {tuple(x): n for x, n in zip(centers, (1, 3, 0, 1), strict=True)}
    box = make_packing(centers, np.ones(4), (4, 4, 4), False, {})
    found = count_neighbours(box, np.zeros(5, int))
    assert {tuple(x): n for x, n in zip(box.centers, found, strict=True)} == at
    inside = np.linalg.norm(centers[:, :2] - 2, axis=1) <= 1.01
    drum = make_packing(centers[inside], np.ones(3), (4, 4, 4), (False, False, True), {}, domain="cylinder-z")
    found = count_neighbours(drum, np.arange(4))
    assert_array_equal(found, np.where(abs(drum.centers[:, 0] - 2) == 1, 2, 1))
    assert_array_equal(count_neighbours(drum, np.zeros(4, int), gap=1.1), 1)


def test_the_simple_cubic_crystal_is_the_difference_stencil():
    packing = crystal((10, 11, 12), periodic=False, edge=0.5)
    facets = platonic_facets(packing, Platonic(gap=1e-6, wall="surface"))
    # Area of a cell's face for six neighbours, walls included, and its volume; rounding.
    assert_allclose(facets.area, 0.25, rtol=1e-14)
    assert_allclose(facets.volumes, 0.125, rtol=1e-14)
    assert_allclose(facets.wall_area, 0.25, rtol=1e-14)
    assert_allclose(facets.wall_distance, 0.25, rtol=1e-13)


@pytest.mark.parametrize("name", CRYSTALS)
def test_steady_conductivity_of_crystals(name):
    """Volume of the polyhedron, n s(n) / 3, over that of the cell, 4 pi / (3 f(n)): one where the polyhedra tile."""
    packing = crystal(3, name)
    scene = Scene((3, 3, 3), ONE, gradient=(1.0, 2.0, -0.5))
    number, fraction = crystal_packing(CRYSTALS[name])
    links = contacts(packing, gap=1e-6)
    assert_array_equal(np.diff(links[0]), number)
    field = demheat.solve(scene, law="platonic", packing=packing, coordination=number, allow_few=True)
    expected = number * surface_factors(np.array([number]))[0] * fraction / (4 * np.pi)
    assert_allclose(field.conductivity, expected, rtol=1e-7)  # solver tolerance 1e-8
    assert (abs(expected - 1) < 1e-12) == (name == "simple cubic")
    # Each sphere of a crystal does stand for its part of the volume.
    assert_allclose(field.samples.volumes.sum(), 27.0, rtol=1e-12)


def test_links_at_the_wall_make_up_for_the_layer_there():
    """Under a linear field the whole sample conducts on average as planes through its bulk do, brute force."""
    packing = relax(2000, periodic=(True, False, True), phi=0.628, seed=1)
    facets = platonic_facets(packing, Platonic(wall="surface"))
    rows, y = row_numbers(facets.indptr), packing.centers[:, 1]
    step = branches(packing.centers, packing.size, facets.indptr, facets.indices, facets.image)
    flow, low = facets.area / np.linalg.norm(step, axis=1) * step[:, 1], y[rows]
    depth = 6 * packing.radii.mean()
    crossing = [flow[(low < h) & (low + step[:, 1] > h)].sum() for h in np.linspace(depth, 1 - depth, 2001)]
    height = np.minimum(y, 1 - y)[facets.wall_particle]
    walls = (facets.wall_area / facets.wall_distance) @ height**2
    # Sampling by 2001 planes: 1e-4. Without the factor the sum would be 2 % higher.
    assert_allclose(0.5 * flow @ step[:, 1] + walls, np.mean(crossing), rtol=1e-3)
