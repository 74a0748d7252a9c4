"""Compiled cell cutter of the radical (Laguerre, power) tessellation.

A cell is a convex polyhedron around its site. Its plane slots 0 to 5 are the sides of the start box, the others the
radical planes with neighbours, nearest first, and planes of a round wall.
"""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

from demheat.network.polyhedron_kernels import cut, empty_polyhedron, measure, start_box

OK, UNSECURED, OVERFLOW, TANGLED = 0, 1, 2, 3
# Code of the image in the box itself: no shift along any axis.
HERE = 13
# Sites cut with one scratch memory, by one thread.
CHUNK = 128


class Sites(NamedTuple):
    """Weighted points in a box, filed in a grid of cells (see `bin_points`).

    Attributes
    ----------
    points : (n, 3) float array, m
    weights : (n,) float array, m2
    heaviest : float, m2
        The largest weight.
    size : (3,) float array, m
    periodic : (3,) bool array
    counts : (3,) int64 array
        Cells of the grid along each axis.
    start : (cells + 1,) int64 array
    items : (n,) uint32 array
    """

    points: np.ndarray
    weights: np.ndarray
    heaviest: float
    size: np.ndarray
    periodic: np.ndarray
    counts: np.ndarray
    start: np.ndarray
    items: np.ndarray


class Limits(NamedTuple):
    """How far the cutter looks and what it has room for.

    Attributes
    ----------
    reach : float, m
        Sites farther than this are not looked at.
    room : int
        Sites within reach at most.
    most : int
        Planes that may cut a cell at most, and facets that it may have.
    eps : float, m
        Vertices up to so high above a plane count as below it.
    """

    reach: float
    room: int
    most: int
    eps: float


class Cut(NamedTuple):
    """What became of the cells of r rows, with up to f facets each.

    Attributes
    ----------
    status : (r,) int8 array
        OK; UNSECURED if a site beyond reach might cut the cell; OVERFLOW if the room is too small; TANGLED by rounding.
        What follows is good for cells that are OK.
    volume : (r,) float array, m3
        Zero for the cell of a hidden site.
    number : (r,) int64 array
        Of facets.
    neighbour : (r, f) int64 array
        The site beyond each facet; -1 - s for side s of the box, -7 - q for plane q of a round wall.
    image : (r, f) uint8 array
        Which periodic image of it.
    area : (r, f) float array, m2
    distance : (r, f) float array, m
        From the site to the facet's plane.
    """

    status: np.ndarray
    volume: np.ndarray
    number: np.ndarray
    neighbour: np.ndarray
    image: np.ndarray
    area: np.ndarray
    distance: np.ndarray


class _Candidates(NamedTuple):
    """Sites that may cut a cell: number, image, offset from its own site, distance of the plane, and a heap of them."""

    number: np.ndarray
    image: np.ndarray
    offset: np.ndarray
    plane: np.ndarray
    heap: np.ndarray


@njit(cache=True)
def _empty_candidates(room):
    return _Candidates(
        np.empty(room, np.int64),
        np.empty(room, np.uint8),
        np.empty((room, 3)),
        np.empty(room),
        np.empty(room, np.int64),
    )


@njit(cache=True)
def _gather(i, reach, sites, found):
    """Candidates within reach of site i; their number, or -1 if there are more than there is room for."""
    points, weights, size, counts = sites.points, sites.weights, sites.size, sites.counts
    lo = np.empty(3, np.int64)
    hi = np.empty(3, np.int64)
    for k in range(3):
        width = size[k] / counts[k]
        lo[k] = np.int64(np.floor((points[i, k] - reach) / width))
        hi[k] = np.int64(np.floor((points[i, k] + reach) / width))
        if not sites.periodic[k]:
            lo[k] = max(lo[k], 0)
            hi[k] = min(hi[k], counts[k] - 1)
        else:  # one image to either side; the driver refuses a reach beyond the box
            lo[k] = max(lo[k], -counts[k])
            hi[k] = min(hi[k], 2 * counts[k] - 1)
    m = 0
    for cx in range(lo[0], hi[0] + 1):
        sx = cx // counts[0]
        for cy in range(lo[1], hi[1] + 1):
            sy = cy // counts[1]
            for cz in range(lo[2], hi[2] + 1):
                sz = cz // counts[2]
                c = ((cx - sx * counts[0]) * counts[1] + cy - sy * counts[1]) * counts[2] + cz - sz * counts[2]
                for slot in range(sites.start[c], sites.start[c + 1]):
                    j = sites.items[slot]
                    x = points[j, 0] - points[i, 0] + sx * size[0]
                    y = points[j, 1] - points[i, 1] + sy * size[1]
                    z = points[j, 2] - points[i, 2] + sz * size[2]
                    d2 = x * x + y * y + z * z
                    image = np.uint8((sx + 1) * 9 + (sy + 1) * 3 + sz + 1)
                    if d2 > reach * reach or (j == i and image == HERE):
                        continue
                    if m == len(found.number):
                        return -1
                    found.number[m] = j
                    found.image[m] = image
                    found.offset[m, 0], found.offset[m, 1], found.offset[m, 2] = x, y, z
                    # Coincident centres: the heavier hides the lighter, of equals the later number is hidden.
                    if d2 == 0.0:
                        hides = weights[j] > weights[i] or (weights[j] == weights[i] and j < i)
                        found.plane[m] = -np.inf if hides else np.inf
                    else:
                        found.plane[m] = (d2 + weights[i] - weights[j]) / (2.0 * np.sqrt(d2))
                    m += 1
    return m


