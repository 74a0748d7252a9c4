"""Hard spheres in motion: their state, and the neighbour lists that serve them for a while.

The unit of length is the mean radius of the start, that of velocity the thermal one (the standard deviation of one
component); all spheres have mass 1.
"""

from __future__ import annotations

import math

import numpy as np

import demheat.threads  # noqa: F401 (chooses the threading layer)
from demheat.packing import lsa_kernels as kernels
from demheat.packing.base import wrap
from demheat.packing.neighbours import near_rows
from demheat.scene import ROUND_AXES, domain_volume

# Collisions per sphere (each counted for one of the two) over which the pressure is averaged.
WINDOW = 10
# The reach of the neighbour lists beyond contact, in mean radii, adapts: longer when a sphere left its region after
# less than half of a window, shorter when none did in a whole one.
SKIN, SKIN_MOST, SKIN_LEAST, LONGER, SHORTER = 0.5, 2.0, 1e-7, 1.4, 0.6
# Likewise the growth of the radii that lists provide for, relative.
GROWTH_MOST, GROWTH_LEAST = 0.02, 1e-12
# Spheres that overlap more than this are no start: one bad pair would make all others a thin gas.
LEAST_RATIO = 0.5


class Motion:
    """Spheres in motion: their state, the neighbour lists that serve them for a while, and what was counted so far."""

    def __init__(self, start, rng):
        self.unit = float(np.mean(start.radii))
        self.box = start.size / self.unit
        self.periodic, self.domain = start.periodic, start.domain
        n = start.number
        self.spheres = _aligned(n)
        self.spheres[:, :3] = start.centers / self.unit
        self.spheres[:, 3:6] = rng.standard_normal((n, 3))
        self.spheres[:, 3:6] -= self.spheres[:, 3:6].mean(axis=0)
        self.spheres[:, 6] = 0.0
        self.spheres[:, 7] = start.radii / self.unit
        ratio = min(1.0, tightest(self.points, self.box, self.periodic, self.domain))
        if ratio < LEAST_RATIO:
            raise ValueError(
                f"start: two of its spheres, or one and a wall, are at {ratio:.3g} of their contact distance, must be "
                f">= {LEAST_RATIO}; push them apart first (demheat.packing.settle)"
            )
        self.start_shrunk = 1.0 - ratio
        # A hair of room: spheres that touch exactly would all collide at once.
        self.spheres[:, 7] *= ratio * (1 - 1e-12)
        self.times, self.levels = _tree(n)
        self.partner = np.empty(n, dtype=np.int32)
        self.skin, self.room, self.row = SKIN, GROWTH_MOST, 16.0
        self.collisions = self.events = self.lists = 0
        self.pressure = math.nan
        self.window = np.zeros(3)  # virial over thermal energy, time, collisions
        self._to_unit_temperature()

    @property
    def points(self):
        """Centres and radii, (n, 4) float array."""
        return self.spheres[:, [0, 1, 2, 7]]

    @property
    def phi(self):
        """Packing fraction."""
        return 4 / 3 * math.pi * float(np.sum(self.spheres[:, 7] ** 3)) / domain_volume(self.domain, self.box)

    def run(self, rate, phi):
        """Move on with one list of neighbours, up to `phi` or the end of the window; True if that has ended."""
        n = len(self.spheres)
        indptr, indices = near_rows(
            self.points, self.box, self.periodic, scale=1.0 + self.room, skin=self.skin, guess=self.row
        )
        self.row = len(indices) / n
        # In units of the thermal velocity, per mean diameter that is 2 times the mean radius now.
        grow = rate / (2 * float(np.mean(self.spheres[:, 7])))
        last = self.room / grow
        if phi is not None:
            last = min(last, (math.cbrt(phi / self.phi) - 1.0) / grow)
        bounds = self._bounds(grow, last)
        arrays = (self.spheres, self.spheres[:, :3].copy(), indptr, indices, self.times, self.levels, self.partner)
        kernels.start(bounds, *arrays)
        left = WINDOW * n - int(self.window[2])
        why, now, collisions, events, virial = kernels.run(bounds, *arrays, left)
        if why == kernels.STUCK:
            raise RuntimeError(f"{events} events without {left} collisions at phi = {self.phi:.6f}: time stands still")
        self.spheres[:, 7] *= 1.0 + grow * now
        self.spheres[:, 6] = 0.0
        self._count(why, now, collisions, events, virial, grow)
        return why == kernels.COUNTED

    def _bounds(self, grow, last):
        across = np.zeros(3)
        across[list(ROUND_AXES[self.domain])] = 1.0
        period = np.where(self.periodic, self.box, 0.0)
        wall = np.where(self.periodic | (across > 0), 0.0, self.box)
        bounds = (tuple(part.tolist()) for part in (period, wall, self.box / 2, across))
        radius = float(np.max(across * self.box)) / 2
        return kernels.Bounds(*bounds, radius, grow, self.skin / 2, float(last))

    def _count(self, why, now, collisions, events, virial, grow):
        """Add up a run; at the end of a window find the pressure; adapt the lists to what happened."""
        self.collisions, self.events, self.lists = self.collisions + collisions, self.events + events, self.lists + 1
        # Velocities grow by the collisions with growing spheres: mean of the thermal energy before (1) and after.
        self.window += virial / ((1.0 + self._to_unit_temperature()) / 2), now, collisions
        early = collisions < WINDOW * len(self.spheres) / 2
        if why == kernels.COUNTED:
            self.pressure = 1.0 + self.window[0] / (3 * len(self.spheres) * self.window[1])
            self.window[:] = 0.0
        if why == kernels.LEFT and early:
            self.skin = min(self.skin * LONGER, SKIN_MOST)
        elif why == kernels.COUNTED and not early:
            self.skin = max(self.skin * SHORTER, SKIN_LEAST)
        used = 1.5 * grow * now
        self.room = min(2 * self.room, GROWTH_MOST) if why == kernels.TIMED_OUT else max(used, GROWTH_LEAST)

    def _to_unit_temperature(self):
        """Scale the velocities to thermal velocity 1; returns the thermal energy they had."""
        energy = float(np.mean(self.spheres[:, 3:6] ** 2))
        self.spheres[:, 3:6] /= math.sqrt(energy)
        return energy

    def packing(self):
        """Centres and radii in metres without overlap, and by how much of themselves the radii were shrunk for it."""
        centers = np.clip(
            wrap(self.spheres[:, :3] * self.unit, self.box * self.unit, self.periodic), 0.0, self.box * self.unit
        )
        radii = self.spheres[:, 7] * self.unit
        ratio = min(1.0, tightest(np.column_stack((centers, radii)), self.box * self.unit, self.periodic, self.domain))
        return centers, radii * ratio, 1.0 - ratio

    def reached(self):
        """What the motion came to, for a packing's provenance."""
        n = len(self.spheres)
        counts = {"collisions": self.collisions / n, "events": self.events / n, "lists": self.lists}
        return {"phi": self.phi, "pressure": None if math.isnan(self.pressure) else float(self.pressure)} | counts


