"""Convex polyhedra that planes are cut off from, compiled.

Functions here that make no array are compiled without Numba's counting of references to them, which is most of the time
of a function this short.

Every vertex is the meeting of three planes, kept as an oriented triple of plane slots with the vertices at the other
ends of its three edges; cutting by a plane takes away the vertices beyond it and closes the hole by a rim of new ones.
Memory grows with the number of planes, not with its square.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

# Options of functions that make no array: no references are counted, and no division is checked.
PLAIN = {"cache": True, "error_model": "numpy", "_nrt": False}
# Of functions called in one place: what Numba inlines itself it compiles once, not at every level of its callers, and
# hands no arrays on, each of which is a dozen arguments.
ONCE = {**PLAIN, "inline": "always"}
# Where things stand in the arrays of a Polyhedron: few arrays are quick to hand on, and quick to compile.
X, Y, Z, ABOVE = range(4)
EDGE, GONE, BEGINS = 3, 6, 7
DISTANCE, AREA = 3, 4


class Polyhedron(NamedTuple):
    """A convex polyhedron around the origin, of up to p planes in slots, and scratch memory for cutting it.

    Its volume is that of normal.x <= distance for all slots in use; how many vertices are in use its owner knows.
    """

    # (4, 4 p) float array, m: Places of the vertices in rows X, Y and Z; row ABOVE is scratch: heights above the
    # cutting plane
    vertex: np.ndarray
    # (4 p, 8) uint32 array: Of each vertex: the slots of the three planes that meet there, counter-clockwise seen from
    # outside; from EDGE on the vertices at the other ends of the edges in which planes k and k + 1 (cyclically) of the
    # three meet. Columns GONE and BEGINS are scratch lists: vertices that are cut off, and for each plane the new
    # vertex that begins with it
    corner: np.ndarray
    # (p, 5) float array, m and m2: Outward unit normals, DISTANCE from the origin, and AREA of the facets by `measure`
    plane: np.ndarray
    label: np.ndarray  # (p,) int64 array: What a plane is of, for who cuts


def empty_polyhedron(most):
    """Memory of a Polyhedron of up to `most` planes."""
    return Polyhedron(
        np.empty((4, 4 * most)),
        np.zeros((4 * most, 8), np.uint32),
        np.empty((most, 5)),
        np.empty(most, np.int64),
    )


@njit(**PLAIN)
def start_box(low, high, cell):
    """Begin a polyhedron as a box; slots 2k and 2k + 1 are the low and the high side of axis k.

    low, high : (3,) float arrays, m; corners; the origin lies between them
    cell : Polyhedron, out
    Returns int: number of vertices, 8
    """
    corner = cell.corner
    for side in range(6):
        for k in range(3):
            cell.plane[side, k] = 0.0
        cell.plane[side, side // 2] = 2 * (side % 2) - 1
        cell.plane[side, DISTANCE] = high[side // 2] if side % 2 else -low[side // 2]
    for v in range(8):
        for k in range(3):
            end = (v >> (2 - k)) & 1
            cell.vertex[k, v] = high[k] if end else low[k]
            corner[v, k] = 2 * k + end
        if (v ^ (v >> 1) ^ (v >> 2)) & 1 == 0:  # keep every triple counter-clockwise seen from outside
            corner[v, 1], corner[v, 2] = corner[v, 2], corner[v, 1]
        for k in range(3):
            # The edge of two planes runs along the axis of the third.
            corner[v, EDGE + k] = v ^ (4 >> (corner[v, (k + 2) % 3] // 2))
    return 8


@njit(**ONCE)
def beyond(cell, count, x, y, z, limit):
    """How many of the vertices have a larger product with a vector than that.

    cell : Polyhedron
    count : int; number of vertices
    x, y, z : float
    limit : float, m
    Returns int
    """
    number = 0
    for v in range(count):
        number += x * cell.vertex[X, v] + y * cell.vertex[Y, v] + z * cell.vertex[Z, v] > limit
    return number


@njit(**PLAIN)
def _end(corner, w, b):
    """Where plane b stands in the triple of vertex w: its edge with the plane that follows."""
    return 0 if corner[w, 0] == b else (1 if corner[w, 1] == b else 2)


@njit(**ONCE)
def _heights(cell, count, slot):
    """Note the height of each vertex above the plane in a slot."""
    x, y, z, h = cell.plane[slot, 0], cell.plane[slot, 1], cell.plane[slot, 2], cell.plane[slot, DISTANCE]
    for v in range(count):
        cell.vertex[ABOVE, v] = x * cell.vertex[X, v] + y * cell.vertex[Y, v] + z * cell.vertex[Z, v] - h


@njit(**ONCE)
def _add(cell, new, v, k, slot):
    """Put a new vertex where edge k of vertex v crosses the plane in a slot."""
    vertex, corner = cell.vertex, cell.corner
    a, b, w = corner[v, k], corner[v, (k + 1) % 3], corner[v, EDGE + k]
    t = vertex[ABOVE, v] / (vertex[ABOVE, v] - min(vertex[ABOVE, w], 0.0))  # what is kept within eps above is on it
    for axis in range(3):
        vertex[axis, new] = vertex[axis, v] + t * (vertex[axis, w] - vertex[axis, v])
    vertex[ABOVE, new] = 0.0
    corner[new, 0], corner[new, 1], corner[new, 2], corner[new, EDGE] = a, b, slot, w
    corner[w, EDGE + _end(corner, w, b)] = new
    corner[a, BEGINS] = new


@njit(**ONCE)
def _close(corner, first, total):
    """Join the new vertices from `first` on to a rim; False unless they are one simple loop."""
    v, steps = first, 0
    while steps < total - first:
        b = corner[v, 1]
        w = np.int64(corner[b, BEGINS])
        if w < first or w >= total or corner[w, 0] != b:
            break
        corner[v, EDGE + 1], corner[w, EDGE + 2] = w, v
        v = w
        steps += 1
        if v == first:
            break
    return v == first and steps == total - first


@njit(**ONCE)
def _fill(cell, gone, total, eps):
    """Move the last vertices to the places of those that are gone; the new number of vertices."""
    vertex, corner = cell.vertex, cell.corner
    left, last = total - gone, total - 1
    for s in range(gone):
        hole = corner[s, GONE]
        if hole >= left:
            break
        while vertex[ABOVE, last] > eps:
            last -= 1
        for axis in range(3):
            vertex[axis, hole] = vertex[axis, last]
        for k in range(3):
            w = corner[last, EDGE + k]
            corner[hole, k], corner[hole, EDGE + k] = corner[last, k], w
            corner[w, EDGE + _end(corner, w, corner[last, (k + 1) % 3])] = hole
        last -= 1
    return left


@njit(**PLAIN)
def cut(cell, count, slot, eps):
    """Cut a polyhedron by the plane in a slot that it does not use yet.

    Parameters
    ----------
    cell : Polyhedron
        Normal and distance of the slot are set.
    count : int
        Number of vertices.
    slot : int
    eps : float, m
        Vertices up to so high above the plane count as below it.

    Returns
    -------
    count : int
        The new number of vertices: 0 if nothing is left, -1 where rounding tangles, which spoils the polyhedron.
    new : int
        How many of them lie on the plane: 0 if it misses, and the polyhedron is as it was.
    """
    _heights(cell, count, slot)
    vertex, corner = cell.vertex, cell.corner
    total, gone = count, 0
    for v in range(count):
        if vertex[ABOVE, v] > eps:
            corner[gone, GONE] = v
            gone += 1
            for k in range(3):
                if vertex[ABOVE, corner[v, EDGE + k]] <= eps:
                    if total == vertex.shape[1]:
                        return -1, 0
                    _add(cell, total, v, k, slot)
                    total += 1
    if gone == 0 or gone == count:
        return count - gone, 0
    if total == count or not _close(corner, count, total):
        return -1, 0
    return _fill(cell, gone, total, eps), total - count


@njit(**PLAIN)
def measure(cell, count, planes):
    """Write the facet areas of a polyhedron by slot.

    cell : Polyhedron
    count : int; number of vertices
    planes : int; slots in use: areas of those that have no facet become 0
    Returns float, m3: its volume
    """
    vertex, corner, plane = cell.vertex, cell.corner, cell.plane
    for f in range(planes):
        plane[f, AREA] = 0.0
    for v in range(count):
        for k in range(3):
            w = corner[v, EDGE + k]
            if w < v:
                continue
            # Half the cross product of both ends; seen from outside plane b is on the left of the way from v to w.
            a, b = corner[v, k], corner[v, (k + 1) % 3]
            x = 0.5 * (vertex[Y, v] * vertex[Z, w] - vertex[Z, v] * vertex[Y, w])
            y = 0.5 * (vertex[Z, v] * vertex[X, w] - vertex[X, v] * vertex[Z, w])
            z = 0.5 * (vertex[X, v] * vertex[Y, w] - vertex[Y, v] * vertex[X, w])
            plane[b, AREA] += plane[b, 0] * x + plane[b, 1] * y + plane[b, 2] * z
            plane[a, AREA] -= plane[a, 0] * x + plane[a, 1] * y + plane[a, 2] * z
    volume = 0.0
    for f in range(planes):
        volume += plane[f, DISTANCE] * plane[f, AREA]
    return volume / 3.0
