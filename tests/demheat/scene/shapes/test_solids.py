"""Only here: solids whose distance, reach or volume is another's, or that overlap and are taken."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation
from solid_shapes import HALF, LIMITS, OTHER, RING, SOLIDS, TURN, ball, cell

from demheat import Layer, Sphere
from demheat.scene import Box, Cylinder, Ellipsoid, HalfSpace, LevelSet
from demheat.scene.shapes.samples import surface_points
from demheat.scene.shapes.sections import below
from demheat.scene.shapes.solid import Solid
from demheat.scene.volumes import extents, narrower

PERIOD = np.array([1.0, 1.5, 2.0])
EACH = list(SOLIDS.values())
ONCE = [*EACH, HALF]
IDS = [*SOLIDS, "half", "ring"]


@pytest.fixture
def points():
    return np.random.default_rng(0).uniform(-0.5, 1.5, (3000, 3)) * PERIOD


@pytest.mark.parametrize("shape", ONCE, ids=IDS[:-1])
def test_inside_is_where_the_distance_is_not_positive(shape, points):
    for period in (None, PERIOD) if shape is not HALF else (None,):
        inside, distance = shape.contains(points, period=period), shape.distance(points, period=period)
        assert inside.any() and not inside.all()
        assert_array_equal(inside, distance <= 0)


@pytest.mark.parametrize("shape", ONCE, ids=IDS[:-1])
def test_the_distance_is_that_to_the_surface_along_the_normal(shape, points):
    period = PERIOD if shape is not HALF else None
    distance, normal = shape.distance(points, period=period), shape.normal(points, period=period)
    assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-13)
    foot = points - distance[:, None] * normal
    assert_allclose(shape.distance(foot, period=period), 0.0, atol=1e-13)  # rounding of coordinates up to 3
    # Beside an edge the normal of the outside is not that of the foot's own side; outside it is its gradient.
    step = 1e-6
    out = distance > 1e-3
    assert_allclose(shape.distance(points + step * normal, period=period)[out], distance[out] + step, atol=1e-12)


@pytest.mark.parametrize("shape", EACH[1:], ids=IDS[1:-2])
def test_no_point_of_the_surface_is_nearer(shape):
    """Against points all over the surface, a pitch apart: they are no nearer, and not a pitch farther."""
    low, high = shape.bounds()
    pitch = 0.02
    surface, areas = surface_points(shape, low, high, pitch)
    points = np.random.default_rng(1).uniform(low - 0.3, high + 0.3, (100, 3))
    nearest = np.linalg.norm(points[:, None] - surface, axis=2).min(axis=1)
    distance = np.abs(shape.distance(points))
    assert np.all(distance <= nearest + 1e-12) and np.all(nearest <= distance + 1.5 * pitch)
    assert areas.sum() > 0.9 * 6 * (math.pi / 6) ** (1 / 3) * shape.volume ** (2 / 3)  # isoperimetric, but for edges


@pytest.mark.parametrize("shape", EACH, ids=IDS[:-2])
def test_the_nearest_image_is_the_nearest_of_all(shape, points):
    steps = [np.arange(-2, 3) if end else [0] for end in np.isfinite(shape.bounds()[0])]
    shifts = np.stack(np.meshgrid(*steps, indexing="ij"), -1).reshape(-1, 3) * PERIOD
    once = np.min([shape.distance(points + shift) for shift in shifts], axis=0)
    assert_allclose(shape.distance(points, period=PERIOD), once, atol=1e-13)


@pytest.mark.parametrize("shape", EACH, ids=IDS[:-2])
def test_bounds_reach_and_hulls_hold_it_and_no_more(shape):
    low, high = shape.bounds()
    center, radius = shape.ball()
    ends = np.where(np.isfinite(low), [low, high], [[0.0] * 3, PERIOD])
    points = np.random.default_rng(2).uniform(*ends, (40_000, 3))
    inside = points[shape.contains(points)]
    assert np.all(np.linalg.norm(inside - center, axis=1) <= radius * (1 + 1e-12))
    for direction in np.random.default_rng(3).normal(size=(20, 3)):
        if not shape.bounded:
            direction[2] = 0.0
        direction /= np.linalg.norm(direction)
        # The foot of a point far out along a direction is where the shape reaches farthest along it, or nearly.
        foot = center + 1e6 * direction
        foot = foot - shape.distance(foot[None])[0] * shape.normal(foot[None])[0]
        assert_allclose(shape.reach(direction), foot @ direction, atol=1e-5)
        assert (inside @ direction).max() <= shape.reach(direction) + 1e-12
        centers, around = shape.hull(PERIOD)
        assert shape.reach(direction) <= (centers @ direction).max() + around + 1e-12
    for axis in np.flatnonzero(np.isfinite(low)):
        assert_allclose([shape.reach(np.eye(3)[axis]), -shape.reach(-np.eye(3)[axis])], [high[axis], low[axis]])


@pytest.mark.parametrize("shape", ONCE, ids=IDS[:-1])
def test_volumes_are_those_of_points(shape):
    box = (2.0, 2.0, 4.0)
    moved = shape if shape is HALF else replace(shape, center=(0.9, 1.1, 1.9))
    points = np.random.default_rng(4).random((200_000, 3)) * box
    share = moved.contains(points).mean()
    found = moved.volume_in(box, periodic=False) / np.prod(box)
    assert abs(found - share) < 4 * math.sqrt(share / len(points))  # 4 standard deviations
    assert moved.volume == (found * np.prod(box) if moved.bounded else math.inf) or moved.bounded
    with pytest.raises(NotImplementedError, match="cut by a wall") if shape is not HALF else pytest.raises(ValueError):
        if shape is HALF:
            shape.check_fit("it", box, periodic=True)
        replace(moved, center=(0.1, 0.1, 1.9)).volume_in(box, periodic=False)


@pytest.mark.parametrize("length", [None, 2.6])
def test_what_goes_through_two_walls_at_an_angle_has_the_volume_of_an_oblique_cylinder(length):
    rod = Cylinder((0.5, 0.4, 0.5), 0.15, (0.3, 1.0, -0.2), OTHER, length=length)
    assert_allclose(rod.volume_in((1, 1, 1), periodic=False), math.pi * 0.15**2 * math.sqrt(1.13))
    # Too short, off to a side, and off beyond a wall.
    for other in ({"length": 1.1}, {"axis": (0.7, 1.0, 0.0)}, {"center": (0.15, 0.4, 0.5)}):
        with pytest.raises(NotImplementedError, match="cut by a wall"):
            replace(rod, **other).volume_in((1, 1, 1), periodic=False)


@pytest.mark.parametrize("shape", [*ONCE, RING], ids=IDS)
@pytest.mark.parametrize("order", [(2, 0, 1), (1, 0, 2)])
def test_turned_axes(shape, order, points):
    points = points[:300]
    turned = shape.turned(order)
    assert_allclose(turned.distance(points[:, order]), shape.distance(points), atol=1e-13)
    assert_allclose(turned.normal(points[:, order]), shape.normal(points)[:, order], atol=1e-7)
    assert shape.turned((0, 1, 2)) == shape


def test_an_ellipsoid_of_equal_axes_is_a_sphere(points):
    sphere, egg = Sphere((0.1, 0.7, 1.9), 0.3, OTHER), Ellipsoid((0.1, 0.7, 1.9), (0.3, 0.3, 0.3), OTHER, rotation=TURN)
    for period in (None, PERIOD):
        assert_allclose(egg.distance(points, period=period), sphere.distance(points, period=period), atol=1e-13)
        assert_allclose(egg.normal(points, period=period), sphere.normal(points, period=period), atol=1e-12)
    # In the middle, where all of the surface is as near.
    assert_allclose(egg.distance(np.array([egg.center])), [-0.3])


def test_far_from_round_ellipsoids_have_feet_too():
    needle, disc = Ellipsoid((0, 0, 0), (1.0, 1e-3, 1e-3), OTHER), Ellipsoid((0, 0, 0), (1.0, 1.0, 1e-3), OTHER)
    axis = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [2.0, 0.0, 0.0]])
    # From the long axis the foot is beside it, x/a = y/(a (1 - b^2/a^2)), up to the tip's centre of curvature.
    beside = 1e-3 * math.sqrt(1 - 0.25 / (1 - 1e-6))
    assert_allclose(needle.distance(axis), [-1e-3, -beside, 1.0], rtol=1e-6)
    assert_allclose(disc.distance(axis), [-1e-3, -beside, 1.0], rtol=1e-6)


def test_a_level_set_is_exact_inside_and_nearly_so_elsewhere():
    points = np.random.default_rng(5).random((2000, 3))
    sphere = LevelSet(ball, LIMITS, OTHER)
    assert_array_equal(sphere.contains(points), ball(points) <= 0)
    # The gradient points at the nearest point of these two.
    assert_allclose(sphere.distance(points), np.linalg.norm(points - 0.5, axis=1) - 0.3, atol=1e-9)
    x, y, z = (points - 0.5).T
    # A nearer point is sought from a sine of 1e-3 on: half its square of the distance is left.
    assert_allclose(RING.distance(points), np.hypot(np.hypot(x, y) - 0.28, z) - 0.12, atol=1e-7)
    # Cells of a 48th and a 24th of the limits, planes of second order, extrapolated.
    assert_allclose(sphere.volume, 4 / 3 * math.pi * 0.027, rtol=1e-4)
    assert_allclose(RING.volume, 2 * math.pi**2 * 0.28 * 0.12**2, rtol=1e-4)
    # Elsewhere, by its own function.
    moved = RING.placed((0.2, 0.5, 0.5))
    assert_array_equal(moved.contains(points - [0.3, 0, 0]), RING.contains(points))
    assert RING.contains(RING.point_in((1, 1, 1), periodic=False)[None])[0]


def test_a_level_set_is_checked_once():
    asked = []

    def counted(points):
        asked.append(len(points))
        return ball(points)

    sphere = LevelSet(counted, LIMITS, OTHER)
    made = sum(asked)
    moved = sphere.placed((0.2, 0.5, 0.5)).turned((1, 0, 2))
    # What was kept of the first is not its own.
    assert sum(asked) == made and moved.center == pytest.approx((0.5, 0.2, 0.5))
    assert moved.contains(np.array([[0.5, 0.2, 0.5], [0.2, 0.5, 0.5]])).tolist() == [True, False]
    assert_allclose(moved.volume, sphere.volume, rtol=1e-12)
    with pytest.raises(ValueError, match="LevelSet.limits = .*must be three finite numbers"):
        sphere.placed((0.2, np.nan, 0.5))


def test_rotations_are_matrices_or_scipys():
    turn = Rotation.from_euler("xyz", [0.3, 0.5, 0.7])
    one, other = (Box((0, 0, 0), (1, 2, 3), OTHER, rotation=r) for r in (turn, turn.as_matrix()))
    assert one == other and hash(one) == hash(other)
    # Rounded entries become the nearest rotation, which then stays as it is.
    rounded = Box((0, 0, 0), (1, 2, 3), OTHER, rotation=np.round(turn.as_matrix(), 7))
    assert_allclose(np.array(rounded.rotation) @ np.array(rounded.rotation).T, np.eye(3), atol=1e-15)
    assert replace(rounded) == rounded
    # The first column is where the first of its own axes points.
    assert_allclose(one.distance(turn.apply([[0.7, 0, 0], [0, 1.2, 0], [0, 0, 1.7]])), 0.2)


@pytest.mark.parametrize("seed", range(2))
def test_what_planes_leave_of_boxes(seed):
    """Part and area against a fine sum over points, and exactly where the plane is level."""
    rng = np.random.default_rng(seed)
    sides = rng.uniform(0.5, 2.0, 3)
    normals = rng.normal(size=(8, 3))
    normals[0], normals[1] = [0, 0, 1], [0.6, 0.8, 0]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    heights = rng.uniform(-0.6, 0.6, 8)
    part, area = below(normals, heights, sides)
    ticks = (np.arange(60) + 0.5) / 60 - 0.5
    grid = np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij"), -1).reshape(-1, 3) * sides
    for n, h, p, a in zip(normals, heights, part, area, strict=True):
        away = grid @ n + h
        # A plane passes some 60^2 to 3 60^2 of 60^3 points, and misjudges each by half at most, evenly.
        assert abs(np.mean(away <= 0) - p) < 0.01
        step = 1e-6
        lower, upper = below(np.array([n, n]), np.array([h - step, h + step]), sides)[0]
        assert_allclose((lower - upper) / (2 * step) * np.prod(sides), a, atol=1e-5)
    assert_allclose(part[0], np.clip(0.5 - heights[0] / sides[2], 0, 1), rtol=1e-14)
    assert_allclose(area[0], sides[0] * sides[1] * (abs(heights[0]) < sides[2] / 2), rtol=1e-14)
    assert_allclose(below(normals, -heights, sides)[0], 1 - part, atol=1e-12)


def fibre(x, y, radius, axis=(0, 0, 1), **knobs):
    return Cylinder((x, y, 0.5), radius, axis, OTHER, **knobs)


def egg(center, axes):
    return Ellipsoid(center, axes, OTHER, rotation=TURN)


def brick(center, sides):
    return Box(center, sides, OTHER, rotation=TURN)


MIDDLE = (0.5, 0.5, 0.5)
BESIDE = tuple(np.array(MIDDLE) + 0.1 * TURN[:, 2])
TAKEN = {
    "fibres that touch": [fibre(0.25, 0.25, 0.25), fibre(0.75, 0.75, math.sqrt(0.5) - 0.25)],
    "a fibre at a corner, and one in the middle": [fibre(0.0, 0.0, 0.3), fibre(0.5, 0.5, math.sqrt(0.5) - 0.3)],
    "a coated fibre": [fibre(0.5, 0.5, 0.3), fibre(0.55, 0.5, 0.25)],
    "crossed fibres": [fibre(0.25, 0.25, 0.2), fibre(0.5, 0.65, 0.2, (1, 0, 0))],
    "a fibre in a layer": [Layer(0, 0.2, 0.8, OTHER), fibre(0.5, 0.5, 0.3)],
    "a sphere beside a fibre": [fibre(0.0, 0.0, 0.3), Sphere(MIDDLE, math.sqrt(0.5) - 0.3, OTHER)],
    "a coated egg": [egg(MIDDLE, (0.4, 0.3, 0.2)), egg(MIDDLE, (0.39, 0.29, 0.199))],
    "an egg in a ball": [Sphere(MIDDLE, 0.4, OTHER), egg(MIDDLE, (0.4, 0.3, 0.2))],
    "bricks that touch": [brick(MIDDLE, (0.4, 0.2, 0.1)), brick(BESIDE, (0.3, 0.2, 0.1))],
    "a brick in an egg": [egg(MIDDLE, (0.4, 0.3, 0.2)), brick(MIDDLE, (0.46, 0.34, 0.23))],
    "an egg in a brick": [brick(MIDDLE, (0.6, 0.4, 0.3)), egg(MIDDLE, (0.3, 0.2, 0.15))],
    "a rod in a fibre": [fibre(0.5, 0.5, 0.3), fibre(0.5, 0.5, 0.29, (0, 0.02, 1), length=0.9)],
    "a ring in a box": [Box(MIDDLE, (0.9, 0.9, 0.9), OTHER), RING],
}
REFUSED = {
    "fibres": [fibre(0.25, 0.25, 0.25), fibre(0.75, 0.75, math.sqrt(0.5) - 0.2499)],
    "a fibre round the corner": [fibre(0.0, 0.0, 0.3), fibre(0.5, 0.5, math.sqrt(0.5) - 0.2999)],
    "crossed fibres": [fibre(0.25, 0.25, 0.2), fibre(0.5, 0.6499, 0.2001, (1, 0, 0))],
    "a fibre across a layer": [Layer(2, 0.2, 0.8, OTHER), fibre(0.5, 0.5, 0.3)],
    "an egg, not quite in an egg": [egg(MIDDLE, (0.4, 0.3, 0.2)), egg(MIDDLE, (0.39, 0.29, 0.2001))],
    "bricks": [brick(MIDDLE, (0.4, 0.2, 0.1)), brick(BESIDE, (0.3, 0.2, 0.1001))],
    "an egg in a brick": [brick(MIDDLE, (0.6, 0.4, 0.3)), egg(MIDDLE, (0.3, 0.2, 0.1501))],
    "a sphere in the hole of a ring, which is not told": [RING, Sphere(MIDDLE, 0.05, OTHER)],
}


@pytest.mark.parametrize("name", TAKEN)
def test_where_they_may_lie(name):
    scene = cell(*TAKEN[name])
    points = np.random.default_rng(6).random((20_000, 3))
    one, other = (shape.contains(points, period=scene.period) for shape in scene.inclusions)
    # Taken are those that share no point, or one all of the other's.
    assert not np.any(one & other) or np.all(one[other])
    assert_array_equal(scene.phase_at(points), np.where(other, 2, np.where(one, 1, 0)))
    assert scene.parents()[2] == (1 if np.any(one & other) else 0)


@pytest.mark.parametrize("name", REFUSED)
def test_where_they_may_not_lie(name):
    with pytest.raises(ValueError, match="overlap partially"):
        cell(*REFUSED[name])


def half(point, outward):
    return HalfSpace(point, outward, OTHER)


def test_half_spaces_in_boxes():
    one = half(MIDDLE, (1, 1, 0))
    for others in (
        [half((0.7, 0.7, 0.5), (-1, -1, 0))],
        [half((0.2, 0.2, 0.5), (1, 1, 0))],
        [Sphere((0.2, 0.2, 0.5), 0.2, OTHER)],
        [Layer(0, 0.0, 0.2, OTHER), Layer(0, 0.5, 0.6, OTHER)][:0],
        [fibre(0.2, 0.2, 0.2)],
        [fibre(0.9, 0.9, 0.3)],
    ):
        assert len(cell(one, *others, walls=True).inclusions) == 1 + len(others)
    for other in (half((0.2, 0.7, 0.5), (-1, 1, 0)), Sphere(MIDDLE, 0.2, OTHER), Layer(0, 0.0, 0.1, OTHER)):
        with pytest.raises(ValueError, match="overlap partially"):
            cell(one, other, walls=True)
    # Corners of what lies in the box decide, not what is beyond.
    assert len(cell(half(MIDDLE, (1, 0, 0)), Layer(0, 0.5, 0.6, OTHER), walls=True).inclusions) == 2
    assert len(cell(half((0.1, 0.1, 0.5), (1, 1, 0)), half((0.9, 0.1, 0.5), (-1, 1, 0)), walls=True).inclusions) == 2
    with pytest.raises(ValueError, match="lies outside the box"):
        cell(half((-0.1, 0.5, 0.5), (1, 0, 0)), walls=True)
    with pytest.raises(ValueError, match="half-space in a periodic cell does not repeat"):
        cell(one)


def test_cells_that_do_not_repeat_a_cylinder_are_refused():
    with pytest.raises(ValueError, match=r"inclusions\[0\]: cylinder without end along .* does not repeat"):
        cell(fibre(0.5, 0.5, 0.1, (0, 1, 1)))
    assert cell(fibre(0.5, 0.5, 0.1, (0, 1, 1)), walls=True).parents()[1] == 0
    with pytest.raises(ValueError, match="cylinder of diameter 1.02 is larger than the box"):
        cell(fibre(0.5, 0.5, 0.51))
    with pytest.raises(ValueError, match="ellipsoid of diameter .* is larger than the box"):
        cell(egg(MIDDLE, (0.8, 0.1, 0.1)))


def test_images_of_a_fibre_lie_across_it_only():
    scene = cell(fibre(0.0, 0.5, 0.3), fibre(0.5, 0.0, 0.1))
    assert [(phase, image.center[:2]) for phase, image in scene.images()] == [
        (1, (0.0, 0.5)),
        (1, (1.0, 0.5)),
        (2, (0.5, 0.0)),
        (2, (0.5, 1.0)),
    ]
    assert scene.phase_at([[0.99, 0.5, 77.0], [0.5, 0.99, -3.0], [0.5, 0.5, 0.5]]).tolist() == [1, 2, 0]


def test_thin_ones_are_thin_however_they_lie():
    """Their bounds are wide: grids and particles must know all the same."""
    plate = brick(MIDDLE, (0.5, 0.4, 0.02))
    assert_allclose(
        extents(cell(plate, walls=True)).tolist()
        + extents(cell(egg(MIDDLE, (0.4, 0.3, 0.01)))).tolist()
        + extents(cell(fibre(0.5, 0.5, 0.03, (1, 2, 3)), walls=True)).tolist()
        + extents(cell(half(MIDDLE, (1, 2, 3)), walls=True)).tolist(),
        [0.02, 0.02, 0.06, math.inf],
    )
    assert narrower(cell(plate), np.full(3, 0.03)).all() and not narrower(cell(plate), np.full(3, 0.01)).any()


def test_a_solid_supplies_what_its_surface_is():
    parts = {"_normal": lambda self, offsets: offsets}
    with pytest.raises(TypeError, match="class Half: must supply _distance and _normal, or _surface"):
        type("Half", (Solid,), parts)
    type("Whole", (Solid,), parts | {"_distance": lambda self, offsets: offsets[:, 0]})