@njit(cache=True)
def _sift(heap, key, root, count):
    """Restore the heap (least key first) below root."""
    item = heap[root]
    while True:
        child = 2 * root + 1
        if child >= count:
            break
        if child + 1 < count and key[heap[child + 1]] < key[heap[child]]:
            child += 1
        if key[heap[child]] >= key[item]:
            break
        heap[root] = heap[child]
        root = child
    heap[root] = item


@njit(cache=True)
def _cut_wall(cell, count, planes, center, eps, wall, tangents, skip):
    """Cut by the planes of a round wall listed in tangents, but for the plane `skip`.

    Returns (status, vertex count, number of planes); a plane q is labelled -1 - q.
    """
    normals, middle = wall.normals, wall.middle
    for q in tangents:
        if q == skip:
            continue
        if planes == len(cell.distance):
            return OVERFLOW, 0, 0
        x, y, z = normals[q]
        h = wall.radius - x * (center[0] - middle[0]) - y * (center[1] - middle[1]) - z * (center[2] - middle[2])
        cell.normal[planes, 0], cell.normal[planes, 1], cell.normal[planes, 2], cell.distance[planes] = x, y, z, h
        count = cut(cell, count, planes, eps)
        if count < 0:
            return TANGLED, 0, 0
        if count == 0:
            return OK, 0, 0
        if cell.triple[count - 1, 2] == planes:
            cell.label[planes] = -1 - q
            planes += 1
    return OK, count, planes


@njit(cache=True)
def _misses_tangents(vertex, count, reach, center, wall):
    """Whether a plane of a round wall farther than reach from the centre might still cut the cell.

    A plane beyond which a vertex lies touches the round body within sqrt(R_v^2 - R^2) of that vertex, R_v the vertex's
    distance from the body's middle or axis.
    """
    for v in range(count):
        off, far = -(wall.radius**2), 0.0
        for k in range(3):
            off += wall.across[k] * (center[k] + vertex[v, k] - wall.middle[k]) ** 2
            far += vertex[v, k] ** 2
        if off > 0.0 and np.sqrt(far) + np.sqrt(off) > reach:
            return True
    return False


@njit(cache=True)
def _nearest(center, tangents, wall):
    """Where among the listed planes of a round wall that nearest to the centre stands; -1 for an empty list."""
    best, found = -np.inf, -1
    for t in range(len(tangents)):
        along = 0.0
        for k in range(3):
            along += wall.normals[tangents[t], k] * (center[k] - wall.middle[k])
        if along > best:
            best, found = along, t
    return found


@njit(cache=True)
def _start(i, reach, sites, wall, cell):
    """Begin the cell of site i as the box of its reach, within walls; the vertex count."""
    low, high = np.empty(3), np.empty(3)
    for k in range(3):
        low[k], high[k] = -reach, reach
        # Tangent planes enclose as much as the round body: their corners stand out of its box.
        if not sites.periodic[k] and wall.across[k] == 0.0:
            low[k], high[k] = max(low[k], -sites.points[i, k]), min(high[k], sites.size[k] - sites.points[i, k])
    return start_box(low, high, cell)


