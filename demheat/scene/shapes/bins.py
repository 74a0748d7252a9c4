"""Cells that know which balls reach into them: the way from points to the few of many shapes that may hold them."""

from typing import NamedTuple

import numpy as np

# A level has the balls of radii between its largest and half of that; its cells are this part of the largest wide. With
# 20000 equal spheres 0.5 to 1 differ little: smaller cells cost memory, larger ones candidates.
PART = 0.7
# Most cells of a level for each of its balls, where balls are small and far apart.
MOST_CELLS = 64
# Balls filed together: bounds the scratch memory.
BLOCK = 1024
# Of a cell, against rounding: a point on the edge of a ball finds it.
SLACK = 1e-9


class BallBins(NamedTuple):
    """Cells of a box, one grid for each size level of the balls; plain arrays, so that kernels can read them."""

    dims: np.ndarray  # (levels, 3) int array: Cells along each axis
    first: np.ndarray  # (levels,) int array: Number of the first cell of each level; z runs fastest
    start: np.ndarray  # (cells + 1,) int array: First entry of each cell
    balls: np.ndarray  # (entries,) int array: The balls that reach into each cell, ascending
    size: np.ndarray  # (3,) float array, m
    periodic: bool


def ball_bins(centers, radii, size, *, periodic) -> BallBins:
    """File balls under the cells that they reach into, in time and memory in proportion to their number."""
    size, level = np.asarray(size, dtype=float), _levels(radii)
    dims, first, keys, balls = np.empty((level.max(initial=-1) + 1, 3), np.int64), [0], [], []
    for number in range(len(dims)):
        of = np.flatnonzero(level == number)
        side = PART * float(radii[of].max())
        side = max(side, float(np.cbrt(np.prod(size) / (MOST_CELLS * len(of)))))
        dims[number] = np.maximum(1, np.floor(size / side))
        for begin in range(0, len(of), BLOCK):
            block = of[begin : begin + BLOCK]
            ball, key = _entries(centers[block], radii[block], size / dims[number], dims[number], periodic)
            balls.append(block[ball])
            keys.append(first[-1] + key)
        first.append(first[-1] + int(np.prod(dims[number])))
    key = np.concatenate([*keys, np.empty(0, np.int64)])
    order = np.argsort(key, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(key, minlength=first[-1]))])
    balls = np.concatenate([*balls, np.empty(0, np.int64)])[order]
    return BallBins(dims, np.array(first[:-1], dtype=np.int64), start, balls, size, bool(periodic))


def candidates(bins: BallBins, points) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of points and balls that may hold them, as two int arrays: every ball that does, and few others."""
    part = points / bins.size
    part = part - np.floor(part) if bins.periodic else part
    point, ball = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    for dims, first in zip(bins.dims, bins.first, strict=True):
        x, y, z = np.clip(part * dims, 0, dims - 1).astype(np.int64).T
        key = first + (x * dims[1] + y) * dims[2] + z
        count = bins.start[key + 1] - bins.start[key]
        point.append(np.repeat(np.arange(len(points)), count))
        ball.append(bins.balls[runs(bins.start[key], count)])
    return np.concatenate(point), np.concatenate(ball)


def runs(start, count):
    """Numbers start, start + 1, ... of each run, one after the other, as an int array."""
    first = np.concatenate([[0], np.cumsum(count)])
    return np.repeat(start - first[:-1], count) + np.arange(first[-1])


def _levels(radii):
    """Size level of each ball, without empty ones."""
    if not len(radii):
        return np.empty(0, np.int64)
    raw = np.floor(np.log(radii.max() / radii) / np.log(2.0))
    return np.unique(raw, return_inverse=True)[1]


def _entries(centers, radii, cell, dims, periodic):
    """Balls and cells of one level that meet."""
    low = np.floor((centers - radii[:, None]) / cell - SLACK).astype(np.int64)
    high = np.floor((centers + radii[:, None]) / cell + SLACK).astype(np.int64)
    if not periodic:
        low, high = np.clip(low, 0, dims - 1), np.clip(high, 0, dims - 1)
    span = np.minimum(high - low + 1, dims)
    count = span.prod(axis=1)
    ball, number = np.repeat(np.arange(len(radii)), count), runs(np.zeros(len(radii), np.int64), count)
    left, key = radii[ball] ** 2 * (1 + SLACK), np.zeros(len(ball), np.int64)
    steps = number // (span[ball, 1] * span[ball, 2]), number // span[ball, 2] % span[ball, 1], number % span[ball, 2]
    for axis, step in enumerate(steps):
        here, center = low[ball, axis] + step, centers[ball, axis] / cell[axis]
        away = np.maximum(0.0, np.maximum(here - center, center - (here + 1)) - SLACK)
        # Outer cells serve what is beyond a wall, and round a period the nearer image is another cell's.
        outer = span[ball, axis] == dims[axis] if periodic else (here == 0) | (here == dims[axis] - 1)
        left -= np.where(outer, 0.0, away * cell[axis]) ** 2
        key = key * dims[axis] + here % dims[axis]
    return ball[left >= 0], key[left >= 0]
