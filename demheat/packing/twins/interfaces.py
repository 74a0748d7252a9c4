"""The interfaces of a scene as surfaces, found by `surfaces_of`: point patterns on them and distances to them."""

from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from demheat.scene import Scene, Shape
from demheat.scene.shapes.base import TOUCH
from demheat.scene.shapes.patterns import Room
from demheat.scene.shapes.periodic import shifts

# Points of an even pattern on a sphere, at least: facets that enclose it.
FEWEST = 12
# Cosine between two normals below which a surface that is nearest to a point of another lies beside it.
# Of the box: how far behind it a body is looked for.
BESIDE, STEP = 0.1, 1e-6


class SphereSurface(NamedTuple):
    """The surface of a spherical inclusion."""

    shape: Shape
    scene: Scene

    # Such surfaces are asked all at once, by `demheat.packing.twins.spheres`; others need not say that they are none.
    is_sphere = True

    @property
    def depth(self) -> float:
        """How far inwards nothing is in the way, m."""
        return self.shape.radius

    def ball(self):
        """A ball that holds the surface: centre, (3,) float array, and radius, m."""
        return self.shape.ball()

    def pattern(self, spacing, rng):
        """Evenly spread points and outward normals, both (k, 3) float arrays, m and 1."""
        center, radius = self.ball()
        count = int(pattern_count(radius, spacing))
        normals = Rotation.random(random_state=rng).apply(fibonacci_sphere(count))
        return center + radius * normals, normals

    def touched(self, points, normals):
        """The points moved inwards, onto the polyhedron of the sphere's volume with their tangent planes as facets."""
        if len(normals) == 0:
            return points
        center, radius = self.ball()
        return center + self.inner_radius(normals) * radius * normals

    def inner_radius(self, normals):
        """Distance of those tangent planes from the centre over the radius."""
        return inscribed_radius(normals, counted=None if self.scene.periodic else self._in_box)

    def _in_box(self, directions):
        """Directions in which the surface lies in the box: elsewhere it has no facets."""
        center, radius = self.ball()
        points = center + radius * directions
        return np.all((points > 0) & (points < self.scene.size), axis=1)

    def gap(self, points, *, skip_self=False):
        """Distance of points to the surface and its periodic images, m; of its own points, if so, to these alone."""
        if not skip_self:
            return np.abs(self.shape.distance(points, period=self.scene.period))
        nearest = np.full(len(points), np.inf)
        if self.scene.periodic:
            (center, radius), box = self.ball(), np.array(self.scene.size)
            for shift in product((-1, 0, 1), repeat=3):
                if any(shift):
                    offsets = points - center - shift * box
                    nearest = np.minimum(nearest, np.abs(np.linalg.norm(offsets, axis=1) - radius))
        return nearest


