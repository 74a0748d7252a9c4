"""Tetrahedra cut along a surface that is known by its inside alone (after Labelle and Shewchuk 2007).

Corners near the surface are moved onto it first, so that few of the pieces are thin; edges that still cross it are then
halved there, one after the other in an order of their own, by which neighbours agree on every face. What is done to a
node or an edge is done to its periodic twins.
"""

from typing import NamedTuple

import numpy as np

from references.mesh.cells import EDGE_COLUMN, volumes_of

EDGES = np.array(list(EDGE_COLUMN))
# Halvings of an edge: to a billionth of it.
HALVINGS = 30
# Of an edge: a corner nearer to where it crosses is moved, along an edge that crosses not farther than the second; one
# nearer than the third that cannot be moved is on the surface all the same.
NEAR, FARTHEST, ON = 0.3, 0.45, 0.02
# Of its volume, what a cell keeps at least when its corners are moved.
KEPT = 0.15


class Cells(NamedTuple):
    """Tetrahedra of a box, some of them cut."""

    points: np.ndarray  # (n, 3) float array
    cells: np.ndarray  # (m, 4) int array
    phase: np.ndarray  # (m,) int array
    twin: np.ndarray  # (n,) int array: The node that stands for each and its periodic twins
    fixed: np.ndarray  # (n,) bool array: On a surface
    box: np.ndarray  # (3,) float array


class _Crossed(NamedTuple):
    """Edges that cross a surface, the end inside first; those that are periodic twins are of one kind."""

    edges: np.ndarray  # (k, 2) int array
    part: np.ndarray  # (k,) float array: Of the edge, from its first end to where it crosses
    kind: np.ndarray  # (k,) int array
    first: np.ndarray  # (kinds,) int array: One edge of each


def cut(body: Cells, inside, number: int) -> Cells:
    """The same tetrahedra cut along a surface; what `inside` holds of points is of phase `number`."""
    sign = np.where(inside(body.points), -1, 1)[body.twin]
    crossed = _crossed(body, sign, inside)
    body, moved = _moved(body, crossed)
    sign[moved | _touched(body, crossed)] = 0
    body = _divided(body._replace(fixed=body.fixed | (sign == 0)), crossed, np.all(sign[crossed.edges] != 0, axis=1))
    side = np.append(sign, np.zeros(len(body.points) - len(sign), int))[body.cells].sum(axis=1)
    # All four corners on the surface.
    flat = np.flatnonzero(side == 0)
    side[flat] = np.where(inside(body.points[body.cells[flat]].mean(axis=1)), -1, 1)
    return body._replace(phase=np.where(side < 0, number, body.phase))


def faces_of(points, box):
    """On which of the six faces of a box each point is, (n, 6) bool array."""
    return np.concatenate([points == 0.0, points == box], axis=1)


def crossing(one, other, inside):
    """Of the way from points inside to others that are not, the part to where it leaves, (n,) float array."""
    low, high = np.zeros(len(one)), np.ones(len(one))
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        held = inside(one + middle[:, None] * (other - one))
        low, high = np.where(held, middle, low), np.where(held, high, middle)
    return 0.5 * (low + high)


