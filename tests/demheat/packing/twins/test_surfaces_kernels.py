"""Only here: kernels of twins that turn, thin or part points otherwise than NumPy does."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from demheat.packing.twins import surfaces_kernels as kernels
from demheat.packing.twins.interfaces import fibonacci_sphere, inscribed_radius
from demheat.packing.twins.patterns import thinned
from demheat.packing.twins.spheres import inscribed_radii
from demheat.scene.shapes.bins import ball_bins


@pytest.mark.twin
def test_patterns_are_turned_fibonacci_points():
    counts, rng = np.array([12, 0, 333, 5000]), np.random.default_rng(0)
    turns = Rotation.random(4, random_state=1).as_matrix()
    balls = rng.random((4, 4))
    start = np.concatenate([[0], np.cumsum(counts)])
    points, normals = np.full((start[-1], 3), np.nan), np.full((start[-1], 3), np.nan)
    kernels.turned_patterns(0, 4, start, turns, balls, points, normals)
    wanted = np.concatenate([fibonacci_sphere(n) @ turn.T for n, turn in zip(counts, turns, strict=True)])
    # Sines of angles up to 5e4, and steps between them: their rounding.
    assert_allclose(normals, wanted, rtol=0, atol=2e-11)
    own = np.repeat(np.arange(4), counts)
    assert_allclose(points, balls[own, :3] + balls[own, 3:] * normals, rtol=0, atol=1e-15)


def slow_gaps(points, own, balls, size, periodic):
    offsets = points[:, None] - balls[:, :3]
    offsets -= size * np.round(offsets / size) if periodic else 0.0
    gaps = np.abs(np.linalg.norm(offsets, axis=2) - balls[:, 3])
    gaps[own[:, None] == np.arange(len(balls))] = np.inf
    return gaps.min(axis=1)


@pytest.mark.twin
@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize(("number", "ratio"), [(1, 1.0), (40, 1.0), (300, 20.0)])
def test_nearest_gaps_are_those_to_all_spheres(periodic, number, ratio):
    rng, size = np.random.default_rng(2), np.array([1.0, 0.8, 1.1])
    balls = np.column_stack([size * rng.random((number, 3)), 0.4 * number ** (-1 / 3) * ratio ** -rng.random(number)])
    points, own = size * rng.uniform(0.0, 1.0, (3000, 3)), rng.integers(-1, number, 3000)
    reach, gaps = 0.07, np.full(3000, np.nan)
    bins = ball_bins(balls[:, :3], balls[:, 3] + reach, size, periodic=periodic)
    kernels.nearest_gaps(0, 3000, points, own, np.arange(number), balls, bins, reach, gaps)
    wanted = slow_gaps(points, own, balls, size, periodic)
    assert np.any(wanted > reach) and np.any(wanted < reach)
    # Rounding of distances of order 1.
    assert_allclose(gaps, np.where(wanted <= reach, wanted, np.inf), rtol=0, atol=1e-14)


@pytest.mark.parametrize("ratio", [1.0, 10.0])
def test_distances_taken_do_not_grow_with_the_number_of_spheres(ratio):
    """At a fixed number of points, and gaps in proportion to the spheres: a count, not a time."""
    rng, taken = np.random.default_rng(3), []
    for number in (500, 8000):
        balls = np.column_stack([rng.random((number, 3)), 0.4 * number ** (-1 / 3) * ratio ** -rng.random(number)])
        reach = 0.3 * number ** (-1 / 3)
        bins = ball_bins(balls[:, :3], balls[:, 3] + reach, np.ones(3), periodic=True)
        none, gaps = np.full(3000, -1), np.empty(3000)
        where = none, np.arange(number), balls, bins, reach, gaps
        taken.append(kernels.nearest_gaps(0, 3000, rng.random((3000, 3)), *where))
    assert 0 < taken[1] < 1.3 * taken[0]


@pytest.mark.twin
def test_order_and_thinning_of_a_few():
    """Along x, some as they stand: the closest-set of those left is chosen, and takes its neighbours out."""
    along, least = np.array([0.0, 0.1, 0.25, 0.6, 0.65]), np.array([0.2, 0.12, 0.2, 0.06, 0.3])
    order, place = np.empty(5, np.int64), np.arange(5)
    kernels.ascending(least, np.zeros(6, np.int64), order)
    assert_array_equal(order, np.argsort(least, kind="stable"))
    points, taken = np.column_stack([along, 0 * along, 0 * along]), np.array([[0.0, 0.11, 0.0]])
    free, chosen = np.ones(5, bool), np.zeros(5, bool)
    kernels.thin(points, least, order, place, place, along, taken, taken[:, 0], np.zeros(1, int), free, chosen)
    # 0 is too near to the one taken; 3 takes 4 out; 1 takes 0 out, and leaves 2.
    assert chosen.tolist() == [False, True, True, True, False]


@pytest.mark.twin
@pytest.mark.parametrize("ascending", [True, False])
def test_thinned_points_keep_their_distance(ascending):
    rng, axes = np.random.default_rng(4), np.array([[1.0, 0.0, 0.0], [0.0, 0.6, 0.8], [0.0, 0.0, 1.0]])
    counts, there = [400, 0, 300], [20, 5, 0]
    groups = [rng.random((n, 3)) * [1.0, 1.0, 0.02] for n in counts]
    if ascending:
        groups = [points[np.argsort(points @ axis)] for points, axis in zip(groups, axes, strict=True)]
    points, least = np.concatenate(groups), np.maximum(rng.uniform(0.0, 0.2, 700), 0.06)  # some the same
    taken = rng.random((25, 3)) * [1.0, 1.0, 0.02]
    ends, ends_there = np.cumsum(counts), np.cumsum(there)
    spans = np.stack([ends - counts, ends], axis=1)
    spans_there = np.stack([ends_there - there, ends_there], axis=1)
    chosen = np.zeros(700, dtype=bool)
    thinned(0, 3, (spans, points, least), (spans_there, taken), axes, chosen)
    slow = np.zeros(700, dtype=bool)
    for (begin, end), (first, last) in zip(spans, spans_there, strict=True):
        for p in begin + np.argsort(least[begin:end], kind="stable"):
            before = begin + np.flatnonzero(slow[begin:end])
            far = np.linalg.norm(points[before] - points[p], axis=1) > least[before]
            far_there = np.linalg.norm(taken[first:last] - points[p], axis=1) >= least[p]
            slow[p] = far.all() and far_there.all()
    assert_array_equal(chosen, slow)


def polar_volume(normals):
    """Of {x : n.x <= 1}: its corners are the planes of the hull of the normals, whose neighbours share its edges."""
    hull = ConvexHull(normals)
    corners = -hull.equations[:, :3] / hull.equations[:, 3:]
    volume = 0.0
    for face, (simplex, others) in enumerate(zip(hull.simplices, hull.neighbors, strict=True)):
        for other, opposite in zip(others, range(3), strict=True):
            for normal in normals[np.delete(simplex, opposite)]:
                volume += abs(np.linalg.det([normal, corners[face], corners[other]])) / 12  # seen from both faces
    return volume


@pytest.mark.twin
def test_areas_are_those_of_the_polyhedron():
    """Against the volume by the hull of the normals, whose facets all hold their touch points."""
    rng = np.random.default_rng(5)
    sets = [fibonacci_sphere(n) @ Rotation.random(random_state=n).as_matrix().T for n in (12, 50, 700)]
    # Close-set on one side.
    rough = rng.standard_normal((4000, 3))
    rough /= np.linalg.norm(rough, axis=1)[:, None]
    sets.append(np.concatenate([fibonacci_sphere(30), rough[rough[:, 0] > 0.8][:200]]))
    normals, count = np.concatenate(sets), np.array([len(each) for each in sets])
    own = np.repeat(np.arange(4), count)
    order, areas = np.lexsort((normals[:, 2], own)), np.full(len(normals), np.nan)
    start = np.concatenate([[0], np.cumsum(count)])
    kernels.facet_areas(0, len(normals), start, own, normals[order], areas)
    wanted = [3 * polar_volume(each) for each in sets[:3]]
    assert_allclose(np.bincount(own, areas)[:3], wanted, rtol=1e-12)  # rounding
    # The mean over 40 directions a normal.
    assert_allclose(inscribed_radii(normals, count), [inscribed_radius(each) for each in sets], rtol=2e-4)


def test_many_corners_are_no_crash():
    """A facet with more corners than there is room for, between two rings of planes that are nearly upright."""
    angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), np.full(200, 0.2)], axis=1)
    ring /= np.linalg.norm(ring, axis=1)[:, None]
    normals = np.concatenate([ring, ring * [1, 1, -1], [[0, 0, 1.0], [0, 0, -1.0]]])
    assert np.isnan(inscribed_radii(np.tile(normals, (3, 1)), np.full(3, len(normals)))).all()


def test_a_cube_and_what_has_no_end():
    cube = np.concatenate([np.eye(3), -np.eye(3)])
    half = fibonacci_sphere(200)[:100]
    radii = inscribed_radii(np.concatenate([cube, half, cube]), np.array([6, 100, 6]))
    assert_allclose(radii[[0, 2]], (np.pi / 6) ** (1 / 3), rtol=1e-14)
    assert np.isnan(radii[1])
