"""Near-neighbour search on one grid per size level (factor 4), compiled.

A particle looks into the grid of every level, in the box that its own reach to the largest sphere of that level spans,
so the cost per particle does not grow with the width of the size distribution. Cells are numbered along z first: the
cells of one row are one run of memory.
"""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

# Particles per task. Fixed, so that rows land in the same place whatever the number of threads.
CHUNK = 256


class Grid(NamedTuple):
    """Cells of all size levels.

    Attributes
    ----------
    dims : (levels, 3) int array
        Cells along each axis.
    cell : (levels, 3) float array
        Sides of a cell.
    largest : (levels,) float array
        Largest radius in the level.
    first : (levels,) int array
        Number of the first cell of each level.
    start : (cells + 1,) int array
        First slot of each cell.
    order : (n,) uint32 array
        Particle in each slot.
    slots : (n, 4) float array
        Wrapped centre and radius of that particle.
    box : (3,) float array
        Period of each axis, 0 where it is walled.
    """

    dims: np.ndarray
    cell: np.ndarray
    largest: np.ndarray
    first: np.ndarray
    start: np.ndarray
    order: np.ndarray
    slots: np.ndarray
    box: np.ndarray


@njit(cache=True)
def fill_cells(points, level, dims, cell, first, start, order, slots):
    """Counting sort of the points into cells; fills start, order and slots."""
    n = len(points)
    keys = np.empty(n, np.int64)
    start[:] = 0
    for i in range(n):
        lev = level[i]
        key = np.int64(0)
        for axis in range(3):
            c = np.int64(np.floor(points[i, axis] / cell[lev, axis]))
            key = key * dims[lev, axis] + min(max(c, 0), dims[lev, axis] - 1)
        keys[i] = key + first[lev]
        start[keys[i] + 1] += 1
    for k in range(len(start) - 1):
        start[k + 1] += start[k]
    place = start.copy()
    for i in range(n):
        t = place[keys[i]]
        place[keys[i]] += 1
        order[t] = i
        for c in range(4):
            slots[t, c] = points[i, c]


@njit(cache=True)
def _span(x, reach, cell, count, period):
    """Cells met by x - reach .. x + reach, unwrapped; all of them once when the span reaches round the period."""
    low = np.int64(np.floor((x - reach) / cell))
    high = np.int64(np.floor((x + reach) / cell))
    if period > 0.0:
        if high - low + 1 >= count:
            return np.int64(0), count - 1, True
        return low, high, False
    return min(max(low, 0), count - 1), min(max(high, 0), count - 1), False


@njit(cache=True)
def _wrapped(c, count):
    """Cell number of an unwrapped one; a span shorter than the period leaves the box by less than one period."""
    if c < 0:
        return c + count
    return c - count if c >= count else c


@njit(cache=True)
def _distance_to_cell(x, c, cell, count, period, whole):
    """Least distance along one axis from x to anything filed under cell c."""
    # Outer cells of a walled axis also file what lies beyond the wall; a whole span has lost its images.
    if whole or (period == 0.0 and (c == 0 or c == count - 1)):
        return 0.0
    return max(0.0, c * cell - x, x - (c + 1) * cell)


@njit(cache=True)
def _scan(i, p, begin, end, order, slots, box, scale, skin, out, k):
    """Append the particles of slots begin..end that are near particle i; counts on when `out` is full."""
    last = len(out) - 1
    ix = 1.0 / box[0] if box[0] > 0.0 else 0.0
    iy = 1.0 / box[1] if box[1] > 0.0 else 0.0
    iz = 1.0 / box[2] if box[2] > 0.0 else 0.0
    # Unsigned: a signed index is tested for counting from the end.
    for t in range(np.uint64(begin), np.uint64(end)):
        dx = slots[t, 0] - p[0]
        dy = slots[t, 1] - p[1]
        dz = slots[t, 2] - p[2]
        dx -= box[0] * np.rint(dx * ix)
        dy -= box[1] * np.rint(dy * iy)
        dz -= box[2] * np.rint(dz * iz)
        reach = scale * (p[3] + slots[t, 3]) + skin
        j = order[t]
        # Always written, kept only if near: no branch to mispredict.
        out[np.uint64(min(k, last))] = j
        k += (dx * dx + dy * dy + dz * dz < reach * reach) & (j != i)
    return k


