"""Only here: contacts other than the paper's surfaces and numbers, walls that are not shared out, links at them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat.laws import MEANS as NAMED
from demheat.laws import Calibrated
from demheat.network.base import branches, row_numbers
from demheat.network.calibrated import MEANS, _joined, contact_facets
from demheat.network.interface import connect
from demheat.network.laguerre import drop_empty_cells
from demheat.packing.base import make_packing
from demheat.packing.neighbours import contacts
from demheat.packing.relax import relax


@pytest.fixture(scope="module")
def packing():
    return relax(1000, seed=3)


@pytest.fixture(scope="module")
def between_walls():
    """Walls along y only; the bulk is that of phi = 0.64: a flat wall takes 0.27 mean radii away."""
    return relax(3000, periodic=(True, False, True), phi=0.628, seed=1)


def pairs_of(facets):
    rows = row_numbers(facets.indptr).tolist()
    return {(p, q): a for p, q, a in zip(rows, facets.indices.tolist(), facets.area, strict=True)}


@pytest.mark.parametrize(
    ("mean", "formula"),
    [("arithmetic", lambda a, b: (a + b) / 2), ("harmonic", lambda a, b: 2 / (1 / a + 1 / b)), ("geometric", None)],
)
def test_links_are_symmetric_and_carry_the_papers_surface(packing, mean, formula):
    formula = formula or (lambda a, b: np.exp((np.log(a) + np.log(b)) / 2))
    pairs = pairs_of(contact_facets(packing, Calibrated(mean=mean)))
    for (p, q), area in pairs.items():
        assert pairs[q, p] == area
        # Rounding of a few operations, the logarithms of 3 or so worst: found 1.4e-15.
        assert_allclose(area, np.pi * formula(packing.radii[p], packing.radii[q]) ** 2, rtol=1e-14)
    assert set(MEANS) == set(NAMED) == {"arithmetic", "harmonic", "geometric"}


def test_mean_coordination_and_policies(packing):
    kept, joined = (
        np.diff(contact_facets(packing, Calibrated(sparse=sparse)).indptr) for sparse in ("keep", "nearest")
    )
    # The gap is the midpoint between two pair distances: Z is met to one pair, 2/n.
    assert_allclose(kept.mean(), 7.5, atol=2 / 1000 + 1e-12)
    assert kept.min() < 2 <= joined.min()
    assert np.all(joined >= kept)


def test_joining_is_that_of_brute_force(packing):
    indptr, indices, _ = contacts(packing)
    offsets = packing.centers[None] - packing.centers[:, None]
    offsets -= np.round(offsets)
    surface = np.linalg.norm(offsets, axis=2) - packing.radii
    np.fill_diagonal(surface, np.inf)
    expected = set(zip(row_numbers(indptr).tolist(), indices.tolist(), strict=True))
    for p in np.flatnonzero(np.diff(indptr) < 2).tolist():
        for q in np.argsort(surface[p])[:2].tolist():
            expected |= {(p, q), (q, p)}
    new, columns = _joined(packing, indptr, indices, 2)
    found = list(zip(row_numbers(new).tolist(), columns.tolist(), strict=True))
    assert found == sorted(expected) and len(found) > len(indices)
    assert columns.dtype == np.uint32


def test_dropping_peels_chains_and_islands():
    """A square of spheres with a tail of three, a triangle apart and a lone one: only the square stays."""
    square, tail = [(3, 3), (5, 3), (3, 5), (5, 5)], [(7, 5), (9, 5), (11, 5)]
    triangle, lone = [(15, 15), (17, 15), (16, 16.7)], [(3, 17)]
    centers = np.array([(x, y, 10.0) for x, y in square + tail + triangle + lone])
    packing = make_packing(centers, np.full(len(centers), 1.0), (20, 20, 20), True, {})
    facets = contact_facets(packing, Calibrated(gap=0.02, sparse="drop"))
    alive = np.isin(packing.centers[:, :2], (3, 5)).all(axis=1)
    assert_array_equal(facets.volumes > 0, alive)
    assert_array_equal(np.diff(facets.indptr), np.where(alive, 2, 0))
    rest, facets = drop_empty_cells(packing, facets)
    assert rest.number == 4 and facets.indices.max() < 4
    assert_allclose(facets.volumes.sum(), packing.volume, rtol=1e-12)  # rounding


def test_a_column_between_two_walls_is_not_dropped():
    centers = np.array([(5.0, y, 5.0) for y in (1, 3, 5, 7, 9)] + [(1.0, 1.0, 1.0)])
    packing = make_packing(centers, np.full(6, 1.0), (10, 10, 10), (True, False, True), {})
    facets = contact_facets(packing, Calibrated(gap=0.02, sparse="drop"))
    assert_array_equal(facets.volumes > 0, packing.centers[:, 0] == 5.0)
    assert len(facets.wall_particle) == 2  # that of the lone sphere is gone


def test_volumes_fill_the_domain(packing):
    for sparse in ("keep", "drop"):
        assert_allclose(contact_facets(packing, Calibrated(sparse=sparse)).volumes.sum(), 1.0, rtol=1e-12)
    inside = np.linalg.norm(packing.centers[:, [0, 2]] - 0.5, axis=1) < 0.5
    drum = make_packing(
        packing.centers[inside], packing.radii[inside], (1, 1, 1), (False, True, False), {}, domain="cylinder-y"
    )
    assert_allclose(contact_facets(drum, Calibrated()).volumes.sum(), np.pi / 4, rtol=1e-12)


def test_wall_contacts():
    packing = relax(1000, periodic=False, seed=3)
    links = contacts(packing)
    facets = contact_facets(packing, Calibrated())
    assert set(facets.wall_side) == set(range(6))
    # A wall is met within the gap of the pairs, by every particle that is so near to it.
    for side in range(6):
        above = packing.centers[:, side // 2] if side % 2 == 0 else 1 - packing.centers[:, side // 2]
        near = np.flatnonzero(above <= packing.radii * (1 + links[2]))
        here = facets.wall_side == side
        assert_array_equal(np.sort(facets.wall_particle[here]), near)
        # The whole wall, shared out as the sections of the spheres; rounding.
        squares = packing.radii[facets.wall_particle[here]] ** 2
        assert_allclose(facets.wall_area[here], squares / squares.sum(), rtol=1e-12)  # rounding


def test_walls_of_a_drum_have_their_area():
    rng = np.random.default_rng(0)
    centers = rng.uniform(0.05, 0.95, (3000, 3))
    centers = centers[np.linalg.norm(centers[:, [0, 2]] - 0.5, axis=1) < 0.45]
    drum = make_packing(centers, np.full(len(centers), 0.05), (1, 1, 1), False, {}, domain="cylinder-y")
    facets = contact_facets(drum, Calibrated(gap=0.05))
    assert set(facets.wall_side) == {2, 3, 6}
    for side, area in ((3, np.pi / 4), (6, np.pi)):
        assert_allclose(facets.wall_area[facets.wall_side == side].sum(), area, rtol=1e-12)  # rounding


def linear_flow(packing, facets, axis):
    """First moment of the flows of a unit gradient along an axis, walls included, over the volume."""
    network = connect(packing, facets, np.zeros(packing.number, int), np.ones(1))
    step = branches(packing.centers, packing.size, facets.indptr, facets.indices, facets.image)[:, axis]
    x = packing.centers[facets.wall_particle, axis]
    height = np.where(facets.wall_side % 2, packing.size[axis] - x, x)
    walls = (network.wall_conductance * height**2)[facets.wall_side // 2 == axis].sum()
    return 0.5 * (network.conductance @ step**2), walls


def test_surface_links_make_up_for_what_the_layer_at_the_wall_lacks(between_walls):
    """The sum over the whole sample of a linear field's flow is that of its bulk, brute force over thin slices."""
    packing = between_walls
    facets = contact_facets(packing, Calibrated(wall="surface"))
    links, walls = linear_flow(packing, facets, 1)
    depth = 6 * packing.radii.mean()
    rows, low = row_numbers(facets.indptr), packing.centers[:, 1]
    step = branches(packing.centers, packing.size, facets.indptr, facets.indices, facets.image)
    flow = facets.area / np.linalg.norm(step, axis=1) * np.abs(step[:, 1])
    planes = np.linspace(depth, 1 - depth, 2001)
    crossing = [flow[(low[rows] < y) & (low[rows] + step[:, 1] > y)].sum() for y in planes]
    # Heat through a plane of the bulk, averaged over 2001 of them: the sampling error is about 1e-4.
    assert_allclose(links + walls, np.mean(crossing), rtol=1e-3)
    assert walls > 0.02 * links  # without wall links this test would fail by 4 % and more


