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


class Polyhedron(NamedTuple):
    """A convex polyhedron around the origin, of up to p planes in slots, and scratch memory for cutting it.

    Its volume is that of normal.x <= distance for all slots in use; how many vertices are in use its owner knows.

    Attributes
    ----------
    x, y, z : (4 p,) float arrays, m
        Vertices.
    square : (4 p,) float array, m2
        Squared distance of each vertex from the origin.
    triple : (4 p, 3) int32 array
        Slots of the three planes that meet in each vertex, counter-clockwise seen from outside.
    edge : (4 p, 3) int32 array
        The vertex at the other end of the edge in which planes k and k + 1 (cyclically) of the triple meet.
    normal : (p, 3) float array
        Outward unit vectors.
    distance : (p,) float array, m
        Of the planes from the origin.
    label : (p,) int64 array
        What a plane is of, for who cuts.
    area : (p,) float array, m2
        Of the facets, by `measure`.
    above : (4 p,) float array, m
        Scratch: height of each vertex above the cutting plane.
    gone : (4 p,) int32 array
        Scratch: the vertices that are cut off.
    begins : (p,) int32 array
        Scratch: the new vertex whose triple begins with a plane.
    """

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    square: np.ndarray
    triple: np.ndarray
    edge: np.ndarray
    normal: np.ndarray
    distance: np.ndarray
    label: np.ndarray
    area: np.ndarray
    above: np.ndarray
    gone: np.ndarray
    begins: np.ndarray


@njit(cache=True)
def empty_polyhedron(most):
    """Memory of a Polyhedron of up to `most` planes."""
    return Polyhedron(
        np.empty(4 * most),
        np.empty(4 * most),
        np.empty(4 * most),
        np.empty(4 * most),
        np.empty((4 * most, 3), np.int32),
        np.empty((4 * most, 3), np.int32),
        np.empty((most, 3)),
        np.empty(most),
        np.empty(most, np.int64),
        np.empty(most),
        np.empty(4 * most),
        np.empty(4 * most, np.int32),
        np.zeros(most, np.int32),
    )