@njit(cache=True)
def _row(i, p, grid, scale, skin, out, k):
    """Append all near neighbours of the particle i at p = (x, y, z, radius)."""
    box, start, order, slots = grid.box, grid.start, grid.order, grid.slots
    for lev in range(len(grid.largest)):
        # A hair more than the reach: cell edges are rounded, the comparison of distances is not.
        reach = (scale * (p[3] + grid.largest[lev]) + skin) * (1.0 + 1e-9)
        nx, ny, nz = grid.dims[lev, 0], grid.dims[lev, 1], grid.dims[lev, 2]
        hx, hy, hz = grid.cell[lev, 0], grid.cell[lev, 1], grid.cell[lev, 2]
        x0, x1, all_x = _span(p[0], reach, hx, nx, box[0])
        y0, y1, all_y = _span(p[1], reach, hy, ny, box[1])
        for cx in range(x0, x1 + 1):
            gap = _distance_to_cell(p[0], cx, hx, nx, box[0], all_x)
            left_x = reach * reach - gap * gap
            slab = grid.first[lev] + _wrapped(cx, nx) * ny * nz
            for cy in range(y0, y1 + 1):
                gap = _distance_to_cell(p[1], cy, hy, ny, box[1], all_y)
                left = left_x - gap * gap
                if left < 0.0:
                    continue
                z0, z1, _ = _span(p[2], np.sqrt(left), hz, nz, box[2])
                row = slab + _wrapped(cy, ny) * nz
                # One run of cells, or two when it crosses the period.
                if z0 < 0:
                    k = _scan(i, p, start[row + z0 + nz], start[row + nz], order, slots, box, scale, skin, out, k)
                    z0 = np.int64(0)
                if z1 >= nz:
                    k = _scan(i, p, start[row], start[row + z1 - nz + 1], order, slots, box, scale, skin, out, k)
                    z1 = nz - 1
                k = _scan(i, p, start[row + z0], start[row + z1 + 1], order, slots, box, scale, skin, out, k)
    return k


@njit(parallel=True, cache=True)
def near_rows(points, grid, scale, skin, buffer, lengths):
    """Rows of near neighbours, one chunk of particles per row of `buffer`; lengths are right even if it is too short.

    Parameters
    ----------
    points : (n, 4) float array
        Wrapped centre and radius.
    grid : Grid
    scale, skin : float
        j is near i when |x_i - x_j| < scale (r_i + r_j) + skin, nearest image.
    buffer : (chunks, capacity) uint32 array, out
        The last column is scratch.
    lengths : (n,) int array, out
    """
    n = len(points)
    for chunk in prange(len(buffer)):
        k = np.int64(0)
        for i in range(chunk * CHUNK, min(n, (chunk + 1) * CHUNK)):
            before = k
            k = _row(i, points[i], grid, scale, skin, buffer[chunk], k)
            lengths[i] = k - before


@njit(parallel=True, cache=True)
def compact_rows(buffer, indptr, indices):
    """Copy the rows of all chunks behind each other."""
    n = len(indptr) - 1
    for chunk in prange(len(buffer)):
        begin = indptr[chunk * CHUNK]
        end = indptr[min(n, (chunk + 1) * CHUNK)]
        indices[begin:end] = buffer[chunk, : end - begin]


@njit(parallel=True, cache=True)
def sort_rows(indptr, indices):
    """Sort each row in place by insertion: rows are short and nearly sorted."""
    for i in prange(len(indptr) - 1):
        for a in range(indptr[i] + 1, indptr[i + 1]):
            value = indices[a]
            b = a
            while b > indptr[i] and indices[b - 1] > value:
                indices[b] = indices[b - 1]
                b -= 1
            indices[b] = value


@njit(parallel=True, cache=True)
def row_distances(points, box, indptr, indices, out):
    """Distance of each listed pair over the sum of its radii, nearest image."""
    for i in prange(len(indptr) - 1):
        for t in range(indptr[i], indptr[i + 1]):
            j = indices[t]
            d2 = 0.0
            for axis in range(3):
                d = points[j, axis] - points[i, axis]
                if box[axis] > 0.0:
                    d -= box[axis] * np.rint(d / box[axis])
                d2 += d * d
            out[t] = np.sqrt(d2) / (points[i, 3] + points[j, 3])
