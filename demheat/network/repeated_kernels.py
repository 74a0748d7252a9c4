"""Cells that are known before they are cut, compiled: those of a tile that is repeated."""

from typing import NamedTuple

import numpy as np
from numba import njit

from demheat.network.polyhedron_kernels import ONCE, PLAIN


class Known(NamedTuple):
    """Cells of one tile, and where the particles of a packing stand in its repeats."""

    # (k,) int32 array: Of the first k sites: t times the number of the tile, plus that of its point among t; -1 for
    # cells to be cut
    place: np.ndarray
    # (t times the number of tiles,) int32 array: The site at each place; -1 where there is none, or one that is not as
    # heavy as the others
    site: np.ndarray
    counts: np.ndarray  # (3,) int64 array: Tiles along each axis, numbered along the last one first
    indptr: np.ndarray  # (t + 1,) int64 array: Row pointers of the tile's facets
    neighbour: np.ndarray  # (m,) uint32 array: The point beyond each
    image: np.ndarray  # (m,) uint8 array: Which periodic image of the tile it lies in
    area: np.ndarray  # (m,) float array, m2
    distance: np.ndarray  # (m,) float array, m
    volume: np.ndarray  # (t,) float array, m3


def nothing_known():
    """Every cell is to be cut."""
    none, whole = np.empty(0, np.int32), np.empty(0, np.int64)
    columns = np.empty(0, np.uint32), np.empty(0, np.uint8), np.empty(0), np.empty(0), np.empty(0)
    return Known(none, none, whole, whole, *columns)


@njit(**ONCE)
def _turned(c, count):
    """Image of the box in which a tile lies that is at most one box away."""
    return -1 if c < 0 else np.int64(c >= count)


@njit(**PLAIN)
def repeat_cell(i, row, chunk, known, out):
    """Note the cell of site i as that of its tile's point; False if a neighbour that it has there is not in its place.

    Whether any other site reaches it, the caller knows.
    """
    if i >= len(known.place) or known.place[i] < 0:
        return False
    count, (nx, ny, nz) = len(known.volume), known.counts
    tile, point = known.place[i] // count, known.place[i] % count
    x, y, z = tile // (ny * nz), tile // nz % ny, tile % nz
    used, ends, room = out.used[chunk, 0], out.used[chunk, 1], out.area.shape[1]
    begin, end = known.indptr[point], known.indptr[point + 1]
    for e in range(begin, end):
        code = np.int64(known.image[e])
        a, b, c = x + code // 9 - 1, y + code // 3 % 3 - 1, z + code % 3 - 1
        sa, sb, sc = _turned(a, nx), _turned(b, ny), _turned(c, nz)
        there = ((a - sa * nx) * ny + b - sb * ny) * nz + c - sc * nz
        site = known.site[there * count + known.neighbour[e]]
        if site < 0:
            return False
        at = used + e - begin
        if at + ends < room:
            out.neighbour[chunk, at], out.image[chunk, at] = site, 9 * (sa + 1) + 3 * (sb + 1) + sc + 1
            out.area[chunk, at], out.distance[chunk, at] = known.area[e], known.distance[e]
    out.used[chunk, 0] = used + end - begin
    out.times[row], out.status[row], out.volume[row] = 1, 0, known.volume[point]
    out.links[row], out.ends[row] = end - begin, 0
    return True
