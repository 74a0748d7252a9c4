"""Only here: balls that the search by cells leaves out, or finds with work that grows as the square."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from demheat import Layer, Material, Scene, Sphere
from demheat.scene.shapes.bins import ball_bins, candidates

MATRIX, OTHER = Material(1.0), Material(10.0)
SIZE = np.array([1.0, 0.7, 1.3])


def spread(number, *, ratio, seed=0):
    """Centres, some beyond the box, and radii of this ratio."""
    rng = np.random.default_rng(seed)
    radii = 0.3 * number ** (-1 / 3) * ratio ** -rng.random(number)
    return SIZE * rng.uniform(-0.05, 1.05, (number, 3)), radii


def slow_pairs(points, centers, radii, periodic):
    offsets = points[:, None] - centers
    offsets -= SIZE * np.round(offsets / SIZE) if periodic else 0.0
    return np.argwhere(np.sum(offsets**2, axis=2) <= radii**2)


@pytest.mark.twin
@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize(("number", "ratio"), [(1, 1.0), (200, 30.0)])
def test_no_ball_that_holds_a_point_is_left_out(periodic, number, ratio):
    centers, radii = spread(number, ratio=ratio)
    radii[0] = 0.34  # across nearly all of the shortest side
    rng = np.random.default_rng(1)
    edge = centers[rng.integers(number, size=200)].copy()
    edge[:, 0] += radii[rng.integers(number, size=200)]
    points = np.concatenate([SIZE * rng.uniform(-0.2, 1.2, (2000, 3)), edge])
    point, ball = candidates(ball_bins(centers, radii, SIZE, periodic=periodic), points)
    found = set(zip(point.tolist(), ball.tolist(), strict=True))
    assert len(found) == len(point)  # once each
    assert {tuple(pair) for pair in slow_pairs(points, centers, radii, periodic).tolist()} <= found


@pytest.mark.parametrize("ratio", [1.0, 30.0])
def test_entries_and_candidates_grow_with_the_number_of_balls(ratio):
    """Cells and pairs per ball and per point are the same for 500 and 8000: counts, not times."""
    counts = []
    for number in (500, 8000):
        centers, radii = spread(number, ratio=ratio)
        bins = ball_bins(centers, radii, SIZE, periodic=True)
        points = SIZE * np.random.default_rng(2).random((4000, 3))
        counts.append((len(bins.balls) / number, len(bins.start) / number, len(candidates(bins, points)[0]) / 4000))
    few, many = np.array(counts)
    # Cells are whole parts of the box, and radii are drawn: a fifth or so; a square would be a factor 16.
    assert np.all(many < 1.5 * few)


def test_no_balls():
    point, ball = candidates(ball_bins(np.empty((0, 3)), np.empty(0), SIZE, periodic=True), np.ones((5, 3)))
    assert len(point) == len(ball) == 0


def crowd(periodic):
    """Spheres side by side, some with a core, some cut by walls, over a layer."""
    rng = np.random.default_rng(3)
    sites = (np.stack(np.meshgrid(*[np.arange(5)] * 3, indexing="ij"), -1).reshape(-1, 3) + 0.5) / 5
    spheres = [Sphere(c + rng.uniform(-0.02, 0.02, 3), rng.uniform(0.02, 0.08), OTHER) for c in sites]
    cores = [Sphere(s.center, 0.5 * s.radius, MATRIX) for s in spheres[::3]]
    layer = Layer(2, 0.62, 0.78, OTHER)
    kept = [s for s in spheres + cores if abs(s.center[2] - 0.7) + s.radius < 0.08 or abs(s.center[2] - 0.7) > 0.17]
    if not periodic:
        kept += [Sphere((0.0, 0.6, 0.4), 0.01, OTHER), Sphere((-0.01, 0.4, 0.4), 0.02, OTHER)]
    load = {"gradient": (0, 1, 0)} if periodic else {"walls": {"y-": 0.0, "y+": 1.0}}
    return Scene((1, 1, 1), MATRIX, [layer, *kept], **load)


@pytest.mark.twin
@pytest.mark.parametrize("periodic", [True, False])
def test_phases_and_parents_are_those_of_one_shape_after_the_other(periodic):
    scene = crowd(periodic)
    points = np.random.default_rng(4).uniform(-0.1, 1.1, (40_000, 3))
    phase, parent = np.zeros(len(points), int), np.zeros(len(scene.inclusions) + 1, int)
    inner = np.array([shape.point_in(scene.size, periodic=periodic) for shape in scene.inclusions])
    for number, shape in enumerate(scene.inclusions, start=1):
        phase[shape.contains(points, period=scene.period)] = number
        parent[number + 1 :][shape.contains(inner[number:], period=scene.period)] = number
    assert_array_equal(scene.phase_at(points), phase)
    assert_array_equal(scene.parents(), parent)
    assert len(np.unique(phase)) > 120 and np.sum(parent > 1) > 20 and np.any(parent == 1)


@pytest.mark.parametrize("ratio", [1.0, 20.0])
def test_one_overlap_among_many_spheres_is_found(ratio):
    rng = np.random.default_rng(5)
    sites = (np.stack(np.meshgrid(*[np.arange(8)] * 3, indexing="ij"), -1).reshape(-1, 3) + 0.5) / 8
    spheres = [Sphere(c, 0.06 * ratio ** -rng.random(), OTHER) for c in sites]
    Scene((1, 1, 1), MATRIX, spheres, gradient=(0, 1, 0))
    beside = np.array(spheres[300].center) + [0.0, spheres[300].radius, 0.0]
    with pytest.raises(ValueError, match=r"inclusions\[300\] and \[512\] overlap partially"):
        Scene((1, 1, 1), MATRIX, [*spheres, Sphere(beside, 0.001, OTHER)], gradient=(0, 1, 0))
    # Through a periodic face.
    spheres[0] = Sphere((0.0625, 0.0625, 0.003), 0.0625, OTHER)
    spheres[7] = Sphere((0.0625, 0.0625, 0.9), 0.05, OTHER)
    with pytest.raises(ValueError, match=r"inclusions\[0\] and \[7\] overlap partially"):
        Scene((1, 1, 1), MATRIX, spheres, gradient=(0, 1, 0))
