"""Gaps between the interfaces of a scene, and between them and walls: what patterns of twins must fit into."""

import numpy as np

from demheat.packing.twins.interfaces import FEWEST, PlaneSurface, surfaces_of
from demheat.packing.twins.spheres import Spheres
from demheat.packing.twins.stacks import stacks_of


class Interfaces:
    """All surfaces of a scene, numbered: the spheres, asked all at once, before the others, asked one by one.

    Those that are parallel and near each other have their twins in columns: what is between them is no gap. The
    keywords are those of `stacks_of`.
    """

    def __init__(self, scene, reach, **columns):
        found = surfaces_of(scene)
        whole = [getattr(surface, "is_sphere", False) for surface in found]
        spheres = [surface for surface, is_sphere in zip(found, whole, strict=True) if is_sphere]
        self.scene, self.reach, self.spheres = scene, reach, Spheres(spheres, scene, reach)
        self.others = [surface for surface, is_sphere in zip(found, whole, strict=True) if not is_sphere]
        self.planes = [other if isinstance(other, PlaneSurface) else None for other in self.others]
        self.stacks = stacks_of(self.spheres.balls, self.planes, scene, **columns)

    def __len__(self):
        """Number of surfaces."""
        return len(self.spheres) + len(self.others)

    def gap(self, points, own=None):
        """Distance of points to the nearest surface, periodic images included, (n,) float array, m.

        Of points that belong to a surface, to the nearest of other stacks.
        """
        own = np.full(len(points), -1) if own is None else own
        leader = self.stacks.leader
        kin = np.where(own >= 0, leader[own], -1) if self.stacks.members else own
        gap = self.spheres.gap(points, own, kin, leader)
        for number, other in enumerate(self.others, start=len(self.spheres)):
            mine = kin == leader[number]
            if not mine.any():
                np.minimum(gap, other.gap(points), out=gap)
                continue
            gap[mine] = np.minimum(gap[mine], other.gap(points[mine], skip_self=True))
            gap[~mine] = np.minimum(gap[~mine], other.gap(points[~mine]))
        return gap

    def depth(self, own):
        """How far inwards of surfaces nothing is in the way, (n,) float array, m."""
        depths = np.append(self.spheres.radii, [other.depth for other in self.others])
        return depths[own]

    def bend(self, points, normals, own, step):
        """Sum of the principal curvatures at points of surfaces, (n,) float array, 1/m; its sign is of no meaning."""
        if len(own) and own[0] >= len(self.spheres):
            return self.others[own[0] - len(self.spheres)].bend(points, normals, step)
        return 2.0 / self.spheres.radii[own]

    def widest_spacing(self, own):
        """Spacing at which an even pattern on each surface has the fewest points that it may have, (n,), m."""
        area = 4 * np.pi * self.spheres.radii**2
        widest = np.append(np.sqrt(area / (np.sqrt(0.75) * FEWEST)), np.full(len(self.others), np.inf))
        return widest[own]

    def touched(self, points, normals, own):
        """The points moved onto the facets of the cells of twins, see `SphereSurface.touched`."""
        if len(own) and own[0] >= len(self.spheres):
            return self.others[own[0] - len(self.spheres)].touched(points, normals)
        return self.spheres.touched(points, normals, own)

    def width(self, points, normals, own):
        """Width of the gap to the nearest surface of another stack, or to the mirror image in a wall that faces it."""
        # A wall that cuts the interface, rather than faces it, leaves no gap.
        return np.minimum(self.gap(points, own), 2.0 * self.way_to_wall(points, normals, own, facing=0.9))

    def columns(self, points, normals, own):
        """The other surfaces' points above and below those of leaders: which of these, points, normals, owners."""
        for members in self.stacks.members:
            there = np.flatnonzero(members[own] >= 0)
            number = members[own[there]]
            yield there, self._moved(points[there], normals[there], number), normals[there], number

    def _moved(self, points, normals, number):
        """The points moved onto other surfaces of their stacks."""
        if len(number) and number[0] >= len(self.spheres):
            plane, moved = self.planes[number[0] - len(self.spheres)], points.copy()
            moved[:, plane.axis] = plane.position
            return moved
        return self.spheres.centers[number] + self.spheres.radii[number, None] * normals

    def way_to_wall(self, points, normals, own=None, *, facing=0.0):
        """Distance along the normal, either way, to the nearest wall whose own normal is that close to it (cosine).

        Not to those that count as the mirrors of a stack.
        """
        way = np.full(len(points), np.inf)
        if self.scene.periodic:
            return way
        size = np.array(self.scene.size)
        near = np.flatnonzero(np.any((points < self.reach) | (points > size - self.reach), axis=1))
        stacked = np.zeros((len(near), 2), bool) if own is None else self._mirrored()[own[near]]
        points, normals = points[near], normals[near]
        for end, direction in enumerate((-normals, normals)):
            height = np.where(direction > 0, size - points, points)
            faced = (np.abs(direction) > facing) & ~stacked[:, end, None]
            ways = np.divide(height, np.abs(direction), out=np.full_like(height, np.inf), where=faced)
            way[near] = np.minimum(way[near], ways.min(axis=1))
        return way

    def _mirrored(self):
        """Whether a wall is next in each surface's stack, against its normal and along it, (surfaces, 2) bool array."""
        mirrored = np.isfinite(self.stacks.apart)
        mirrored[: len(self.spheres)] = False
        return mirrored
