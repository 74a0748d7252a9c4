"""Points evenly all over the surface of any shape, and planes there that keep its volume: facets of twins lie in them.

Facets of twins are no exact polyhedron there, as they are on a sphere: beside each other, two of them meet where their
touch points are equally near, not where their tangent planes cross, unless both are alike by a mirror between them. On
flat faces and in rows along a cylinder they are; elsewhere steps between facets are as high as facets are bent, of
second order in their width. All planes are moved inwards so that the volume stays right.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from demheat.scene.beats import beat
from demheat.scene.shapes.directions import across
from demheat.scene.shapes.morton import morton_order
from demheat.scene.shapes.samples import CLOSER, closer_points, surface_points

# Side of a square pattern over the spacing of a triangular one as dense.
SQUARE = 0.75**0.25
# Points in a pattern on a closed surface, at least.
FEWEST = 12
# Cells of the sampling along a spacing where points are spread out, and where planes are moved; rounds of the first.
SPREAD, LIFTED, ROUNDS = 5, 4, 16
# Times that a sampling is halved for what is thin, at most.
FINER = 6
# Cells beyond a wall in which points are spread out, too: those beside the wall then lie as elsewhere.
BEYOND = 10
# Samples whose nearest points are sought at once: tenths of a second.
SOUGHT = 1 << 17


class Room(NamedTuple):
    """Where a pattern is wanted: the box from 0 to a size, m, which repeats or has walls."""

    size: Sequence[float]
    periodic: bool


def even_points(shape, spacing: float, rng, room: Room):
    """Points in the middles of their own parts of any closed smooth surface, and normals."""
    pitch = spacing / SPREAD
    samples, areas = sampled(shape, room, pitch)
    # Of what is thinner than that too few are met for the fewest points: some of these would be one.
    for _ in range(FINER if len(samples) else 0):
        if len(samples) >= SPREAD * FEWEST:
            break
        pitch *= 0.5
        samples, areas = sampled(shape, room, pitch)
    count = max(FEWEST, int(np.ceil(areas.sum() / (np.sqrt(0.75) * spacing**2))))
    return spread(shape, samples, areas, count, rng)


def spread(shape, samples, areas, count: int, rng):
    """Points in the middles of their own parts of the samples of a surface (Lloyd's algorithm), and normals."""
    samples, areas = _ordered(samples, areas)
    share = (np.arange(count) + rng.random()) / count
    points = samples[np.searchsorted(np.cumsum(areas) / areas.sum(), share).clip(max=len(samples) - 1)]
    for _ in range(ROUNDS):
        nearest = nearest_of(points, samples)
        area = np.bincount(nearest, areas, count)
        sums = np.stack([np.bincount(nearest, areas * column, count) for column in samples.T], axis=1)
        points = np.where(area[:, None] > 0, sums / np.maximum(area, 1e-300)[:, None], points)
        distance, normal = shape.surface(points)
        points = points - distance[:, None] * normal
    return points, shape.normal(points)


def level(shape, points, normals, room: Room):
    """Points moved inwards so that over its own part of the surface each plane holds as much as the shape."""
    samples, areas = sampled_between(shape, points, room)
    return lifted(points, normals, samples, shape.normal(samples), areas)


def sampled_between(shape, points, room: Room):
    """Points of a surface between walls, if there are any, closer than those of a pattern, and their areas."""
    samples, areas = sampled(shape, room, between(points) / LIFTED)
    if room.periodic:
        return samples, areas
    inside = np.all((samples > 0) & (samples < room.size), axis=1)
    return samples[inside], areas[inside]


def between(points) -> float:
    """Median distance of points from the next one, m."""
    from scipy.spatial import cKDTree

    return float(np.median(cKDTree(points).query(points, k=2)[0][:, 1]))


def lifted(points, normals, samples, outward, areas, nearest=None):
    """Points moved so that over the samples nearest to it each plane holds as much as the shape."""
    nearest = nearest_of(points, samples) if nearest is None else nearest
    there = normals[nearest]
    cosine = np.maximum(np.einsum("ij,ij->i", there, outward), 0.25)
    height = np.einsum("ij,ij->i", points[nearest] - samples, there) / cosine
    total, weight = (np.bincount(nearest, column, len(points)) for column in (areas * height, areas))
    # What is sampled by chance only is moved as far as all are in the mean.
    mean = total.sum() / max(weight.sum(), 1e-300)
    lift = np.where(weight > 0, total / np.maximum(weight, 1e-300), mean)
    return points - lift[:, None] * normals


def nearest_of(points, samples):
    """Number of the point nearest to each sample, (n,) int array."""
    from scipy.spatial import cKDTree

    tree, nearest = cKDTree(points), np.empty(len(samples), np.intp)
    for start in range(0, len(samples), SOUGHT):
        beat("points on a surface")
        part = slice(start, start + SOUGHT)
        nearest[part] = tree.query(samples[part])[1]
    return nearest


def closer(shape, widest: float, wanted, rng, room: Room):
    """Points of a surface to choose from where less than a spacing is wanted, and normals; see `closer_points`."""
    pitch = CLOSER * widest
    low, high = _around(shape, room, pitch, pitch)
    shift = np.where(np.isfinite(shape.bounds()[0]), pitch * rng.random(3), 0.0)
    return closer_points(shape, low - shift, high, widest, wanted)


def sampled(shape, room: Room, pitch: float):
    """Points all over a surface, in a box with walls and a little beyond, and their areas."""
    return surface_points(shape, *_around(shape, room, pitch, BEYOND * pitch), pitch)


def _around(shape, room, pitch, beyond):
    """Ends of a box a pitch wider than a surface, at most so far beyond walls, two (3,) float arrays, m."""
    low, high = shape.bounds()
    if not room.periodic:
        low, high = np.maximum(low, -beyond), np.minimum(high, np.array(room.size) + beyond)
    # What goes on through a periodic cell is looked at once along it.
    ends = np.isfinite(low)
    return np.where(ends, low - pitch, 0.0), np.where(ends, high + pitch, room.size)


def _ordered(samples, areas):
    """Samples along a curve that fills space: every part of it is a part of the surface."""
    low = samples.min(axis=0)
    order = morton_order(samples - low, np.maximum(np.ptp(samples, axis=0), 1e-300))
    return samples[order], areas[order]


def random_frame(axis, rng):
    """Two random directions across an axis, and the axis, as rows."""
    angle = rng.uniform(0, 2 * np.pi)
    one, other = across(np.array(axis))
    first = np.cos(angle) * one + np.sin(angle) * other
    return np.stack([first, np.cross(axis, first), axis])


def grid(one, other):
    """All pairs of two rows of numbers, two float arrays."""
    return tuple(a.ravel() for a in np.meshgrid(one, other, indexing="ij"))
