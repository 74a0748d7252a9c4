"""The surfaces of all spheres of a scene at once: patterns, gaps and tangent planes as flat arrays with owners."""

import math
from functools import cache

import numpy as np

from demheat.packing.twins import surfaces
from demheat.packing.twins import surfaces_kernels as kernels
from demheat.packing.twins.interfaces import pattern_count
from demheat.powers import cube_root
from demheat.runtime.threads import shared_out
from demheat.scene.shapes.bins import ball_bins

# Spheres, points and facets that a thread does at a time.
SPHERES, POINTS, FACETS = 16, 8192, 1024
# Other spheres are first looked for within so many mean distances between them, then within twice as many, and so on.
NEAR = 1.0


class Spheres:
    """Spherical surfaces, numbered; the cost of what is asked of them grows with the points, not with their number."""

    def __init__(self, surfaces, scene, reach):
        self.surfaces, self.scene, self.reach = surfaces, scene, reach
        self.centers = np.array([surface.shape.center for surface in surfaces]).reshape(-1, 3)
        self.radii = np.array([surface.shape.radius for surface in surfaces], dtype=float)
        self.balls = np.column_stack([self.centers, self.radii])
        self.bins = cache(self._bins)
        # Spheres that nearly meet their own images.
        self.lonely = np.flatnonzero(scene.periodic & (2 * self.radii + _hair_more(reach) > min(scene.size)))

    def __len__(self):
        """Number of surfaces."""
        return len(self.surfaces)

    def pattern(self, numbers, spacing, turns):
        """Evenly spread points on some of the spheres."""
        start = np.concatenate([[0], np.cumsum(pattern_count(self.radii[numbers], spacing))])
        where, own = (start, turns, self.balls[numbers]), np.repeat(numbers, np.diff(start))
        if start[-1] <= surfaces.FEW:
            return *surfaces.turned_patterns(*where), own
        points, normals = np.empty((start[-1], 3)), np.empty((start[-1], 3))
        shared_out(kernels.turned_patterns, len(numbers), *where, points, normals, piece=SPHERES)
        return points, normals, own

    def touched(self, points, normals, own):
        """The points moved inwards, onto the polyhedra of the spheres' volumes with their tangent planes as facets."""
        if not len(own):
            return points
        numbers, first = np.unique(own, return_index=True)
        count = np.diff(first, append=len(own))
        inner = inscribed_radii(normals, count)
        # Elsewhere than in the box a sphere has no facets.
        for k in np.flatnonzero(self._cut(numbers) | np.isnan(inner)):
            facets = slice(first[k], first[k] + count[k])
            inner[k] = self.surfaces[numbers[k]].inner_radius(normals[facets])
        return self.centers[own] + np.repeat(inner, count)[:, None] * self.radii[own][:, None] * normals

    def gap(self, points, own, kin, leader):
        """Distance of points to the nearest surface that is no kin, periodic images included, (n,) float array, m."""
        gaps, kins = np.full(len(points), np.inf), leader[: len(self)]
        for reach in self._reaches():
            left = np.flatnonzero(np.isinf(gaps))
            if len(left):
                gaps[left] = self._gaps_within(reach, points[left], kin[left], kins)
        for number in self.lonely:
            mine = np.flatnonzero(own == number)
            if len(mine):
                gaps[mine] = np.minimum(gaps[mine], self.surfaces[number].gap(points[mine], skip_self=True))
        return gaps

    def _reaches(self):
        """How far is looked for other spheres: near at first, for among many small ones a far reach meets them all."""
        if not len(self):
            return []
        apart = cube_root(math.prod(self.scene.size) / len(self))
        count = max(math.ceil(math.log2(self.reach / (NEAR * apart))), 0)
        return [self.reach / 2**k for k in range(count, -1, -1)]

    def _gaps_within(self, reach, points, kin, kins):
        """Distance of points to the nearest sphere that is no kin, infinite beyond a reach."""
        where = points, kin, kins, self.balls, self.bins(reach), reach
        if len(points) <= surfaces.FEW:
            return surfaces.nearest_gaps(*where)
        gaps = np.empty(len(points))
        shared_out(kernels.nearest_gaps, len(points), *where, gaps, piece=POINTS)
        return gaps

    def _bins(self, reach):
        """Cells that know which spheres are within a reach."""
        wide = self.radii + _hair_more(reach)
        return ball_bins(self.centers, wide, self.scene.size, periodic=self.scene.periodic)

    def _cut(self, numbers):
        """Which of some spheres a wall cuts, (m,) bool array."""
        if self.scene.periodic:
            return np.zeros(len(numbers), dtype=bool)
        centers, radii = self.centers[numbers], self.radii[numbers, None]
        return np.any((centers - radii < 0) | (centers + radii > self.scene.size), axis=1)


def _hair_more(reach):
    """What lies at the reach is found."""
    return reach * (1 + 1e-9)


def inscribed_radii(normals, count):
    """Radii of spheres inscribed in polyhedra with these facet normals and the volume of the unit sphere."""
    if len(count) <= surfaces.FEW_SPHERES and len(normals) <= surfaces.FEW_NORMALS:
        parts = np.split(normals, np.cumsum(count)[:-1])
        return np.cbrt(4.0 / 3.0 * np.pi / np.array([surfaces.circumscribed_volume(part) for part in parts]))
    own = np.repeat(np.arange(len(count)), count)
    order = np.lexsort((normals[:, 2], own))
    areas = np.empty(len(normals))
    where = np.concatenate([[0], np.cumsum(count)]), own, normals[order], areas
    shared_out(kernels.facet_areas, len(normals), *where, piece=FACETS)
    # Pyramids of height 1.
    volume = np.bincount(own, areas, len(count)) / 3.0
    return np.cbrt(4.0 / 3.0 * np.pi / volume)
