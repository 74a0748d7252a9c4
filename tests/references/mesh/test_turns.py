"""Turns of spheres: poles and seam lie off what cuts the sphere, and all images of one are turned alike."""

import math

import meshed_here
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from demheat.scene import Material, Scene, Sphere
from references import mesh
from references.mesh import cad
from references.mesh.turns import turn

METAL = Material(10.0)
RADIUS = 0.1
FACES = [np.array([0.0, 1.0])] * 3


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
    assert turn(np.full(3, 0.5), RADIUS, FACES) == (1.0, 2.0, 3.0, 1.0)


def test_images_of_a_sphere_are_turned_alike():
    class Recorded(list):
        def rotate(self, tags, *numbers):
            self.append(numbers[3:])

    spheres = [Sphere(c, RADIUS, METAL) for c in ((0.05, 0.02, 0.08), (0.5, 0.5, 0.48))]
    of = Scene((1.0, 1.0, 0.5), Material(1.0), spheres, gradient=(1.0, 0.0, 0.0))
    geometry, turns = cad._Geometry(of.images(), of.size, of.periodic), Recorded()
    cad._turn_spheres(turns, geometry, range(len(geometry.images)))
    phases = [phase for phase, _ in geometry.images]
    assert phases == [1] * 8 + [2] * 2
    assert len(set(turns[:8])) == 1 and turns[8] == turns[9] != turns[0]
    faces = [np.array([0.0, length]) for length in of.size]
    assert [turns[0], turns[8]] == [turn(np.array(s.center), RADIUS, faces) for s in spheres]


def test_a_sphere_whose_pole_was_near_a_periodic_face_is_meshed_at_once():
    # Of a dispersion; turned as others its pole is two elements from the face, and gmsh fails at every size.
    of = Scene(
        (1.0, 1.0, 1.0),
        Material(1.0),
        [Sphere((0.95132941, 0.38179127, 0.36558301), 0.089470, METAL)],
        gradient=(1.0, 0.0, 0.0),
    )
    meshed_here.gmsh_or_skip()
    assert mesh.make(of, size=0.15, order=1).stats["attempts"] == 1
