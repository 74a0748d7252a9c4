"""Only here: edges of boxes that meet taken as all others, where errors hardly fall."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from surface_bodies import brick, joined, ring

from demheat import Material, Scene, solve
from demheat.scene import Box, Cylinder, Ellipsoid, HalfSpace, Sphere, SurfaceMesh, Union
from demheat.scene.edges import edge_order, power
from demheat.scene.shapes import Shape
from references import fft


def board(contrast, depth=0.5, shift=0.0):
    """A checkerboard across z; its conductivity is the root of the contrast (Keller 1964)."""
    sides, good = (0.5, 0.5, depth), Material(contrast)
    boxes = [Box((x, x + (x > 0.5) * shift, depth / 2), sides, good) for x in (0.25, 0.75)]
    return Scene((1.0, 1.0, depth), Material(1.0), boxes, gradient=(0, 1, 0))


@pytest.mark.parametrize("contrast", [2.0, 1000.0])
def test_power_at_the_edges_of_a_board_is_the_exact_one(contrast):
    exact = 4 / math.pi * math.atan(contrast**-0.5)
    # Powers are tried in steps of 1/2000, the first beyond the root counts.
    assert_allclose(power([contrast, 1, contrast, 1]), exact, rtol=0, atol=1 / 2000)
    assert_allclose(edge_order(board(contrast)), 2 * exact, rtol=0, atol=1 / 1000)


def test_power_of_other_edges():
    assert power([5.0] * 4) == power([0.0] * 4) == power([5.0, 5.0, 1.0, 1.0]) == 1.0
    # A corner of a perfect conductor or insulator: 2/3, as around any angle of 270 degrees.
    assert_allclose([power([1e9, 1, 1, 1]), power([0, 1, 1, 1])], 2 / 3, atol=1 / 2000)
    assert power([1.0, 0.0, 1.0, 0.0]) == 1 / 2000


@pytest.mark.parametrize("contrast, angle", [(100.0, 0.3), (0.05, 0.8), (7.0, 1.2)])
def test_power_of_wedges(contrast, angle):
    """Even modes of a wedge of twice an angle: k tan(p angle) = -tan(p (pi - angle)); odd ones with 1 / k."""

    def least(k):
        p = np.linspace(1e-4, 1.0, 100_001)
        # Without the poles of the tangents.
        mode = k * np.sin(p * angle) * np.cos(p * (np.pi - angle)) + np.cos(p * angle) * np.sin(p * (np.pi - angle))
        return p[1:][np.diff(np.sign(mode)) != 0].min(initial=1.0)

    exact = min(least(contrast), least(1 / contrast))
    assert_allclose(power([contrast, 1.0], [2 * angle, 2 * np.pi - 2 * angle]), exact, atol=1 / 2000)


def test_rims_and_inclined_planes_have_edges():
    cell, good = {"size": (1.0, 1.0, 1.0), "matrix": Material(1.0)}, Material(1e9)
    walls = {"walls": {"x-": 0.0, "x+": 1.0}}
    rod = Cylinder((0.5,) * 3, 0.2, (1, 2, 0), good, length=0.3)
    assert_allclose(edge_order(Scene(inclusions=[rod], **cell, **walls)), 4 / 3, atol=2 / 1000)
    fibre = Cylinder((0.5,) * 3, 0.2, (1, 0, 0), good)
    assert edge_order(Scene(inclusions=[fibre], **cell, **walls)) == 2.0
    # A plane at 45 degrees is the edge of a square bar there, or one less a quarter; an upright one is none.
    tilted = HalfSpace((0.5,) * 3, (1, 1, 0), good)
    assert_allclose(edge_order(Scene(inclusions=[tilted], **cell, **walls)), 4 / 3, atol=2 / 1000)
    assert edge_order(Scene(inclusions=[HalfSpace((0.5,) * 3, (0, 0, 1), good)], **cell, **walls)) == 2.0


@pytest.mark.parametrize("contrast", [20.0, 0.05])
def test_what_is_round_has_an_edge_where_a_wall_cuts_it_off_its_middle(contrast):
    """A ball at .6 of its radius from a wall meets it at arccos(.6), whichever side its middle is on."""

    def order(shape, **load):
        return edge_order(Scene((1.0, 1.0, 1.0), Material(1.0), [shape], **(load or {"walls": {"x-": 0.0, "x+": 1.0}})))

    good, angle = Material(contrast), 2 * math.acos(0.6)
    wedges = ([angle, 2 * np.pi - angle], [2 * np.pi - angle, angle])
    exact = 2 * min(power([contrast, 1.0], each) for each in wedges)
    assert exact < 1.8
    for place in (0.18, -0.18, 1.18):
        # Angles are told apart by a hundredth of a radian.
        assert_allclose(order(Sphere((place, 0.5, 0.5), 0.3, good)), exact, atol=0.02)
    assert order(Sphere((0.0, 0.5, 0.5), 0.3, good)) == order(Sphere((0.31, 0.5, 0.5), 0.3, good)) == 2.0
    assert order(Sphere((0.18, 0.5, 0.5), 0.3, good), gradient=(1, 0, 0)) == 2.0


def test_an_ellipsoid_leans_as_far_as_its_normals():
    """Against those of the walls, at points of its surface on them: of a thousand, by distances."""
    body = Ellipsoid((0.1, 0.5, 0.9), (0.35, 0.2, 0.25), Material(5.0), rotation=(0.2, 0.4, 0.7))
    seen, span = np.zeros(3), np.linspace(0.0, 1.0, 1001)
    for axis, at in ((0, 0.0), (2, 1.0)):
        points = np.stack(np.meshgrid(span, span, indexing="ij"), axis=-1).reshape(-1, 2)
        points = np.insert(points, axis, at, axis=1)
        on = points[np.abs(body.distance(points)) < 5e-4]
        seen[axis] = np.abs(body.normal(on)[:, axis]).max()
    # Points lie half of a step off.
    assert_allclose(body.leans((1.0, 1.0, 1.0)), seen, atol=4e-3)
    ball = Sphere((0.1, 0.5, 0.9), 0.2, Material(5.0))
    alike = Ellipsoid(ball.center, (0.2,) * 3, ball.material, rotation=(0.3, 0.2, 0.1))
    assert_allclose(alike.leans((1.0, 1.0, 1.0)), ball.leans((1.0, 1.0, 1.0)), atol=1e-12)


@pytest.mark.parametrize("contrast", [1e9, 10.0, 0.0])
def test_a_mesh_knows_the_edges_of_the_box_it_is(contrast):
    """Ridges and, of a cavity, grooves; diagonals of faces are none, nor are those of a ring of 7.5 and 15 degrees."""
    cell = {"size": (1.0, 1.0, 1.0), "matrix": Material(1.0), "gradient": (0, 1, 0)}
    box = Scene(inclusions=[Box((0.5,) * 3, (0.5, 0.375, 0.75), Material(contrast))], **cell)
    for body in (brick(), joined(brick(), brick((0.2, 0.2, 0.2)))):
        mesh = SurfaceMesh(*body, Material(contrast))
        assert edge_order(Scene(inclusions=[mesh], **cell)) == edge_order(box)
    assert edge_order(Scene(inclusions=[SurfaceMesh(*ring(), Material(contrast))], **cell)) == 2.0


@pytest.mark.parametrize("contrast", [1e9, 0.0])
def test_a_mesh_knows_its_angles(contrast):
    """Wedges of arccos(1 / 3) in a tetrahedron, of which all but that is outside, and one of 270 degrees, a groove."""
    cell = {"size": (1.0, 1.0, 1.0), "matrix": Material(1.0), "gradient": (0, 1, 0)}
    corners = 0.5 + 0.2 * np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)])
    four = SurfaceMesh(corners, np.array([(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]), Material(contrast))
    exact = math.pi / (2 * math.pi - math.acos(1 / 3))
    assert_allclose(edge_order(Scene(inclusions=[four], **cell)), 2 * exact, atol=4 / 1000)
    points, angles = four.edges((1.0, 1.0, 1.0)), four.wedges((1.0, 1.0, 1.0))
    assert_allclose(angles.sum(axis=1), 2 * math.pi)
    inside = np.stack([four.contains(each) for each in points])
    assert_allclose((angles * inside).sum(axis=1), math.acos(1 / 3))
    hollow = SurfaceMesh(*joined(brick(), brick((0.2, 0.2, 0.2))), Material(contrast))
    points, angles = hollow.edges((1.0, 1.0, 1.0)), hollow.wedges((1.0, 1.0, 1.0))
    within = (angles * np.stack([hollow.contains(each) for each in points])).sum(axis=1)
    assert_allclose(np.unique(within.round(9)), [math.pi / 2, 3 * math.pi / 2])


def test_boxes_that_keep_apart_or_share_a_face_are_as_all_others():
    good, cell = Material(1000.0), {"size": (1.0, 1.0, 1.0), "matrix": Material(1.0), "gradient": (0, 1, 0)}
    one = Box((0.25, 0.25, 0.5), (0.3, 0.3, 0.3), good)
    for other in (Box((0.7, 0.7, 0.5), (0.3, 0.3, 0.3), good), Box((0.25, 0.55, 0.5), (0.3, 0.3, 0.3), good)):
        # Each edge by itself, of a good conductor: 2/3, twice.
        assert_allclose(edge_order(Scene(inclusions=[one, other], **cell)), 4 / 3, atol=2 / 1000)
    assert edge_order(Scene(inclusions=[Sphere((0.5, 0.5, 0.5), 0.3, good)], **cell)) == 2.0
    # Edge on edge, by half of their lengths, turned alike; and as parts of a union.
    turned = [Box(c, (0.3, 0.3, 0.3), good, rotation=(0, 0, math.pi / 4)) for c in ((0.3, 0.5, 0.4), (0.3, 0.5, 0.4))]
    step = 0.3 * math.sqrt(2)
    turned[1] = Box((0.3 + step, 0.5, 0.55), (0.3, 0.3, 0.3), good, rotation=(0, 0, math.pi / 4))
    assert edge_order(Scene(inclusions=turned, **cell)) < 0.1
    assert edge_order(Scene(inclusions=[Union(turned, good)], **cell)) < 0.1


def on_edge(contrast, place=0.5):
    """A box on its edge, which reaches from wall to wall: a board, with what walls mirror."""
    side = math.sqrt(0.5)
    box = Box((0.5, place, 0.1), (side, side, 0.2), Material(contrast), rotation=(0, 0, math.pi / 4))
    return Scene((1.0, 1.0, 0.2), Material(1.0), [box], walls={"x-": 0.0, "x+": 1.0})


def test_an_edge_at_a_wall_meets_its_image():
    assert_allclose(edge_order(on_edge(10.0)), edge_order(board(10.0)), atol=1 / 1000)
    # Wherever it touches; a side along the wall has none.
    assert edge_order(on_edge(10.0, place=0.2)) == edge_order(on_edge(10.0))
    flat = Box((0.25, 0.5, 0.1), (0.5, 1.0, 0.2), Material(1000.0))
    assert edge_order(Scene((1.0, 1.0, 0.2), Material(1.0), [flat], walls={"x-": 0.0, "x+": 1.0})) == 2.0
    with pytest.raises(NotImplementedError, match="edges of boxes meet"):
        fft.solve(on_edge(1000.0), voxels=8)


def test_a_shape_of_ones_own_tells_its_edges():
    box = Box((0.5, 0.5, 0.5), (0.4, 0.4, 0.4), Material(1000.0))

    told = ("center", "material", "distance", "normal", "bounds", "volume", "turned")

    def own(*more):
        """The box as a class that nobody knows, which says this of itself."""
        return type("Own", (Shape,), {name: getattr(box, name) for name in (*told, *more)})()

    cell = {"size": (1.0, 1.0, 1.0), "matrix": Material(1.0), "gradient": (0, 1, 0)}
    assert edge_order(Scene(inclusions=[own()], **cell)) == 2.0
    assert_allclose(edge_order(Scene(inclusions=[own("edges")], **cell)), 4 / 3, atol=2 / 1000)


@pytest.mark.parametrize("method", [fft.solve, solve])
@pytest.mark.parametrize("contrast", [30.0, 1000.0])
def test_boards_of_high_contrast_are_refused(method, contrast):
    with pytest.raises(NotImplementedError, match="edges of boxes meet"):
        method(board(contrast, depth=0.0625))


@pytest.mark.parametrize(("contrast", "rule"), [(2.0, "auto"), (10.0, "plain"), (24.0, "links")])
def test_intervals_of_boards_know_how_slowly_errors_fall(contrast, rule):
    # With first order instead, the interval of links at 24 is half as wide as the error.
    error = fft.solve(board(contrast), voxels=24, rule=rule).error
    assert error.lower <= math.sqrt(contrast) <= error.upper


@pytest.mark.parametrize("length", [None, 2.0])
def test_a_cylinder_that_goes_through_a_wall_at_an_angle_has_the_edges_of_a_plane_there(length):
    cell, good = {"size": (1.0, 1.0, 1.0), "matrix": Material(1.0), "walls": {"x-": 0.0, "x+": 1.0}}, Material(1e9)
    fibre = Cylinder((0.5,) * 3, 0.1, (1, 1, 0), good, length=length)
    plane = HalfSpace((0.5,) * 3, (1, 1, 0), good)
    assert edge_order(Scene(inclusions=[fibre], **cell)) == edge_order(Scene(inclusions=[plane], **cell)) < 1.4
