"""Random sequential addition: spheres put at random, one after the other, where they find room.

Source: Widom, J. Chem. Phys. 44 (1966) 3888.
"""

import numpy as np

from demheat.powers import cube_root

# Jams near a volume fraction of 0.38; well before that nearly every trial is refused.
MOST_FILLED = 0.35
# Trials drawn at once, and those in a row after which a sphere has no room.
BATCH, TRIALS = 256, 200_000
# Of a batch, looked at before the others where only one sphere is sought.
FIRST = 16


def add_spheres(radii, size, rng, *, periodic: bool, margin=0.0, reuse: bool = False) -> np.ndarray:
    """Centres of spheres added at random where they overlap none that came before.

    Each trial is held against the spheres in cells around it: the time goes with their number.
    """
    radii, size = np.asarray(radii, dtype=float), np.asarray(size, dtype=float)
    margins, cells, placed, failed = np.broadcast_to(margin, len(radii)), _Cells(radii, size, periodic), 0, 0
    while placed < len(radii):
        if failed * BATCH >= TRIALS:
            raise RuntimeError(f"no room for sphere {placed + 1} of {len(radii)} in {TRIALS} trials: ask for fewer")
        edge, begin = margins[placed], placed
        trials = edge + (size - 2 * edge) * rng.random((BATCH, 3))
        placed = _add_some(trials, cells, begin, reuse)
        cells.file(np.arange(begin, placed))
        failed = 0 if placed > begin else failed + 1
    return cells.centers[:-1]


def _add_some(trials, cells, begin, reuse):
    """Give the next sphere, or with `reuse` as many as there is room for, trials in order; number placed then."""
    placed, centers, radii = begin, cells.centers, cells.radii
    for some in np.split(trials, [] if reuse else [FIRST]):
        for trial in some[cells.free(some, radii[begin])]:
            if placed == len(radii) - 1 or (placed > begin and not reuse):
                return placed
            if _free(trial[None], centers[None, begin:placed], radii[begin:placed] + radii[begin], cells.period)[0]:
                centers[placed] = trial
                placed += 1
    return placed


class _Cells:
    """Spheres placed so far, in cells at least as wide as the largest one."""

    def __init__(self, radii, size, periodic):
        n, self.size, self.period = len(radii), size, size if periodic else None
        side = max(2 * float(np.max(radii, initial=0.0)), cube_root(np.prod(size) / max(n, 1)))
        self.dims = np.maximum(1, np.floor(size / side)).astype(np.int64)
        # One more, infinitely far away, stands in slots that are free.
        self.centers, self.radii = np.full((n + 1, 3), np.inf), np.append(radii, 0.0)
        number = int(np.prod(self.dims))
        self.slots, self.used = np.full((number, 4), n), np.zeros(number, dtype=np.int64)
        here = np.stack(np.unravel_index(np.arange(number), self.dims), axis=1)
        steps = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
        mode = "wrap" if periodic else "clip"
        self.around = np.ravel_multi_index(np.moveaxis(here[:, None] + steps, 2, 0), self.dims, mode=mode)

    def _numbers(self, points):
        return np.ravel_multi_index((points / self.size * self.dims).astype(np.int64).T, self.dims, mode="clip")

    def file(self, numbers):
        """Put spheres that have got a centre into their cells."""
        for number, cell in zip(numbers, self._numbers(self.centers[numbers]), strict=True):
            if self.used[cell] == self.slots.shape[1]:
                self.slots = np.pad(self.slots, ((0, 0), (0, self.used[cell])), constant_values=len(self.radii) - 1)
            self.slots[cell, self.used[cell]] = number
            self.used[cell] += 1

    def free(self, trials, radius):
        """Which trials have room for a sphere, (t,) bool array."""
        placed = int(self.used.sum())
        if placed <= self.around.shape[1] * self.slots.shape[1]:
            return _free(trials, self.centers[None, :placed], self.radii[:placed] + radius, self.period)
        near = self.slots[self.around[self._numbers(trials)]].reshape(len(trials), -1)
        return _free(trials, self.centers[near], self.radii[near] + radius, self.period)


def _free(trials, centers, reach, period):
    """Which trials are no nearer to any of their centres, (t or 1, k, 3), than its reach, (t,) bool array."""
    square = np.zeros((len(trials), centers.shape[1]))
    for axis in range(3):
        along = np.abs(trials[:, axis, None] - centers[..., axis])
        square += (along if period is None else np.minimum(along, period[axis] - along)) ** 2
    return np.all(square >= reach**2, axis=1)
