"""The interfaces of a scene as surfaces: point patterns on them and distances to them."""

from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from demheat.scene import Scene, Sphere

# Points that are looked at together: some tens of microseconds of work for each surface that is near.
BLOCK = 2048
# Of sums of a few lengths.
ROUNDING = 1e-12


class SphereSurface(NamedTuple):
    """The surface of a spherical inclusion."""

    center: np.ndarray
    radius: float
    scene: Scene

    def pattern(self, spacing, rng):
        """Evenly spread points and outward normals, both (k, 3) float arrays."""
        count = max(12, int(np.ceil(4 * np.pi * self.radius**2 / (np.sqrt(0.75) * spacing**2))))
        normals = Rotation.random(random_state=rng).apply(fibonacci_sphere(count))
        return self.center + self.radius * normals, normals

    def touched(self, points, normals):
        """The points moved inwards, onto the polyhedron of the sphere's volume with their tangent planes as facets."""
        if len(normals) == 0:
            return points
        counted = None if self.scene.periodic else self._in_box
        return self.center + inscribed_radius(normals, counted=counted) * self.radius * normals

    def _in_box(self, directions):
        """Directions in which the surface lies in the box: elsewhere it has no facets."""
        points = self.center + self.radius * directions
        return np.all((points > 0) & (points < self.scene.size), axis=1)

    def gap(self, points, *, skip_self=False):
        """Distance of points to the surface, its periodic images included; of its own points to its images only."""
        box = np.array(self.scene.size)
        if self.scene.periodic and skip_self:
            nearest = np.full(len(points), np.inf)
            for shift in product((-1, 0, 1), repeat=3):
                if any(shift):
                    offsets = points - self.center - shift * box
                    nearest = np.minimum(nearest, np.abs(np.linalg.norm(offsets, axis=1) - self.radius))
            return nearest
        if skip_self:
            return np.full(len(points), np.inf)
        offsets = points - self.center
        if self.scene.periodic:
            offsets -= box * np.round(offsets / box)
        return np.abs(np.sqrt(np.einsum("ij,ij->i", offsets, offsets)) - self.radius)


class PlaneSurface(NamedTuple):
    """One face of a layer."""

    axis: int
    position: float
    scene: Scene

    def pattern(self, spacing, rng):
        """Touch points on a jittered triangular pattern that fits the box."""
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

    def touched(self, points, normals):
        """The points themselves: a plane is its own tangent."""
        return points

    def gap(self, points, *, skip_self=False):
        """Distance of points to the plane, its periodic images included."""
        if skip_self:
            return np.full(len(points), np.inf)
        offset = points[:, self.axis] - self.position
        if self.scene.periodic:
            length = self.scene.size[self.axis]
            offset = offset - length * np.round(offset / length)
        return np.abs(offset)


def surfaces_of(scene):
    """Every sphere and every plane between layers of a scene, once each."""
    spheres, planes = [], set()
    for inclusion in scene.inclusions:
        if isinstance(inclusion, Sphere):
            spheres.append(SphereSurface(np.array(inclusion.center), inclusion.radius, scene))
            continue
        length = scene.size[inclusion.axis]
        for x in (inclusion.start, inclusion.stop):
            if scene.periodic or 0.0 < x < length:
                planes.add((inclusion.axis, x % length))
    return spheres + [PlaneSurface(axis, x, scene) for axis, x in sorted(planes)]


def nearest_gap(points, surfaces):
    """Distance of points to the nearest of some surfaces, (n,) float array, m.

    Cheap where neighbours in memory are near in space: of each block of points only the surfaces that can be nearest to
    one of them are looked at, since no distance changes by more than a point moves.
    """
    nearest = np.full(len(points), np.inf)
    if not surfaces or not len(points):
        return nearest
    starts = np.arange(0, len(points), BLOCK)
    low, high = np.minimum.reduceat(points, starts), np.maximum.reduceat(points, starts)
    rough = np.array([surface.gap(0.5 * (low + high)) for surface in surfaces])
    # Twice half the diagonal of the block, and a little for rounding.
    spread = 1.0001 * np.linalg.norm(high - low, axis=1)
    for start, close in zip(starts, (rough <= rough.min(axis=0) + spread).T, strict=True):
        block = slice(start, start + BLOCK)
        for k in np.flatnonzero(close):
            np.minimum(nearest[block], surfaces[k].gap(points[block]), out=nearest[block])
    return nearest


def surfaces_near(surface, surfaces, reach):
    """Those of some surfaces, itself for its images, that come within a distance of points of a surface."""
    if not isinstance(surface, SphereSurface):
        return surfaces
    found = []
    for other in surfaces:
        if other is surface:
            # Its images: a period away.
            between = min(surface.scene.size) - surface.radius if surface.scene.periodic else np.inf
        else:
            between = other.gap(surface.center[None])[0]
        if between <= (surface.radius + reach) * (1 + ROUNDING):
            found.append(other)
    return found


def fibonacci_sphere(count):
    """Evenly spread unit vectors, (count, 3) float array."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    azimuth = np.pi * (1.0 + np.sqrt(5.0)) * k
    ring = np.sqrt(1.0 - z * z)
    return np.stack([ring * np.cos(azimuth), ring * np.sin(azimuth), z], axis=1)


def inscribed_radius(normals, *, counted=None):
    """Radius of the sphere inscribed in the polyhedron with these facet normals and the unit sphere's volume.

    The polyhedron {x : n.x <= 1 for all n} has the volume of the mean of 1/cos^3 of the angle from a direction to
    the nearest normal; the mean is taken over 40 directions per normal, or those of them that `counted` accepts.
    """
    directions = fibonacci_sphere(40 * len(normals) + 7)
    if counted is not None:
        directions = directions[counted(directions)]
    if len(directions) == 0:
        return 1.0
    chord, _ = cKDTree(normals).query(directions)
    cosine = 1.0 - 0.5 * chord**2
    return float(np.mean(cosine**-3.0) ** (-1.0 / 3.0))
