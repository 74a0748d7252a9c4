"""Packing fraction, contacts and isotropy of packings."""

import numpy as np
import pytest
from crystals import TOUCH, face_centred, random_packing, simple_cubic, touching
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import linprog

from demheat.packing import statistics_kernels as kernels
from demheat.packing.base import Packing, make_packing
from demheat.packing.neighbours import neighbours
from demheat.packing.statistics import (
    backbone,
    coordination,
    directions,
    fabric,
    packing_fraction,
    radial_distribution,
    two_point,
)
from demheat.packing.statistics.links import _wall_contacts
from demheat.packing.statistics.regions import _lens_areas, _spheres_in_cylinder, spheres_in_box, wall_distances


def pairs_at_random(seed, links):
    """Pairs of touching spheres with directions at random, far from each other."""
    normals = np.random.default_rng(seed).standard_normal((links, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    middles = np.column_stack((3.0 * np.arange(links) + 1.5, np.full((links, 2), 1.5)))
    centers = np.concatenate((middles - normals / 2, middles + normals / 2))
    return make_packing(centers, np.full(2 * links, 0.5), (3.0 * links, 3.0, 3.0), False, {})


# Packing fraction


def test_spheres_are_cut_exactly():
    """Against chords summed on a fine grid; the surface is the growth of the volume with the radius."""
    rng = np.random.default_rng(0)
    centers, radii = rng.uniform(-0.8, 0.8, (40, 3)), rng.uniform(0.2, 1.0, 40)
    low, high = np.array([-0.5, -0.3, -0.6]), np.array([0.4, 0.7, 0.3])
    volumes, surfaces = spheres_in_box(centers, radii, low, high)
    m, sides = 400, high - low
    x, y = (low[a] + (np.arange(m) + 0.5) / m * sides[a] for a in (0, 1))
    for c, r, volume in zip(centers, radii, volumes, strict=True):
        half = np.sqrt(np.maximum(r**2 - (x[:, None] - c[0]) ** 2 - (y - c[1]) ** 2, 0.0))
        chord = np.maximum(np.minimum(c[2] + half, high[2]) - np.maximum(c[2] - half, low[2]), 0.0) * (half > 0)
        # Midpoint rule with kinks: second order, h^2 = 6e-6 times lengths below 1.
        assert_allclose(volume, chord.mean() * sides[0] * sides[1], atol=6e-6)
    grown, shrunk = (spheres_in_box(centers, radii + h, low, high)[0] for h in (1e-5, -1e-5))
    # Central difference: h^2 and rounding 1e-16/h, both 1e-10 times the curvature.
    assert_allclose(surfaces, (grown - shrunk) / 2e-5, atol=1e-7)
    whole = spheres_in_box(centers, radii, np.full(3, -np.inf), np.full(3, np.inf))
    assert_allclose(whole, [4 / 3 * np.pi * radii**3, 4 * np.pi * radii**2], rtol=1e-14)  # rounding


def test_fraction_of_crystals():
    # Rounding of a sum over few hundred spheres, each cut by a difference of terms of order 1.
    assert_allclose(packing_fraction(face_centred()), np.pi * np.sqrt(2) / 6, rtol=1e-13)
    walled = simple_cubic(periodic=False)
    # Faces of the core between spheres, through their centres, and halfway: mirror planes first, then a cap of height
    # r/2 = 5 pi/24 r^3 less per sphere of the outer layers, which the box then shares.
    for margin in (0.0, 1.0, 2.0, 3.0):
        assert_allclose(packing_fraction(walled, margin=margin), np.pi / 6, rtol=1e-13)
    slab = simple_cubic(periodic=(True, True, False))
    cap = 5 * np.pi / 24 * 0.5**3
    assert_allclose(packing_fraction(slab, margin=0.5), (np.pi / 6 * 6 - 2 * cap) / 5.5, rtol=1e-13)


def test_spheres_in_a_cylinder_are_the_sum_of_their_discs():
    rng = np.random.default_rng(2)
    radii = rng.uniform(0.1, 0.4, 30)
    distance = 1 + rng.uniform(-1.1, 1.1, 30) * radii
    low, high = -rng.uniform(0, 1.5, 30) * radii, rng.uniform(0, 1.5, 30) * radii
    found = _spheres_in_cylinder(distance, radii, 1.0, low, high)
    low, high = np.maximum(low, -radii), np.minimum(high, radii)
    z = low + (high - low) * ((np.arange(20000) + 0.5) / 20000)[:, None]
    areas = _lens_areas(distance, np.sqrt(radii**2 - z**2), 1.0)
    # Midpoint rule, second order: 2.5e-9 times the curvature.
    assert_allclose(found, areas.mean(axis=0) * (high - low), atol=1e-8)


@pytest.mark.parametrize("domain", ["sphere", "cylinder-x", "cylinder-y", "cylinder-z"])
def test_fraction_of_round_cores(domain):
    packing = random_packing(1, 40, periodic=False, domain=domain, radius=0.1)
    # Two that fill the core or nearly so, one of them around it.
    packing = packing._replace(centers=np.vstack((packing.centers[1:], packing.size / 2)))
    packing.radii[[0, -1]] = 0.45
    margin = 0.1 / packing.radii.mean()
    m = 100
    at = (np.indices((m, m, m)).reshape(3, -1).T + 0.5) / m
    depth = wall_distances(packing._replace(centers=at))
    at, found = at[depth >= 0.1], 0.0
    for c, r in zip(packing.centers, packing.radii, strict=True):
        found += np.count_nonzero(((at - c) ** 2).sum(axis=1) < r * r)
    # Counts of points err by the random cut of cells of 1e-6: both volumes were found right to 5e-4.
    core = {"sphere": 4 / 3 * np.pi * 0.4**3}.get(domain, np.pi * 0.4**2 * 0.8)
    assert_allclose(len(at) / m**3, core, rtol=1e-3)
    assert_allclose(packing_fraction(packing, margin=margin) * core, found / m**3, rtol=1e-3)


# Contacts


def test_coordination_of_crystals():
    for packing, number in ((simple_cubic(), 6), (face_centred(), 12)):
        found = coordination(packing, *touching(packing))
        assert (found.mean, found.least, found.under_4, found.islands, found.largest) == (number, number, 0, 1, 1)
        assert_array_equal(found.histogram, [0] * number + [packing.number])
    walled = simple_cubic(periodic=False)
    rows = touching(walled)
    assert coordination(walled, *rows).mean == 2 * 3 * 5 * 36 / 216
    inner = coordination(walled, *rows, margin=1.5)
    assert (inner.mean, inner.least, inner.counted, inner.islands) == (6, 6, 64, 1)


def test_coordination_by_hand():
    # A chain of three, a pair, one alone.
    x = np.array([1.0, 2.0, 3.0, 5.0, 6.0, 8.0])
    packing = make_packing(np.column_stack((x, x * 0 + 1, x * 0 + 1)), np.full(6, 0.5), (9, 2, 2), False, {})
    found = coordination(packing, *touching(packing))
    assert_array_equal(found.histogram, [1, 4, 1])
    assert_allclose(found[:1] + found[3:5], [1, 5 / 6, 1], rtol=1e-15)
    assert (found.islands, found.largest, found.counted, found.least) == (3, 0.5, 6, 0)


def held(vectors, half_space=True):
    """Whether vectors hold a particle, through the kernel: particle 0 touches walls only."""
    now, ends = np.empty(1, dtype=bool), np.array([0, len(vectors)])
    none = np.zeros(2, dtype=np.int64), np.empty(0, dtype=np.uint32), np.empty((0, 3))
    kernels.held(*none, ends, np.array(vectors, dtype=float), half_space, np.ones(1, dtype=bool), now)
    return bool(now[0])


def test_what_holds_a_particle():
    tetrahedron = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]) / np.sqrt(3)
    assert held(tetrahedron) and not held(tetrahedron[:3])
    assert held(tetrahedron, half_space=False) and not held(tetrahedron[:3], half_space=False)
    assert not held(tetrahedron * [[-1], [1], [1], [1]])  # one on the wrong side
    axes = np.vstack((np.eye(3), -np.eye(3)))
    assert held(axes)
    assert not held(axes[:5]) and held(axes[:5], half_space=False)  # closed half-space: nothing at -z
    assert not held(axes[[0, 1, 3, 4]]) and held(axes[[0, 1, 3, 4]], half_space=False)  # in one plane
    assert not held([axes[0], axes[3]] * 3)  # on one line


