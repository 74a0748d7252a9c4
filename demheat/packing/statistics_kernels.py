"""Compiled loops of the packing statistics: link vectors, held particles, pair counts and lines through spheres."""

import numpy as np
from numba import njit, prange

from demheat.packing.cells_kernels import _row

# Parts of the work, each with its own sums. Fixed, so that sums are the same whatever the number of threads.
TASKS = 64
# Unit vectors closer than this to parallel span no plane worth testing; in what remains rounding stays below SLACK.
PARALLEL, SLACK = 1e-6, 1e-9


@njit(parallel=True, cache=True)
def unit_vectors(centers, box, indptr, indices, out):
    """Unit vectors along listed pairs, nearest image; NaN where two centres coincide.

    Parameters
    ----------
    centers : (n, 3) float array
    box : (3,) float array
        Period of each axis, 0 where it is walled.
    indptr, indices : arrays
    out : (nnz, 3) float array, out
    """
    for i in prange(len(indptr) - 1):
        for t in range(indptr[i], indptr[i + 1]):
            j = indices[t]
            d2 = 0.0
            for axis in range(3):
                d = centers[j, axis] - centers[i, axis]
                if box[axis] > 0.0:
                    d -= box[axis] * np.rint(d / box[axis])
                out[t, axis] = d
                d2 += d * d
            factor = 1.0 / np.sqrt(d2) if d2 > 0.0 else np.nan
            for axis in range(3):
                out[t, axis] *= factor


@njit(parallel=True, cache=True)
def held(indptr, indices, vectors, wall_indptr, wall_vectors, half_space, before, now):
    """Which of the particles held `before` are held by the contacts with each other and with walls.

    Parameters
    ----------
    indptr, indices : arrays
    vectors : (nnz, 3) float array
        Unit vector of each contact.
    wall_indptr, wall_vectors : arrays
        Unit vectors of contacts with walls, by particle.
    half_space : bool
        Four contacts are enough if False; they must also lie in no closed half-space if True.
    before : (n,) bool array
    now : (n,) bool array, out
    """
    for i in prange(len(before)):
        now[i] = False
        if before[i]:
            found = np.empty((indptr[i + 1] - indptr[i] + wall_indptr[i + 1] - wall_indptr[i], 3))
            count = 0
            for t in range(indptr[i], indptr[i + 1]):
                if before[indices[t]]:
                    found[count] = vectors[t]
                    count += 1
            for t in range(wall_indptr[i], wall_indptr[i + 1]):
                found[count] = wall_vectors[t]
                count += 1
            now[i] = count >= 4 and (not half_space or _spans(found[:count]))


@njit(cache=True)
def _spans(vectors):
    """Whether unit vectors lie in no closed half-space.

    If they lie in one, some half-space that holds them has two independent ones of them in its boundary plane (an
    extreme ray of a pointed cone), or all of them lie in one plane: try the plane of each pair.
    """
    count, tried = len(vectors), False
    for a in range(count - 1):
        for b in range(a + 1, count):
            x = vectors[a, 1] * vectors[b, 2] - vectors[a, 2] * vectors[b, 1]
            y = vectors[a, 2] * vectors[b, 0] - vectors[a, 0] * vectors[b, 2]
            z = vectors[a, 0] * vectors[b, 1] - vectors[a, 1] * vectors[b, 0]
            norm = np.sqrt(x * x + y * y + z * z)
            if norm < PARALLEL:
                continue
            low = high = 0.0
            for c in range(count):
                if c != a and c != b:
                    s = x * vectors[c, 0] + y * vectors[c, 1] + z * vectors[c, 2]
                    low, high = min(low, s), max(high, s)
            if low >= -SLACK * norm or high <= SLACK * norm:
                return False
            tried = True
    return tried


