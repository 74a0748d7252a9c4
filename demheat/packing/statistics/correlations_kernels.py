"""Compiled loops of the pair correlations: pairs counted by their distance, and lines through spheres."""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

from demheat.packing.cells_kernels import RADIUS, Reach, append_row

# Parts of the work, each with its own sums. Fixed, so that sums are the same whatever the number of threads.
TASKS = 64
# Axes of the counts: partners that are no origins, and that are.
SINGLE, DOUBLE = 0, 1
# Axes of the sums over lines.
SUM, SQUARES = 0, 1


class Lines(NamedTuple):
    """Parallel lines, and what is asked of them."""

    # (lines, 3) float array, m: Each line runs from here, twice the largest lag far; lag r is averaged over origins on
    # its first half
    starts: np.ndarray
    along: np.ndarray  # (3,) float array: Unit vector
    lags: np.ndarray  # (m,) float array, m: Rising from 0
    steps: int  # Pieces into which a line is cut for the search


@njit(cache=True)
def _neighbours(i, p, grid, reach, buffer):
    """All near neighbours of particle i at p, in a buffer that comes back longer if need be, and their number."""
    # One call in a loop: two calls in a row take twice as long to compile.
    while True:
        k = append_row(i, p, grid, reach, buffer, np.int64(0))
        if k < len(buffer):
            return buffer, k
        buffer = np.empty(2 * k, np.uint32)


@njit(parallel=True, cache=True)
def pair_counts(points, grid, origins, is_origin, reach, counts):
    """Histogram of distances from the origins to all particles, by equal bins up to a reach.

    points : (n, 4) float array, m; wrapped centre and radius
    grid : Grid
    origins : (m,) int array
    is_origin : (n,) bool array
    reach : Reach; its scale or its skin is 0: the longest distance, or largest ratio of distance to sum of radii,
      counted
    counts : (TASKS, 2, bins) int array, out; partners SINGLE and DOUBLE
    """
    bins = counts.shape[2]
    for task in prange(TASKS):
        buffer = np.empty(256, np.uint32)
        counts[task] = 0
        for o in range(task * len(origins) // TASKS, (task + 1) * len(origins) // TASKS):
            i = origins[o]
            buffer, k = _neighbours(i, points[i], grid, reach, buffer)
            for t in range(k):
                j = buffer[t]
                unit = reach.skin + reach.scale * (points[i, RADIUS] + points[j, RADIUS])
                b = np.int64(np.sqrt(_distance2(points[i], points[j], grid.box)) / unit * bins)
                # Rounding may put the last hair of the reach into a bin beyond.
                counts[task, DOUBLE if is_origin[j] else SINGLE, min(b, bins - 1)] += 1


@njit(cache=True)
def _distance2(p, q, box):
    """Squared distance of nearest images."""
    total = 0.0
    for axis in range(3):
        d = q[axis] - p[axis]
        if box[axis] > 0.0:
            d -= box[axis] * np.rint(d / box[axis])
        total += d * d
    return total


@njit(parallel=True, cache=True)
def line_correlations(points, grid, lines, sums):
    """Sums over lines of the exact two-point function of the union of spheres along each, and of its start slope.

    points : (n, 4) float array, m; wrapped centre and radius
    grid : Grid
    lines : Lines
    sums : (TASKS, 2, m + 1) float array, out; SUM and SQUARES of S2 at each lag; in the last column of the slope, 1/m
    """
    lags, m = lines.lags, len(lines.lags)
    window, number = lags[-1], len(lines.starts)
    for task in prange(TASKS):
        buffer, spans = np.empty(256, np.uint32), np.empty((64, 2))
        sums[task] = 0.0
        for line in range(task * number // TASKS, (task + 1) * number // TASKS):
            buffer, spans, count = _chords(points, grid, lines, line, buffer, spans)
            for a in range(m):
                value = _shared(spans, count, window, lags[a]) / window
                sums[task, SUM, a] += value
                sums[task, SQUARES, a] += value * value
            ends = 0
            for s in range(count):
                ends += 0.0 < spans[s, 1] < window
            sums[task, SUM, m] -= ends / window
            sums[task, SQUARES, m] += (ends / window) ** 2


@njit(cache=True)
def _shared(spans, count, window, lag):
    """Length of the part of [0, window] that is in one of the spans and, shifted by the lag, again."""
    total, a, b = 0.0, 0, 0
    while a < count and b < count and spans[a, 0] < window:
        stop, shifted = spans[a, 1], spans[b, 1] - lag
        total += max(0.0, min(stop, shifted, window) - max(spans[a, 0], spans[b, 0] - lag))
        if stop < shifted:
            a += 1
        else:
            b += 1
    return total


@njit(cache=True)
def _chords(points, grid, lines, line, buffer, spans):
    """Union of the chords that spheres cut from a line, as rising disjoint spans; buffers come back grown."""
    start, along, steps, length = lines.starts[line], lines.along, lines.steps, 2 * lines.lags[-1]
    count, p, step = 0, np.zeros(4), length / steps
    for s in range(steps):
        low, high = length * s / steps, length * (s + 1) / steps
        middle = (low + high) / 2
        for axis in range(3):
            x, period = start[axis] + along[axis] * middle, grid.box[axis]
            p[axis] = x - period * np.floor(x / period) if period > 0.0 else x
        # A point of zero radius: all spheres that come within half a step of it.
        buffer, k = _neighbours(-1, p, grid, Reach(1.0, step / 2), buffer)
        if count + k > len(spans):
            grown = np.empty((2 * (count + k), 2))
            for a in range(count):
                grown[a, 0], grown[a, 1] = spans[a, 0], spans[a, 1]
            spans = grown
        found = count
        for t in range(k):
            at, half = _chord(points[buffer[t]], p, along, grid.box)
            a, b = max(low, middle + at - half), min(high, middle + at + half)
            if half > 0.0 and a < b:
                spans[found, 0], spans[found, 1] = a, b
                found += 1
        count = _merge(spans, count, found)
    return buffer, spans, count


@njit(cache=True)
def _chord(q, p, along, box):
    """Middle, from p, and half the length of what the nearest image of sphere q cuts from the line through p."""
    projection = square = 0.0
    for axis in range(3):
        d = q[axis] - p[axis]
        if box[axis] > 0.0:
            d -= box[axis] * np.rint(d / box[axis])
        projection += d * along[axis]
        square += d * d
    half2 = q[RADIUS] * q[RADIUS] - square + projection * projection
    return projection, np.sqrt(max(half2, 0.0))


@njit(cache=True)
def _merge(spans, count, found):
    """Sort the spans from `count` to `found` by their starts and join them with each other and the last one before."""
    for a in range(count + 1, found):
        low, high = spans[a, 0], spans[a, 1]
        b = a
        while b > count and spans[b - 1, 0] > low:
            spans[b, 0], spans[b, 1] = spans[b - 1, 0], spans[b - 1, 1]
            b -= 1
        spans[b, 0], spans[b, 1] = low, high
    for a in range(count, found):
        if count > 0 and spans[a, 0] <= spans[count - 1, 1]:
            spans[count - 1, 1] = max(spans[count - 1, 1], spans[a, 1])
        else:
            spans[count, 0], spans[count, 1] = spans[a, 0], spans[a, 1]
            count += 1
    return count
