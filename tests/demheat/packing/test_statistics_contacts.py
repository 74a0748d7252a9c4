"""Only here: contacts, backbones and fabrics of packings other than those of crystals and of theory."""

import numpy as np
import pytest
from crystals import CONTACT_GAP, face_centred, random_packing, simple_cubic, touching
from numpy.testing import assert_allclose, assert_array_equal

from demheat.packing.base import make_packing
from demheat.packing.neighbours import neighbours
from demheat.packing.statistics import backbone, coordination, directions, fabric
from demheat.packing.statistics.contacts import _wall_contacts
from demheat.packing.walls import wall_distances


def pairs_at_random(seed, links):
    """Pairs of touching spheres with directions at random, far from each other."""
    normals = np.random.default_rng(seed).standard_normal((links, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    middles = np.column_stack((3.0 * np.arange(links) + 1.5, np.full((links, 2), 1.5)))
    centers = np.concatenate((middles - normals / 2, middles + normals / 2))
    return make_packing(centers, np.full(2 * links, 0.5), (3.0 * links, 3.0, 3.0), False, {})


# Contacts


def test_coordination_of_crystals():
    for packing, number in ((simple_cubic(), 6), (face_centred(), 12)):
        found = coordination(packing, *touching(packing))
        assert (found.mean, found.least, found.under_4, found.components, found.largest) == (number, number, 0, 1, 1)
        assert_array_equal(found.histogram, [0] * number + [packing.number])
    walled = simple_cubic(periodic=False)
    rows = touching(walled)
    assert coordination(walled, *rows).mean == 2 * 3 * 5 * 36 / 216
    inner = coordination(walled, *rows, margin=1.5)
    assert (inner.mean, inner.least, inner.counted, inner.components) == (6, 6, 64, 1)


def test_coordination_by_hand():
    # A chain of three, a pair, one alone.
    x = np.array([1.0, 2.0, 3.0, 5.0, 6.0, 8.0])
    packing = make_packing(np.column_stack((x, x * 0 + 1, x * 0 + 1)), np.full(6, 0.5), (9, 2, 2), False, {})
    found = coordination(packing, *touching(packing))
    assert_array_equal(found.histogram, [1, 4, 1])
    assert_allclose(found[:1] + found[3:5], [1, 5 / 6, 1], rtol=1e-15)
    assert (found.components, found.largest, found.counted, found.least) == (3, 0.5, 6, 0)


def test_a_stack_unravels_from_its_free_top():
    n = 5
    packing = simple_cubic(n, periodic=(True, True, False), size=(n, n, n + 0.5))
    rows = touching(packing)
    found = backbone(packing, *rows, gap=CONTACT_GAP, rule="half-space")
    # One layer per round, and a round that finds nothing more.
    assert found.rattler.all() and found.rounds == n + 1 and np.isnan(found.coordination)
    counted = backbone(packing, *rows, gap=CONTACT_GAP)
    assert not counted.rattler.any()
    closed = simple_cubic(n, periodic=(True, True, False))
    found = backbone(closed, *touching(closed), gap=CONTACT_GAP, rule="half-space")
    pairs, walls = 2 * n**3 + n * n * (n - 1), 2 * n * n
    assert not found.rattler.any() and found.rounds == 1
    assert_allclose(found[1:3], [2 * pairs / n**3, (pairs + walls) / (3 * n**3)], rtol=1e-15)


def test_rattlers_fall_one_after_another():
    """A chain of three beads ending at a crystal: each is held by fewer than four contacts once its neighbour falls."""
    block = simple_cubic(4)
    top = np.array([[1.5, 1.5, z] for z in (4.5, 5.5, 6.5)])
    packing = make_packing(np.vstack((block.centers, top)), np.full(67, 0.5), (4, 4, 8), (True, True, False), {})
    found = backbone(packing, *touching(packing), gap=CONTACT_GAP)
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
