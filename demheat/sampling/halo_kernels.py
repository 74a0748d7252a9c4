"""Compiled means over spheres around points: samples filed in cells, no lists of neighbours.

The points of one cell are taken together. Cells wholly within the radius of all of them are summed once, by their
totals; samples of cells that only some spheres meet, or meet in part, are copied side by side and looked at one by one
for each point. All that is done for a point is done by one thread in a fixed order: bits do not depend on the number of
threads.
"""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

# A cell counts as inside, or as out of reach, only beyond this part of the radius: its edges are rounded.
HAIR = 1e-9
# Rows of `Cells.slots`: three coordinates, the phase, the volume, volume times three values.
PHASE, SUMS, ROWS = 3, 4, 8


class Cells(NamedTuple):
    """Samples sorted by the cells of one grid."""

    dims: np.ndarray  # (3,) int array: Cells along each axis
    cell: np.ndarray  # (3,) float array, m: Sides of a cell
    period: np.ndarray  # (3,) float array, m: Period of each axis, 0 where it is walled
    start: np.ndarray  # (cells + 1,) int array: First slot of each cell
    # (8, n) float array: Centre, phase, volume, and volume times three values of the sample in each slot
    slots: np.ndarray
    totals: np.ndarray  # (cells, 4) float array: Sums of volume and of volume times values
    phases: bool  # Whether only samples of a point's own phase count


@njit(cache=True)
def cell_totals(start, slots):
    """Sums over each cell of the volume and of volume times values.

    start : (cells + 1,) int array
    slots : (8, n) float array; as in `Cells`
    Returns (cells, 4) float array
    """
    totals = np.zeros((len(start) - 1, ROWS - SUMS))
    for c in range(len(totals)):
        for t in range(start[c], start[c + 1]):
            for k in range(ROWS - SUMS):
                totals[c, k] += slots[SUMS + k, t]
    return totals


@njit(cache=True)
def _bounds(points, low, high):
    """Smallest box around some points, into low and high."""
    for axis in range(3):
        low[axis] = high[axis] = points[0, axis]
        for i in range(1, len(points)):
            low[axis] = min(low[axis], points[i, axis])
            high[axis] = max(high[axis], points[i, axis])


@njit(cache=True)
def _span(low, high, axis, cells):
    """First and last cell that low .. high meets along an axis; unwrapped if that is periodic."""
    cell = cells.cell[axis]
    first, last = np.int64(np.floor(low / cell)), np.int64(np.floor(high / cell))
    if cells.period[axis] > 0.0:
        return first, last
    return max(first, 0), min(last, cells.dims[axis] - 1)


@njit(cache=True)
def _nearest_and_farthest(c, cell, low, high):
    """Along one axis, least and largest distance from any point of low .. high to any of cell c."""
    left, right = c * cell, (c + 1) * cell
    return max(0.0, left - high, low - right), max(right - low, high - left)


@njit(cache=True)
def _copied(cells, c, shift, buffer, count):
    """Append the samples of a cell, shifted, to the buffer; the buffer, grown if need be, and how many it holds."""
    begin, end = cells.start[c], cells.start[c + 1]
    if count + end - begin > buffer.shape[1]:
        larger = np.empty((ROWS, 2 * (count + end - begin)))
        # In loops: compiled in half the time of an assignment of slices.
        for k in range(ROWS):
            for t in range(count):
                larger[k, t] = buffer[k, t]
        buffer = larger
    for k in range(ROWS):
        add = shift[k] if k < 3 else 0.0
        for t in range(begin, end):
            buffer[k, count + t - begin] = cells.slots[k, t] + add
    return buffer, count + end - begin


@njit(cache=True)
def _gathered(low, high, radius, cells, buffer, common):
    """What spheres around the points of a box may hold: totals of the cells they all hold, samples of other cells."""
    near, far, shift = radius * (1.0 + HAIR), radius * (1.0 - HAIR), np.zeros(3)
    count, dims, cell, period = 0, cells.dims, cells.cell, cells.period
    common[:] = 0.0
    x0, x1 = _span(low[0] - near, high[0] + near, 0, cells)
    y0, y1 = _span(low[1] - near, high[1] + near, 1, cells)
    z0, z1 = _span(low[2] - near, high[2] + near, 2, cells)
    for cx in range(x0, x1 + 1):
        ax, bx = _nearest_and_farthest(cx, cell[0], low[0], high[0])
        shift[0] = cx // dims[0] * period[0]
        for cy in range(y0, y1 + 1):
            ay, by = _nearest_and_farthest(cy, cell[1], low[1], high[1])
            if ax * ax + ay * ay > near * near:
                continue
            shift[1] = cy // dims[1] * period[1]
            column = (cx % dims[0] * dims[1] + cy % dims[1]) * dims[2]
            for cz in range(z0, z1 + 1):
                az, bz = _nearest_and_farthest(cz, cell[2], low[2], high[2])
                if ax * ax + ay * ay + az * az > near * near:
                    continue
                c = column + cz % dims[2]
                if bx * bx + by * by + bz * bz <= far * far and not cells.phases:
                    for k in range(ROWS - SUMS):
                        common[k] += cells.totals[c, k]
                    continue
                shift[2] = cz // dims[2] * period[2]
                buffer, count = _copied(cells, c, shift, buffer, count)
    return buffer, count


# Sums in lanes: the order is another one than written, but always the same.
@njit(cache=True, fastmath={"reassoc", "nsz", "contract"})
def _scan(p, wanted, square, buffer, count):
    """Sums over the samples of the buffer of the phase wanted whose distance squared from p is at most `square`."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    x, y, z = p[0], p[1], p[2]
    for t in range(np.uint64(count)):
        dx = buffer[0, t] - x
        dy = buffer[1, t] - y
        dz = buffer[2, t] - z
        inside = (dx * dx + dy * dy + dz * dz <= square) & (buffer[PHASE, t] == wanted)
        weight = 1.0 if inside else 0.0
        a += weight * buffer[SUMS, t]
        b += weight * buffer[SUMS + 1, t]
        c += weight * buffer[SUMS + 2, t]
        d += weight * buffer[SUMS + 3, t]
    return a, b, c, d


@njit(cache=True, parallel=True)
def ball_means(at, start, wanted, radius, cells, out):
    """Write the means of three values over the samples within the radius of each point to out (m, 3).

    at : (m, 3) float array, m; wrapped into the box on periodic axes, sorted by cells
    start : (cells + 1,) int array; first point of each cell. Of some whole columns of cells only: points of the others
      are passed over
    wanted : (m,) float array; phase that counts for each point; 0 if phases do not
    radius : float, m; twice it at most the period
    cells : Cells
    out : (m, 3) float array, out; not-a-number where the sphere holds no volume
    """
    run = cells.dims[2]
    for column in prange((len(start) - 1) // run):
        buffer, common = np.empty((ROWS, 1024)), np.empty(ROWS - SUMS)
        low, high = np.empty(3), np.empty(3)
        for here in range(column * run, (column + 1) * run):
            if start[here] == start[here + 1]:
                continue
            _bounds(at[start[here] : start[here + 1]], low, high)
            buffer, count = _gathered(low, high, radius, cells, buffer, common)
            for i in range(start[here], start[here + 1]):
                a, b, c, d = _scan(at[i], wanted[i], radius * radius, buffer, count)
                volume = a + common[0]
                out[i, 0] = (b + common[1]) / volume if volume > 0.0 else np.nan
                out[i, 1] = (c + common[2]) / volume if volume > 0.0 else np.nan
                out[i, 2] = (d + common[3]) / volume if volume > 0.0 else np.nan