@njit(cache=True)
def _cut_sites(cell, count, planes, found, m, eps):
    """Cut by the radical planes of the m candidates, nearest first, until the next is beyond the cell.

    Returns (status, vertex count, number of planes, distance of the farthest vertex).
    """
    heap, plane, offset = found.heap, found.plane, found.offset
    for c in range(m):
        heap[c] = c
    for root in range(m // 2 - 1, -1, -1):
        _sift(heap, plane, root, m)
    farthest = np.inf
    while m > 0 and plane[heap[0]] < farthest:
        c, h = heap[0], plane[heap[0]]
        m -= 1
        heap[0] = heap[m]
        _sift(heap, plane, 0, m)
        if planes == len(cell.distance):
            return OVERFLOW, 0, 0, farthest
        if h == -np.inf:
            return OK, 0, 0, farthest
        d = np.sqrt(offset[c, 0] ** 2 + offset[c, 1] ** 2 + offset[c, 2] ** 2)
        for k in range(3):
            cell.normal[planes, k] = offset[c, k] / d
        cell.distance[planes] = h
        count = cut(cell, count, planes, eps)
        if count < 0:
            return TANGLED, 0, 0, farthest
        if count == 0:
            return OK, 0, 0, farthest
        if cell.triple[count - 1, 2] == planes:  # the newest vertices stand last, so the plane did cut
            cell.label[planes] = c
            planes += 1
            farthest = 0.0
            for v in range(count):
                farthest = max(farthest, cell.vertex[v, 0] ** 2 + cell.vertex[v, 1] ** 2 + cell.vertex[v, 2] ** 2)
            farthest = np.sqrt(farthest)
    return OK, count, planes, farthest


@njit(cache=True)
def _cell(i, sites, wall, tangents, limits, found, cell):
    """Cut the cell of site i; (status, vertex count, number of planes)."""
    reach, eps, center = limits.reach, limits.eps, sites.points[i]
    m = _gather(i, reach, sites, found)
    if m < 0:
        return OVERFLOW, 0, 0
    count, planes = _start(i, reach, sites, wall, cell), 6
    # The wall plane in front of the centre bounds the cell early; the others of the wall mostly miss it in the end.
    first = _nearest(center, tangents, wall)
    if first >= 0:
        state, count, planes = _cut_wall(cell, count, planes, center, eps, wall, tangents[first : first + 1], -1)
        if state != OK or count == 0:
            return state, 0, 0
    state, count, planes, farthest = _cut_sites(cell, count, planes, found, m, eps)
    if state != OK or count == 0:
        return state, 0, 0
    if (reach**2 + sites.weights[i] - sites.heaviest) / (2.0 * reach) < farthest:
        return UNSECURED, 0, 0
    if len(wall.normals) == 0:
        return OK, count, planes
    skip = tangents[first] if first >= 0 else -1
    state, count, planes = _cut_wall(cell, count, planes, center, eps, wall, tangents, skip)
    if state == OK and count > 0 and _misses_tangents(cell.vertex, count, reach, center, wall):
        state = UNSECURED
    return state, count, planes


@njit(cache=True)
def _note_facets(row, planes, found, cell, out):
    """Note the facets that have an area."""
    for f in range(planes):
        if cell.area[f] <= 0.0:
            continue
        e = out.number[row]
        if e == out.area.shape[1]:
            out.status[row] = OVERFLOW
            break
        label = cell.label[f]
        if f < 6:
            out.neighbour[row, e], out.image[row, e] = -1 - f, HERE
        elif label < 0:
            out.neighbour[row, e], out.image[row, e] = label - 6, HERE
        else:
            out.neighbour[row, e], out.image[row, e] = found.number[label], found.image[label]
        out.area[row, e], out.distance[row, e] = cell.area[f], cell.distance[f]
        out.number[row] = e + 1


@njit(cache=True)
def _cut_chunk(first, last, rows, sites, wall, near, limits, out):
    """Cut the cells of some rows with one scratch memory.

    Not within the parallel loop: there Numba mixes up arrays that it meets as parts of a tuple made in the loop.
    """
    found, cell = _empty_candidates(limits.room), empty_polyhedron(limits.most)
    for row in range(first, last):
        out.number[row] = 0
        out.volume[row] = 0.0
        tangents = near.planes[near.pointers[row] : near.pointers[row + 1]]
        state, count, planes = _cell(rows[row], sites, wall, tangents, limits, found, cell)
        out.status[row] = state
        if state != OK or count == 0:
            continue
        cell.area[:planes] = 0.0
        out.volume[row] = measure(cell, count)
        _note_facets(row, planes, found, cell, out)


@njit(cache=True, parallel=True)
def cut_cells(rows, sites, wall, near, limits, out):
    """Cut the cells of some sites; each thread writes its own rows only.

    Parameters
    ----------
    rows : (r,) int64 array
        Numbers of the sites.
    sites : Sites
    wall : RoundWall
        Tangent planes normal.(x - middle) <= radius; without planes for a box.
    near : Tangents
        The planes of the wall that touch the body within reach of each of these sites.
    limits : Limits
    out : Cut, out
    """
    for block in prange((len(rows) + CHUNK - 1) // CHUNK):
        _cut_chunk(block * CHUNK, min(len(rows), (block + 1) * CHUNK), rows, sites, wall, near, limits, out)
