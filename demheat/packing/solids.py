"""Surfaces of cylinders, ellipsoids, boxes and the like: even patterns of points, and tangent planes of right volume.

Facets of twins are no exact polyhedron there, as they are on a sphere: beside each other, two of them meet where their
touch points are equally near, not where their tangent planes cross, unless both are alike by a mirror between them. On
flat faces and in rows along a cylinder they are; elsewhere steps between facets are as high as facets are bent, of
second order in their width. All planes are moved inwards so that the volume stays right.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.spatial import cKDTree

from demheat.packing.base import morton_order
from demheat.scene import Scene, Shape
from demheat.scene.shapes.base import shifts
from demheat.scene.shapes.directions import across
from demheat.scene.shapes.samples import surface_points

# Side of a square pattern over the spacing of a triangular one as dense.
SQUARE = 0.75**0.25
# Points round a cylinder, in a pattern on a closed surface, at least.
FEWEST_ROUND, FEWEST = 8, 12
# Cells of the sampling along a spacing where points are spread out, and where planes are moved; rounds of the first.
SPREAD, LIFTED, ROUNDS = 5, 4, 16
# Times that a sampling is halved for what is thin, at most.
FINER = 6
# Of a width: faces this near to each other in a point are one there.
ON = 1e-9
# Cells beyond a wall in which points are spread out, too: those beside the wall then lie as elsewhere.
BEYOND = 10


@dataclass(frozen=True)
class SolidSurface:
    """The surface of a shape; its methods are those of `demheat.packing.interfaces.SphereSurface`.

    Parameters
    ----------
    shape : Shape
    scene : Scene
    depth : float, m
        How far inwards nothing is in the way.
    spread : callable (shape, scene, spacing, rng) -> points, normals
        Its pattern.
    moved : callable (shape, scene, points, normals) -> (k, 3) float array, m
        Puts points onto planes that keep the volume.
    """

    shape: Shape
    scene: Scene
    depth: float
    spread: Callable
    moved: Callable

    def ball(self):
        """A ball that holds the surface: centre, (3,) float array, and radius, m; infinite where it has no end."""
        return self.shape.ball()

    def pattern(self, spacing, rng):
        """Evenly spread points and outward normals, both (k, 3) float arrays."""
        return self.spread(self.shape, self.scene, spacing, rng)

    def touched(self, points, normals):
        """The points moved onto planes that keep the volume, (k, 3) float array, m."""
        return self.moved(self.shape, self.scene, points, normals) if len(points) else points

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
        nearest = np.full(len(points), np.inf)
        for shift in shifts(self.shape, self.scene.period):
            nearest = np.minimum(nearest, np.abs(self.shape.distance(points - shift)))
        return nearest


def on_cylinder(shape, scene, spacing, rng):
    """Rows of points along a cylinder, which share their angles, and rings on its ends; normals besides."""
    frame, side = _frame(shape.axis, rng), SQUARE * spacing
    low, high = _along(shape, scene)
    rows = max(1, round((high - low) / side))
    columns = max(FEWEST_ROUND, round(2 * np.pi * shape.radius / side))
    heights = low + (np.arange(rows) + 0.5) * (high - low) / rows
    if not scene.periodic:
        # Of a rod that reaches far beyond the walls, what is near.
        middle = 0.5 * np.array(scene.size)
        heights = heights[np.abs(heights - (middle - shape.center) @ frame[2]) <= np.linalg.norm(middle) + spacing]
    height, angle = _grid(heights, 2 * np.pi * np.arange(columns) / columns)
    normals = np.outer(np.cos(angle), frame[0]) + np.outer(np.sin(angle), frame[1])
    points = [shape.radius * normals + np.outer(height, frame[2])]
    normals = [normals]
    for end in () if shape.length is None else (low, high):
        disc = _disc(shape.radius, side) @ frame[:2]
        points.append(disc + end * frame[2])
        normals.append(np.tile(np.sign(end) * frame[2], (len(disc), 1)))
    return np.array(shape.center) + np.concatenate(points), np.concatenate(normals)


def on_prism(shape, scene, points, normals):
    """Points of a cylinder moved inwards, onto the prism of its volume with their tangent planes as sides.

    The volume of what tangent planes enclose is that of the mean of 1/cos^2 of the angle to the nearest touch point.
    """
    axis = np.array(shape.axis)
    around = np.abs(normals @ axis) < 0.5
    if not around.any():
        return points
    own = points[around] - np.array(shape.center)
    height = own @ axis
    count = 40 * len(own)
    turn = np.pi * (1 + np.sqrt(5.0)) * np.arange(count)
    frame = across(axis)
    # Between the outermost rows: beyond them no point is nearer than those.
    where = height.min() + (np.arange(count) + 0.5) / count * np.ptp(height)
    out = np.outer(np.cos(turn), frame[0]) + np.outer(np.sin(turn), frame[1])
    _, nearest = cKDTree(own).query(shape.radius * out + np.outer(where, axis))
    cosine = np.maximum(np.einsum("ij,ij->i", out, normals[around][nearest]), 0.25)
    inner = float(np.mean(cosine**-2.0) ** -0.5)
    moved = points.copy()
    moved[around] = np.array(shape.center) + np.outer(height, axis) + inner * shape.radius * normals[around]
    return moved


def on_faces(shape, scene, spacing, rng):
    """Square patterns on the faces of a box, half a side from its edges, and normals."""
    turn, middle = np.array(shape.rotation).T, 0.5 * np.array(scene.size)
    counts = np.maximum(1, np.rint(np.array(shape.sides) / (SQUARE * spacing)).astype(int))
    ticks = [((np.arange(n) + 0.5) / n - 0.5) * side for n, side in zip(counts, shape.sides, strict=True)]
    if not scene.periodic:
        # Of faces far beyond the walls, what is near.
        near = np.linalg.norm(middle) + spacing
        ticks = [t[np.abs(t - m) <= near] for t, m in zip(ticks, turn @ (middle - shape.center), strict=True)]
    points, normals = [], []
    for axis, sign in product(range(3), (-1.0, 1.0)):
        u, v = (k for k in range(3) if k != axis)
        first, second = _grid(ticks[u], ticks[v])
        own = np.full((len(first), 3), sign * shape.sides[axis] / 2)
        own[:, u], own[:, v] = first, second
        points.append(own)
        normals.append(np.tile(sign * np.eye(3)[axis], (len(own), 1)))
    return np.array(shape.center) + np.concatenate(points) @ turn, np.concatenate(normals) @ turn


def on_plane(shape, scene, spacing, rng):
    """A triangular pattern on the plane of a half-space, beyond the box too, and normals."""
    frame, middle = _frame(shape.outward, rng), 0.5 * np.array(scene.size)
    middle = middle - shape.distance(middle[None])[0] * frame[2]
    count = int(np.ceil(0.5 * np.linalg.norm(scene.size) / (np.sqrt(0.75) * spacing))) + 1
    i, j = _grid(np.arange(-count, count + 1), np.arange(-count, count + 1))
    start = rng.uniform(-0.5, 0.5, 2)
    across = np.stack([i + 0.5 * (j % 2) + start[0], np.sqrt(0.75) * (j + start[1])], axis=1) * spacing
    return middle + across @ frame[:2], np.tile(frame[2], (len(across), 1))


def where_they_are(shape, scene, points, normals):
    """The points themselves: planes are their own tangents."""
    return points


def on_smooth(shape, scene, spacing, rng):
    """Points in the middles of their own parts of any closed smooth surface (Lloyd's algorithm), and normals."""
    pitch = spacing / SPREAD
    samples, areas = _sampled(shape, scene, pitch)
    # Of what is thinner than that too few are met for the fewest points: some of these would be one.
    for _ in range(FINER if len(samples) else 0):
        if len(samples) >= SPREAD * FEWEST:
            break
        pitch *= 0.5
        samples, areas = _sampled(shape, scene, pitch)
    count = max(FEWEST, int(np.ceil(areas.sum() / (np.sqrt(0.75) * spacing**2))))
    return _spread(shape, samples, areas, count, rng)


def _spread(shape, samples, areas, count, rng):
    """Points in the middles of their own parts of the samples of a surface, and normals."""
    samples, areas = _ordered(samples, areas)
    share = (np.arange(count) + rng.random()) / count
    points = samples[np.searchsorted(np.cumsum(areas) / areas.sum(), share).clip(max=len(samples) - 1)]
    for _ in range(ROUNDS):
        _, nearest = cKDTree(points).query(samples)
        area = np.bincount(nearest, areas, count)
        sums = np.stack([np.bincount(nearest, areas * column, count) for column in samples.T], axis=1)
        points = np.where(area[:, None] > 0, sums / np.maximum(area, 1e-300)[:, None], points)
        distance, normal = shape.surface(points)
        points = points - distance[:, None] * normal
    return points, shape.normal(points)


def on_union(shape, scene, spacing, rng):
    """Points in the middles of their own parts of each face of a union, so that half a spacing is left to its edges."""
    samples, areas = _sampled(shape, scene, spacing / SPREAD)
    own, found = _faced(shape, samples), [(np.empty((0, 3)), np.empty((0, 3)))]
    for number in np.unique(own):
        face, mine = shape.faces[number], own == number
        count = max(1, round(areas[mine].sum() / (np.sqrt(0.75) * spacing**2)))
        points, normals = _spread(face, samples[mine], areas[mine], count, rng)
        bare = shape.bare(points, normals)
        found.append((points[bare], normals[bare]))
    return tuple(np.concatenate(column) for column in zip(*found, strict=True))


def by_faces(shape, scene, points, normals):
    """Points moved inwards as by `by_volume`, each face of a union for itself: across a crease planes are others."""
    samples, areas = _sampled_in(shape, scene, points)
    own, sampled, moved = _faced(shape, points), _faced(shape, samples), points.copy()
    for number in np.unique(own):
        mine, there = own == number, sampled == number
        moved[mine] = _lifted(shape.faces[number], points[mine], normals[mine], samples[there], areas[there])
    return moved


def _faced(shape, points):
    """The face of a union that each point of its surface lies on, the first of those that go on in each other."""
    away = np.stack([np.abs(face.distance(points)) for face in shape.faces])
    return np.argmax(away <= away.min(axis=0) + ON * shape.width, axis=0)


def by_volume(shape, scene, points, normals):
    """Points moved inwards so that over its own part of the surface each plane holds as much as the shape."""
    return _lifted(shape, points, normals, *_sampled_in(shape, scene, points))


def _sampled_in(shape, scene, points):
    """Points of a surface between walls, if there are any, closer than those of a pattern, and their areas."""
    away, _ = cKDTree(points).query(points, k=2)
    samples, areas = _sampled(shape, scene, float(np.median(away[:, 1])) / LIFTED)
    if scene.periodic:
        return samples, areas
    inside = np.all((samples > 0) & (samples < scene.size), axis=1)
    return samples[inside], areas[inside]


def _lifted(shape, points, normals, samples, areas):
    """Points moved so that over the samples nearest to it each plane holds as much as the shape."""
    _, nearest = cKDTree(points).query(samples)
    there = normals[nearest]
    cosine = np.maximum(np.einsum("ij,ij->i", there, shape.normal(samples)), 0.25)
    height = np.einsum("ij,ij->i", points[nearest] - samples, there) / cosine
    total, weight = (np.bincount(nearest, column, len(points)) for column in (areas * height, areas))
    # What is sampled by chance only is moved as far as all are in the mean.
    mean = total.sum() / max(weight.sum(), 1e-300)
    lift = np.where(weight > 0, total / np.maximum(weight, 1e-300), mean)
    return points - lift[:, None] * normals


def _sampled(shape, scene, pitch):
    """Points all over a surface, in a box with walls and a little beyond, and their areas."""
    low, high = shape.bounds()
    if not scene.periodic:
        low, high = np.maximum(low, -BEYOND * pitch), np.minimum(high, np.array(scene.size) + BEYOND * pitch)
    # What goes on through a periodic cell is looked at once along it.
    ends = np.isfinite(low)
    return surface_points(shape, np.where(ends, low - pitch, 0.0), np.where(ends, high + pitch, scene.size), pitch)


def _ordered(samples, areas):
    """Samples along a curve that fills space: every part of it is a part of the surface."""
    low = samples.min(axis=0)
    order = morton_order(samples - low, np.maximum(np.ptp(samples, axis=0), 1e-300))
    return samples[order], areas[order]


def _frame(axis, rng):
    """Two random directions across an axis, and the axis, as rows."""
    angle = rng.uniform(0, 2 * np.pi)
    one, other = across(np.array(axis))
    first = np.cos(angle) * one + np.sin(angle) * other
    return np.stack([first, np.cross(axis, first), axis])


def _along(shape, scene):
    """Ends of a cylinder along its axis, or of what is to have points, m from its centre."""
    if shape.length is not None:
        return -0.5 * shape.length, 0.5 * shape.length
    corners = np.array(list(product(*((0.0, side) for side in scene.size)))) - np.array(shape.center)
    heights = corners @ np.array(shape.axis)
    return heights.min(), heights.max()


def _disc(radius, side):
    """Points on rings of a disc, (k, 2) float array, m."""
    count = max(1, round(radius / side))
    rings = []
    for away in (np.arange(count) + 0.5) / count * radius:
        number = max(3, round(2 * np.pi * away * count / radius))
        angle = 2 * np.pi * (np.arange(number) + 0.5) / number
        rings.append(away * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    return np.concatenate(rings)


def _grid(one, other):
    return tuple(a.ravel() for a in np.meshgrid(one, other, indexing="ij"))