@njit(parallel=True, cache=True)
def pair_counts(points, grid, origins, is_origin, reach, counts):
    """Histogram of distances from the origins to all particles, by equal bins up to a reach.

    Parameters
    ----------
    points : (n, 4) float array
        Wrapped centre and radius.
    grid : Grid
    origins : (m,) int array
    is_origin : (n,) bool array
    reach : (2,) float array
        (longest distance, 0), or (0, largest ratio of distance to sum of radii): one of the two is counted.
    counts : (TASKS, 2, bins) int array, out
        Partners that are no origins, and that are.
    """
    length, scale = reach[0], reach[1]
    bins = counts.shape[2]
    for task in prange(TASKS):
        buffer = np.empty(256, np.uint32)
        counts[task] = 0
        for o in range(task * len(origins) // TASKS, (task + 1) * len(origins) // TASKS):
            i = origins[o]
            k = _row(i, points[i], grid, scale, length, buffer, np.int64(0))
            if k >= len(buffer):
                buffer = np.empty(2 * k, np.uint32)
                k = _row(i, points[i], grid, scale, length, buffer, np.int64(0))
            for t in range(k):
                j = buffer[t]
                unit = length + scale * (points[i, 3] + points[j, 3])
                b = np.int64(np.sqrt(_distance2(points[i], points[j], grid.box)) / unit * bins)
                # Rounding may put the last hair of the reach into a bin beyond.
                counts[task, np.int64(is_origin[j]), min(b, bins - 1)] += 1


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
def line_correlations(points, grid, starts, along, lags, steps, sums):
    """Sums over lines of the exact two-point function of the union of spheres along each, and of its start slope.

    Parameters
    ----------
    points : (n, 4) float array
        Wrapped centre and radius.
    grid : Grid
    starts : (lines, 3) float array
        Each line runs from here, twice the largest lag far; lag r is averaged over origins on its first half.
    along : (3,) float array
        Unit vector.
    lags : (m,) float array
        Rising from 0.
    steps : int
        Pieces into which a line is cut for the search.
    sums : (TASKS, 2, m + 1) float array, out
        Sums and sums of squares; the last column is the slope.
    """
    window, m = lags[-1], len(lags)
    for task in prange(TASKS):
        buffer, spans = np.empty(256, np.uint32), np.empty((64, 2))
        sums[task] = 0.0
        for line in range(task * len(starts) // TASKS, (task + 1) * len(starts) // TASKS):
            buffer, spans, count = _chords(points, grid, starts[line], along, 2 * window, steps, buffer, spans)
            for a in range(m):
                value = _shared(spans[:count], window, lags[a]) / window
                sums[task, 0, a] += value
                sums[task, 1, a] += value * value
            ends = 0
            for s in range(count):
                ends += 0.0 < spans[s, 1] < window
            sums[task, 0, m] -= ends / window
            sums[task, 1, m] += (ends / window) ** 2


@njit(cache=True)
def _shared(spans, window, lag):
    """Length of the part of [0, window] that is in a span and, shifted by the lag, again."""
    total, a, b = 0.0, 0, 0
    while a < len(spans) and b < len(spans) and spans[a, 0] < window:
        stop, shifted = spans[a, 1], spans[b, 1] - lag
        total += max(0.0, min(stop, shifted, window) - max(spans[a, 0], spans[b, 0] - lag))
        if stop < shifted:
            a += 1
        else:
            b += 1
    return total


@njit(cache=True)
def _chords(points, grid, start, along, length, steps, buffer, spans):
    """Union of the chords that spheres cut from a line, as rising disjoint spans; buffers come back grown."""
    count, p, step = 0, np.zeros(4), length / steps
    for s in range(steps):
        low, high = length * s / steps, length * (s + 1) / steps
        middle = (low + high) / 2
        for axis in range(3):
            x, period = start[axis] + along[axis] * middle, grid.box[axis]
            p[axis] = x - period * np.floor(x / period) if period > 0.0 else x
        # A point of zero radius: all spheres that come within half a step of it.
        k = _row(-1, p, grid, 1.0, step / 2, buffer, np.int64(0))
        if k >= len(buffer):
            buffer = np.empty(2 * k, np.uint32)
            k = _row(-1, p, grid, 1.0, step / 2, buffer, np.int64(0))
        if count + k > len(spans):
            grown = np.empty((2 * (count + k), 2))
            grown[:count] = spans[:count]
            spans = grown
        found = count
        for t in range(k):
            found = _clip_chord(points[buffer[t]], p, along, grid.box, middle, low, high, spans, found)
        count = _merge(spans, count, found)
    return buffer, spans, count


@njit(cache=True)
def _clip_chord(q, p, along, box, middle, low, high, spans, found):
    """Append what the nearest image of sphere q cuts from the line through p, between low and high."""
    projection = square = 0.0
    for axis in range(3):
        d = q[axis] - p[axis]
        if box[axis] > 0.0:
            d -= box[axis] * np.rint(d / box[axis])
        projection += d * along[axis]
        square += d * d
    half2 = q[3] * q[3] - square + projection * projection
    if half2 > 0.0:
        half = np.sqrt(half2)
        a, b = max(low, middle + projection - half), min(high, middle + projection + half)
        if a < b:
            spans[found, 0], spans[found, 1] = a, b
            found += 1
    return found


@njit(cache=True)
def _merge(spans, count, found):
    """Sort the spans from `count` to `found` by their starts and join them with each other and the last one before."""
    for a in range(count + 1, found):
        low, high = spans[a, 0], spans[a, 1]
        b = a
        while b > count and spans[b - 1, 0] > low:
            spans[b] = spans[b - 1]
            b -= 1
        spans[b, 0], spans[b, 1] = low, high
    for a in range(count, found):
        if count > 0 and spans[a, 0] <= spans[count - 1, 1]:
            spans[count - 1, 1] = max(spans[count - 1, 1], spans[a, 1])
        else:
            spans[count, 0], spans[count, 1] = spans[a, 0], spans[a, 1]
            count += 1
    return count
