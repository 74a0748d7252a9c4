"""Turns of spheres: poles and seam lie off what cuts the sphere, and all images of one are turned alike."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from demheat.scene import Layer, Material, Scene, Sphere
from references import mesh
from references.mesh import cad
from references.mesh.turns import turn

METAL = Material(10.0)
RADIUS = 0.1
FACES = [np.array([-1.0, 0.0, 1.0, 2.0])] * 3


def seam(center, planes):
    """Points of the seam of a sphere of radius one, from pole to pole, as turned."""
    latitude = np.linspace(-np.pi / 2, np.pi / 2, 1001)
    before = np.column_stack([np.cos(latitude), np.zeros(1001), np.sin(latitude)])
    *axis, angle = turn(center, RADIUS, planes)
    return Rotation.from_rotvec(angle * np.array(axis)).apply(before)


def distances(center, planes, points):
    """Angles from points of a sphere of radius one to the circles of the cuts (signed) and to where two meet, rad."""
    cuts = [(across - c) / RADIUS for across, c in zip(planes, center, strict=True)]
    heights = [(axis, h) for axis in range(3) for h in cuts[axis] if abs(h) < 1]
    circles = [np.arccos(points[:, axis]) - math.acos(h) for axis, h in heights]
    corners = []
    for i, (a, one) in enumerate(heights):
        for b, other in heights[i + 1 :]:
            rest = 1 - one**2 - other**2
            if a != b and rest > 0:
                corner = np.zeros((2, 3))
                corner[:, a], corner[:, b], corner[:, 3 - a - b] = one, other, (-math.sqrt(rest), math.sqrt(rest))
                corners.append(np.arccos(np.clip(points @ corner.T, -1, 1)).min(axis=1))
    return np.array(circles), np.array(corners).reshape(-1, len(points))


def cut_spheres(faces, count=40):
    """Centres of spheres that so many faces cut, so many of each in turn from the corner's side."""
    rng = np.random.default_rng(faces)
    centers = rng.uniform(0.2, 0.8, (count, 3))
    centers[:, :faces] = rng.uniform(-RADIUS, RADIUS, (count, faces))
    return centers


# At best a quarter of pi from one circle; three circles with six corners leave less.
@pytest.mark.parametrize(("faces", "off"), [(1, 0.6), (2, 0.35), (3, 0.25)])
def test_poles_and_seam_lie_off_the_curves_and_their_corners(faces, off):
    for center in cut_spheres(faces):
        circles, corners = distances(center, FACES, seam(center, FACES))
        assert np.abs(circles[:, [0, -1]]).min() > off and corners.min(initial=math.pi) > off
        # Where the seam crosses a circle it does so steeply.
        slope = np.abs(np.gradient(circles, np.pi / 1000, axis=1))
        assert slope[np.abs(circles) < off / 2].min(initial=math.inf) > off


def test_spheres_that_nothing_cuts_are_turned_as_ever():
    *axis, angle = turn(np.full(3, 0.5), RADIUS, FACES)
    assert_allclose(np.array(axis) * angle, np.array([1, 2, 3]) / math.sqrt(14), rtol=1e-12)  # rounding


@pytest.mark.parametrize("other", [(0.9, 0.9, 0.9), (0.05, 0.02, 0.03)])
def test_images_of_a_sphere_are_turned_alike(other):
    class Recorded:
        def __init__(self):
            self.turns = []

        def rotate(self, tags, *numbers):
            self.turns.append(numbers[3:])

    # Its lower plane cuts the spheres, above the face that they cross, where their images have none.
    layer = Layer(2, 0.12, 0.6, METAL)
    spheres = [Sphere(other, RADIUS, METAL), Sphere((0.5, 0.5, 0.05), RADIUS, METAL)]
    of = Scene((1.0, 1.0, 1.0), Material(1.0), [layer, *spheres], gradient=(1.0, 0.0, 0.0))
    geometry, occ = cad._Geometry(of.images(), of.size, of.periodic), Recorded()
    cad._turn_spheres(occ, geometry, range(len(geometry.images)))
    phases = [phase for phase, shape in geometry.images if isinstance(shape, Sphere)]
    made = {phase: {t for p, t in zip(phases, occ.turns, strict=True) if p == phase} for phase in phases}
    assert len(phases) == len(occ.turns) and all(len(found) == 1 for found in made.values())


def test_planes_are_those_of_the_faces_the_layers_and_their_images():
    layers = [Layer(2, 0.4, 0.6, METAL), Layer(2, 0.6, 0.8, METAL)]
    walled = Scene((1.0, 1.0, 2.0), Material(1.0), layers, walls={"y-": 0.0, "y+": 1.0})
    periodic = Scene((1.0, 1.0, 2.0), Material(1.0), layers, gradient=(1.0, 0.0, 0.0))
    one, images = (cad._Geometry(of.images(), of.size, of.periodic).planes for of in (walled, periodic))
    assert_allclose(one[0], [0.0, 0.5])
    assert_allclose(one[2], [0.0, 0.2, 0.3, 0.4, 1.0])
    assert_allclose(images[0], [-0.5, 0.0, 0.5, 1.0])
    assert_allclose(images[2], [-1, -0.8, -0.7, -0.6, 0, 0.2, 0.3, 0.4, 1, 1.2, 1.3, 1.4, 2])


def test_a_sphere_whose_pole_was_near_a_periodic_face_is_meshed_at_once():
    # Of a dispersion; turned as others its pole is two elements from the face, and gmsh fails at every size.
    of = Scene(
        (1.0, 1.0, 1.0),
        Material(1.0),
        [Sphere((0.95132941, 0.38179127, 0.36558301), 0.089470, METAL)],
        gradient=(1.0, 0.0, 0.0),
    )
    try:
        mesh.load_gmsh()
    except ImportError as error:
        pytest.skip(str(error))
    assert mesh.make(of, size=0.15, order=1).stats["attempts"] == 1