@pytest.mark.parametrize("seed", range(80))
def test_half_space_rule_is_that_of_a_linear_program(seed):
    """Positive forces in balance exist exactly if no half-space holds all directions."""
    rng = np.random.default_rng(seed)
    normals = rng.standard_normal((rng.integers(4, 11), 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    program = linprog(np.zeros(len(normals)), A_eq=normals.T, b_eq=np.zeros(3), bounds=(1, None))
    assert program.status in (0, 2)
    assert held(normals) == (program.status == 0)


def test_a_stack_unravels_from_its_free_top():
    n = 5
    packing = simple_cubic(n, periodic=(True, True, False), size=(n, n, n + 0.5))
    rows = touching(packing)
    found = backbone(packing, *rows, gap=TOUCH, rule="half-space")
    # One layer per round, and a round that finds nothing more.
    assert found.rattler.all() and found.rounds == n + 1 and np.isnan(found.coordination)
    counted = backbone(packing, *rows, gap=TOUCH)
    assert not counted.rattler.any()
    closed = simple_cubic(n, periodic=(True, True, False))
    found = backbone(closed, *touching(closed), gap=TOUCH, rule="half-space")
    pairs, walls = 2 * n**3 + n * n * (n - 1), 2 * n * n
    assert not found.rattler.any() and found.rounds == 1
    assert_allclose(found[1:3], [2 * pairs / n**3, (pairs + walls) / (3 * n**3)], rtol=1e-15)


def test_rattlers_fall_one_after_another():
    """A chain of three beads ending at a crystal: each is held by fewer than four contacts once its neighbour falls."""
    block = simple_cubic(4)
    top = np.array([[1.5, 1.5, z] for z in (4.5, 5.5, 6.5)])
    packing = make_packing(np.vstack((block.centers, top)), np.full(67, 0.5), (4, 4, 8), (True, True, False), {})
    found = backbone(packing, *touching(packing), gap=TOUCH)
    assert_array_equal(packing.centers[found.rattler][:, 2].round(1), [4.5, 5.5, 6.5])
    assert_allclose(found.coordination, 2 * (2 * 64 + 48) / 64, rtol=1e-15)


def test_round_walls_touch_along_the_radius():
    packing = make_packing([[0.9, 0.5, 0.1], [0.5, 0.5, 0.5]], [0.1, 0.1], (1, 1, 2), False, {}, domain="cylinder-z")
    first = int(np.argmin(packing.centers[:, 2]))
    indptr, vectors = _wall_contacts(packing, 1e-9)
    assert_array_equal(np.diff(indptr), [2, 0] if first == 0 else [0, 2])
    assert_allclose(vectors, [[0, 0, -1], [1, 0, 0]], atol=1e-15)  # rounding
    ball = make_packing([[0.5, 0.5 + 0.24, 0.5 - 0.32]], [0.1], (1, 1, 1), False, {}, domain="sphere")
    assert_allclose(_wall_contacts(ball, 1e-9)[1], [[0, 0.6, -0.8]], atol=1e-15)


# Isotropy


def test_fabric_of_crystals():
    # A cubic crystal is invisible to the tensor and plain in the fourth moments: 1/3 and 1/6 instead of 1/5.
    for packing, fourth in ((simple_cubic(), 1 / 3), (face_centred(), 1 / 6)):
        rows = touching(packing)
        found = fabric(packing, *rows)
        assert_allclose(found.tensor, np.eye(3) / 3, atol=1e-14)  # rounding
        assert_allclose(found.fourth, fourth, rtol=1e-13)
        assert found.links == len(rows[1]) / 2 and found.deviation < 1e-10
        assert_allclose(found.fourth_deviation, abs(fourth - 0.2) / np.sqrt(16 / 225 / found.links), rtol=1e-10)


def test_fabric_at_walls_counts_links_from_the_core():
    packing = random_packing(2, 500, periodic=False)
    indptr, indices = neighbours(packing)
    deep = wall_distances(packing) >= 3 * packing.radii.mean()
    total, count, squares = np.zeros((3, 3)), 0, 0
    for i in np.flatnonzero(deep):
        for j in indices[indptr[i] : indptr[i + 1]]:
            n = packing.centers[j] - packing.centers[i]
            total, count = total + np.outer(n, n) / (n @ n), count + 1
            squares += 2 if deep[j] else 1  # a weight of 2, squared, shared by the two ends
    found = fabric(packing, indptr, indices, margin=3.0)
    assert_allclose(found.tensor, total / count, rtol=1e-12, atol=1e-14)  # order of summation
    assert_allclose(found.links, count**2 / squares, rtol=1e-12)
    assert count != len(indices)


def test_sampling_errors_are_those_of_independent_links():
    links, repeats = 100, 300
    tensors, fourths, densities = [], [], []
    for seed in range(repeats):
        packing = pairs_at_random(seed, links)
        rows = touching(packing)
        found, histogram = fabric(packing, *rows), directions(packing, *rows, bins=12)
        tensors.append(found.tensor)
        fourths.append(found.fourth)
        densities.append(histogram.density)
    off, on = np.triu_indices(3, 1), np.diag_indices(3)
    tensors = np.array(tensors)
    for values, mean, error in (
        (tensors[:, on[0], on[1]], 1 / 3, found.diagonal_error),
        (tensors[:, off[0], off[1]], 0.0, found.off_diagonal_error),
        (np.array(fourths), 1 / 5, found.fourth_error),
        (np.array(densities)[:, :, :6].reshape(repeats, -1), 1.0, histogram.error[0]),
    ):
        # Standard error of a mean of 300: 4 of them; of a root mean square of 900 values, some 3 %: 4 of them.
        assert_allclose(values.mean(axis=0), mean, atol=4 * error / np.sqrt(repeats))
        assert_allclose(np.sqrt(np.mean((values - mean) ** 2)), error, rtol=0.12)


def test_directions_of_crystals():
    for packing, at_axes, at_bisectors in ((simple_cubic(), 18, 0), (face_centred(), 12, 6)):
        found = directions(packing, *touching(packing))
        expected = np.zeros(72)
        # Of the 36 bins of a half turn: SC fills two, FCC has 2 of 6 links on each axis and 1 on each bisector.
        expected[::18], expected[9::18] = at_axes, at_bisectors
        assert_allclose(found.density, np.tile(expected, (3, 1)), rtol=1e-13)
        assert_allclose(np.degrees(found.angles), 5 * np.arange(72), rtol=1e-13)


@pytest.mark.parametrize("degrees", [20, 40])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_directions_turn_the_right_way(axis, degrees):
    """A link in the plane normal to an axis, on either side of the middle of a bin, 30 degrees."""
    n = np.zeros(3)
    n[(axis + 1) % 3], n[(axis + 2) % 3] = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    packing = make_packing([[2, 2, 2], n + 2], [0.5, 0.5], (4, 4, 4), False, {})
    found = directions(packing, *touching(packing), bins=12)
    assert_allclose(found.angles[found.density[axis] > 0], [np.pi / 6, 7 * np.pi / 6], rtol=1e-15)
    # Seen along the first of the two axes only the second shows, where angles start.
    assert_array_equal(np.flatnonzero(found.density[(axis + 1) % 3]), [0, 6])


def test_links_along_an_axis_have_no_angle_around_it():
    along_x = make_packing([[1, 1, 1], [2, 1, 1]], [0.5, 0.5], (3, 2, 2), False, {})
    assert np.isnan(directions(along_x, *touching(along_x)).density[0]).all()


def test_bad_input():
    crystal = simple_cubic(6)
    walled, rows = crystal._replace(periodic=np.zeros(3, dtype=bool)), touching(crystal)
    indptr, indices = rows
    swapped = indices.copy()
    swapped[[0, 1]] = swapped[[1, 0]]
    one = Packing(np.full((2, 3), 1.0), np.full(2, 0.5), np.full(3, 4.0), np.ones(3, dtype=bool), {})
    pair = np.array([0, 1, 2]), np.array([1, 0])
    for name, call in (
        ("margin = -1", lambda: packing_fraction(crystal, margin=-1)),
        ("margin = nan", lambda: packing_fraction(crystal, margin=np.nan)),
        ("margin = '1'", lambda: packing_fraction(crystal, margin="1")),
        ("margin = 6.0: must be < 6 mean radii", lambda: packing_fraction(walled, margin=6.0)),
        ("margin = 5.5: no particle", lambda: coordination(walled, *rows, margin=5.5)),
        ("indptr of shape", lambda: coordination(crystal, indptr[:-1], indices)),
        ("indptr of shape", lambda: coordination(crystal, indptr[::-1], indices)),
        ("indices of shape", lambda: coordination(crystal, indptr, indices[:-1])),
        ("indices of shape", lambda: coordination(crystal, indptr, indices.astype(float))),
        ("indices from", lambda: coordination(crystal, indptr, indices + 1)),
        ("indices: each pair", lambda: coordination(crystal, indptr, swapped)),
        ("indices: each pair", lambda: coordination(one, np.array([0, 1, 1]), np.array([1]))),
        ("indices: each pair", lambda: coordination(one, np.array([0, 1, 2]), np.array([0, 1]))),
        ("indices: each pair", lambda: coordination(one, np.array([0, 2, 4]), np.array([1, 1, 0, 0]))),
        ("centers: 0 and 1 coincide", lambda: fabric(one, *pair)),
        ("centers: 0 and 1 coincide", lambda: backbone(one, *pair)),
        ("no links", lambda: fabric(one, np.zeros(3, dtype=int), np.empty(0, dtype=int))),
        ("gap = -1", lambda: backbone(crystal, *rows, gap=-1)),
        ("rule = 'lp'", lambda: backbone(crystal, *rows, rule="lp")),
        ("bins = 7", lambda: directions(crystal, *rows, bins=7)),
        ("bins = 0", lambda: radial_distribution(crystal, bins=0)),
        ("bins = 9.0", lambda: radial_distribution(crystal, r_max=1.0, bins=9.0)),
        ("r_max = 3.1: .* <= 3, half of the shortest period", lambda: radial_distribution(crystal, r_max=3.1)),
        ("r_max = 3.0: no centre", lambda: radial_distribution(walled, r_max=3.0)),
        ("r_max = 0", lambda: two_point(crystal, r_max=0)),
        ("r_max = 2.6: must be <= 2.5, half of the longest line", lambda: two_point(walled, r_max=2.6, margin=1.0)),
        ("at least 2", lambda: radial_distribution(make_packing([[1, 1, 1]], [0.5], (4, 4, 4), True, {}))),
        ("along = ", lambda: two_point(crystal, along=[[0, 0, 0]], r_max=1.0)),
        ("along = ", lambda: two_point(crystal, along=(1, 0, 0), r_max=1.0)),
        ("along = ", lambda: two_point(crystal, along="x", r_max=1.0)),
        ("points = 1", lambda: two_point(crystal, points=1, r_max=1.0)),
        ("lines = 1", lambda: two_point(crystal, lines=1, r_max=1.0)),
        ("seed = -1", lambda: two_point(crystal, seed=-1, r_max=1.0)),
        ("periods must be", lambda: two_point(one._replace(radii=np.full(2, 1.1)), r_max=0.5)),
    ):
        with pytest.raises(ValueError, match=name):
            call()
