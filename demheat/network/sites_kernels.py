"""Weighted points filed by size and place, and the search for those that may cut a radical cell, compiled.

A site at distance d with weight w cuts off points of the cell of another, weight w_i, whose farthest vertex is f away,
only if d < f + sqrt(f^2 + w - w_i). Sites are filed in grids by size, so that a few heavy ones do not make all searches
wide, and looked at in rings of grid cells around the home of the cell, until the next ring is farther than that.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from demheat.network.links_kernels import HERE
from demheat.network.polyhedron_kernels import ONCE, PLAIN

LOW, HIGH, WIDTH = range(3)
HOME, COUNT, PERIODIC = range(3)
# Bins that candidates are put in order by.
BINS = 32


class Sites(NamedTuple):
    """Weighted points in a box, filed in grids, one for each level of weight."""

    points: np.ndarray  # (n, 3) float array, m
    weights: np.ndarray  # (n,) float array, m2
    size: np.ndarray  # (3,) float array, m
    periodic: np.ndarray  # (3,) bool array
    heaviest: np.ndarray  # (levels,) float array, m2: The largest weight of each level
    counts: np.ndarray  # (levels, 3) int64 array: Cells of each grid along each axis
    first: np.ndarray  # (levels,) int64 array: Where the cells of each grid begin in `start`
    start: np.ndarray  # int64 array: Where each cell begins among the items; of each grid one more than it has cells
    items: np.ndarray  # (n,) uint32 array: Numbers of the points, those of one cell side by side and ascending
    slots: np.ndarray  # (n, 4) float array, m and m2: Places and weights of the items, in their order


class Candidates(NamedTuple):
    """Sites that may cut a cell, up to some room, and where its own site stands in a grid."""

    label: np.ndarray  # (room,) int64 array: 32 times the number of a site, plus the code of its image
    # (room, 4) float array, m: The radical plane: unit vector towards the site, distance from the cell's own; that is
    # minus infinity for a site that hides the cell's own
    plane: np.ndarray
    order: np.ndarray  # (room,) uint32 array: The candidates, nearest plane first as far as `arrange` tells
    bin: np.ndarray  # (room,) uint32 array: Scratch of `arrange`
    # (3, 3) int64 array: For each axis, the grid cell of the cell's site, the number of grid cells, and 1 if it is
    # periodic, in columns HOME, COUNT and PERIODIC
    grid: np.ndarray
    # (3, 3) float array, m: From the site to the low and to the high side of its grid cell, and the width of a grid
    # cell, in rows LOW, HIGH and WIDTH
    frame: np.ndarray


def empty_candidates(room):
    """Uninitialised memory of up to `room` Candidates."""
    return Candidates(
        np.empty(room, np.int64),
        np.empty((room, 4)),
        np.empty(room, np.uint32),
        np.empty(room + BINS, np.uint32),
        np.empty((3, 3), np.int64),
        np.empty((3, 3)),
    )


@njit(**PLAIN)
def cutting_reach(farthest, weight, heaviest):
    """Sites of at most some weight cut a cell only if they are nearer than this.

    farthest : float, m; of the cell's vertices from its site
    weight, heaviest : float, m2; of the cell's own site and of the others
    Returns float, m
    """
    square = farthest * farthest + heaviest - weight
    return farthest + np.sqrt(square) if square > 0.0 else 0.0


@njit(**PLAIN)
def find_home(i, level, sites, found):
    """Note where a site stands in the grid of a level.

    i, level : int
    sites : Sites
    found : Candidates, out
    """
    for k in range(3):
        count = sites.counts[level, k]
        width = sites.size[k] / count
        # As points are filed: rounding may put one a hair beyond its cell, and the gap is then negative.
        home = min(max(np.int64(sites.points[i, k] / sites.size[k] * count), 0), count - 1)
        low = sites.points[i, k] - home * width
        found.grid[k, HOME], found.grid[k, COUNT], found.grid[k, PERIODIC] = home, count, sites.periodic[k]
        found.frame[LOW, k], found.frame[HIGH, k], found.frame[WIDTH, k] = low, width - low, width


@njit(**PLAIN)
def ring_distance(ring, grid, frame):
    """What a ring of grid cells keeps away from the site, and whether it and those beyond hold no cell.

    ring : int
    grid, frame : arrays; of Candidates, after `find_home`
    Returns:
    distance : float, m
    ended : bool; one image of the box to either side of a periodic one has been seen
    """
    least, ended = np.inf, True
    for k in range(3):
        images = grid[k, PERIODIC] * grid[k, COUNT]
        for end in range(2):
            cells = grid[k, HOME] if end == 0 else grid[k, COUNT] - 1 - grid[k, HOME]
            if ring <= cells + images:
                ended = False
            if ring <= cells + images or images:
                least = min(least, frame[end, k] + (min(ring, cells + images + 1) - 1) * frame[WIDTH, k])
    return max(least, 0.0), ended


@njit(**ONCE)
def _cells(begin, end, sx, sy, sz, i, farthest, sites, m, found):
    """Add the sites of items from begin to end, shifted by an image, that may cut; their number, -1 beyond the room."""
    x = sites.points[i, 0] - sx * sites.size[0]
    y = sites.points[i, 1] - sy * sites.size[1]
    z = sites.points[i, 2] - sz * sites.size[2]
    weight, bound = sites.weights[i], 4.0 * farthest * farthest
    code = 9 * (sx + 1) + 3 * (sy + 1) + sz + 1
    for item in range(begin, end):
        s = np.uint64(item)  # not counted from the end
        dx, dy, dz = sites.slots[s, 0] - x, sites.slots[s, 1] - y, sites.slots[s, 2] - z
        square = dx * dx + dy * dy + dz * dz
        rise = square + weight - sites.slots[s, 3]
        if rise > 0.0 and rise * rise >= bound * square:
            continue
        j = np.int64(sites.items[s])
        if j == i and code == HERE:
            continue
        # Coincident centres: the heavier hides the lighter, of equals the later number is hidden.
        if square == 0.0 and not (sites.slots[s, 3] > weight or (sites.slots[s, 3] == weight and j < i)):
            continue
        if m == len(found.label):
            m = -1
            break
        found.label[m] = 32 * j + code
        if square > 0.0:
            one = 1.0 / np.sqrt(square)
            found.plane[m, 0], found.plane[m, 1], found.plane[m, 2] = dx * one, dy * one, dz * one
            found.plane[m, 3] = 0.5 * rise * one
        else:
            found.plane[m, 3] = -np.inf
        m += 1
    return m


@njit(**PLAIN)
def _step(step, k, grid, frame):
    """Grid cells so many steps along an axis: image of the box (2: there is none), number in it, squared distance."""
    count, c = grid[k, COUNT], grid[k, HOME] + step
    image = -1 if c < 0 else np.int64(c >= count)
    if image != 0 and (grid[k, PERIODIC] == 0 or c < -count or c >= 2 * count):
        image = 2
    way = step * frame[WIDTH, k]
    gap = max(0.0, way - frame[LOW, k], -way - frame[HIGH, k])
    return image, c - image * count, gap * gap


@njit(**PLAIN)
def gather_ring(i, ring, level, farthest, sites, found):
    """Find the sites of a ring of grid cells that may cut a cell; the home belongs to ring 1.

    i, ring, level : int; site, ring >= 1 and level
    farthest : float, m; of the cell's vertices
    sites : Sites
    found : Candidates, in and out; after `find_home` for this level
    Returns int: their number; -1 if there is no room
    """
    limit = cutting_reach(farthest, sites.weights[i], sites.heaviest[level]) ** 2
    grid, frame, m = found.grid, found.frame, 0
    for a in range(-ring, ring + 1):
        sx, x, near = _step(a, 0, grid, frame)
        if sx == 2 or near >= limit:
            continue
        for b in range(-ring, ring + 1):
            sy, y, beside = _step(b, 1, grid, frame)
            beside += near
            if sy == 2 or beside >= limit:
                continue
            row = sites.first[level] + (x * grid[1, COUNT] + y) * grid[2, COUNT]
            whole = ring == 1 or abs(a) == ring or abs(b) == ring
            c = -ring
            while c <= ring:
                last, (sz, z, far) = c, _step(c, 2, grid, frame)
                if sz != 2 and beside + far < limit:
                    # Cells in a row of the same image lie side by side.
                    while whole and last < ring:
                        image, _, far = _step(last + 1, 2, grid, frame)
                        if image != sz or beside + far >= limit:
                            break
                        last += 1
                    begin, end = sites.start[row + z], sites.start[row + z + last - c + 1]
                    m = _cells(begin, end, sx, sy, sz, i, farthest, sites, m, found)
                    if m < 0:
                        return m
                c = last + 1 if whole or c == ring else ring
    return m


@njit(**PLAIN)
def arrange(found, m):
    """Put candidates in the order of their planes' distances, as far as bins tell: enough, and linear.

    found : Candidates, in and out
    m : int; their number
    """
    plane, bins, ends = found.plane, found.bin, found.bin[len(found.label) :]
    most = 0.0
    for c in range(m):
        most = max(most, plane[c, 3])
    scale = (BINS - 1) / most if most > 0.0 else 0.0
    for b in range(BINS):
        ends[b] = 0
    for c in range(m):
        bins[c] = np.uint32(plane[c, 3] * scale) if plane[c, 3] > 0.0 else 0
        ends[bins[c]] += 1
    total = 0
    for b in range(BINS):
        total += ends[b]
        ends[b] = total
    for c in range(m - 1, -1, -1):
        ends[bins[c]] -= 1
        found.order[ends[bins[c]]] = c
