"""Hard spheres in motion: their state, and the neighbour lists that serve them for a while.

The unit of length is the mean radius of the start, that of velocity the thermal one (the standard deviation of one
component); all spheres have mass 1.
"""

import math
from typing import NamedTuple

import numpy as np

import demheat.runtime.threads  # noqa: F401 (chooses the threading layer)
from demheat.packing import lsa_kernels as kernels
from demheat.packing.base import wrap
from demheat.packing.neighbours import near_rows
from demheat.powers import cube_root, cubed
from demheat.scene.bodies import ROUND_AXES, domain_volume, nearest_wall, wall_names

# Collisions per sphere (each counted for one of the two) over which the pressure is averaged.
WINDOW = 10
# The reach of the neighbour lists beyond contact, in mean radii, adapts: longer when a sphere left its region after
# less than half of a window, shorter when none did in a whole one.
SKIN, SKIN_MOST, SKIN_LEAST, LONGER, SHORTER = 0.5, 2.0, 1e-7, 1.4, 0.6
# Likewise the growth of the radii that lists provide for, relative.
GROWTH_MOST, GROWTH_LEAST = 0.02, 1e-12
# Spheres that overlap more than this are no start: one bad pair would make all others a thin gas.
LEAST_RATIO = 0.5
# Events between which Ctrl-C is heard: some tenths of a second.
PAUSE = 100_000
CENTER, VELOCITY = slice(kernels.X, kernels.Z + 1), slice(kernels.U, kernels.W + 1)


class Window(NamedTuple):
    """What was counted over some time: virial over the thermal energy, time, and collisions."""

    virial: float
    time: float
    collisions: int


NOTHING = Window(0.0, 0.0, 0)


