"""Packings whose radical facets lie on the interfaces of a scene.

Twins, one on either side of an interface and mirrored in its tangent plane, share that plane as their facet. With
weights delta^2 + c (delta the offset from the interface, c one constant) the facets of all twins of a sphere are
exactly its circumscribed polyhedron, whatever the offsets: no facet crosses the interface.
"""

from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from demheat.packing.base import make_packing
from demheat.scene import Scene, Sphere

# In mean radii of the packing. Twins at half a radius make cells centred between the interface and the next layer,
# which is what the two-point flux needs where the interface is curved; found best of offsets .3 to .95 and spacings 1.2
# to 2.1 on the centred sphere at four contrasts (at offset .8 and spacing 1.8 the error is six times larger).
OFFSET = 0.5
SPACING = 1.6
# A particle gives way when its centre is nearer to the interface than the twins beside it plus this.
CLEARANCE = 0.4
# Nearer to an obstacle than this the two cells of a pair would be slivers: the pair is left out.
LEAST_OFFSET = 0.05
# Weight of a twin beyond its squared offset: a twin at OFFSET weighs as much as a mean particle.
EXCESS = 1.0 - OFFSET**2
# Every point of an interface lies within this many spacings of a twin (a triangular pattern would need 0.58).
COVER = 0.7


class _Twins(NamedTuple):
    points: np.ndarray  # (k, 3) touch points on the interface, m
    normals: np.ndarray  # (k, 3) unit vectors
    offsets: np.ndarray  # (k,) m


def conform(packing, scene, *, seed=0):
    """Replace the particles near every interface of a scene by mirrored twins.

    Parameters
    ----------
    packing : Packing
        Of the scene's box.
    scene : Scene
    seed : int
        Turns the point pattern of each sphere.

    Returns
    -------
    Packing
        Radii are square roots of the radical weights (up to a constant added to all). Where two interfaces, or an
        interface and a wall, come closer than a few tenths of a mean radius, twins do not fit and the facets there do
        not conform.
    """
    if not scene.inclusions:
        return packing
    radius = packing.radii.mean()
    rng = np.random.default_rng([seed, 71])
    surfaces = _surfaces(scene)
    parts = []
    for surface in surfaces:
        points, normals = surface.pattern(SPACING * radius, rng)
        offsets = _room(points, normals, surface, surfaces, scene, OFFSET * radius)
        fits = offsets >= LEAST_OFFSET * radius
        parts.append(_Twins(points[fits], normals[fits], offsets[fits]))
    twins = _Twins(*(np.concatenate(column) for column in zip(*parts, strict=True)))
    centers, weights, good = _twin_points(twins, scene, radius)
    twins = _Twins(*(column[good] for column in twins))
    near = np.min([surface.gap(packing.centers) for surface in surfaces], axis=0)
    keep = near > _cleared(packing, twins, radius, near)
    kept = np.minimum(packing.radii**2, near**2 - _margin(radius))[keep]
    # Radical facets do not change when all weights grow alike: make the least one positive.
    raised = np.concatenate([kept, weights]) + max(0.0, 0.01 * radius**2 - kept.min(initial=np.inf))
    provenance = {**packing.provenance, "twins": len(centers)}
    return make_packing(
        np.concatenate([packing.centers[keep], centers]), np.sqrt(raised), packing.size, packing.periodic, provenance
    )


def _margin(radius):
    """What a particle's weight must stay below its squared distance to an interface so that no facet of it reaches it.

    On the interface a twin at lateral distance t has the power t^2 - EXCESS R^2, a particle at distance D and weight w
    at least D^2 - w; t is at most COVER spacings.
    """
    return ((COVER * SPACING) ** 2 - EXCESS) * radius**2


class _SphereSurface(NamedTuple):
    center: np.ndarray
    radius: float
    scene: Scene

    def pattern(self, spacing, rng):
        """Touch points and outward normals, evenly spread, on the polyhedron of the sphere's volume."""
        count = max(12, int(np.ceil(4 * np.pi * self.radius**2 / (np.sqrt(0.75) * spacing**2))))
        normals = Rotation.random(random_state=rng).apply(fibonacci_sphere(count))
        return self.center + inscribed_radius(normals) * self.radius * normals, normals

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


