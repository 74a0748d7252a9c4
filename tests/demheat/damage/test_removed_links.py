"""Only here: links gone from one end alone, or more of them than asked; lattices beside theory."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
from random_links import dense, each_link

from demheat import Laguerre, Layer, Material, Scene, damage
from demheat.conduction.steady import solve_steady
from demheat.damage.links import pairs
from demheat.dem.networks import network_of
from demheat.network.base import branches, row_numbers
from demheat.network.links_kernels import Links
from demheat.packing.base import make_packing

ONE = Material(1.0)
CELL = Scene((1.0, 1.0, 1.0), ONE, gradient=(0.0, 0.0, 1.0))


def lattice(cells, *, periodic=True):
    """Particles on a simple cubic lattice: their network is one of equal links."""
    step = 1 / cells
    centers = step * (np.stack(np.meshgrid(*3 * [np.arange(cells)], indexing="ij"), axis=-1).reshape(-1, 3) + 0.5)
    return make_packing(centers, np.full(len(centers), step / 2), (1.0, 1.0, 1.0), (periodic,) * 3, {})


def network(cells=6):
    return network_of(CELL, lattice(cells), Laguerre())


def test_pairs_are_both_ends_of_each_link():
    made = network(4)
    first, second = pairs(made)
    assert len(np.union1d(first, second)) == 2 * len(first) == len(made.indices)
    there = branches(made.centers, made.size, made.indptr, made.indices, made.image)
    assert_allclose(there[first], -there[second], atol=1e-12)
    row = row_numbers(made.indptr)
    assert_array_equal(row[first], made.indices[second])
    assert_array_equal(row[second], made.indices[first])


def test_the_share_that_is_asked_for():
    made = network()
    conducting = np.count_nonzero(made.conductance > 0)
    less, more = (damage.without_links(made, share, seed=3) for share in (0.2, 0.5))
    assert np.count_nonzero(less.conductance > 0) == conducting - 2 * round(0.2 * conducting / 2)
    # The same draw and more; links stay symmetric.
    assert np.all(less.conductance[more.conductance > 0] > 0)
    first, second = pairs(made)
    assert_array_equal(less.conductance[first], less.conductance[second])
    assert damage.without_links(made, 0.0, seed=3) is made
    assert made.whole and not less.whole


def test_beside_a_dense_solution():
    """On islands and dead ends alike, by the pseudoinverse of the whole matrix."""
    made = damage.without_links(network(4), 0.5, seed=1)
    solution = solve_steady(made, CELL, tolerance=1e-12)
    links = Links(made.indptr, made.indices, made.conductance)
    step = branches(made.centers, made.size, made.indptr, made.indices, made.image)[:, 2]
    row = row_numbers(made.indptr)
    diagonal = np.bincount(row, made.conductance, minlength=64)
    heat = np.bincount(row, made.conductance * step, minlength=64)
    T = np.linalg.pinv(dense(links, diagonal)) @ heat
    flow = made.conductance * (step + T[made.indices] - T[row])
    mine = np.nan_to_num(solution.temperature)
    # The solver's tolerance.
    assert_allclose(made.conductance * (step + mine[made.indices] - mine[row]), flow, atol=1e-9)
    assert sum(1 for _ in each_link(links)) == len(links.indices)


def test_what_cannot_pass_is_exactly_nothing():
    packing = lattice(6)
    found = damage.solve(CELL, removed=0.9, packing=packing, draw=1)
    assert found.conductivity == 0.0 and found.stats["iterations"] == 0
    walled = Scene((1.0, 1.0, 1.0), ONE, walls={"z-": 0.0, "z+": 1.0})
    gone = damage.solve(walled, removed=1.0, packing=lattice(6, periodic=False))
    assert gone.conductivity == 0.0
    # Particles at walls have their temperatures, those between none.
    assert sorted(set(gone.samples.temperature[np.isfinite(gone.samples.temperature)])) == [0.0, 1.0]
    assert np.isnan(gone.samples.temperature).sum() == 6 * 6 * 4


def test_few_links_gone_from_a_lattice():
    """A link of n neighbours gone takes 1/(1 - 2/n) of its share: 1.5 of the simple cubic lattice (Kirkpatrick 1973).

    Exact for one link in an endless lattice; in a cell its images change that by some 1/7^3, neighbours among ten by a
    few per cent. Along the diagonal all
    links carry the same.
    """
    packing, diagonal = lattice(7), Scene((1.0, 1.0, 1.0), ONE, gradient=(1.0, 1.0, 1.0))
    for count, allowed in ((1, 0.005), (10, 0.1)):
        k = damage.solve(diagonal, removed=count / 1029, draw=4, packing=packing).conductivity
        assert_allclose(1 - k, 1.5 * count / 1029, rtol=allowed)


def test_an_undamaged_body_is_that_of_the_engine():
    import demheat

    layer = Layer(1, 0.2, 0.5, Material(9.0), resistance=0.1)
    scene = Scene((1.0, 1.0, 1.0), ONE, [layer], walls={"y-": 0.0, "y+": 1.0})
    mine, theirs = (call(scene, particles=500, seed=2) for call in (damage.solve, demheat.solve))
    assert mine.conductivity == theirs.conductivity
    assert_array_equal(mine.samples.temperature, theirs.samples.temperature)
