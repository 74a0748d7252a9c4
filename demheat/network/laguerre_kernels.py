"""Compiled cell cutter of the radical (Laguerre, power) tessellation.

A cell is a convex polyhedron around its site. Its plane slots 0 to 5 are the sides of the start box, the others the
radical planes with neighbours and planes of a round wall. Sites are looked at ring by ring until those left cannot cut.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from demheat.network.polyhedron_kernels import (
    AREA,
    DISTANCE,
    ONCE,
    PLAIN,
    X,
    Y,
    Z,
    beyond,
    cut,
    measure,
    start_box,
)
from demheat.network.repeated_kernels import repeat_cell
from demheat.network.sites_kernels import (
    HIGH,
    LOW,
    arrange,
    cutting_reach,
    find_home,
    gather_ring,
    ring_distance,
)

OK, UNSECURED, OVERFLOW, TANGLED, NARROW, CROWDED = 0, 1, 2, 3, 4, 5
# Sites whose facets are noted in one place, by one thread.
CHUNK = 128
# Planes, and sites that may cut, that there is room for at first: enough for most cells of most packings.
PLANES, ROOM = 96, 192
# Times that a cell is begun at most; each time what was lacking is doubled or more.
MOST_TIMES = 40


class Limits(NamedTuple):
    """How the cutter begins and what it gives up at."""

    box: float  # m: Half the edge of the box that the cell of the lightest site starts from
    widest: float  # m: Half the edge beyond which no start box need go
    # eps, coarsest: m: Vertices up to so high above a plane count as below it, at first and at last
    eps: float
    coarsest: float
    reach: float  # m: Planes of a round wall farther than this were not listed
    lightest: float  # m2: The least weight
    flat: np.ndarray  # (3,) bool array: Across which axes the box has flat walls
    sliver: float  # m2: Facets up to this area are rounding where more than four cells meet in one point, and left out


class Cut(NamedTuple):
    """What became of the cells of r rows, and the facets of c chunks of them."""

    # (r,) int8 array: OK; UNSECURED if a site or a plane of a round wall beyond what was seen might cut the cell;
    # TANGLED by rounding. What follows is good for cells that are OK
    status: np.ndarray
    times: np.ndarray  # (r,) uint8 array: How often the cell was begun, 0 at first: more than once is rare
    volume: np.ndarray  # (r,) float array, m3: Zero for the cell of a hidden site
    # links, ends: (r,) int32 arrays: Numbers of facets towards other sites and towards walls
    links: np.ndarray
    ends: np.ndarray
    # (c, 2) int64 array: Facets of each chunk, towards sites and towards walls; if both are more than there is room
    # for, some are wrong
    used: np.ndarray
    # (c, room) uint32 array: The site beyond each facet from the front on; from the back on side s of the box, or 6 + q
    # for plane q of a round wall
    neighbour: np.ndarray
    image: np.ndarray  # (c, room) uint8 array: Which periodic image of a site
    area: np.ndarray  # (c, room) float array, m2
    distance: np.ndarray  # (c, room) float array, m: From the site to the facet's plane


@njit(**ONCE)
def _farthest(vertex, count):
    """Distance of the farthest of some vertices from the site."""
    most = 0.0
    for v in range(count):
        square = vertex[X, v] ** 2 + vertex[Y, v] ** 2 + vertex[Z, v] ** 2
        if square > most:
            most = square
    return np.sqrt(most)


@njit(**PLAIN)
def _cut_wall(cell, count, planes, center, eps, wall, tangents, skip):
    """Cut by the planes of a round wall listed in tangents, but for the plane `skip`.

    Returns (status, vertex count, number of planes); a plane q is labelled -1 - q.
    """
    normals, middle = wall.normals, wall.middle
    for q in tangents:
        if q == skip:
            continue
        if planes == len(cell.label):
            return OVERFLOW, 0, 0
        cell.plane[planes, DISTANCE] = wall.radius
        for k in range(3):
            cell.plane[planes, k] = normals[q, k]
            cell.plane[planes, DISTANCE] -= normals[q, k] * (center[k] - middle[k])
        count, new = cut(cell, count, planes, eps)
        if count < 0:
            return TANGLED, 0, 0
        if count == 0:
            return OK, 0, 0
        if new > 0:
            cell.label[planes] = -1 - q
            planes += 1
    return OK, count, planes


@njit(**ONCE)
def _misses_tangents(cell, count, reach, center, wall):
    """Whether a plane of a round wall farther than reach from the centre might still cut the cell.

    A plane beyond which a vertex lies touches the round body within sqrt(R_v^2 - R^2) of that vertex, R_v the vertex's
    distance from the body's middle or axis.
    """
    for v in range(count):
        off, square = -(wall.radius**2), 0.0
        for k in range(3):
            off += wall.across[k] * (center[k] + cell.vertex[k, v] - wall.middle[k]) ** 2
            square += cell.vertex[k, v] ** 2
        if off > 0.0 and np.sqrt(square) + np.sqrt(off) > reach:
            return True
    return False


@njit(**ONCE)
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


@njit(**ONCE)
def _start(i, half, sites, flat, found, cell):
    """Begin the cell of site i as a box of that half edge, within flat walls; the vertex count."""
    low, high = found.frame[LOW], found.frame[HIGH]
    for k in range(3):
        low[k], high[k] = -half, half
        if flat[k]:
            low[k], high[k] = max(low[k], -sites.points[i, k]), min(high[k], sites.size[k] - sites.points[i, k])
        cell.label[2 * k] = NARROW if low[k] == -half else 0
        cell.label[2 * k + 1] = NARROW if high[k] == half else 0
    return start_box(low, high, cell)


@njit(**ONCE)
def _cut_sites(cell, count, planes, farthest, found, m, eps):
    """Cut by the radical planes of the m candidates, the nearest first.

    Returns (status, vertex count, number of planes, distance of the farthest vertex).
    """
    plane, state = found.plane, OK
    arrange(found, m)
    for rank in range(m):
        c = found.order[rank]
        h = plane[c, 3]
        if h >= farthest:
            continue
        # Most planes miss: that is found here, where it costs least.
        gone = beyond(cell, count, plane[c, 0], plane[c, 1], plane[c, 2], h + eps) if h > -np.inf else count
        if gone == 0:
            continue
        if gone == count or planes == len(cell.label):
            state, count = OK if gone == count else OVERFLOW, 0
            break
        for k in range(4):
            cell.plane[planes, k] = plane[c, k]
        cell.label[planes] = found.label[c]
        count, _ = cut(cell, count, planes, eps)
        if count < 0:
            state, count = TANGLED, 0
            break
        planes += 1
        farthest = _farthest(cell.vertex, count)
    return state, count, planes, farthest


@njit(**ONCE)
def _cut_level(i, level, sites, cell, count, planes, found, eps):
    """Cut by the sites of a level, ring by ring, until those left cannot; (status, vertex count, number of planes)."""
    farthest, ring = _farthest(cell.vertex, count), 1
    find_home(i, level, sites, found)
    while True:
        m = gather_ring(i, ring, level, farthest, sites, found)
        if m < 0:
            return CROWDED, 0, 0
        if m > 0:
            state, count, planes, farthest = _cut_sites(cell, count, planes, farthest, found, m, eps)
            if state != OK or count == 0:
                return state, 0, 0
        ring += 1
        distance, ended = ring_distance(ring, found.grid, found.frame)
        if distance >= cutting_reach(farthest, sites.weights[i], sites.heaviest[level]):
            return OK, count, planes
        if ended:
            return UNSECURED, count, planes


@njit(**ONCE)
def _secured(i, sites, farthest):
    """Whether no site of any level that lies beyond one image of the box to either side might still cut the cell."""
    least = np.inf
    for k in range(3):
        if sites.periodic[k]:
            off = min(sites.points[i, k], sites.size[k] - sites.points[i, k])
            least = min(least, sites.size[k] + off)
    heaviest = sites.heaviest[len(sites.heaviest) - 1]
    return least >= cutting_reach(farthest, sites.weights[i], heaviest)


@njit(**ONCE)
def _cell(i, half, sites, wall, tangents, eps, limits, found, cell):
    """Cut the cell of site i from a box of that half edge; (status, vertex count, number of planes)."""
    count, planes, state, first = _start(i, half, sites, limits.flat, found, cell), 6, OK, -1
    if wall is not None:
        # The plane in front of the centre bounds the cell early; the others of the wall mostly miss it in the end.
        first = _nearest(sites.points[i], tangents, wall)
        if first >= 0:
            one = tangents[first : first + 1]
            state, count, planes = _cut_wall(cell, count, planes, sites.points[i], eps, wall, one, -1)
    # Sites of its own level are all round it, those of others perhaps far away: the cell is small when they are met.
    own, wide = 0, False
    while sites.heaviest[own] < sites.weights[i]:
        own += 1
    for turn in range(len(sites.heaviest)):
        level = own if turn == 0 else turn - 1 if turn <= own else turn
        if state != OK or count == 0:
            return state, 0, 0
        state, count, planes = _cut_level(i, level, sites, cell, count, planes, found, eps)
        if state == UNSECURED and len(sites.heaviest) > 1:
            state, wide = OK, True
    if state != OK or count == 0:
        return state, 0, 0
    if wide and not _secured(i, sites, _farthest(cell.vertex, count)):
        return UNSECURED, 0, 0
    if wall is not None:
        skip = tangents[first] if first >= 0 else -1
        state, count, planes = _cut_wall(cell, count, planes, sites.points[i], eps, wall, tangents, skip)
        if state == OK and count > 0 and _misses_tangents(cell, count, limits.reach, sites.points[i], wall):
            state = UNSECURED
    return state, count, planes


@njit(**PLAIN)
def _note_facets(row, chunk, planes, cell, sliver, out):
    """Note the facets of more than a sliver's area at the end of a chunk's."""
    links, ends, room = out.used[chunk, 0], out.used[chunk, 1], out.area.shape[1]
    for f in range(planes):
        area = cell.plane[f, AREA]
        if area <= sliver:
            continue
        label = cell.label[f]
        inner = f >= 6 and label >= 0
        if links + ends < room:
            e = links if inner else room - 1 - ends
            out.neighbour[chunk, e] = label >> 5 if inner else (f if f < 6 else 5 - label)
            out.image[chunk, e] = label & 31
            out.area[chunk, e], out.distance[chunk, e] = area, cell.plane[f, DISTANCE]
        links += inner
        ends += not inner
    out.links[row], out.ends[row] = links - out.used[chunk, 0], ends - out.used[chunk, 1]
    out.used[chunk, 0], out.used[chunk, 1] = links, ends


@njit(**PLAIN, nogil=True)
def cut_cells(first, last, chunks, start, sites, known, wall, near, limits, found, cell, out):
    """Cut the cells of some chunks of CHUNK rows, those in places from first / CHUNK to last / CHUNK in a list.

    Cells that are known are noted as they are. Each chunk has rows and facets of its own. Python's lock is not held:
    threads may cut other chunks meanwhile.

    first, last : int; CHUNK times places; to go on, more
    chunks : (c,) int64 array; numbers of the chunks among the rows of `out`
    start : int; the site of its first row
    sites : Sites
    known : Known
    wall : RoundWall or None; tangent planes normal.(x - middle) <= radius; None for a box, for which half as much is
      compiled
    near : Tangents or None; the planes of the wall that touch the body within reach of each row's site
    limits : Limits
    found : Candidates; scratch memory
    cell : Polyhedron; scratch memory
    out : Cut, in and out
    Returns int: `last`; less if a cell needs more scratch memory: where to go on with more
    """
    for at in range(first, last):
        place, within = at // CHUNK, at % CHUNK
        row = chunks[place] * CHUNK + within
        if within == 0:
            out.used[place, 0], out.used[place, 1] = 0, 0
        if row >= len(out.status):
            continue
        i = start + row
        if repeat_cell(i, row, place, known, out):
            continue
        half = min(limits.box + 2.0 * np.sqrt(sites.weights[i] - limits.lightest), limits.widest)
        eps, state, count, planes, volume, tangents = limits.eps, OK, 0, 0, 0.0, None
        if near is not None:
            tangents = near.planes[near.pointers[row] : near.pointers[row + 1]]
        while out.times[row] < MOST_TIMES:
            out.times[row] += 1
            state, count, planes = _cell(i, half, sites, wall, tangents, eps, limits, found, cell)
            if state == OK and count > 0:
                volume = measure(cell, count, planes)
                for side in range(6):
                    # A side of the start box that is no wall still bounds the cell.
                    if half < limits.widest and cell.label[side] == NARROW and cell.plane[side, AREA] > 0.0:
                        state = NARROW
            if state == CROWDED or state == OVERFLOW:
                return at
            if state == NARROW:
                half = min(4.0 * half, limits.widest)
            elif state == TANGLED and eps < limits.coarsest:
                eps *= 4.0
            else:
                break
        out.status[row], out.volume[row], out.links[row], out.ends[row] = state, 0.0, 0, 0
        if state == OK and count > 0:
            out.volume[row] = volume
            _note_facets(row, place, planes, cell, limits.sliver, out)
    return last