def test_surface_links_make_up_for_what_the_layer_in_a_sphere_lacks():
    """The same for T = r: the heat through concentric spheres of the bulk over their area, brute force."""
    packing = relax(3000, periodic=False, domain="sphere", seed=1)
    facets = contact_facets(packing, Calibrated(wall="surface"))
    network = connect(packing, facets, np.zeros(packing.number, int), np.ones(1))
    r = np.linalg.norm(packing.centers - 0.5, axis=1)
    rows, layer = row_numbers(facets.indptr), 6 * packing.radii.mean()
    low, high = np.minimum(r[rows], r[facets.indices]), np.maximum(r[rows], r[facets.indices])
    begin, end = min(layer, (0.5 - layer) / 2), 0.5 - layer
    shells = np.linspace(begin, end, 2001)
    flow = 0.5 * network.conductance * (high - low)
    crossing = [flow[(low < s) & (high > s)].sum() for s in shells]
    bulk = np.trapezoid(crossing, shells) / (4 / 3 * np.pi * (end**3 - begin**3))
    links = flow @ np.maximum(high - np.maximum(low, begin), 0.0)
    walls = network.wall_conductance @ (0.5 - r[facets.wall_particle]) ** 2
    # Averaged over 2001 shells: the sampling error is about 1e-4.
    assert_allclose(links + walls, bulk * 4 / 3 * np.pi * (0.5**3 - begin**3), rtol=1e-3)
    assert walls > 0.05 * links


