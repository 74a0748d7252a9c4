"""Bodies within closed surfaces of triangles: what they hold, how far they are, and which surfaces are none."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from solid_shapes import MATRIX, OTHER
from surface_bodies import brick, joined, ring

from demheat import Box, Scene, SurfaceMesh, Torus, solve
from references import fem, fft

SIDES, MIDDLE = (0.5, 0.375, 0.75), (0.5, 0.5, 0.5)
BOX = Box(MIDDLE, SIDES, OTHER)
BRICK = SurfaceMesh(*brick(), OTHER)


@pytest.fixture
def points():
    return np.random.default_rng(0).random((4000, 3))


def cell(*shapes, **load):
    return Scene((1, 1, 1), MATRIX, shapes, **(load or {"gradient": (0.0, 1.0, 0.0)}))


def test_a_brick_of_triangles_is_a_box(points):
    assert_allclose(BRICK.volume, BOX.volume, rtol=1e-14)
    assert_array_equal(BRICK.contains(points), BOX.contains(points))
    assert_array_equal(BRICK.bounds(), BOX.bounds())
    piece = np.linalg.norm(SIDES) / 80
    right, found = BOX.distance(points), BRICK.distance(points)
    assert_array_equal(np.sign(found), np.sign(right))
    # Never too short; too long by a piece at most, and beside the surface not at all.
    off = np.abs(found) - np.abs(right)
    assert off.min() > -1e-12
    assert off.max() < piece
    near = np.abs(right) < piece
    assert near.sum() > 50
    assert_allclose(found[near], right[near], atol=1e-12)
    assert_allclose(BRICK.normal(points)[near], BOX.normal(points)[near], atol=1e-6)


def test_points_on_planes_of_its_corners_are_told():
    """Where rays would run along faces and through edges."""
    ticks = np.linspace(0, 1, 17)
    grid = np.stack(np.meshgrid(ticks, ticks, ticks), -1).reshape(-1, 3)
    off = np.abs(BOX.distance(grid)) > 1e-9
    assert_array_equal(BRICK.contains(grid[off]), BOX.contains(grid[off]))


def test_a_ring_holds_what_a_torus_does(points):
    mesh, torus = SurfaceMesh(*ring(), OTHER), Torus(MIDDLE, 0.28, 0.12, (0, 0, 1), OTHER)
    # Chords of 24 parts around the tube and 48 around the ring dip below it by less than this.
    dip = 0.12 * (1 - np.cos(np.pi / 24)) + 0.4 * (1 - np.cos(np.pi / 48))
    clear = np.abs(torus.distance(points)) > dip
    assert_array_equal(mesh.contains(points[clear]), torus.contains(points[clear]))
    assert_allclose(mesh.volume, torus.volume, rtol=0.02)
    assert mesh.contains([mesh.point_in((1, 1, 1), periodic=True)])[0]


def test_it_is_the_same_by_period_elsewhere_and_turned(points):
    moved = BRICK.placed((0.1, 0.95, 0.3))
    right = Box((0.1, 0.95, 0.3), SIDES, OTHER)
    period = np.ones(3)
    assert_array_equal(moved.contains(points, period=period), right.contains(points, period=period))
    assert moved.volume == BRICK.volume
    for order in ((2, 0, 1), (1, 0, 2)):
        turned = BRICK.turned(order)
        assert_array_equal(turned.contains(points[:, order]), BRICK.contains(points))
        assert_allclose(turned.distance(points[:, order]), BRICK.distance(points), atol=0.02)
        assert_allclose(turned.volume, BRICK.volume, rtol=1e-14)
        near = np.abs(BOX.distance(points)) < 0.01
        assert_allclose(turned.normal(points[:, order])[near], BRICK.normal(points)[near][:, order], atol=1e-6)


def test_turned_triangles_and_corners_of_their_own_are_mended(points):
    vertices, triangles = ring()
    right = SurfaceMesh(vertices, triangles, OTHER)
    some = triangles.copy()
    some[::3] = some[::3, ::-1]
    for given in ((vertices, triangles[:, ::-1]), (vertices, some), (vertices[triangles].reshape(-1, 3), None)):
        own = np.arange(3 * len(triangles)).reshape(-1, 3) if given[1] is None else given[1]
        mesh = SurfaceMesh(given[0], own, OTHER)
        assert_allclose(mesh.volume, right.volume, rtol=1e-13)
        assert_array_equal(mesh.contains(points), right.contains(points))
        away, normal = mesh.surface(points)
        # Outwards: a step along it leads away from inside.
        assert np.all(mesh.distance(points + 1e-6 * normal) > away)


def test_a_piece_within_another_is_a_cavity(points):
    hollow = SurfaceMesh(*joined(brick(), brick((0.2, 0.2, 0.2))), OTHER)
    assert_allclose(hollow.volume, BOX.volume - 0.008, rtol=1e-13)
    hole = Box(MIDDLE, (0.2, 0.2, 0.2), OTHER)
    assert_array_equal(hollow.contains(points), BOX.contains(points) & ~hole.contains(points))


RUNS = {
    "dem": lambda scene: solve(scene, particles=4000),
    "fft": lambda scene: fft.solve(scene, voxels=24, rule="laminate", threads=1),
    "fem": lambda scene: fem.solve(scene, size=0.06),
}


@pytest.mark.parametrize("way", RUNS)
@pytest.mark.parametrize("load", [{}, {"walls": {"y-": 0.0, "y+": 1.0}}], ids=["cell", "walls"])
def test_every_method_takes_it_for_the_box_it_is(way, load):
    """Edges are no better followed than those of any shape without patterns of its own, at contrast 5."""
    mesh, box = (RUNS[way](cell(shape, **load)) for shape in (BRICK, BOX))
    # A hundredth: facets spread evenly, and edges of elements half a cube long; voxels are cut by the same planes.
    limit = 1e-3 if way == "fft" else 0.012
    assert_allclose(mesh.conductivity, box.conductivity, rtol=limit)


def klein():
    return ring(twisted=True)


def crossed():
    return joined(brick(), brick(middle=(0.6, 0.61, 0.62)))


BAD = {
    "open": (lambda: (brick()[0], brick()[1][1:]), r"SurfaceMesh: not closed, 3 edges do not belong to two triangles"),
    "thrice": (lambda: (brick()[0], np.concatenate([brick()[1], brick()[1][:1]])), "belongs to 3 triangles"),
    "crossed": (crossed, r"SurfaceMesh: crosses itself near \(.*\) m; must be"),
    "one side": (klein, "SurfaceMesh: has one side only"),
    "nan": (lambda: (brick()[0] * [1, 1, np.nan], brick()[1]), r"of shape \(8, 3\), 8 of them not finite"),
    "flat": (lambda: (brick()[0] * [1, 1, 0.0], brick()[1]), "SurfaceMesh"),
    "beyond": (lambda: (brick()[0], brick()[1] + 1), r"whole numbers of vertices, 0 to 7"),
    "lines": (lambda: (brick()[0], brick()[1][:, :2]), r"of shape \(12, 2\)"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_surface_is_told_in_one_sentence(name):
    make, words = BAD[name]
    with pytest.raises(ValueError, match=words) as error:
        SurfaceMesh(*make(), OTHER)
    assert "\n" not in str(error.value)


def test_millimetres_are_seen():
    vertices, triangles = brick()
    body = SurfaceMesh(1000 * vertices, triangles, OTHER)
    for load in ({}, {"walls": {"y-": 0.0, "y+": 1.0}}):
        with pytest.raises(ValueError, match=r"Scene.inclusions\[0\]: vertices from .* seem to be in millimetres"):
            cell(body, **load)
