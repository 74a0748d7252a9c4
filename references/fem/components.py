"""What pores leave of a mesh: bodies of conducting elements, and those that no heat can pass in a steady state."""

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from references.fem.elements import at_quadrature

# Of the rises that cancel in a sum: those of a closed way across the mean gradient leave rounding only.
ROUNDING = 1e-12


class Bodies(NamedTuple):
    """Bodies of a mesh with pores."""

    # node, element: (n,) and (m,) int arrays: Body of each; -1 in pores
    node: np.ndarray
    element: np.ndarray
    # (n, 3) int array: Boxes by which a node is moved to where its body reaches it from its first piece
    shift: np.ndarray
    passing: np.ndarray  # (number of bodies,) bool array: Whether heat passes
    # (number of bodies,) float array, K or degrees Celsius: Temperature of the wall that a body reaches where no heat
    # passes, else NaN
    level: np.ndarray

    @property
    def still(self):
        """Elements that no heat passes, pores included, (m,) bool array."""
        return np.append(~self.passing, True)[self.element]


def find(scene, mesh) -> Bodies:
    """Bodies of a scene on a mesh."""
    solid = scene.mean_conductivities[mesh.phase] > 0
    jump = np.array(scene.gradient) * scene.size if scene.periodic else np.zeros(3)
    node, shift, climbs = gathered(scene, mesh, solid, mesh.pairs, jump)
    element = np.where(solid, node[mesh.cells[:, 0]], -1)
    passing, level = climbs, np.full(len(climbs), np.nan)
    if not scene.periodic:
        passing, level = _at_walls(scene, mesh, node, solid, len(climbs))
    return Bodies(node, element, shift, passing, level)


def gathered(scene, mesh, chosen, pairs, jump):
    """Body of each node of some elements, -1 elsewhere; boxes by which it is moved there; which bodies climb a jump."""
    piece, count = _pieces(mesh, chosen)
    body, shift, climbs = _joined(*_seams(scene, mesh, piece, pairs), count, jump)
    return np.append(body, -1)[piece], np.vstack([shift, np.zeros((1, 3), int)])[piece], climbs


def settle(found: Bodies, scene, mesh, temperature) -> None:
    """Give bodies that no heat passes their temperature, in a periodic cell all bodies their level, in place."""
    settle_still(found, scene, temperature)
    if not scene.periodic:
        return
    gradient = np.array(scene.gradient)
    total, mass = np.zeros((2, len(found.passing) + 1))
    for ids, points, volumes, values, _ in at_quadrature(mesh, temperature):
        rest = values - points @ gradient
        np.add.at(total, found.element[ids], (volumes * rest).sum(axis=1))
        np.add.at(mass, found.element[ids], volumes.sum(axis=1))
    mean = total / np.where(mass > 0, mass, 1.0)
    inside = found.node >= 0
    temperature[inside] -= mean[found.node[inside]]


def settle_still(found: Bodies, scene, temperature) -> None:
    """Give nodes of bodies that no heat passes the temperature of a wall, in a periodic cell one without a gradient."""
    still = np.append(~found.passing, False)[found.node]
    if scene.periodic:
        temperature[still] = -found.shift[still] @ (np.array(scene.gradient) * scene.size)
        return
    level = np.append(found.level, np.nan)[found.node]
    known = still & np.isfinite(level)
    temperature[known] = level[known]


def extend(found: Bodies, mesh, temperature) -> None:
    """Give nodes in pores the temperature of the nearest body, in place: elements there may reach past an interface."""
    inside = np.flatnonzero(found.node >= 0)
    if len(inside):
        outside = np.flatnonzero(found.node < 0)
        temperature[outside] = temperature[inside[cKDTree(mesh.points[inside]).query(mesh.points[outside])[1]]]


def reached(found: Bodies, scene, temperature):
    """The temperature of nodes, NaN in bodies that no wall's temperature reaches."""
    lost = np.append(~found.passing & np.isnan(found.level) & (not scene.periodic), False)
    return np.where(lost[found.node], np.nan, temperature)


def _pieces(mesh, solid):
    """Piece of each node in the box, joined by conducting elements, -1 in pores; their number."""
    cells = mesh.cells[solid].astype(np.int64)
    first = np.repeat(cells[:, 0], cells.shape[1] - 1)
    ones = np.ones(len(first), bool)
    graph = sparse.coo_matrix((ones, (first, cells[:, 1:].ravel())), shape=(len(mesh.points),) * 2)
    _, label = connected_components(graph, directed=False)
    piece = np.full(len(mesh.points), -1)
    used = np.unique(cells)
    numbers, piece[used] = np.unique(label[used], return_inverse=True)
    return piece, len(numbers)


def _seams(scene, mesh, piece, pairs):
    """Pieces that periodic twins join, once each, and boxes from the second's node to the first's."""
    pairs = pairs[np.all(piece[pairs] >= 0, axis=1)]
    boxes = np.rint((mesh.points[pairs[:, 0]] - mesh.points[pairs[:, 1]]) / scene.size).astype(int)
    seams = np.unique(np.column_stack([piece[pairs], boxes]), axis=0)
    return seams[:, :2], seams[:, 2:]


def _joined(pieces, boxes, count, jump):
    """Body of each piece, boxes by which it is moved, and which bodies climb the mean gradient."""
    near = [[] for _ in range(count)]
    for (a, b), step in zip(pieces, boxes, strict=True):
        near[a].append((b, step))
        near[b].append((a, -step))
    body, shift, climbs = np.full(count, -1), np.zeros((count, 3), int), []
    for first in range(count):
        if body[first] >= 0:
            continue
        body[first], queue = len(climbs), [first]
        climbs.append(False)
        for a in queue:
            for b, step in near[a]:
                if body[b] < 0:
                    body[b], shift[b] = body[a], shift[a] + step
                    queue.append(b)
                rises = (shift[a] + step - shift[b]) * jump
                climbs[-1] |= bool(abs(rises.sum()) > ROUNDING * np.abs(rises).sum())
    return body, shift, np.array(climbs, dtype=bool)


def _at_walls(scene, mesh, node, solid, count):
    """Which bodies pass heat, by what their walls impose; the temperature of the wall that a body reaches, else NaN."""
    low, high, fed = np.full(count, np.inf), np.full(count, -np.inf), np.zeros(count, bool)
    for name, value in (scene.imposed_temperatures | scene.wall_fluxes).items():
        triangles, owners = mesh.walls[name]
        body = np.unique(node[triangles[solid[owners]]])
        if name in scene.wall_fluxes:
            fed[body] |= value != 0
        else:
            low[body], high[body] = np.minimum(low[body], value), np.maximum(high[body], value)
    return fed | (high > low), np.where(np.isfinite(low), low, np.nan)