def _crossed(body, sign, inside) -> _Crossed:
    count = len(body.points)
    mixed = body.cells[np.ptp(sign[body.cells], axis=1) > 0]
    edges = mixed[:, EDGES].reshape(-1, 2)
    edges = edges[sign[edges[:, 0]] != sign[edges[:, 1]]]
    edges = np.where((sign[edges[:, 0]] < 0)[:, None], edges, edges[:, ::-1])
    keys = np.unique(edges[:, 0] * count + edges[:, 1])
    edges = np.column_stack([keys // count, keys % count])
    _, first, kind = np.unique(body.twin[edges] @ [count, 1], return_index=True, return_inverse=True)
    part = crossing(*(body.points[edges[first, end]] for end in (0, 1)), inside)
    return _Crossed(edges, part[kind], kind, first)


def _moved(body, crossed):
    """Corners moved onto the surface where it is near, along an edge that stays on their faces; which they are."""
    # Both ends of each edge: the corner, the other end, and the part of the edge between the corner and the surface.
    here, there = crossed.edges.T.ravel(), crossed.edges[:, ::-1].T.ravel()
    part, kind = np.concatenate([crossed.part, 1 - crossed.part]), np.tile(crossed.kind, 2)
    way = part[:, None] * (body.points[there] - body.points[here])
    near = np.zeros(len(body.points), bool)
    near[body.twin[here[part < NEAR]]] = True
    faces = faces_of(body.points, body.box)
    free = ~body.fixed[here] & np.all(faces[here] <= faces[there], axis=1)
    able = np.flatnonzero(near[body.twin[here]] & (part < FARTHEST) & free)
    # The shortest way first, of equal ones that of the first kind, whichever twin has it.
    order = able[np.lexsort([kind[able], np.linalg.norm(way[able], axis=1), body.twin[here[able]]])]
    corner, which = np.unique(body.twin[here[order]], return_index=True)
    shift = np.zeros_like(body.points)
    shift[corner] = way[order[which]]
    return _kept_in_shape(body, shift)


def _kept_in_shape(body, shift):
    """Points that are shifted, but for those whose cells would be too flat; which are."""
    before = volumes_of(body.points[body.cells])
    while True:
        points = body.points + shift[body.twin]
        bad = body.cells[volumes_of(points[body.cells]) < KEPT * before]
        if not len(bad):
            return body._replace(points=points), np.any(shift != 0, axis=1)[body.twin]
        shift[body.twin[bad]] = 0.0


def _touched(body, crossed):
    """Corners that stayed where they were although the surface passes right beside them, (n,) bool array."""
    found = np.zeros(len(body.points), bool)
    for end, part in ((0, crossed.part), (1, 1 - crossed.part)):
        found[body.twin[crossed.edges[part < ON, end]]] = True
    return found[body.twin]


def _divided(body, crossed, kept):
    """Body with nodes where those edges that are kept cross, and cells that end there."""
    count, edges = len(body.points), crossed.edges[kept]
    one, other = body.points[edges[:, 0]], body.points[edges[:, 1]]
    number = np.full(len(crossed.edges), -1)
    number[kept] = count + np.arange(len(edges))
    new = one + crossed.part[kept, None] * (other - one)
    # The longest edge first, of equal ones that of the first kind: the same for twins.
    length = np.linalg.norm(np.diff(body.points[crossed.edges[crossed.first]], axis=1)[:, 0], axis=1)
    rank = np.empty(len(length), int)
    rank[np.argsort(-length, kind="stable")] = np.arange(len(length))
    keys = np.sort(edges, axis=1) @ [count, 1]
    order = np.argsort(keys)
    table = keys[order], rank[crossed.kind[kept]][order], number[kept][order]
    cells, phase = _halved(body.cells, body.phase, count, table)
    return body._replace(
        points=np.concatenate([body.points, new]),
        cells=cells,
        phase=phase,
        twin=np.concatenate([body.twin, number[crossed.first[crossed.kind[kept]]]]),
        fixed=np.append(body.fixed, np.ones(len(edges), bool)),
    )


def _halved(cells, phase, count, table):
    """Cells whose edges that have a node of their own are halved there, the first by rank before others."""
    keys, rank, node = table
    if not len(keys):
        return cells, phase
    done, going = [], (cells, phase)
    while len(going[0]):
        cells, phase = going
        ends = np.sort(cells[:, EDGES], axis=2)
        # Nodes of their own have no edges here: keys of theirs are of other ones only by chance.
        own = np.all(ends < count, axis=2)
        wanted = ends @ [count, 1]
        place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        none = rank.max() + 1
        ranks = np.where(own & (keys[place] == wanted), rank[place], none)
        best, rows = np.argmin(ranks, axis=1), np.arange(len(cells))
        whole = ranks[rows, best] == none
        done.append((cells[whole], phase[whole]))
        rows, best = rows[~whole], best[~whole]
        halves = np.repeat(cells[rows], 2, axis=0)
        for half in (0, 1):
            halves[np.arange(half, len(halves), 2), EDGES[best, half]] = node[place[rows, best]]
        going = halves, np.repeat(phase[rows], 2)
    return (np.concatenate(column) for column in zip(*done, strict=True))