class _PlaneSurface(NamedTuple):
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

    def gap(self, points, *, skip_self=False):
        """Distance of points to the plane, its periodic images included."""
        if skip_self:
            return np.full(len(points), np.inf)
        offset = points[:, self.axis] - self.position
        if self.scene.periodic:
            length = self.scene.size[self.axis]
            offset = offset - length * np.round(offset / length)
        return np.abs(offset)


def fibonacci_sphere(count):
    """Evenly spread unit vectors, (count, 3) float array."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    azimuth = np.pi * (1.0 + np.sqrt(5.0)) * k
    ring = np.sqrt(1.0 - z * z)
    return np.stack([ring * np.cos(azimuth), ring * np.sin(azimuth), z], axis=1)


def inscribed_radius(normals):
    """Radius of the sphere inscribed in the polyhedron with these facet normals and the unit sphere's volume.

    The polyhedron {x : n.x <= 1 for all n} has the volume of the mean of 1/cos^3 of the angle from a direction to
    the nearest normal; the mean is taken over 40 directions per normal.
    """
    directions = fibonacci_sphere(40 * len(normals) + 7)
    chord, _ = cKDTree(normals).query(directions)
    cosine = 1.0 - 0.5 * chord**2
    return float(np.mean(cosine**-3.0) ** (-1.0 / 3.0))


def _surfaces(scene):
    """Every sphere and every plane between layers, once each."""
    spheres, planes = [], set()
    for inclusion in scene.inclusions:
        if isinstance(inclusion, Sphere):
            spheres.append(_SphereSurface(np.array(inclusion.center), inclusion.radius, scene))
            continue
        length = scene.size[inclusion.axis]
        for x in (inclusion.start, inclusion.stop):
            if scene.periodic or 0.0 < x < length:
                planes.add((inclusion.axis, x % length))
    return spheres + [_PlaneSurface(axis, x, scene) for axis, x in sorted(planes)]


def _room(points, normals, surface, surfaces, scene, most):
    """Largest offset that leaves each twin its own place: a half of the way to a wall, a quarter to an interface."""
    room = np.full(len(points), most)
    if isinstance(surface, _SphereSurface):
        room = np.minimum(room, 0.5 * surface.radius)
    for other in surfaces:
        room = np.minimum(room, 0.25 * other.gap(points, skip_self=other is surface))
    if not scene.periodic:
        for direction in (normals, -normals):
            with np.errstate(divide="ignore"):
                way = np.where(direction > 0, scene.size - points, points) / np.abs(direction)
            room = np.minimum(room, 0.5 * way.min(axis=1))
    return room


def _twin_points(twins, scene, radius):
    """Both sides of each pair that lies in the box and in two phases: centres, weights, and the pairs kept."""
    shift = twins.offsets[:, None] * twins.normals
    inner, outer = twins.points - shift, twins.points + shift
    good = scene.phase_at(inner) != scene.phase_at(outer)
    if not scene.periodic:
        margin = 0.3 * twins.offsets[:, None]
        for side in (inner, outer):
            good &= np.all((side > margin) & (side < scene.size - margin), axis=1)
    weights = twins.offsets[good] ** 2 + EXCESS * radius**2
    return np.concatenate([inner[good], outer[good]]), np.tile(weights, 2), good


def _cleared(packing, twins, radius, near):
    """Distance from the interfaces within which each particle gives way to the twins beside it."""
    cleared = np.full(len(near), (OFFSET + CLEARANCE) * radius)
    close = np.flatnonzero(near < cleared)
    if len(close) and len(twins.points):
        box = packing.size if packing.periodic.all() else None
        tree = cKDTree(twins.points % packing.size if box is not None else twins.points, boxsize=box)
        _, nearest = tree.query(packing.centers[close])
        cleared[close] = twins.offsets[nearest] + CLEARANCE * radius
    return cleared