def test_center_links_hold_the_centres(between_walls):
    facets = contact_facets(between_walls, Calibrated(wall="center"))
    assert_allclose(facets.wall_distance, 1e-4 * between_walls.radii[facets.wall_particle], rtol=1e-14)


def test_surface_links_need_bulk_and_hard_walls(packing, between_walls):
    with pytest.raises(ValueError, match="no bulk 6 mean radii"):
        contact_facets(relax(300, periodic=(True, False, True), phi=0.5, seed=0), Calibrated(wall="surface"))
    with pytest.raises(ValueError, match="no bulk 6 mean radii"):
        contact_facets(relax(300, periodic=False, domain="sphere", seed=0), Calibrated(wall="surface"))
    # A periodic packing merely declared walled: nobody touches its walls as a rule.
    hollow = between_walls._replace(centers=between_walls.centers * [1, 0.8, 1] + [0, 0.1, 0])
    with pytest.raises(ValueError, match="hard walls"):
        contact_facets(hollow, Calibrated(gap=0.05, wall="surface"))


def test_walls_are_shared_in_any_unit(between_walls):
    """Walls that nothing touches overflowed where those that are touched measure 1e18 m2."""
    unit = 1e9
    other = between_walls._replace(
        centers=between_walls.centers * unit, radii=between_walls.radii * unit, size=between_walls.size * unit
    )
    one, two = (contact_facets(each, Calibrated()) for each in (between_walls, other))
    # Rounding of a few sums over all particles.
    assert_allclose(two.wall_area, one.wall_area * unit**2, rtol=1e-12)  # rounding
    assert_allclose(two.area, one.area * unit**2, rtol=1e-12)  # rounding
