"""Convex polyhedra that planes are cut off from, compiled.

Every vertex is the meeting of three planes, kept as an oriented triple of plane slots; cutting by a plane removes the
vertices beyond the plane and closes the hole by a fan of new ones.
"""

from typing import NamedTuple

import numpy as np
from numba import njit


class Polyhedron(NamedTuple):
    """A convex polyhedron around the origin, of up to p planes in slots, and scratch memory for cutting it.

    Its volume is that of normal.x <= distance for all slots in use; how many vertices are in use its owner knows.

    Attributes
    ----------
    vertex : (4 p, 3) float array, m
    triple : (4 p, 3) int16 array
        Slots of the three planes that meet in each vertex, counter-clockwise seen from outside.
    owner : (p, p) int16 array
        The vertex whose triple holds a and then b, cyclically, stands at [a, b].
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
    edge : (4 p, 4) int64 array
        Scratch: two planes of each cut edge, its vertex beyond the plane and that on this side.
    follow : (p,) int64 array
        Scratch: the plane that follows another along the rim of the cut.
    """

    vertex: np.ndarray
    triple: np.ndarray
    owner: np.ndarray
    normal: np.ndarray
    distance: np.ndarray
    label: np.ndarray
    area: np.ndarray
    above: np.ndarray
    edge: np.ndarray
    follow: np.ndarray


@njit(cache=True)
def empty_polyhedron(most):
    """Uninitialised memory of a Polyhedron of up to `most` planes."""
    return Polyhedron(
        np.empty((4 * most, 3)),
        np.empty((4 * most, 3), np.int16),
        np.empty((most, most), np.int16),
        np.empty((most, 3)),
        np.empty(most),
        np.empty(most, np.int64),
        np.empty(most),
        np.empty(4 * most),
        np.empty((4 * most, 4), np.int64),
        np.empty(most, np.int64),
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
    vertex = cell.vertex
    v = 0
    for a in range(2):
        for b in range(2):
            for c in range(2):
                vertex[v, 0] = high[0] if a else low[0]
                vertex[v, 1] = high[1] if b else low[1]
                vertex[v, 2] = high[2] if c else low[2]
                p, q, r = a, 2 + b, 4 + c
                if (a + b + c) % 2 == 0:  # keep every triple counter-clockwise seen from outside
                    q, r = r, q
                _put(v, p, q, r, cell.triple, cell.owner)
                v += 1
    return v


@njit(cache=True)
def _put(v, p, q, r, triple, owner):
    triple[v, 0], triple[v, 1], triple[v, 2] = p, q, r
    owner[p, q] = v
    owner[q, r] = v
    owner[r, p] = v


@njit(cache=True)
def cut(cell, count, slot, eps):
    """Cut a polyhedron by the plane in a slot that it does not use yet.

    Parameters
    ----------
    cell : Polyhedron
        Normal and distance of the slot are set. The newest vertices stand last: the plane did cut if the last vertex
        has it.
    count : int
        Number of vertices.
    slot : int
    eps : float, m
        Vertices up to so high above the plane count as below it.

    Returns
    -------
    int
        The new number of vertices: the old one if the plane misses, 0 if nothing is left, -1 where rounding tangles.
    """
    vertex, triple, owner = cell.vertex, cell.triple, cell.owner
    above, edge, follow = cell.above, cell.edge, cell.follow
    nx, ny, nz, h = cell.normal[slot, 0], cell.normal[slot, 1], cell.normal[slot, 2], cell.distance[slot]
    removed = 0
    for v in range(count):
        above[v] = nx * vertex[v, 0] + ny * vertex[v, 1] + nz * vertex[v, 2] - h
        if above[v] > eps:
            removed += 1
    if removed == 0:
        return count
    if removed == count:
        return 0
    edges = 0
    for v in range(count):
        if above[v] > eps:
            for k in range(3):
                a, b = triple[v, k], triple[v, (k + 1) % 3]
                if above[owner[b, a]] <= eps:
                    edge[edges, 0], edge[edges, 1], edge[edges, 2], edge[edges, 3] = a, b, v, owner[b, a]
                    follow[a] = b
                    edges += 1
    # The hole must be bounded by one simple loop.
    a, steps = edge[0, 0], 0
    while True:
        a = follow[a]
        steps += 1
        if a == edge[0, 0] or steps > edges:
            break
    if steps != edges or count + edges > len(vertex):
        return -1
    total = count
    for e in range(edges):
        v, w = edge[e, 2], edge[e, 3]
        t = above[v] / (above[v] - min(above[w], 0.0))  # a vertex kept within eps above the plane stands for it
        for k in range(3):
            vertex[total, k] = vertex[v, k] + t * (vertex[w, k] - vertex[v, k])
        triple[total, 0], triple[total, 1], triple[total, 2] = edge[e, 0], edge[e, 1], slot
        above[total] = 0.0
        total += 1
    kept = 0
    for v in range(total):
        if above[v] <= eps:
            for k in range(3):
                vertex[kept, k] = vertex[v, k]
            _put(kept, triple[v, 0], triple[v, 1], triple[v, 2], triple, owner)
            kept += 1
    return kept


@njit(cache=True)
def measure(cell, count):
    """Write the facet areas of a polyhedron by slot; only those of planes that a vertex has are touched.

    Parameters
    ----------
    cell : Polyhedron
    count : int
        Number of vertices.

    Returns
    -------
    float, m3
        Its volume.
    """
    vertex, triple, owner = cell.vertex, cell.triple, cell.owner
    normal, distance, area = cell.normal, cell.distance, cell.area
    for v in range(count):
        for k in range(3):
            area[triple[v, k]] = 0.0
    for v in range(count):
        for k in range(3):
            f, b = triple[v, k], triple[v, (k + 2) % 3]
            w = owner[f, b]
            cx = vertex[v, 1] * vertex[w, 2] - vertex[v, 2] * vertex[w, 1]
            cy = vertex[v, 2] * vertex[w, 0] - vertex[v, 0] * vertex[w, 2]
            cz = vertex[v, 0] * vertex[w, 1] - vertex[v, 1] * vertex[w, 0]
            area[f] += 0.5 * (normal[f, 0] * cx + normal[f, 1] * cy + normal[f, 2] * cz)
    volume = 0.0
    for v in range(count):
        for k in range(3):
            f = triple[v, k]
            # Each facet is met once per vertex: count it at its lowest vertex only.
            first, w = True, owner[f, triple[v, (k + 2) % 3]]
            while w != v:
                if w < v:
                    first = False
                    break
                m = 0
                while triple[w, m] != f:
                    m += 1
                w = owner[f, triple[w, (m + 2) % 3]]
            if first:
                volume += distance[f] * area[f] / 3.0
    return volume
