"""Which of many shapes hold points: balls all at once, others one by one where they may."""

from collections.abc import Sequence

import numpy as np

from demheat.scene.shapes.base import Shape
from demheat.scene.shapes.bins import ball_bins, candidates
from demheat.scene.shapes.periodic import nearest

# Points looked at together: bounds the scratch memory, and fits a cache.
BLOCK = 16384


class Holders:
    """The shapes of a box, asked which of them hold points; the cost does not grow with their number."""

    def __init__(self, shapes: Sequence[Shape], size: Sequence[float], *, periodic: bool):
        self.shapes, self.period = shapes, np.array(size) if periodic else None
        self.centers, self.radii = bounding_balls(shapes)
        self.spheres = np.array([shape.fills_ball for shape in shapes], dtype=bool)
        ends = np.isfinite(self.radii)
        self.endless = np.flatnonzero(~ends)
        self._ball = np.flatnonzero(ends)
        # A ball that only holds a shape is as wide as its corners, whose distance is rounded.
        wide = np.where(self.spheres, self.radii, self.radii * (1 + 1e-9))[ends]
        self._bins = ball_bins(self.centers[ends], wide, size, periodic=periodic)

    def pairs(self, points: np.ndarray):
        """All pairs of a point and a shape that holds it, block by block of points."""
        for start in range(0, len(points), BLOCK):
            block = points[start : start + BLOCK]
            point, ball = candidates(self._bins, block)
            shape = self._ball[ball]
            quick = self.spheres[shape]
            found = [self._in_spheres(block, point[quick], shape[quick])]
            found += self._in_others(block, point[~quick], shape[~quick])
            for number in self.endless:
                inside = np.flatnonzero(self.shapes[number].contains(block, period=self.period))
                found.append((inside, np.full(len(inside), number)))
            point, shape = (np.concatenate(column) for column in zip(*found, strict=True))
            yield start + point, shape

    def _in_spheres(self, points, point, shape):
        """Those of some pairs whose sphere holds the point: `Sphere.contains` of many."""
        offsets = nearest(points[point] - self.centers[shape], self.period)
        inside = np.einsum("ij,ij->i", offsets, offsets) <= self.radii[shape] ** 2
        return point[inside], shape[inside]

    def _in_others(self, points, point, shape):
        """Those of some pairs whose shape, of any kind, holds the point."""
        order = np.argsort(shape, kind="stable")
        point, shape = point[order], shape[order]
        found = []
        for number in np.unique(shape):
            of = point[slice(*np.searchsorted(shape, [number, number + 1]))]
            inside = of[self.shapes[number].contains(points[of], period=self.period)]
            found.append((inside, np.full(len(inside), number)))
        return found


def bounding_balls(shapes: Sequence[Shape]) -> tuple[np.ndarray, np.ndarray]:
    """Centres and radii of the balls of shapes, (n, 3) and (n,) float arrays, m."""
    balls = [shape.ball() for shape in shapes]
    return np.array([center for center, _ in balls]).reshape(-1, 3), np.array([radius for _, radius in balls])
