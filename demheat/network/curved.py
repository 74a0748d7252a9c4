"""Round walls of radical cells: tangent planes placed so that the volume they enclose is that of the round body.

A cylinder is replaced by the prism over a regular polygon, a sphere by the polyhedron whose planes touch it at the
points of a spherical Fibonacci lattice, both with facets about as large as those of the cells, moved inwards until the
volume is right. They do not depend on the packing, so that cells match by construction.

The wall's temperature acts where the round wall is seen from a centre along the facet's normal, not on the plane: the
heating of a sphere then does not depend on how wide the facets are (found for half, one and two spacings and for facets
in front of each particle), while planes alone are too far from centres to their sides. The area of all facets exceeds
that of a sphere or a cylinder as much as their distance from the middle falls short of its radius (3e-4 with 2e4
particles in a sphere).
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from demheat.network.base import SIDES
from demheat.packing.twins.interfaces import fibonacci_sphere
from demheat.packing.twins.surfaces import circumscribed_volume
from demheat.scene import ROUND_AXES

# Width of a wall facet in mean spacings of the particles.
WIDTH = 1.0
ROUND_SIDE = SIDES.index("round")
FEWEST_SIDES, FEWEST_FACES = 8, 20


class RoundWall(NamedTuple):
    """Tangent planes normal.(x - middle) = radius of a round wall."""

    normals: np.ndarray  # (m, 3) float array: Outward unit vectors
    radius: float  # m: Distance of every plane from the middle or the axis; a little less than the radius of the body
    middle: np.ndarray  # (3,) float array, m
    across: np.ndarray  # (3,) float array: 1 on the axes across which the wall is round, else 0


class Tangents(NamedTuple):
    """Planes of a round wall that lie near each of some points, as compressed rows."""

    pointers: np.ndarray  # (n + 1,) int64 array: Where the planes of each point begin
    planes: np.ndarray  # (m,) int64 array: Numbers of planes


def round_wall(domain, size, spacing, *, width=WIDTH):
    """Tangent planes of a domain that enclose exactly its volume."""
    if domain not in ROUND_AXES:
        raise ValueError(f"domain = {domain!r}: must be one of {', '.join(ROUND_AXES)}")
    axes = list(ROUND_AXES[domain])
    middle, across = np.asarray(size, dtype=float) / 2, np.zeros(3)
    across[axes] = 1.0
    if not axes:
        return RoundWall(np.empty((0, 3)), 0.0, middle, across)
    radius = float(middle[axes[0]])
    if len(axes) == 2:
        sides = max(FEWEST_SIDES, round(2 * np.pi * radius / (width * spacing)))
        angle = 2 * np.pi * np.arange(sides) / sides
        normals = np.zeros((sides, 3))
        normals[:, axes[0]], normals[:, axes[1]] = np.cos(angle), np.sin(angle)
        # A regular polygon about a circle of radius r has the area n r^2 tan(pi/n).
        return RoundWall(normals, radius * float(np.sqrt(np.pi / (sides * np.tan(np.pi / sides)))), middle, across)
    normals = fibonacci_sphere(max(FEWEST_FACES, round(4 * np.pi * (radius / (width * spacing)) ** 2)))
    share = 4 * np.pi / 3 / circumscribed_volume(normals)
    return RoundWall(normals, radius * float(np.cbrt(share)), middle, across)


def round_distances(wall, points, normals):
    """Distance from points inside a round body to its wall along outward normals of planes."""
    radius = (wall.middle * wall.across).max()
    offsets = (points - wall.middle) * wall.across
    along = np.einsum("ij,ij->i", offsets, normals)
    aside = np.einsum("ij,ij->i", offsets, offsets) - along**2
    return np.sqrt(radius**2 - aside) - along


def tangents_within(wall, points, reach):
    """The planes that touch the body within reach of each point (across the axis, for a cylinder)."""
    counts, planes = np.zeros(len(points), dtype=np.int64), np.empty(0, dtype=np.int64)
    if len(wall.normals):
        axes = np.flatnonzero(wall.across)
        offsets = (points - wall.middle)[:, axes]
        near = np.flatnonzero(np.linalg.norm(offsets, axis=1) > wall.radius - reach)
        tree = cKDTree(wall.radius * wall.normals[:, axes])
        lists = tree.query_ball_point(offsets[near], reach, return_sorted=True)
        counts[near] = [len(found) for found in lists]
        if counts.any():
            planes = np.concatenate([np.asarray(found, dtype=np.int64) for found in lists])
    return Tangents(np.concatenate([[0], np.cumsum(counts)]), planes)