class PlaneSurface(NamedTuple):
    """One face of a layer; its methods are those of `SphereSurface`."""

    axis: int
    position: float
    scene: Scene

    @property
    def depth(self) -> float:
        """How far inwards nothing is in the way, m: other surfaces tell."""
        return np.inf

    def ball(self):
        """No ball holds a plane."""
        return np.zeros(3), np.inf

    def pattern(self, spacing, rng):
        """Touch points on a jittered triangular pattern that fits the box, and normals, both (k, 3) float arrays."""
        size = self.scene.size
        u, v = (k for k in range(3) if k != self.axis)
        columns = max(4, round(size[u] / spacing))
        rows = max(4, 2 * round(size[v] / (spacing * np.sqrt(0.75)) / 2))
        i, j = (a.ravel() for a in np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij"))
        points = np.empty((len(i), 3))
        points[:, self.axis] = self.position
        points[:, u] = (i + 0.25 + 0.5 * (j % 2)) / columns * size[u]
        points[:, v] = (j + 0.5) / rows * size[v]
        jitter = 0.1 * spacing * rng.uniform(-1, 1, (len(i), 2))
        points[:, u] = (points[:, u] + jitter[:, 0]) % size[u]
        points[:, v] = (points[:, v] + jitter[:, 1]) % size[v]
        normals = np.zeros((len(i), 3))
        normals[:, self.axis] = 1.0
        return points, normals

    def choice(self, least, widest, wanted, rng):
        """Points to choose closer ones from."""
        return self.pattern(least, rng)

    def bend(self, points, normals, step):
        """Of a plane there is none, (k,) float array."""
        return np.zeros(len(points))

    def touched(self, points, normals):
        """The points themselves: a plane is its own tangent."""
        return points

    def gap(self, points, *, skip_self=False):
        """Distance of points to the plane, its periodic images included, (n,) float array, m."""
        if skip_self:
            return np.full(len(points), np.inf)
        offset = points[:, self.axis] - self.position
        if self.scene.periodic:
            length = self.scene.size[self.axis]
            offset = offset - length * np.round(offset / length)
        return np.abs(offset)


@dataclass(frozen=True)
class ShapeSurface:
    """The surface of any other shape, as the shape tells it; its methods are those of `SphereSurface`."""

    shape: Shape
    scene: Scene

    @property
    def depth(self) -> float:
        """How far inwards nothing is in the way, m."""
        return self.shape.depth

    def ball(self):
        """A ball that holds the surface: centre, (3,) float array, and radius, m; infinite where it has no end."""
        return self.shape.ball()

    def pattern(self, spacing, rng):
        """Evenly spread points and outward normals, both (k, 3) float arrays."""
        return self.shape.pattern(spacing, rng, self._room)

    def choice(self, least, widest, wanted, rng):
        """Points to choose closer ones from, where less than `widest` is wanted, and normals, two (k, 3) arrays."""
        return self.shape.choice(least, widest, wanted, rng, self._room)

    def touched(self, points, normals):
        """The points moved onto planes that keep the volume, (k, 3) float array, m."""
        return self.shape.facets(points, normals, self._room) if len(points) else points

    def bend(self, points, normals, step):
        """Sum of the principal curvatures at points, from normals beside them, (k,) float array, 1/m."""
        bend = np.zeros(len(points))
        first = np.cross(normals, np.eye(3)[np.argmin(np.abs(normals), axis=1)])
        first /= np.linalg.norm(first, axis=1)[:, None]
        for along in (first, np.cross(normals, first)):
            ahead, behind = (self.shape.normal(points + sign * step * along) for sign in (1.0, -1.0))
            bend += np.einsum("ij,ij->i", ahead - behind, along) / (2.0 * step)
        return bend

    def gap(self, points, *, skip_self=False):
        """Distance of points to the surface, its periodic images included, (n,) float array, m."""
        if not skip_self:
            return np.abs(self.shape.distance(points, period=self.scene.period))
        nearest, normals = np.full(len(points), np.inf), self.shape.normal(points) if self._meets_itself() else None
        low, high = self.shape.bounds()
        # Those beside it first: of the others most are farther, by their bounds alone.
        for shift in sorted(shifts(self.shape, self.scene.period), key=np.linalg.norm):
            moved = points - shift
            beyond = np.maximum(np.maximum(low - moved, moved - high), 0.0)
            near = np.flatnonzero(np.einsum("ij,ij->i", beyond, beyond) < nearest**2)
            if len(near):
                moved = moved[near]
                away = self.shape.distance(moved) if normals is None else self._facing(moved, normals[near])
                nearest[near] = np.minimum(nearest[near], np.abs(away))
        return nearest

    def _meets_itself(self):
        """Whether it reaches from face to face of a periodic cell along an axis along which it has ends."""
        low, high = self.shape.bounds()
        ends = np.isfinite(low)
        return self.scene.periodic and bool(np.any((high - low)[ends] >= (1 - TOUCH) * np.array(self.scene.size)[ends]))

    def _facing(self, points, normals):
        """Distance of points on an image, with its normals, to the surface; infinite on it, and where it goes on there.

        Nothing is between a body and an image in which it goes on. One that meets it with an edge does not.
        """
        away, outward = self.shape.surface(points)
        step = STEP * max(self.scene.size)
        beyond = points - (away + np.copysign(step, away))[:, None] * outward - step * normals
        on = self.shape.contains(beyond, period=np.array(self.scene.size))
        on &= np.abs(np.einsum("ij,ij->i", outward, normals)) < BESIDE
        return np.where(on | (np.abs(away) <= TOUCH * max(self.scene.size)), np.inf, away)

    @property
    def _room(self):
        return Room(self.scene.size, self.scene.periodic)


def surfaces_of(scene: Scene) -> list:
    """Every surface of a scene's inclusions, and after them every plane between its layers, once each."""
    bodies = [shape for shape in scene.inclusions if not shape.flat]
    found = [(SphereSurface if shape.fills_ball else ShapeSurface)(shape, scene) for shape in bodies]
    planes = [plane for shape in scene.inclusions if shape.flat for plane in _faces(shape, scene)]
    return found + _once(sorted(planes, key=lambda plane: (plane.axis, plane.position)), scene)


def _faces(layer, scene):
    length = scene.size[layer.axis]
    slack = TOUCH * length
    faces = (x for x in (layer.start, layer.stop) if scene.periodic or slack < x < length - slack)
    return [PlaneSurface(layer.axis, x % length, scene) for x in faces]


def _once(planes, scene):
    """Planes in order, less those that only rounding tells from the one before: faces of layers that touch."""
    kept = []
    for plane in planes:
        slack = TOUCH * scene.size[plane.axis]
        # In a periodic cell the last may be the first.
        first = next((each for each in kept if each.axis == plane.axis), None)
        around = scene.periodic and first and first.position + scene.size[plane.axis] - plane.position <= slack
        if not around and not (first and plane.position - kept[-1].position <= slack):
            kept.append(plane)
    return kept


def pattern_count(radius, spacing):
    """Number of points of an even pattern on spheres, (m,) int array."""
    return np.maximum(FEWEST, np.ceil(4 * np.pi * np.square(radius) / (np.sqrt(0.75) * spacing**2))).astype(np.int64)


def fibonacci_sphere(count):
    """Nearly even directions, (count, 3) float array of unit vectors (spherical Fibonacci lattice)."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    azimuth = np.pi * (1.0 + np.sqrt(5.0)) * k
    ring = np.sqrt(1.0 - z * z)
    return np.stack([ring * np.cos(azimuth), ring * np.sin(azimuth), z], axis=1)


def inscribed_radius(normals, *, counted=None):
    """Radius of the sphere inscribed in the polyhedron with these facet normals and the unit sphere's volume.

    The polyhedron {x : n.x <= 1 for all n} has the volume of the mean of 1/cos^3 of the angle from a direction to
    the nearest normal; the mean is taken over 40 directions per normal, or those of them that are counted.
    """
    directions = fibonacci_sphere(40 * len(normals) + 7)
    if counted is not None:
        directions = directions[counted(directions)]
    if len(directions) == 0:
        return 1.0
    chord, _ = cKDTree(normals).query(directions)
    # Where no facet is near the polyhedron has no end there: it counts as cut off at four radii.
    cosine = np.maximum(1.0 - 0.5 * chord**2, 0.25)
    return float(np.mean(cosine**-3.0) ** (-1.0 / 3.0))
