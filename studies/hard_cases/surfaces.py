"""Balls as surfaces of other kinds, level sets, triangles, unions, ellipsoids: what is true of them is known."""

import math
from dataclasses import replace

import numpy as np

from demheat.scene import Ellipsoid, LevelSet, Sphere, SurfaceMesh, Union

KINDS = ("level set", "mesh", "union", "ellipsoid")
# Halvings of an octahedron's edges: the surface of 2048 triangles is .3 % of the radius off a sphere at most.
HALVED = 4
# Of the radius: half of the limits of a level set, the second member of a union and how far off it lies.
ROOM, MEMBER, ASIDE = 1.15, 0.7, 0.3


def drawn_as(kind: str, sphere: Sphere):
    """A sphere of another kind."""
    center, radius, material = np.array(sphere.center), sphere.radius, sphere.material
    if kind == "ellipsoid":
        return Ellipsoid(sphere.center, (radius,) * 3, material)
    if kind == "union":
        # What lies within the other changes nothing, but for one surface more to be told apart.
        within = Sphere(center + (ASIDE * radius, 0.0, 0.0), MEMBER * radius, material)
        return Union([sphere, within], material)
    if kind == "mesh":
        points, triangles = _ball()
        return SurfaceMesh(center + radius * points, triangles, material)
    limits = (center - ROOM * radius, center + ROOM * radius)
    return LevelSet(
        lambda points: np.sum((points - center) ** 2, axis=1) - radius**2, tuple(map(tuple, limits)), material
    )


def _ball():
    """Corners and triangles of a closed surface near the unit sphere, with its volume."""
    points = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
    faces = np.array([(i, j, k) for i in (0, 1) for j in (2, 3) for k in (4, 5)])
    # Counter-clockwise seen from outside.
    corners = points[faces]
    inwards = np.linalg.det(corners) < 0
    corners[inwards] = corners[inwards][:, ::-1]
    for _ in range(HALVED):
        a, b, c = corners.transpose(1, 0, 2)
        ab, bc, ca = ((p + q) / np.linalg.norm(p + q, axis=1, keepdims=True) for p, q in ((a, b), (b, c), (c, a)))
        parts = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        corners = np.concatenate([np.stack(part, axis=1) for part in parts])
    volume = np.linalg.det(corners).sum() / 6
    found, triangles = np.unique(np.round(corners.reshape(-1, 3), 12), axis=0, return_inverse=True)
    return found * (4 / 3 * math.pi / volume) ** (1 / 3), triangles.reshape(-1, 3)


def as_surfaces(kind: str, scene):
    """A scene with its spheres drawn so."""
    return replace(scene, inclusions=[drawn_as(kind, each) for each in scene.inclusions])
