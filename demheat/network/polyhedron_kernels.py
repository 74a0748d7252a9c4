"""Convex polyhedra that planes are cut off from, compiled.

Every vertex is the meeting of three planes, kept as an oriented triple of plane slots with the vertices at the other
ends of its three edges; cutting by a plane takes away the vertices beyond it and closes the hole by a rim of new ones.
Memory grows with the number of planes, not with its square.
"""

from typing import NamedTuple

import numpy as np
from numba import njit


class Polyhedron(NamedTuple):
    """A convex polyhedron around the origin, of up to p planes in slots, and scratch memory for cutting it.

    Its volume is that of normal.x <= distance for all slots in use; how many vertices are in use its owner knows.

    Attributes
    ----------
    vertex : (3, 4 p) float array, m
        Coordinates, one after the other: loops over the vertices then read what is side by side.
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

    vertex: np.ndarray
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
        np.empty((3, 4 * most)),
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


@njit(cache=True)
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
            cell.vertex[k, v] = high[k] if end else low[k]
            total += cell.vertex[k, v] ** 2
            cell.triple[v, k] = 2 * k + end
        cell.square[v] = total
        if (v ^ (v >> 1) ^ (v >> 2)) & 1 == 0:  # keep every triple counter-clockwise seen from outside
            cell.triple[v, 1], cell.triple[v, 2] = cell.triple[v, 2], cell.triple[v, 1]
        for k in range(3):
            # The edge of two planes runs along the axis of the third.
            cell.edge[v, k] = v ^ (4 >> (cell.triple[v, (k + 2) % 3] // 2))
    return 8


@njit(cache=True)
def _end(triple, w, b):
    """Where plane b stands in the triple of vertex w: its edge with the plane that follows."""
    return 0 if triple[w, 0] == b else (1 if triple[w, 1] == b else 2)


@njit(cache=True)
def _heights(cell, count, slot, eps):
    """Height of each vertex above the plane in a slot; the number of those beyond it."""
    x, y, z, above = cell.vertex[0], cell.vertex[1], cell.vertex[2], cell.above
    nx, ny, nz, h = cell.normal[slot, 0], cell.normal[slot, 1], cell.normal[slot, 2], cell.distance[slot]
    beyond = 0
    for v in range(count):
        above[v] = nx * x[v] + ny * y[v] + nz * z[v] - h
        beyond += above[v] > eps
    return beyond


@njit(cache=True)
def _add(cell, new, v, k, slot):
    """Put a new vertex where edge k of vertex v crosses the plane in a slot."""
    x, y, z, above, triple = cell.vertex[0], cell.vertex[1], cell.vertex[2], cell.above, cell.triple
    a, b, w = triple[v, k], triple[v, (k + 1) % 3], cell.edge[v, k]
    t = above[v] / (above[v] - min(above[w], 0.0))  # a vertex kept within eps above the plane stands for it
    x[new] = x[v] + t * (x[w] - x[v])
    y[new] = y[v] + t * (y[w] - y[v])
    z[new] = z[v] + t * (z[w] - z[v])
    cell.square[new] = x[new] * x[new] + y[new] * y[new] + z[new] * z[new]
    triple[new, 0], triple[new, 1], triple[new, 2] = a, b, slot
    cell.edge[new, 0] = w
    cell.edge[w, _end(triple, w, b)] = new
    cell.begins[a] = new
    above[new] = 0.0


@njit(cache=True)
def _close(cell, first, total):
    """Join the new vertices from `first` on to a rim; False unless they are one simple loop."""
    triple, edge, begins = cell.triple, cell.edge, cell.begins
    v, steps = first, 0
    while steps < total - first:
        b = triple[v, 1]
        w = begins[b]
        if w < first or w >= total or triple[w, 0] != b:
            return False
        edge[v, 1], edge[w, 2] = w, v
        v = w
        steps += 1
        if v == first:
            break
    return v == first and steps == total - first


@njit(cache=True)
def _fill(cell, beyond, total, eps):
    """Move the last vertices to the places of those that are gone; the new number of vertices."""
    vertex, triple, edge, above = cell.vertex, cell.triple, cell.edge, cell.above
    left, last = total - beyond, total - 1
    for s in range(beyond):
        hole = cell.gone[s]
        if hole >= left:
            break
        while above[last] > eps:
            last -= 1
        cell.square[hole] = cell.square[last]
        for k in range(3):
            vertex[k, hole] = vertex[k, last]
            triple[hole, k] = triple[last, k]
            w = edge[last, k]
            edge[hole, k] = w
            edge[w, _end(triple, w, triple[last, (k + 1) % 3])] = hole
        last -= 1
    return left


@njit(cache=True)
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
    if beyond == 0:
        return count, 0
    if beyond == count:
        return 0, 0
    above, edge, gone = cell.above, cell.edge, cell.gone
    total, s = count, 0
    for v in range(count):
        if above[v] > eps:
            gone[s] = v
            s += 1
            for k in range(3):
                if above[edge[v, k]] <= eps:
                    if total == len(above):
                        return -1, 0
                    _add(cell, total, v, k, slot)
                    total += 1
    if total == count or not _close(cell, count, total):
        return -1, 0
    return _fill(cell, beyond, total, eps), total - count


@njit(cache=True)
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
    x, y, z = cell.vertex[0], cell.vertex[1], cell.vertex[2]
    triple, edge, normal, area = cell.triple, cell.edge, cell.normal, cell.area
    for f in range(planes):
        area[f] = 0.0
    for v in range(count):
        for k in range(3):
            w = edge[v, k]
            if w < v:
                continue
            # Seen from outside the edge runs from v to w with plane b on its left and a on its right.
            a, b = triple[v, k], triple[v, (k + 1) % 3]
            cx = 0.5 * (y[v] * z[w] - z[v] * y[w])
            cy = 0.5 * (z[v] * x[w] - x[v] * z[w])
            cz = 0.5 * (x[v] * y[w] - y[v] * x[w])
            area[b] += normal[b, 0] * cx + normal[b, 1] * cy + normal[b, 2] * cz
            area[a] -= normal[a, 0] * cx + normal[a, 1] * cy + normal[a, 2] * cz
    volume = 0.0
    for f in range(planes):
        volume += cell.distance[f] * area[f]
    return volume / 3.0
