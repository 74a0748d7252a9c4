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
# Column of the radius in rows (x, y, z, radius).
RADIUS = 3


class Reach(NamedTuple):
    """How near is near: two particles closer than scale (r_i + r_j) + skin."""

    scale: float
    skin: float  # m


class Grid(NamedTuple):
    """Cells of all size levels."""

    dims: np.ndarray  # (levels, 3) int array: Cells along each axis
    cell: np.ndarray  # (levels, 3) float array, m: Sides of a cell
    largest: np.ndarray  # (levels,) float array, m: Largest radius in the level
    first: np.ndarray  # (levels,) int array: Number of the first cell of each level
    start: np.ndarray  # (cells + 1,) int array: First slot of each cell
    order: np.ndarray  # (n,) uint32 array: Particle in each slot
    slots: np.ndarray  # (n, 4) float array, m: Wrapped centre and radius of that particle
    box: np.ndarray  # (3,) float array, m: Period of each axis, 0 where it is walled


@njit(cache=True)
def fill_cells(points, level, grid):
    """Counting sort of the points into cells.

    points : (n, 4) float array, m; wrapped centre and radius
    level : (n,) int array; size level of each
    grid : Grid; its start, order and slots are filled
    """
    n, dims, start = len(points), grid.dims, grid.start
    keys = np.empty(n, np.int64)
    start[:] = 0
    for i in range(n):
        lev = level[i]
        key = np.int64(0)
        for axis in range(3):
            c = np.int64(np.floor(points[i, axis] / grid.cell[lev, axis]))
            key = key * dims[lev, axis] + min(max(c, 0), dims[lev, axis] - 1)
        keys[i] = key + grid.first[lev]
        start[keys[i] + 1] += 1
    for k in range(len(start) - 1):
        start[k + 1] += start[k]
    place = start.copy()
    for i in range(n):
        t = place[keys[i]]
        place[keys[i]] += 1
        grid.order[t] = i
        for c in range(4):
            grid.slots[t, c] = points[i, c]


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
def _scan(i, p, begin, end, grid, reach, out, k):
    """Append the particles of slots begin..end that are near particle i; counts on when `out` is full."""
    box, order, slots = grid.box, grid.order, grid.slots
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
        near = reach.scale * (p[RADIUS] + slots[t, RADIUS]) + reach.skin
        j = order[t]
        # Always written, kept only if near: no branch to mispredict.
        out[np.uint64(min(k, last))] = j
        k += (dx * dx + dy * dy + dz * dz < near * near) & (j != i)
    return k


@njit(cache=True)
def append_row(i, p, grid, reach, out, k):
    """Append all near neighbours of one particle to a buffer.

    i : int; the particle, which is not its own neighbour; -1 for a place without one
    p : (4,) float array, m; wrapped centre and radius
    grid : Grid
    reach : Reach
    out : (capacity + 1,) uint32 array, out; the last place is scratch
    k : int; how many it holds
    Returns int: how many it holds now; more than the capacity if it was too short
    """
    box, start = grid.box, grid.start
    for lev in range(len(grid.largest)):
        # A hair more than the reach: cell edges are rounded, the comparison of distances is not.
        far = (reach.scale * (p[RADIUS] + grid.largest[lev]) + reach.skin) * (1.0 + 1e-9)
        nx, ny, nz = grid.dims[lev, 0], grid.dims[lev, 1], grid.dims[lev, 2]
        hx, hy, hz = grid.cell[lev, 0], grid.cell[lev, 1], grid.cell[lev, 2]
        x0, x1, all_x = _span(p[0], far, hx, nx, box[0])
        y0, y1, all_y = _span(p[1], far, hy, ny, box[1])
        for cx in range(x0, x1 + 1):
            gap = _distance_to_cell(p[0], cx, hx, nx, box[0], all_x)
            left_x = far * far - gap * gap
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
                    k = _scan(i, p, start[row + z0 + nz], start[row + nz], grid, reach, out, k)
                    z0 = np.int64(0)
                if z1 >= nz:
                    k = _scan(i, p, start[row], start[row + z1 - nz + 1], grid, reach, out, k)
                    z1 = nz - 1
                k = _scan(i, p, start[row + z0], start[row + z1 + 1], grid, reach, out, k)
    return k


@njit(parallel=True, cache=True)
def near_rows(points, grid, reach, first, buffer, lengths):
    """Rows of near neighbours, one chunk of particles per row of `buffer`; lengths are right even if it is too short.

    points : (n, 4) float array, m; wrapped centre and radius
    grid : Grid
    reach : Reach; of the nearest image
    first : int; number of the chunk in the first row of `buffer`
    buffer : (chunks, capacity) uint32 array, out; the last column is scratch
    lengths : (n,) int array, out; of all particles; those of other chunks stay as they are
    """
    n = len(points)
    for row in prange(len(buffer)):
        k = np.int64(0)
        for i in range((first + row) * CHUNK, min(n, (first + row + 1) * CHUNK)):
            before = k
            k = append_row(i, points[i], grid, reach, buffer[row], k)
            lengths[i] = k - before


@njit(parallel=True, cache=True)
def compact_rows(buffer, indptr, indices):
    """Copy the rows of all chunks behind each other.

    buffer : (chunks, capacity + 1) uint32 array; as `near_rows` fills it
    indptr : (n + 1,) int64 array
    indices : (nnz,) uint32 array, out
    """
    n = len(indptr) - 1
    for chunk in prange(len(buffer)):
        begin = indptr[chunk * CHUNK]
        end = indptr[min(n, (chunk + 1) * CHUNK)]
        indices[begin:end] = buffer[chunk, : end - begin]


@njit(parallel=True, cache=True)
def sort_rows(indptr, indices):
    """Sort each row in place by insertion: rows are short and nearly sorted.

    indptr : (n + 1,) int64 array
    indices : (nnz,) uint32 array, in and out
    """
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
    """Distance of each listed pair over the sum of its radii, nearest image.

    points : (n, 4) float array, m; centre and radius
    box : (3,) float array, m; period of each axis, 0 where it is walled
    indptr : (n + 1,) int64 array
    indices : (nnz,) uint32 array
    out : (nnz,) float array, out
    """
    for i in prange(len(indptr) - 1):
        for t in range(indptr[i], indptr[i + 1]):
            j = indices[t]
            d2 = 0.0
            for axis in range(3):
                d = points[j, axis] - points[i, axis]
                if box[axis] > 0.0:
                    d -= box[axis] * np.rint(d / box[axis])
                d2 += d * d
            out[t] = np.sqrt(d2) / (points[i, RADIUS] + points[j, RADIUS])
