"""Only here: a pair that lists of neighbours leave out or count twice, or a gap that lies on a pair."""

import numpy as np
import pytest
from crystals import distances
from numpy.testing import assert_allclose, assert_array_equal

from demheat.packing import cells_kernels
from demheat.packing.base import Packing, make_packing
from demheat.packing.cells_kernels import Reach
from demheat.packing.neighbours import build_grid, contacts, near_rows, neighbours
from demheat.packing.relax import relax


def random_packing(seed, *, most=300, ratio=10.0):
    """Points anywhere, radii over a ratio, sides from thin to wide, each axis periodic or walled."""
    rng = np.random.default_rng(seed)
    number, size, periodic = int(rng.integers(1, most)), rng.uniform(0.2, 2.0, 3), rng.random(3) < 0.5
    radii = 0.1 * np.exp(-rng.uniform(0, np.log(ratio), number))
    return make_packing(rng.random((number, 3)) * size, radii, size, periodic, {})


def rows(near):
    """Compressed rows of a boolean matrix."""
    return np.concatenate(([0], np.cumsum(near.sum(axis=1)))), np.nonzero(near)[1]


@pytest.mark.parametrize("seed", range(12))
def test_lists_are_those_of_brute_force(seed):
    packing = random_packing(seed)
    rng = np.random.default_rng(1000 + seed)
    scale, skin = rng.uniform(0, 2), rng.choice([0.0, 0.1, 1.0])  # up to several times the box
    indptr, indices = neighbours(packing, scale=scale, skin=skin)
    near = distances(packing) < scale * (packing.radii[:, None] + packing.radii) + skin
    expected = rows(near)
    assert_array_equal(indptr, expected[0])
    assert_array_equal(indices, expected[1])
    assert indices.dtype == np.uint32


def test_size_ratio_1000_and_centres_beyond_a_wall():
    packing = random_packing(3, ratio=1000.0)
    # What relaxes and collides asks for rows of spheres that the walls have not put back yet.
    packing = Packing(packing.centers * 1.5 - 0.2, packing.radii, packing.size, np.zeros(3, dtype=bool), {})
    points = np.column_stack((packing.centers, packing.radii))
    indptr, indices = near_rows(points, packing.size, packing.periodic, scale=1.3)
    cells_kernels.sort_rows(indptr, indices)
    expected = rows(distances(packing) < 1.3 * (packing.radii[:, None] + packing.radii))
    assert_array_equal(indptr, expected[0])
    assert_array_equal(indices, expected[1])


def test_a_wide_distribution_costs_few_candidates():
    """Cells visited must follow the size of each level: one large sphere must not coarsen the grid of the others."""
    rng = np.random.default_rng(0)
    points = np.column_stack((rng.random((5000, 3)), np.full(5000, 0.01)))
    points[0, 3] = 0.2
    box = np.ones(3)
    grid = build_grid(points, box, np.ones(3, dtype=bool), Reach(1.0, 0.0))
    # 4 particles per cell of the small level; with one grid the cells would be as large as the large sphere.
    assert grid.dims[1:].prod() >= 5000 / 8


@pytest.fixture(scope="module")
def relaxed():
    return relax(1000, seed=1)


@pytest.fixture(scope="module")
def apart(relaxed):
    """All distances of the relaxed packing, (n, n)."""
    return distances(relaxed)


@pytest.mark.parametrize("coordination", [4.0, 14.0])
def test_coordination_is_met(relaxed, apart, coordination):
    indptr, indices, gap = contacts(relaxed, coordination=coordination)
    # Exact: one pair more or less changes the mean by 2/1000.
    assert_allclose(len(indices) / 1000, coordination, atol=2 / 1000)
    ratio = apart / (relaxed.radii[:, None] + relaxed.radii)
    expected = rows(ratio <= 1 + gap)
    assert_array_equal(indptr, expected[0])
    assert_array_equal(indices, expected[1])
    matrix = np.zeros((1000, 1000), dtype=bool)
    matrix[np.repeat(np.arange(1000), np.diff(indptr)), indices] = True
    assert_array_equal(matrix, matrix.T)


@pytest.mark.parametrize("links", [3500, 3501])
def test_the_gap_parts_no_pair(relaxed, apart, links):
    """Each pair stands in two rows: midway to the next must lie between pairs, not on one."""
    _, indices, gap = contacts(relaxed, coordination=2 * links / 1000 + 1e-6)
    ratio = (apart / (relaxed.radii[:, None] + relaxed.radii))[np.triu_indices(1000, 1)]
    assert len(indices) == 2 * links
    # Pairs are some 1e-5 apart here; rounding is 1e-16.
    assert np.abs(ratio - (1 + gap)).min() > 1e-9


def test_an_odd_number_of_ends_is_rounded(relaxed, apart):
    ends = 7001
    _, indices, gap = contacts(relaxed, coordination=ends / 1000)
    ratio = (apart / (relaxed.radii[:, None] + relaxed.radii))[np.triu_indices(1000, 1)]
    assert abs(len(indices) - ends) == 1
    assert np.abs(ratio - (1 + gap)).min() > 1e-9


def test_walled_coordination_counts_the_bulk_only():
    packing = relax(2000, periodic=False, phi=0.6, seed=1)
    indptr, _, _ = contacts(packing, coordination=7.5, margin=4.0)
    depth = np.minimum(packing.centers, packing.size - packing.centers).min(axis=1)
    bulk = depth >= 4 * packing.radii.mean()
    assert 50 < bulk.sum() < 1500
    # One pair more or less.
    assert_allclose(np.diff(indptr)[bulk].mean(), 7.5, atol=2 / bulk.sum())
    # A particle at a wall has fewer neighbours: the mean over all must be visibly lower.
    assert np.diff(indptr).mean() < 7.4
    everywhere = contacts(packing, coordination=7.5, margin=0.0)
    assert_allclose(len(everywhere[1]) / 2000, 7.5, atol=2 / 2000)


def test_additive_gap_is_one_length_for_all_pairs(relaxed, apart):
    wanted = 7.5
    indptr, indices, gap = contacts(relaxed, coordination=wanted, additive=True)
    surface = apart - relaxed.radii[:, None] - relaxed.radii
    expected = rows(surface <= gap * 2 * relaxed.radii.mean())
    assert_array_equal(indptr, expected[0])
    assert_array_equal(indices, expected[1])
    # One pair more or less changes the mean by 2/1000.
    assert_allclose(len(indices) / 1000, wanted, atol=2 / 1000)
    again = contacts(relaxed, gap=gap, additive=True)
    assert_array_equal(again[1], indices)


def test_bulk_of_a_cylinder_is_away_from_its_round_wall():
    packing = relax(2500, seed=2)
    inside = np.linalg.norm(packing.centers[:, [0, 2]] - 0.5, axis=1) < 0.5
    drum = make_packing(
        packing.centers[inside], packing.radii[inside], (1, 1, 1), (False, True, False), {}, domain="cylinder-y"
    )
    indptr, _, _ = contacts(drum, coordination=7.5, margin=4.0)
    off_axis = np.linalg.norm(drum.centers[:, [0, 2]] - 0.5, axis=1)
    bulk = off_axis <= 0.5 - 4 * drum.radii.mean()
    assert 250 < bulk.sum() < 1800
    # One pair more or less.
    assert_allclose(np.diff(indptr)[bulk].mean(), 7.5, atol=2 / bulk.sum())
