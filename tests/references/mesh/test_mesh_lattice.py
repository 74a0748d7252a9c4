"""Meshes of shapes without a geometry of OpenCASCADE: conforming, periodic, on the surface, right in volume."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat import LevelSet, Material, Scene, Sphere, gallery
from references import exact, fem
from references.mesh import make
from references.mesh.cells import jacobian_coefficients, triangles_on, twins
from references.mesh.lattice import cubes, lattice

MATRIX, OTHER = Material(1.0), Material(10.0)
ALONG = (1.0, 0.0, 0.0)
UNIT = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
RADIUS = 0.3


def ball(points):
    return np.sum((points - 0.5) ** 2, axis=1) - RADIUS**2


def gyroid(points):
    x, y, z = 2 * np.pi * points.T
    return np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)


def off_centre(points):
    """The ball about a corner of the cell."""
    return ball((points + 0.5) % 1.0)


BALL = LevelSet(ball, ((0.1,) * 3, (0.9,) * 3), OTHER)
LABYRINTH = LevelSet(gyroid, UNIT, OTHER, periodic=True)
CORNER = LevelSet(off_centre, UNIT, OTHER, periodic=True)
SHAPES = {"ball": BALL, "labyrinth": LABYRINTH, "corner": CORNER}


def cell(*shapes):
    return Scene((1, 1, 1), MATRIX, shapes, gradient=ALONG)


@pytest.mark.parametrize("size", [(1, 1, 1), (1, 0.5, 2.3)])
def test_a_lattice_fills_its_box_without_gaps(size):
    box = np.array(size, float)
    body = lattice(box, cubes(box, 0.2), periodic=True)
    nodes = body.points[body.cells]
    volumes = np.linalg.det(nodes[:, 1:] - nodes[:, :1]) / 6
    # Rounding alone.
    assert_allclose(volumes.sum(), np.prod(size), rtol=1e-12)
    assert volumes.min() > 0
    # Each face is that of two tetrahedra, or lies on the box.
    triangles, _ = triangles_on(body.cells, np.ones(len(body.points), bool))
    faces, count = np.unique(np.sort(triangles, axis=1), axis=0, return_counts=True)
    middle = body.points[faces[count == 1]]
    outer = np.any(np.all(middle == 0, axis=1) | np.all(middle == body.box, axis=1), axis=1)
    assert count.max() == 2
    assert outer.all()


@pytest.mark.parametrize("name", SHAPES)
def test_elements_conform_and_repeat(name):
    scene = cell(SHAPES[name])
    mesh = make(scene, size=0.12)
    # No element on both sides: its corners lie on its own side, or on the surface.
    inside = SHAPES[name].distance(mesh.points, period=scene.period)
    for phase, sign in ((0, 1), (1, -1)):
        # Distances by a table, as those of the ball in the corner are, are right to 1e-5.
        assert (sign * inside[mesh.cells[mesh.phase == phase, :4]]).min() > -2e-5
    # What is not paired on a face would be a hole in the cell.
    for axis in range(3):
        low, high = (np.flatnonzero(mesh.points[:, axis] == at) for at in (0.0, 1.0))
        assert len(low) == len(high)
    assert len(np.unique(twins(len(mesh.points), mesh.pairs))) == len(mesh.points) - len(np.unique(mesh.pairs[:, 0]))
    assert jacobian_coefficients(mesh.points[mesh.cells]).min() > 0


@pytest.mark.parametrize("size, limit", [(0.12, 1e-3), (0.06, 1e-4)])
def test_the_volume_of_a_ball_is_right(size, limit):
    """To a thousandth at eight elements across: second-order faces, whose volume goes with the fourth power."""
    mesh = make(cell(BALL), size=size)
    volume = mesh.volumes[mesh.phase == 1].sum()
    assert abs(volume / (4 / 3 * np.pi * RADIUS**3) - 1) < limit


def test_half_of_a_gyroid_is_half():
    """By symmetry: the inversion that swaps its labyrinths leaves the lattice as it is."""
    mesh = make(cell(LABYRINTH), size=0.1)
    assert abs(mesh.volumes[mesh.phase == 1].sum() - 0.5) < 1e-3


def test_walls_cut_a_surface():
    scene = Scene((1, 1, 1), MATRIX, [CORNER], walls={"x-": 1.0, "x+": 0.0})
    mesh = make(scene, size=0.1)
    assert len(mesh.pairs) == 0
    assert abs(mesh.volumes[mesh.phase == 1].sum() / (4 / 3 * np.pi * RADIUS**3) - 1) < 1e-3


def test_two_surfaces_are_cut_one_after_the_other():
    """A ball of one material in a coat of another, as level set and as sphere: each has its volume."""
    core = LevelSet(lambda x: ball(x) + RADIUS**2 - 0.15**2, ((0.33,) * 3, (0.67,) * 3), Material(3.0))
    scene = cell(Sphere((0.5,) * 3, RADIUS, OTHER), core)
    mesh = make(scene, size=0.06)
    wanted = [4 / 3 * np.pi * (RADIUS**3 - 0.15**3), 4 / 3 * np.pi * 0.15**3]
    found = np.bincount(mesh.phase, mesh.volumes)[1:]
    assert_allclose(found, wanted, rtol=1e-3)


def test_conductivity_of_a_ball_as_a_level_set_is_that_of_the_sphere():
    right = exact.solve(gallery.simple_cubic(10.0, fraction=4 / 3 * np.pi * RADIUS**3)).conductivity
    matrix = gallery.simple_cubic(10.0, fraction=0.1).matrix.conductivity
    found = fem.solve(cell(BALL), size=0.09).conductivity
    # What gmsh's elements of that size lack is as much.
    assert_allclose(found, right / matrix, rtol=1e-3)


def test_intervals_of_the_coarsest_lattice_hold():
    # Coarser lattices are the same there: their runs, which differ by nothing, had the interval end at a ninth of the
    # error, and it is told by one whose coarser runs are coarser.
    like = gallery.simple_cubic(745.0, fraction=4 / 3 * np.pi * RADIUS**3)
    right = exact.solve(like).conductivity / like.matrix.conductivity
    scene = cell(LevelSet(ball, ((0.1,) * 3, (0.9,) * 3), Material(745.0)))
    field = fem.solve(scene, size=0.18)
    error = field.error
    assert field.stats["cubes"] == 5 and error.how == "a finer mesh"
    assert error.lower < right < error.upper
    # And is no blanket.
    assert error.upper - error.lower < 8 * abs(field.conductivity - right)
    with pytest.raises(NotImplementedError, match="no lattice is so coarse"):
        field.extrapolated  # noqa: B018


def test_straight_elements_lose_volume_and_curved_ones_do_not():
    meshes = [make(cell(BALL), size=0.1, curved=curved) for curved in (True, False)]
    lost = [abs(mesh.volumes[mesh.phase == 1].sum() - 4 / 3 * np.pi * RADIUS**3) for mesh in meshes]
    # Of fourth and of second order, of elements a third of the radius long.
    assert lost[0] < 0.1 * lost[1]


def test_the_same_mesh_comes_again():
    one, other = make(cell(LABYRINTH), size=0.15), make(cell(LABYRINTH), size=0.15)
    assert_array_equal(one.points, other.points)
    assert_array_equal(one.cells, other.cells)


def test_what_is_thinner_than_elements_is_said():
    def plates(points):
        return np.abs((points[:, 0] * 8) % 1 - 0.5) - 0.12

    scene = cell(LevelSet(plates, UNIT, OTHER, periodic=True))
    with pytest.raises(RuntimeError, match="thinner than these; must be a smaller size"):
        make(scene, size=0.2)
