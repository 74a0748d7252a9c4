"""Temperature and slope outside the spheres by cells: near spheres one by one, all others by the cell's own series."""

import numpy as np

from references.multipole import field_kernels as kernels
from references.multipole.fast import FastMultipole, plan
from references.multipole.system import Solved
from references.multipole.translations import Spheres, complex_table, scales
from references.threads import Team

# Relative error of what far spheres make.
PRECISION = 1e-10
# Points at a time: some tenths of a second, after which the interpreter hears an interrupt.
CHUNK = 4096


class CellField:
    """What spheres make at points."""

    def __init__(self, spheres: Spheres, solved: Solved):
        exchange = FastMultipole(spheres, plan(spheres, solved.order, PRECISION))
        self.cells, self.numbers, self.degree = exchange.cells, exchange.order, exchange.degree
        self.order, sent = solved.order, exchange.sent(solved.source)
        with Team(1) as team:
            local = exchange.local(sent, team)
        # Both by the kernels' harmonics.
        self.local = complex_table(local / exchange.root)
        self.multipoles = complex_table(sent * scales(np.ones(1), solved.order).made)
        self.slope, self.level = exchange.background(spheres, solved.source)

    def owners(self, points):
        """Offsets from the nearest image of the sphere that owns a point, else the point itself, and that sphere."""
        places, home = self._placed(points)
        owner = np.empty(len(points), dtype=np.int64)
        kernels.owners_by_cells(places, home, self.cells, owner)
        owned = owner >= 0
        return np.where(owned[:, None], places, points), np.where(owned, self.numbers[owner], -1)

    def outside(self, points):
        """Temperature and its slope at points outside the spheres, without the mean gradient."""
        result = np.empty((len(points), 4))
        for low in range(0, len(points), CHUNK):
            part = result[low : low + CHUNK]
            places, home = self._placed(points[low : low + CHUNK])
            kernels.inside(places, home, self.local, self.degree, part)
            kernels.near_by_cells(places, home, self.cells, self.multipoles, self.order, part)
            part[:, 0] += places @ self.slope + self.level
            part[:, 1:] += self.slope
        return result

    def _placed(self, points):
        """Places from the middles of their cells, and these cells."""
        edge, shape = self.cells.edge, self.cells.shape
        steps = np.floor(points / edge).astype(np.int64)
        return points - (steps + 0.5) * edge, np.ravel_multi_index(tuple((steps % shape).T), tuple(shape))