def tightest(points, size, periodic, domain):
    """Smallest distance over contact distance of any pair, or sphere and wall, that overlaps; inf if none does.

    Parameters
    ----------
    points : (n, 4) float array
        Centres, inside the box where it is not periodic, and radii.
    size : (3,) float array
    periodic : (3,) bool array
    domain : str

    Returns
    -------
    float
    """
    indptr, indices = near_rows(points, size, periodic)
    rows = np.repeat(np.arange(len(points)), np.diff(indptr))
    offsets = points[indices, :3] - points[rows, :3]
    offsets -= np.where(periodic, size * np.rint(offsets / size), 0.0)
    contact = points[indices, 3] + points[rows, 3]
    least = np.min(np.linalg.norm(offsets, axis=1) / contact, initial=np.inf)
    axes = list(ROUND_AXES[domain])
    flat = ~np.asarray(periodic)
    flat[axes] = False
    walls = np.minimum(points[:, :3], size - points[:, :3])[:, flat] / points[:, 3:]
    least = min(least, np.min(walls, initial=np.inf))
    if axes:
        inside = size[axes[0]] / 2 - np.linalg.norm(points[:, axes] - size[axes] / 2, axis=1)
        least = min(least, np.min(inside / points[:, 3]))
    return float(least)


def _tree(n):
    """Storage of the tree of minima over n leaves: times of all levels, and where each level begins."""
    nodes, sizes = n, []
    while True:
        sizes.append(-(-nodes // kernels.FAN) * kernels.FAN)
        if nodes == 1:
            break
        nodes = -(-nodes // kernels.FAN)
    levels = np.concatenate(([0], np.cumsum(sizes)))
    return np.full(levels[-1], np.inf), levels


def _aligned(n):
    """(n, 8) float array whose rows are whole cache lines of 64 bytes."""
    raw = np.empty(8 * n + 8)
    first = (-raw.ctypes.data // 8) % 8
    return raw[first : first + 8 * n].reshape(n, 8)
