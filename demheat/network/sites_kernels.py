"""Weighted points filed by size and place, and the search for those that may cut a radical cell, compiled.

A site at distance d with weight w cuts off points of the cell of another, weight w_i, whose farthest vertex is f away,
only if d < f + sqrt(f^2 + w - w_i). Sites are filed in grids by size, so that a few heavy ones do not make all searches
wide, and looked at in rings of grid cells around the home of the cell, until the next ring is farther than that.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from demheat.network.polyhedron_kernels import PLAIN

# Code of the image in the box itself: no shift along any axis.
HERE = 13
LOW, HIGH, WIDTH = range(3)
# Bins that candidates are put in order by.
BINS = 32


class Sites(NamedTuple):
    """Weighted points in a box, filed in grids, one for each level of weight.

    Attributes
    ----------
    points : (n, 3) float array, m
    weights : (n,) float array, m2
    size : (3,) float array, m
    periodic : (3,) bool array
    heaviest : (levels,) float array, m2
        The largest weight of each level.
    counts : (levels, 3) int64 array
        Cells of each grid along each axis.
    first : (levels,) int64 array
        Where the cells of each grid begin in `start`.
    start : int64 array
        Where each cell begins among the items; of each grid one more than it has cells.
    items : (n,) uint32 array
        Numbers of the points, those of one cell side by side and ascending.
    slots : (n, 4) float array, m and m2
        Places and weights of the items, in their order.
    """

    points: np.ndarray
    weights: np.ndarray
    size: np.ndarray
    periodic: np.ndarray
    heaviest: np.ndarray
    counts: np.ndarray
    first: np.ndarray
    start: np.ndarray
    items: np.ndarray
    slots: np.ndarray


class Candidates(NamedTuple):
    """Sites that may cut a cell, up to some room, and where its own site stands in a grid.

    Attributes
    ----------
    label : (room,) int64 array
        32 times the number of a site, plus the code of its image.
    plane : (room, 4) float array, m
        The radical plane: unit vector towards the site, distance from the cell's own; that is minus infinity for a site
        that hides the cell's own.
    order : (room,) uint32 array
        The candidates, nearest plane first as far as `arrange` tells.
    bin : (room,) uint32 array
        Scratch of `arrange`.
    home : (3,) int64 array
        Grid cell of the cell's site.
    frame : (3, 3) float array, m
        From the site to the low and to the high side of its grid cell, and the width of a grid cell, in rows LOW, HIGH
        and WIDTH.
    """

    label: np.ndarray
    plane: np.ndarray
    order: np.ndarray
    bin: np.ndarray
    home: np.ndarray
    frame: np.ndarray


@njit(cache=True)
def empty_candidates(room):
    """Uninitialised memory of up to `room` Candidates."""
    return Candidates(
        np.empty(room, np.int64),
        np.empty((room, 4)),
        np.empty(room, np.uint32),
        np.empty(room + BINS, np.uint32),
        np.empty(3, np.int64),
        np.empty((3, 3)),
    )


@njit(**PLAIN)
def cutting_reach(farthest, weight, heaviest):
    """Sites of at most some weight cut a cell only if they are nearer than this.

    Parameters
    ----------
    farthest : float, m
        Of the cell's vertices from its site.
    weight, heaviest : float, m2
        Of the cell's own site and of the others.

    Returns
    -------
    float, m
    """
    square = farthest * farthest + heaviest - weight
    return farthest + np.sqrt(square) if square > 0.0 else 0.0


@njit(**PLAIN)
def find_home(i, level, sites, found):
    """Note where a site stands in the grid of a level.

    Parameters
    ----------
    i, level : int
    sites : Sites
    found : Candidates, out
    """
    for k in range(3):
        width = sites.size[k] / sites.counts[level, k]
        # As points are filed: rounding may put one a hair beyond its cell, and the gap is then negative.
        home = np.int64(sites.points[i, k] / sites.size[k] * sites.counts[level, k])
        found.home[k] = min(max(home, 0), sites.counts[level, k] - 1)
        found.frame[LOW, k] = sites.points[i, k] - found.home[k] * width
        found.frame[HIGH, k] = width - found.frame[LOW, k]
        found.frame[WIDTH, k] = width


@njit(**PLAIN)
def ring_distance(ring, level, sites, found):
    """What a ring of grid cells keeps away from the site, and whether it and those beyond hold no cell.

    Parameters
    ----------
    ring, level : int
    sites : Sites
    found : Candidates
        After `find_home`.

    Returns
    -------
    distance : float, m
    ended : bool
        One image of the box to either side of a periodic one has been seen.
    """
    least, ended = np.inf, True
    for k in range(3):
        images = np.int64(sites.periodic[k]) * sites.counts[level, k]
        for end in range(2):
            cells = found.home[k] if end == 0 else sites.counts[level, k] - 1 - found.home[k]
            if ring <= cells + images:
                ended = False
            if ring <= cells + images or images:
                least = min(least, found.frame[end, k] + (min(ring, cells + images + 1) - 1) * found.frame[WIDTH, k])
    return max(least, 0.0), ended


@njit(**PLAIN, inline="always")
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


@njit(**PLAIN, inline="always")
def _beyond(step, k, found):
    """Squared distance along an axis from the site to the grid cells that many steps away."""
    if step == 0:
        return 0.0
    gap = found.frame[HIGH, k] if step > 0 else found.frame[LOW, k]
    gap += (abs(step) - 1) * found.frame[WIDTH, k]
    return gap * gap


@njit(**PLAIN)
def _image(c, count, periodic):
    """Which image of the box a grid cell along an axis lies in; 2 where there is none."""
    if 0 <= c < count:
        return 0
    if not periodic or c < -count or c >= 2 * count:
        return 2
    return -1 if c < 0 else 1


@njit(**PLAIN)
def gather_ring(i, ring, level, farthest, sites, found):
    """Find the sites of a ring of grid cells that may cut a cell; the home belongs to ring 1.

    Parameters
    ----------
    i, ring, level : int
        Site, ring >= 1 and level.
    farthest : float, m
        Of the cell's vertices.
    sites : Sites
    found : Candidates, in and out
        After `find_home` for this level.

    Returns
    -------
    int
        Their number; -1 if there is no room.
    """
    limit = cutting_reach(farthest, sites.weights[i], sites.heaviest[level]) ** 2
    nx, ny, nz = sites.counts[level]
    m = 0
    for a in range(-ring, ring + 1):
        near, sx = _beyond(a, 0, found), _image(found.home[0] + a, nx, sites.periodic[0])
        if sx == 2 or near >= limit:
            continue
        for b in range(-ring, ring + 1):
            beside, sy = near + _beyond(b, 1, found), _image(found.home[1] + b, ny, sites.periodic[1])
            if sy == 2 or beside >= limit:
                continue
            row = (found.home[0] + a - sx * nx) * ny + found.home[1] + b - sy * ny
            whole = ring == 1 or abs(a) == ring or abs(b) == ring
            c = -ring
            while c <= ring:
                sz, last = _image(found.home[2] + c, nz, sites.periodic[2]), c
                if sz != 2 and beside + _beyond(c, 2, found) < limit:
                    cell = sites.first[level] + row * nz + found.home[2] + c - sz * nz
                    # Cells in a row of the same image lie side by side.
                    while whole and last < ring and _image(found.home[2] + last + 1, nz, sites.periodic[2]) == sz:
                        if beside + _beyond(last + 1, 2, found) >= limit:
                            break
                        last += 1
                    begin, end = sites.start[cell], sites.start[cell + last - c + 1]
                    m = _cells(begin, end, sx, sy, sz, i, farthest, sites, m, found)
                    if m < 0:
                        return m
                c = last + 1 if whole or c == ring else ring
    return m


@njit(**PLAIN)
def arrange(found, m):
    """Put candidates in the order of their planes' distances, as far as bins tell: enough, and linear.

    Parameters
    ----------
    found : Candidates, in and out
    m : int
        Their number.
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
