"""The body cut into slabs, one for each rank, with a layer of its neighbours' particles, found by their places."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from demheat.scene import Scene

# In radii that equal spheres would have, half a mean spacing or so. Particles of neighbours that a slab sees: a cell is
# made by those within some 4 of them, a fit of temperatures takes cells three deep; what is nearer to the edge is cut
# wrongly, and asked by nobody.
GHOSTS = 10.0
# And beyond them those that only say which particles give way to which twins, or are moved off a wall.
MARGIN = 4.0
# Of the volume.
PHI = 0.64
# Two slabs make one particle of the same numbers: so far apart, in radii, they are two.
SAME = 1e-6
NOBODY = -1


class Slabs(NamedTuple):
    """Slabs of equal thickness across the longest side of a box."""

    axis: int
    length: float  # m: Of that side
    # ranks, rank: How many slabs, and which is ours
    ranks: int
    rank: int
    periodic: bool
    unit: float  # m: Radius that equal spheres would have

    @property
    def ends(self) -> tuple[float, float]:
        """Of our slab, m."""
        return self._bound(self.rank), self._bound(self.rank + 1)

    @property
    def seen(self) -> tuple[float, float]:
        """Of our slab with the layer of its neighbours, m: in a periodic cell beyond the box at its ends."""
        low, high = self.ends
        low, high = low - GHOSTS * self.unit, high + GHOSTS * self.unit
        return (low, high) if self.periodic else (max(low, 0.0), min(high, self.length))

    @property
    def cut(self) -> tuple[bool, bool]:
        """Whether what we see ends inside of the body, at either end."""
        low, high = self.seen
        return self.periodic or low > 0.0, self.periodic or high < self.length

    def owner(self, points: np.ndarray) -> np.ndarray:
        """Rank whose slab holds each point of the box, (n, 3) float array, m -> (n,) int array."""
        inner = [self._bound(number) for number in range(1, self.ranks)]
        return np.searchsorted(inner, points[:, self.axis], side="right")

    def near(self, points: np.ndarray) -> np.ndarray:
        """Points, or periodic images of them, that what we see may depend on, (n, 3) array, m -> (n,) bool array."""
        low, high = self.ends
        middle, half = 0.5 * (low + high), 0.5 * (high - low) + (GHOSTS + MARGIN) * self.unit
        away = points[:, self.axis] - middle
        if self.periodic:
            away = away - self.length * np.round(away / self.length)
        return np.abs(away) <= half

    def _bound(self, number):
        return self.length * number / self.ranks


def slabs_of(scene: Scene, particles: int, ranks: int, rank: int) -> Slabs:
    """Slabs of a scene's box."""
    axis = int(np.argmax(scene.size))
    unit = float(np.cbrt(0.75 / np.pi * PHI * np.prod(scene.size) / particles))
    slabs = Slabs(axis, float(scene.size[axis]), int(ranks), int(rank), scene.periodic, unit)
    # Thinner ones would see more than their neighbours.
    most = int(slabs.length / (GHOSTS * unit))
    if ranks > most:
        raise ValueError(
            f"ranks = {ranks}: slabs of {particles} particles would be thinner than {GHOSTS:g} of their radii; "
            f"must be at most {most}" + ("" if most else ", that is, no packing so small")
        )
    return slabs


def found_at(points: np.ndarray, own: np.ndarray, slabs: Slabs) -> np.ndarray:
    """Which of a slab's own particles lies at each point, (k,) int array; NOBODY where none does."""
    if not len(points):
        return np.empty(0, dtype=np.int64)
    x, slack = own[:, slabs.axis], SAME * slabs.unit
    near = np.flatnonzero((x >= points[:, slabs.axis].min() - slack) & (x <= points[:, slabs.axis].max() + slack))
    if not len(near):
        return np.full(len(points), NOBODY)
    away, place = cKDTree(own[near]).query(points)
    return np.where(away <= slack, near[place], NOBODY)
