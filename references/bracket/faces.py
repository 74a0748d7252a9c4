"""Faces of a mesh of tetrahedra: which elements share one, and which of them lie between two materials."""

from typing import NamedTuple

import numpy as np

from references.mesh import EDGE_COLUMN, Mesh, twins

# Corners of an element's faces, each opposite the corner of its number.
CORNERS = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])


class Faces(NamedTuple):
    """Faces as rows of unknowns: one at each of the three corners of each face."""

    # (m, 12) int array: Unknown at the corners of `CORNERS` of each element, in that order; periodic twins share theirs
    row: np.ndarray
    node: np.ndarray  # (3 f,) int array: Node of each unknown


def number_faces(mesh: Mesh) -> Faces:
    """Number the faces of a mesh and the unknowns on them."""
    twin = twins(len(mesh.points), mesh.pairs)
    corners = twin[mesh.cells[:, CORNERS]].reshape(-1, 3)
    order = np.argsort(corners, axis=1)
    sides = np.take_along_axis(corners, order, axis=1).astype(np.int64)
    first, face = _unique(sides, len(mesh.points))
    row = np.empty(sides.shape, np.int64)
    np.put_along_axis(row, order, 3 * face[:, None] + np.arange(3), axis=1)
    return Faces(row.reshape(-1, 12), sides[first].ravel())


def _unique(sides, count):
    """First occurrence of each different row of three increasing numbers below `count`, and the number of each row."""
    _, pair = np.unique(sides[:, 0] * count + sides[:, 1], return_inverse=True)
    _, first, face = np.unique(pair.astype(np.int64) * count + sides[:, 2], return_index=True, return_inverse=True)
    return first, face


class Interfaces(NamedTuple):
    """Faces between two phases."""

    nodes: np.ndarray  # (t, 6) int array: Corners, then the middles of the edges 01, 12, 02
    # inner, outer: (t,) int array: Phases: that painted later, and the other
    inner: np.ndarray
    outer: np.ndarray


def interfaces(mesh: Mesh) -> Interfaces:
    """Faces of a second-order mesh between elements of two phases, but for those across a periodic boundary."""
    sides = np.sort(mesh.cells[:, CORNERS].reshape(-1, 3), axis=1).astype(np.int64)
    _, face = _unique(sides, len(mesh.points))
    order = np.argsort(face, kind="stable")
    shared = np.flatnonzero(face[order[1:]] == face[order[:-1]])
    one, other = order[shared], order[shared + 1]
    phases = np.stack([mesh.phase[one // 4], mesh.phase[other // 4]])
    differ = phases[0] != phases[1]
    columns = np.array(
        [[*corner, *(EDGE_COLUMN[corner[i], corner[j]] for i, j in ((0, 1), (1, 2), (0, 2)))] for corner in CORNERS]
    )
    nodes = mesh.cells[(one // 4)[differ, None], columns[one[differ] % 4]]
    return Interfaces(nodes, phases[:, differ].max(axis=0), phases[:, differ].min(axis=0))