@njit(**PLAIN)
def start_box(low, high, cell):
    """Begin a polyhedron as a box; slots 2k and 2k + 1 are the low and the high side of axis k.

    Parameters
    ----------
    low, high : (3,) float arrays, m
        Corners; the origin lies between them.
    cell : Polyhedron, out

    Returns
    -------
    int
        Number of vertices, 8.
    """
    for side in range(6):
        for k in range(3):
            cell.normal[side, k] = 0.0
        cell.normal[side, side // 2] = 2 * (side % 2) - 1
        cell.distance[side] = high[side // 2] if side % 2 else -low[side // 2]
    for v in range(8):
        total = 0.0
        for k in range(3):
            end = (v >> (2 - k)) & 1
            corner = high[k] if end else low[k]
            if k == 0:
                cell.x[v] = corner
            elif k == 1:
                cell.y[v] = corner
            else:
                cell.z[v] = corner
            total += corner * corner
            cell.triple[v, k] = 2 * k + end
        cell.square[v] = total
        if (v ^ (v >> 1) ^ (v >> 2)) & 1 == 0:  # keep every triple counter-clockwise seen from outside
            cell.triple[v, 1], cell.triple[v, 2] = cell.triple[v, 2], cell.triple[v, 1]
        for k in range(3):
            # The edge of two planes runs along the axis of the third.
            cell.edge[v, k] = v ^ (4 >> (cell.triple[v, (k + 2) % 3] // 2))
    return 8


@njit(**PLAIN)
def _end(triple, w, b):
    """Where plane b stands in the triple of vertex w: its edge with the plane that follows."""
    return 0 if triple[w, 0] == b else (1 if triple[w, 1] == b else 2)


@njit(**PLAIN, inline="always")
def _heights(cell, count, slot, eps):
    """Height of each vertex above the plane in a slot; the number of those beyond it."""
    nx, ny, nz, h = cell.normal[slot, 0], cell.normal[slot, 1], cell.normal[slot, 2], cell.distance[slot]
    beyond = 0
    for v in range(count):
        cell.above[v] = nx * cell.x[v] + ny * cell.y[v] + nz * cell.z[v] - h
        beyond += cell.above[v] > eps
    return beyond


@njit(**PLAIN, inline="always")
def _add(cell, new, v, k, slot):
    """Put a new vertex where edge k of vertex v crosses the plane in a slot."""
    a, b, w = cell.triple[v, k], cell.triple[v, (k + 1) % 3], cell.edge[v, k]
    t = cell.above[v] / (cell.above[v] - min(cell.above[w], 0.0))  # what is kept within eps above the plane is on it
    x = cell.x[v] + t * (cell.x[w] - cell.x[v])
    y = cell.y[v] + t * (cell.y[w] - cell.y[v])
    z = cell.z[v] + t * (cell.z[w] - cell.z[v])
    cell.x[new], cell.y[new], cell.z[new], cell.square[new] = x, y, z, x * x + y * y + z * z
    cell.triple[new, 0], cell.triple[new, 1], cell.triple[new, 2] = a, b, slot
    cell.edge[new, 0] = w
    cell.edge[w, _end(cell.triple, w, b)] = new
    cell.begins[a] = new
    cell.above[new] = 0.0


@njit(**PLAIN, inline="always")
def _close(cell, first, total):
    """Join the new vertices from `first` on to a rim; False unless they are one simple loop."""
    v, steps = first, 0
    while steps < total - first:
        b = cell.triple[v, 1]
        w = cell.begins[b]
        if w < first or w >= total or cell.triple[w, 0] != b:
            break
        cell.edge[v, 1], cell.edge[w, 2] = w, v
        v = w
        steps += 1
        if v == first:
            break
    return v == first and steps == total - first


@njit(**PLAIN, inline="always")
def _fill(cell, beyond, total, eps):
    """Move the last vertices to the places of those that are gone; the new number of vertices."""
    left, last = total - beyond, total - 1
    for s in range(beyond):
        hole = cell.gone[s]
        if hole >= left:
            break
        while cell.above[last] > eps:
            last -= 1
        cell.x[hole], cell.y[hole], cell.z[hole] = cell.x[last], cell.y[last], cell.z[last]
        cell.square[hole] = cell.square[last]
        for k in range(3):
            w = cell.edge[last, k]
            cell.triple[hole, k], cell.edge[hole, k] = cell.triple[last, k], w
            cell.edge[w, _end(cell.triple, w, cell.triple[last, (k + 1) % 3])] = hole
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
    beyond = _heights(cell, count, slot, eps)
    if beyond == 0 or beyond == count:
        return count - beyond, 0
    total, s = count, 0
    for v in range(count):
        if cell.above[v] > eps:
            cell.gone[s] = v
            s += 1
            for k in range(3):
                if cell.above[cell.edge[v, k]] <= eps:
                    if total == len(cell.above):
                        return -1, 0
                    _add(cell, total, v, k, slot)
                    total += 1
    if total == count or not _close(cell, count, total):
        return -1, 0
    return _fill(cell, beyond, total, eps), total - count


@njit(**PLAIN)
def measure(cell, count, planes):
    """Write the facet areas of a polyhedron by slot.

    Parameters
    ----------
    cell : Polyhedron
    count : int
        Number of vertices.
    planes : int
        Slots in use: areas of those that have no facet become 0.

    Returns
    -------
    float, m3
        Its volume.
    """
    for f in range(planes):
        cell.area[f] = 0.0
    for v in range(count):
        for k in range(3):
            w = cell.edge[v, k]
            if w < v:
                continue
            # Half the cross product of both ends; seen from outside plane b is on the left of the way from v to w.
            a, b = cell.triple[v, k], cell.triple[v, (k + 1) % 3]
            x = 0.5 * (cell.y[v] * cell.z[w] - cell.z[v] * cell.y[w])
            y = 0.5 * (cell.z[v] * cell.x[w] - cell.x[v] * cell.z[w])
            z = 0.5 * (cell.x[v] * cell.y[w] - cell.y[v] * cell.x[w])
            cell.area[b] += cell.normal[b, 0] * x + cell.normal[b, 1] * y + cell.normal[b, 2] * z
            cell.area[a] -= cell.normal[a, 0] * x + cell.normal[a, 1] * y + cell.normal[a, 2] * z
    volume = 0.0
    for f in range(planes):
        volume += cell.distance[f] * cell.area[f]
    return volume / 3.0