class Motion:
    """Spheres in motion: their state, the neighbour lists that serve them for a while, and what was counted so far."""

    def __init__(self, start, rng):
        self.unit = float(np.mean(start.radii))
        self.box = start.size / self.unit
        self.periodic, self.domain = start.periodic, start.domain
        n = start.number
        self.spheres = _aligned(n)
        self.spheres[:, CENTER] = start.centers / self.unit
        self.spheres[:, VELOCITY] = rng.standard_normal((n, 3))
        self.spheres[:, VELOCITY] -= self.spheres[:, VELOCITY].mean(axis=0)
        self.spheres[:, kernels.TIME] = 0.0
        self.spheres[:, kernels.RADIUS] = start.radii / self.unit
        ratio = min(1.0, tightest(self.points, self.box, self.periodic, self.domain))
        if ratio < LEAST_RATIO:
            raise ValueError(
                f"start: two of its spheres, or one and a wall, are at {ratio:.3g} of their contact distance, must be "
                f">= {LEAST_RATIO}; push them apart first (demheat.packing.settle)"
            )
        self.start_shrunk = 1.0 - ratio
        # A hair of room: spheres that touch exactly would all collide at once.
        self.spheres[:, kernels.RADIUS] *= ratio * (1 - 1e-12)
        self.next = kernels.Events(*tree(n), np.empty(n, dtype=np.int32))
        self.skin, self.room, self.row = SKIN, GROWTH_MOST, 16.0
        self.collisions = self.events = self.lists = 0
        self.pressure = math.nan
        self.window = NOTHING
        self._to_unit_temperature()

    @property
    def points(self):
        """Centres and radii, (n, 4) float array."""
        return np.column_stack((self.spheres[:, CENTER], self.radii))

    @property
    def radii(self):
        """Radii, (n,) float array: a view."""
        return self.spheres[:, kernels.RADIUS]

    @property
    def phi(self):
        """Packing fraction."""
        return 4 / 3 * math.pi * float(np.sum(cubed(self.radii))) / domain_volume(self.domain, self.box)

    def run(self, rate, phi) -> bool:
        """Move on with one list of neighbours."""
        n = len(self.spheres)
        indptr, indices = near_rows(
            self.points, self.box, self.periodic, scale=1.0 + self.room, skin=self.skin, guess=self.row
        )
        self.row = len(indices) / n
        # In units of the thermal velocity, per mean diameter that is 2 times the mean radius now.
        grow = rate / (2 * float(np.mean(self.radii)))
        last = self.room / grow
        if phi is not None:
            last = min(last, (cube_root(phi / self.phi) - 1.0) / grow)
        bounds, lists = self.bounds(grow, last), kernels.Lists(self.spheres[:, CENTER].copy(), indptr, indices)
        kernels.start(bounds, self.spheres, lists, self.next)
        left = WINDOW * n - self.window.collisions
        why, done = kernels.PAUSED, kernels.Count(0, 0, 0.0)
        while why == kernels.PAUSED:
            why, now, done = kernels.run(bounds, self.spheres, lists, self.next, left, done, PAUSE)
        collisions, events, virial = done
        if why == kernels.STUCK:
            raise RuntimeError(f"{events} events without {left} collisions at phi = {self.phi:.6f}: time stands still")
        self.spheres[:, kernels.RADIUS] *= 1.0 + grow * now
        self.spheres[:, kernels.TIME] = 0.0
        self.events, self.lists = self.events + events, self.lists + 1
        self._count(why, Window(virial, now, collisions))
        self._adapt(why, 1.5 * grow * now, early=collisions < WINDOW * n / 2)
        return why == kernels.COUNTED

    def bounds(self, grow, last) -> kernels.Bounds:
        """What holds for a run."""
        across = np.zeros(3)
        across[list(ROUND_AXES[self.domain])] = 1.0
        period = np.where(self.periodic, self.box, 0.0)
        wall = np.where(self.periodic | (across > 0), 0.0, self.box)
        bounds = (tuple(part.tolist()) for part in (period, wall, self.box / 2, across))
        radius = float(np.max(across * self.box)) / 2
        return kernels.Bounds(*bounds, radius, grow, self.skin / 2, float(last))

    def _count(self, why, run):
        """Add up a run; at the end of a window find the pressure."""
        self.collisions += run.collisions
        # Velocities grow by the collisions with growing spheres: mean of the thermal energy before (1) and after.
        run = run._replace(virial=run.virial / ((1.0 + self._to_unit_temperature()) / 2))
        self.window = Window(*(a + b for a, b in zip(self.window, run, strict=True)))
        if why == kernels.COUNTED:
            self.pressure = 1.0 + self.window.virial / (3 * len(self.spheres) * self.window.time)
            self.window = NOTHING

    def _adapt(self, why, used, *, early):
        """Lists that reach farther or less far, and provide for the growth used up or more, as the last one did."""
        if why == kernels.LEFT and early:
            self.skin = min(self.skin * LONGER, SKIN_MOST)
        elif why == kernels.COUNTED and not early:
            self.skin = max(self.skin * SHORTER, SKIN_LEAST)
        self.room = min(2 * self.room, GROWTH_MOST) if why == kernels.TIMED_OUT else max(used, GROWTH_LEAST)

    def _to_unit_temperature(self):
        """Scale the velocities to thermal velocity 1; returns the thermal energy they had."""
        energy = float(np.mean(self.spheres[:, VELOCITY] ** 2))
        self.spheres[:, VELOCITY] /= math.sqrt(energy)
        return energy

    def packing(self):
        """Centres and radii in metres without overlap, and by how much of themselves the radii were shrunk for it."""
        centers = np.clip(
            wrap(self.spheres[:, CENTER] * self.unit, self.box * self.unit, self.periodic), 0.0, self.box * self.unit
        )
        radii = self.radii * self.unit
        ratio = min(1.0, tightest(np.column_stack((centers, radii)), self.box * self.unit, self.periodic, self.domain))
        return centers, radii * ratio, 1.0 - ratio

    def reached(self):
        """What the motion came to, for a packing's provenance."""
        n = len(self.spheres)
        counts = {"collisions": self.collisions / n, "events": self.events / n, "lists": self.lists}
        return {"phi": self.phi, "pressure": None if math.isnan(self.pressure) else float(self.pressure)} | counts


def tightest(points, size, periodic, domain):
    """Smallest distance over contact distance of any pair, or sphere and wall, that overlaps; inf if none does."""
    indptr, indices = near_rows(points, size, periodic)
    rows = np.repeat(np.arange(len(points)), np.diff(indptr))
    offsets = points[indices, :3] - points[rows, :3]
    offsets -= np.where(periodic, size * np.rint(offsets / size), 0.0)
    contact = points[indices, 3] + points[rows, 3]
    least = np.min(np.linalg.norm(offsets, axis=1) / contact, initial=np.inf)
    depth = nearest_wall(points[:, :3], wall_names(domain, periodic), domain, size)
    return float(min(least, np.min(depth / points[:, 3])))


def tree(n):
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
