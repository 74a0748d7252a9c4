"""Only here: unions with a surface left inside, or whose distance is no member's."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial import cKDTree
from solid_shapes import MATRIX, OTHER, TURN, cell

from demheat import Layer, Material, Sphere
from demheat.scene import Box, Cylinder, Ellipsoid, HalfSpace, Union
from demheat.scene.shapes.samples import surface_points

MIDDLE = (0.5, 0.5, 0.5)


def balls(d, r, x=0.5):
    return Union([Sphere((x - d / 2, 0.5, 0.5), r, OTHER), Sphere((x + d / 2, 0.5, 0.5), r, OTHER)], OTHER)


def lens(d, r):
    """Volume of two balls of one radius less that of the lens that they share."""
    return 8 / 3 * math.pi * r**3 - math.pi * (4 * r + d) * (2 * r - d) ** 2 / 12


SPHERE = Sphere(MIDDLE, 0.3, OTHER)
BOXES = [Box((a, 0.5, 0.5), (0.3, 0.4, 0.2), OTHER) for a in (0.35, 0.63)]
RODS = [Cylinder((0.5, 0.5, z), 0.2, (0, 0, 1), OTHER, length=0.4) for z in (0.4, 0.55)]
FIBRES = [Cylinder((0.5, 0.5, z), 0.3, (0, 0, 1), OTHER) for z in (0.4, 0.6)]
# Unions that are one shape, and that.
AS_ONE = {
    "a ball in a ball": (Union([SPHERE, Sphere((0.6, 0.5, 0.5), 0.1, OTHER)], OTHER), SPHERE),
    "a ball twice": (Union([SPHERE, SPHERE], OTHER), SPHERE),
    "two boxes": (Union(BOXES, OTHER), Box((0.49, 0.5, 0.5), (0.58, 0.4, 0.2), OTHER)),
    "two rods": (Union(RODS, OTHER), Cylinder((0.5, 0.5, 0.475), 0.2, (0, 0, 1), OTHER, length=0.55)),
    "two fibres": (Union(FIBRES, OTHER), FIBRES[0]),
}
NECK = balls(0.3, 0.2)
STEP = Union([Box((0.4, 0.5, 0.4), (0.5, 0.4, 0.3), OTHER), Box((0.5, 0.5, 0.6), (0.3, 0.4, 0.3), OTHER)], OTHER)
MIXED = Union(
    [
        Sphere(MIDDLE, 0.25, OTHER),
        Box((0.65, 0.5, 0.5), (0.5, 0.2, 0.2), OTHER, rotation=TURN),
        Ellipsoid((0.3, 0.4, 0.5), (0.15, 0.2, 0.1), OTHER, rotation=TURN),
        Cylinder((0.5, 0.5, 0.6), 0.1, (0, 1, 2), OTHER, length=0.6),
    ],
    OTHER,
)
CREASED = {"neck": NECK, "step": STEP, "mixed": MIXED}


@pytest.fixture
def points():
    return np.random.default_rng(0).uniform(-0.1, 1.1, (1500, 3))


@pytest.mark.parametrize("name", AS_ONE)
def test_what_is_one_shape_has_its_surface(name, points):
    union, one = AS_ONE[name]
    assert_array_equal(union.contains(points), one.contains(points))
    # Rounding: 1e-9 of its width is what lies on a surface.
    assert_allclose(union.distance(points), one.distance(points), atol=1e-12)
    period = np.ones(3)
    assert_allclose(union.distance(points, period=period), one.distance(points, period=period), atol=1e-12)
    near = np.abs(one.distance(points)) > 1e-6
    same = np.einsum("ij,ij->i", union.normal(points), one.normal(points))
    # But where two faces are as near.
    assert np.mean(np.abs(same[near] - 1) < 1e-9) > 0.999
    assert_allclose(np.array(union.bounds()), np.array(one.bounds()), atol=1e-15)
    # By planes in 48 cells, extrapolated.
    assert_allclose(union.volume_in((1, 1, 1), periodic=True), one.volume_in((1, 1, 1), periodic=True), rtol=1e-4)


@pytest.mark.parametrize("name", CREASED)
def test_inside_is_in_a_member_and_outside_the_nearest_member_counts(name, points):
    union = CREASED[name]
    each = np.array([shape.distance(points) for shape in union.shapes])
    inside, distance = union.contains(points), union.distance(points)
    assert inside.any() and not inside.all()
    assert_array_equal(inside, (each <= 0).any(axis=0))
    assert_array_equal(inside, distance <= 0)
    assert_allclose(distance[~inside], each.min(axis=0)[~inside], atol=1e-14)  # rounding of the centre's offset
    # Inside it is no nearer to the surface than the deepest member says.
    assert np.all(distance[inside] <= each.min(axis=0)[inside] + 1e-12)
    assert_array_equal(union.sure_distance(points), each.min(axis=0))
    assert_allclose(np.linalg.norm(union.normal(points), axis=1), 1.0, rtol=1e-12)


@pytest.mark.parametrize(("name", "exact"), [("neck", 1.0), ("step", 1.0), ("mixed", 0.99)])
def test_inside_the_distance_is_that_to_points_of_the_surface(name, exact, points):
    """Against points on the members that lie in no other one, a pitch apart, found without the union's own distance.

    In corners where creases end it may be more, in few points of `mixed`: a hundredth was set before it was seen.
    """
    union, pitch, samples = CREASED[name], 0.01, []
    for shape in union.shapes:
        own, _ = surface_points(
            shape, *(end + s * pitch for end, s in zip(shape.bounds(), (-1, 1), strict=True)), pitch
        )
        others = [each for each in union.shapes if each is not shape]
        samples.append(own[np.min([each.distance(own) for each in others], axis=0) > -1e-12])
    nearest, _ = cKDTree(np.concatenate(samples)).query(points)
    inside = union.contains(points)
    depth, nearest = -union.distance(points)[inside], nearest[inside]
    assert np.all(nearest - depth < 1.5 * pitch)
    assert np.mean(depth <= nearest + 1e-12) >= exact


def test_in_a_neck_the_crease_is_nearest():
    """A circle of radius sqrt(r2 - d2/4) about the middle; its direction is that of the normal."""
    points = np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 0.55], [0.51, 0.45, 0.5]])
    radius = math.sqrt(0.2**2 - 0.15**2)
    assert_allclose(NECK.distance(points), [-radius, 0.05 - radius, -math.hypot(0.01, radius - 0.05)], rtol=1e-9)
    assert_allclose(NECK.normal(points[1:2]), [[0.0, 0.0, 1.0]], atol=1e-9)


def test_no_surface_is_left_where_members_meet():
    """Boxes that overlap by less than rounding would see, by a thousandth, and by half."""
    points = np.stack(np.meshgrid(*[np.linspace(0.42, 0.58, 9)] * 3), -1).reshape(-1, 3)
    for overlap in (0.0, 1e-6, 1e-3, 0.2):
        ends = [0.5 + overlap / 2, 0.5 - overlap / 2]
        two = [Box((a, 0.5, 0.5), (0.5, 1.0, 1.0), OTHER) for a in (ends[0] - 0.25, ends[1] + 0.25)]
        assert Union(two, OTHER).distance(points).max() < -0.3


@pytest.mark.parametrize(("d", "r"), [(0.3, 0.2), (0.1, 0.3), (0.39, 0.2)])
def test_the_volume_of_two_balls(d, r):
    # Planes in 48 cells, extrapolated; what they lack at the crease is of second order, too.
    assert_allclose(balls(d, r).volume, lens(d, r), rtol=1e-4)


@pytest.mark.parametrize("name", CREASED)
def test_turned_and_placed(name, points):
    union, order = CREASED[name], (2, 0, 1)
    assert_allclose(union.turned(order).distance(points[:, order]), union.distance(points), atol=1e-12)
    assert union.turned((0, 1, 2)) == union and hash(union) == hash(union.turned((0, 1, 2)))
    moved = union.placed(np.add(union.center, (0.1, 0.2, 0.3)))
    assert_allclose(moved.distance(points + (0.1, 0.2, 0.3)), union.distance(points), atol=1e-12)
    # Of all images the nearest one, outside.
    period = np.array([1.0, 1.2, 1.1])
    points = points[:300]
    shifts = np.stack(np.meshgrid(*[np.arange(-1, 2)] * 3, indexing="ij"), -1).reshape(-1, 3) * period
    once = np.min([union.distance(points + shift) for shift in shifts], axis=0)
    assert_allclose(union.distance(points, period=period), once, atol=1e-12)
    assert_allclose([union.reach(axis) for axis in np.eye(3)], union.bounds()[1], atol=1e-12)


def test_pairs_are_told_by_their_members():
    niche = Sphere((0.5, 0.5, 0.75), 0.08, OTHER)
    assert np.all(np.abs(np.subtract(niche.center, NECK.center)) < NECK.bounds()[1])
    for taken in (
        [NECK, niche],
        [NECK, Sphere((0.35, 0.5, 0.5), 0.1, MATRIX)],
        [NECK, Sphere(MIDDLE, 0.02, MATRIX)],
        [Sphere(MIDDLE, 0.4, MATRIX), NECK],
        [Layer(2, 0.2, 0.8, MATRIX), NECK],
        [balls(0.3, 0.1, 0.25), balls(0.3, 0.1, 0.75)],
        [NECK, Union([Box((0.5, 0.5, z), (1.0, 0.2, 0.1), OTHER) for z in (0.76, 0.84)], OTHER)],
    ):
        cell(*taken)
    for refused, words in (
        ([NECK, Sphere((0.5, 0.5, 0.7), 0.1, OTHER)], "overlap partially"),
        ([NECK, Sphere((0.9, 0.5, 0.5), 0.1, OTHER)], "overlap partially"),
        ([NECK, Sphere(MIDDLE, 0.4, MATRIX)], "is hidden by"),
        ([NECK, balls(0.3, 0.15, 0.6)], "overlap partially"),
    ):
        with pytest.raises(ValueError, match=words):
            cell(*refused)


def test_a_union_may_cross_faces_and_be_cut_by_walls():
    across = balls(0.3, 0.2, 0.95)
    assert cell(across).phase_at([[0.1, 0.5, 0.5], [0.8, 0.5, 0.5], [0.5, 0.5, 0.5]]).tolist() == [1, 1, 0]
    assert cell(across, walls=True).phase_at([[0.1, 0.5, 0.5], [0.8, 0.5, 0.5]]).tolist() == [0, 1]
    outside = Union([Sphere((1.2, 0.5, 0.5), 0.3, OTHER), Sphere((1.4, 0.5, 0.5), 0.3, OTHER)], OTHER)
    point = outside.point_in((1, 1, 1), periodic=False)
    assert outside.contains(point[None])[0] and np.all((point >= 0) & (point <= 1))
    with pytest.raises(ValueError, match="union of diameter"):
        cell(balls(0.8, 0.2))


BALL = Sphere(MIDDLE, 0.3, OTHER)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Union([BALL], OTHER), r"Union.shapes = .*two or more of Sphere"),
        (lambda: Union([BALL, HalfSpace(MIDDLE, (1, 0, 0), OTHER)], OTHER), r"Union.shapes\[1\] = HalfSpace"),
        (lambda: Union([BALL, NECK], OTHER), r"Union.shapes\[1\] = Union"),
        (lambda: Union([BALL, Sphere(MIDDLE, 0.3, Material(7.0))], OTHER), r"shapes\[1\]: of Material.*Union.material"),
        (lambda: Union([BALL, Sphere(MIDDLE, 0.3, OTHER, resistance=1.0)], OTHER), r"shapes\[1\]: .*resistance 1"),
        (lambda: Union([BALL, FIBRES[0]], OTHER), r"shapes\[1\]: has no end along other axes"),
        (lambda: Union([BALL, BALL], 5.0), "Union.material = 5.0"),
        (lambda: Union([BALL, BALL], OTHER, resistance=-1.0), "Union.resistance = -1.0"),
        (lambda: cell(Union([Cylinder(MIDDLE, 0.1, (1, y, 0), OTHER) for y in (1, -1)], OTHER)), "does not repeat"),
    ],
)
def test_what_they_refuse(make, words):
    with pytest.raises(ValueError, match=words) as refused:
        make()
    assert "\n" not in str(refused.value)
