"""A shape whose distances are slow to find or sure nearby alone, asked for them once, at nodes of a grid.

The grid says where to look, not where the surface is: that is found by what the shape holds, on the line along the
slope of the nodes' distances. Farther away from it a lower bound of the distance is all that walkers need.
"""

from itertools import product

import numpy as np

# Nodes along the longest side.
NODES = 32
# In edges of cells: within which distances are asked for; of a point, by how much that of the nodes may be off on the
# line to the surface; halvings of that; what the nodes' distances are taken for too much.
BAND, OFF, HALVINGS, SLACK = 4.2, 0.2, 10, 0.1


class Sampled:
    """A shape in a box, as walkers ask it; points are of the box, and `period` is that it was made with."""

    def __init__(self, shape, size, period):
        from scipy.ndimage import distance_transform_edt

        self.shape, self.size, self.period = shape, size, period
        self.dims = np.maximum(6, np.round(NODES * size / size.max())).astype(np.int64)
        self.cell = size / self.dims
        self.edge = float(self.cell.max())
        nodes = (np.stack(np.unravel_index(np.arange(self.dims.prod()), self.dims), axis=1) + 0.5) * self.cell
        inside = shape.contains(nodes, period=period).reshape(self.dims)
        half, mode = self.dims // 2, "edge" if period is None else "wrap"
        around = np.pad(inside, [(n, n) for n in half], mode=mode)
        flips = np.zeros(around.shape, dtype=bool)
        for axis in range(3):
            flip = np.diff(around, axis=axis)
            flips[tuple(slice(None, -1) if a == axis else slice(None) for a in range(3))] |= flip
            flips[tuple(slice(1, None) if a == axis else slice(None) for a in range(3))] |= flip
        away = distance_transform_edt(~flips, sampling=self.cell)
        away = away[tuple(slice(n, n + m) for n, m in zip(half, self.dims, strict=True))].ravel()
        band = away <= BAND * self.edge
        self.sure = away - self.edge - 0.5 * float(np.linalg.norm(self.cell))
        self.value = np.where(inside.ravel(), -1.0, 1.0) * away
        self.value[band] = shape.distance(nodes[band], period=period)

    def distance(self, points: np.ndarray, *, period: np.ndarray | None = None) -> np.ndarray:
        """Distance to the surface beside it, negative inside; less than that elsewhere, (n,) float array, m."""
        found = self.sure[self._node(np.floor(points / self.cell).astype(np.int64))]
        near = np.flatnonzero(found < 0.5 * self.edge)
        value, slope = self._between(points[near])
        far = np.abs(value) > self.edge
        found[near[far]] = np.abs(value[far]) - SLACK * self.edge
        found[near[~far]] = self._along(points[near[~far]], value[~far], slope[~far])
        return found

    def surface(self, points: np.ndarray, *, period: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Distance along the slope, negative inside, and the slope, of points beside the surface."""
        value, slope = self._between(points)
        return self._along(points, value, slope), slope

    def _node(self, index):
        """Numbers of nodes, those beyond the box by its images or, between walls, the last ones."""
        index = index % self.dims if self.period is not None else np.clip(index, 0, self.dims - 1)
        return (index[..., 0] * self.dims[1] + index[..., 1]) * self.dims[2] + index[..., 2]

    def _between(self, points):
        """The nodes' distances between them, linear along each axis, and the unit vector of their slope."""
        part = points / self.cell - 0.5
        low = np.floor(part).astype(np.int64)
        part = part - low
        corners = np.array(list(product((0, 1), repeat=3)))
        value = self.value[self._node(low[:, None] + corners)].reshape(-1, 2, 2, 2)
        x, y, z = part.T[:, :, None, None]
        along_x = value[:, 0] * (1 - x) + value[:, 1] * x
        step_x = value[:, 1] - value[:, 0]
        y, z = y[:, :, 0], z[:, 0, 0]
        along_y, step_y = along_x[:, 0] * (1 - y) + along_x[:, 1] * y, along_x[:, 1] - along_x[:, 0]
        step_x = step_x[:, 0] * (1 - y) + step_x[:, 1] * y
        found = along_y[:, 0] * (1 - z) + along_y[:, 1] * z
        ends = [step[:, 0] * (1 - z) + step[:, 1] * z for step in (step_x, step_y)] + [along_y[:, 1] - along_y[:, 0]]
        slope = np.stack(ends, axis=1) / self.cell
        return found, slope / np.maximum(np.linalg.norm(slope, axis=1), 1e-300)[:, None]

    def _along(self, points, value, slope):
        """Where the surface is on the line along the slope: the way back to it."""
        low, high = value - OFF * self.edge, value + OFF * self.edge
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            inside = self.shape.contains(points - middle[:, None] * slope, period=self.period)
            # So far back one is inside: the surface is not that far.
            low, high = np.where(inside, low, middle), np.where(inside, middle, high)
        return 0.5 * (low + high)
