"""Gaps between the interfaces of a scene, and between them and walls: what patterns of twins must fit into."""

import numpy as np

from demheat.packing.interfaces import FEWEST, surfaces_of
from demheat.packing.spheres import Spheres


class Interfaces:
    """All surfaces of a scene, numbered: the spheres, asked all at once, before the others, asked one by one."""

    def __init__(self, scene, reach):
        found = surfaces_of(scene)
        whole = [getattr(surface, "is_sphere", False) for surface in found]
        spheres = [surface for surface, is_sphere in zip(found, whole, strict=True) if is_sphere]
        self.scene, self.reach, self.spheres = scene, reach, Spheres(spheres, scene, reach)
        self.others = [surface for surface, is_sphere in zip(found, whole, strict=True) if not is_sphere]

    def __len__(self):
        """Number of surfaces."""
        return len(self.spheres) + len(self.others)

    def gap(self, points, own=None):
        """Distance of points to the nearest surface, periodic images included, (n,) float array, m."""
        own = np.full(len(points), -1) if own is None else own
        gap = self.spheres.gap(points, own)
        for number, other in enumerate(self.others, start=len(self.spheres)):
            mine = own == number
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
        """Width of the gap to the nearest other surface, or to the mirror image in a wall that faces this one."""
        # A wall that cuts the interface, rather than faces it, leaves no gap.
        return np.minimum(self.gap(points, own), 2.0 * self.way_to_wall(points, normals, facing=0.9))

    def way_to_wall(self, points, normals, *, facing=0.0):
        """Distance along the normal, either way, to the nearest wall whose own normal is that close to it (cosine)."""
        way = np.full(len(points), np.inf)
        if self.scene.periodic:
            return way
        size = np.array(self.scene.size)
        near = np.flatnonzero(np.any((points < self.reach) | (points > size - self.reach), axis=1))
        points, normals = points[near], normals[near]
        for direction in (normals, -normals):
            height = np.where(direction > 0, size - points, points)
            faced = np.abs(direction) > facing
            ways = np.divide(height, np.abs(direction), out=np.full_like(height, np.inf), where=faced)
            way[near] = np.minimum(way[near], ways.min(axis=1))
        return way
