"""Where walkers are: the nearest surface at which the conductivity jumps, and the phase, in an endless space.

A periodic cell is repeated; a box between two held walls, insulated all round, is mirrored in all its faces: with the
mirror images the temperature less the mean gradient is periodic, and a walker that crosses a wall goes on in an image.
"""

import numpy as np

from references.walkers.sampled import Sampled

# Of the longest side: surfaces that lie on each other are one.
SAME = 1e-9
# Cells along an edge for each shape along it, and at most; cells looked at together.
FINE, MOST, BLOCK = 2.0, 32, 4096


class Surfaces:
    """The surfaces of a scene at which the conductivity jumps."""

    def __init__(self, scene, reach: float):
        self.scene, self.size, self.period = scene, np.array(scene.size), scene.period
        k = scene.conductivities
        jumps = np.flatnonzero(k[1:] != k[scene.parents()[1:]])
        self.shapes = [scene.inclusions[number] for number in jumps]
        # What is slow to ask is asked at nodes of a grid, once, and then only what lies inside.
        self.asked = [
            shape if shape.fills_ball or shape.flat else Sampled(shape, self.size, self.period) for shape in self.shapes
        ]
        self.spheres = np.array([shape.fills_ball for shape in self.shapes], dtype=bool)
        balls = [shape.ball() for shape in self.shapes]
        self.centers = np.array([center for center, _ in balls]).reshape(-1, 3)
        self.radii = np.array([radius for _, radius in balls])
        self._file(reach)

    def phase(self, points: np.ndarray) -> np.ndarray:
        """Phase numbers at points anywhere, (n, 3) float array, m -> (n,) int array."""
        return self.scene.phase_at(self._folded(points)[0])

    def nearest(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The nearest surface.

        Besides its number: no more than the distance to it, by its own account, and to the next one, (n,) arrays, m.
        """
        home, _ = self._folded(points)
        number = self._filed[self._cell(home)]
        away = np.full(number.shape, np.inf)
        point, column = np.nonzero(number >= 0)
        away[point, column] = self._away(home, point, number[point, column])
        rows, first = np.arange(len(points)), np.argmin(away, axis=1)
        least = away[rows, first]
        away[away <= (least + SAME * self.size.max())[:, None]] = np.inf
        return number[rows, first], least, away.min(axis=1)

    def side(self, points: np.ndarray, number: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Signed distance, negative inside, and outward normal of surfaces, (n,) and (n, 3) float arrays."""
        home, sign = self._folded(points)
        distance, normal = np.empty(len(points)), np.empty((len(points), 3))
        for each in np.unique(number):
            of = number == each
            distance[of], normal[of] = self.asked[each].surface(home[of], period=self.period)
        return distance, normal * sign

    def _folded(self, points):
        """Points of the box that stand for points anywhere, and by which sign directions change there."""
        if self.period is not None:
            return points - self.size * np.floor(points / self.size), 1.0
        part = points - 2 * self.size * np.floor(points / (2 * self.size))
        over = part > self.size
        return np.where(over, 2 * self.size - part, part), np.where(over, -1.0, 1.0)

    def _away(self, home, point, number):
        """Distances of pairs of points and surfaces, without sign."""
        found, quick = np.empty(len(point)), self.spheres[number]
        offsets = home[point[quick]] - self.centers[number[quick]]
        if self.period is not None:
            offsets -= self.size * np.round(offsets / self.size)
        found[quick] = np.abs(np.sqrt(np.einsum("ij,ij->i", offsets, offsets)) - self.radii[number[quick]])
        for each in np.unique(number[~quick]):
            of = number == each
            found[of] = np.abs(self.asked[each].distance(home[point[of]], period=self.period))
        return found

    def _cell(self, home):
        x, y, z = np.minimum(home / self.size * self.dims, self.dims - 1).astype(np.int64).T
        return (x * self.dims[1] + y) * self.dims[2] + z

    def _file(self, reach):
        """For each cell of the box the surfaces that may be nearest in it, or within reach; -1 fills the rows."""
        count = len(self.shapes)
        edge = self.size.max() / min(MOST, FINE * count ** (1 / 3)) if count > 2 else self.size.max()
        self.dims = np.maximum(1, np.round(self.size / edge)).astype(np.int64)
        half = 0.5 * float(np.linalg.norm(self.size / self.dims))
        grid = np.stack(np.unravel_index(np.arange(self.dims.prod()), self.dims), axis=1)
        middles, rows = (grid + 0.5) * self.size / self.dims, []
        for start in range(0, len(middles), BLOCK):
            block = middles[start : start + BLOCK]
            away = np.abs([shape.distance(block, period=self.period) for shape in self.asked]).T
            near = away <= np.maximum(away.min(axis=1) + 2 * half, reach + half)[:, None] * (1 + SAME)
            rows += [np.flatnonzero(row) for row in near]
        self._filed = np.full((len(rows), max(map(len, rows))), -1)
        for row, own in zip(self._filed, rows, strict=True):
            row[: len(own)] = own
