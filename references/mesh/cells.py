"""Arrays of a mesh: faces, periodic twins, Jacobians, volumes and what is checked. No mesher."""

from itertools import combinations, product
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from demheat.scene import WALLS

# Unit lengths. Nodes this close to a face lie on it (found: they are 1e-15 off, or on spheres at least `NARROWEST`).
SNAP = 1e-9
# Nodes and surfaces this close after the periodic shift are twins (OpenCASCADE's own tolerance is 1e-7).
MATCH = 1e-6
# A curved element whose smallest Jacobian may be below this part of its mean gets straight edges.
SMALLEST_JACOBIAN = 0.1
# Part of a phase's volume that may differ from `Scene.phase_at` at the centroids: chords of coarse elements.
MISLABELLED = 0.25
# Column of the middle node of each edge.
EDGE_COLUMN = {(0, 1): 4, (1, 2): 5, (0, 2): 6, (0, 3): 7, (1, 3): 8, (2, 3): 9}


class Wall(NamedTuple):
    """Triangles on one face of the box, or on one wall of a round body."""

    triangles: np.ndarray  # (k, 3) or (k, 6) int32 array: Corners, then the middles of the edges 01, 12, 02
    owners: np.ndarray  # (k,) int array: The element behind each


class Faces(NamedTuple):
    """Triangles between elements that an interface with a resistance parts, whose nodes stand once on either side."""

    # (t, 2, 3) or (t, 2, 6) int array: Of both sides, in the same places: corners, then the middles of the edges 01,
    # 12, 02. On a face of a periodic cell the places of the second are those of the first less the period
    nodes: np.ndarray
    resistance: np.ndarray  # (t,) float array, m2 K/W


class Mesh(NamedTuple):
    """Tetrahedra of one scene."""

    points: np.ndarray  # (n, 3) float array, m
    # (m, 4) or (m, 10) int32 array: Corners, then the middles of the edges 01, 12, 02, 03, 13, 23 (VTK's order)
    cells: np.ndarray
    phase: np.ndarray  # (m,) int32 array
    volumes: np.ndarray  # (m,) float array, m3
    curved: np.ndarray  # (m,) bool array: Which elements have a curved edge
    walls: dict[str, Wall]  # mapping of str to Wall: All six faces, or "round" and the flat ends of a round body
    # (p, 2) int32 array: Node on a face "+" and its periodic twin on the face "-"; empty in a walled box
    pairs: np.ndarray
    # mapping: `size` used (m), `attempts`, `straightened` elements, smallest relative `jacobian`, `mesh_s`
    stats: dict[str, object]
    faces: Faces | None = None  # Where nodes were doubled, see `references.mesh.sides`


def snap(points, box, periodic):
    """Put nodes exactly onto the faces, in place, and pair those of opposite faces of a periodic cell."""
    pairs = [np.zeros((0, 2), np.int32)]
    for axis in range(3):
        for at in (0.0, box[axis]):
            points[np.abs(points[:, axis] - at) < SNAP, axis] = at
    for axis in range(3) if periodic else ():
        low, high = (np.flatnonzero(points[:, axis] == at) for at in (0.0, box[axis]))
        across = [a for a in range(3) if a != axis]
        distance, match = cKDTree(points[low][:, across]).query(points[high][:, across])
        if len(low) != len(high) or distance.max() > MATCH or len(np.unique(match)) != len(match):
            raise RuntimeError("nodes on opposite faces of the periodic cell do not match")
        points[np.ix_(high, across)] = points[np.ix_(low[match], across)]
        pairs.append(np.column_stack([high, low[match]]).astype(np.int32))
    return np.concatenate(pairs)


def twins(count, pairs):
    """The one node that stands for each node and its periodic twins, (count,) int array."""
    twin = np.arange(count)
    twin[pairs[:, 0]] = pairs[:, 1]
    for _ in range(2):  # a corner of the box reaches its last twin in three steps
        twin = twin[twin]
    return twin


def wall(points, cells, box, name):
    """`Wall` of the tetrahedra that have three corners on a face of the box."""
    axis = "xyz".index(name[0])
    return triangles_on(cells, points[:, axis] == (0.0 if name[1] == "-" else box[axis]))


def triangles_on(cells, on) -> Wall:
    """All faces of tetrahedra with three corners among some nodes."""
    triangles, owners = [], []
    for a, b, c in combinations(range(4), 3):
        mine = np.flatnonzero(on[cells[:, a]] & on[cells[:, b]] & on[cells[:, c]])
        columns = [a, b, c]
        if cells.shape[1] == 10:
            columns += [EDGE_COLUMN[a, b], EDGE_COLUMN[b, c], EDGE_COLUMN[a, c]]
        triangles.append(cells[mine][:, columns])
        owners.append(mine)
    return Wall(np.concatenate(triangles), np.concatenate(owners))


def bent(nodes):
    """Which elements (m, 4 or 10, 3) have a middle node off the middle of its edge."""
    found = np.zeros(len(nodes), bool)
    for (a, b), c in EDGE_COLUMN.items() if nodes.shape[1] == 10 else ():
        off = nodes[:, c] - (nodes[:, a] + nodes[:, b]) / 2
        found |= np.abs(off).max(axis=1) > 1e-10  # rounding of gmsh's middles, unit lengths
    return found


def jacobian_coefficients(nodes):
    """Bernstein coefficients (m, 20) of the Jacobian of second-order tetrahedra, whose hull bounds it.

    The mapping is quadratic, so its gradient is linear, a mean of the gradients J_a at the four corners weighted by
    barycentric coordinates, and the determinant is a cubic whose coefficient at (a, b, c) is the mean over the
    permutations of det[J_a e_1, J_b e_2, J_c e_3]. The integral is the plain mean of the 20 coefficients over 6.
    """
    along = np.zeros((4, 4, len(nodes), 3))  # along[a, b]: derivative at corner a towards corner b
    for (a, b), c in EDGE_COLUMN.items():
        along[a, b] = 4 * nodes[:, c] - 3 * nodes[:, a] - nodes[:, b]
        along[b, a] = 4 * nodes[:, c] - 3 * nodes[:, b] - nodes[:, a]
    columns = along[:, 1:] - along[:, :1]
    sums, counts = {}, {}
    for a, b, c in product(range(4), repeat=3):
        key = tuple(sorted((a, b, c)))
        value = np.einsum("mi,mi->m", columns[a, 0], np.cross(columns[b, 1], columns[c, 2]))
        sums[key], counts[key] = sums.get(key, 0) + value, counts.get(key, 0) + 1
    return np.column_stack([sums[key] / counts[key] for key in sums])


def straighten(points, cells, pairs):
    """Straighten the edges of elements that are, or nearly are, inverted, and their periodic twins."""
    twin, total = twins(len(points), pairs), 0
    for _ in range(20):  # each round may bend a neighbour too far; found: 1 or 2
        curved = np.flatnonzero(bent(points[cells]))
        coefficients = jacobian_coefficients(points[cells[curved]])
        relative = coefficients.min(axis=1) / np.abs(coefficients.mean(axis=1))
        bad = curved[relative < SMALLEST_JACOBIAN]
        if not len(bad):
            return total, float(relative.min(initial=1.0))
        total += len(bad)
        wanted = np.zeros(len(points), bool)
        wanted[twin[cells[bad, 4:]]] = True
        for (a, b), c in EDGE_COLUMN.items():
            mine = cells[wanted[twin[cells[:, c]]]]
            points[mine[:, c]] = (points[mine[:, a]] + points[mine[:, b]]) / 2
    raise RuntimeError(f"{len(bad)} curved elements stay inverted")


def volumes_of(nodes):
    """Signed volumes (m,) of elements given by their nodes (m, 4 or 10, 3)."""
    if nodes.shape[1] == 10:
        return jacobian_coefficients(nodes).mean(axis=1) / 6
    a, b, c = (nodes[:, k] - nodes[:, 0] for k in (1, 2, 3))
    return np.einsum("mi,mi->m", a, np.cross(b, c)) / 6


def finished(scene, points, cells, phase, quadratic) -> Mesh:
    """The mesh of nodes in unit lengths, which are put onto the faces in place; its phases are not checked."""
    scale = max(scene.size)
    box = np.array(scene.size) / scale
    pairs = snap(points, box, scene.periodic)
    straightened, jacobian = straighten(points, cells, pairs) if quadratic else (0, 1.0)
    volumes, curves = volumes_of(points[cells]) * scale**3, bent(points[cells])
    walls = {name: wall(points, cells, box, name) for name in WALLS}
    stats = {"straightened": straightened, "jacobian": jacobian}
    # Exactly on the faces in metres too, whatever the rounding of the scale.
    metres = np.where(points == box, scene.size, points * scale)
    return Mesh(metres, cells, phase, volumes, curves, walls, pairs, stats)


def check(scene, mesh):
    """Raise RuntimeError for inverted elements, a body that does not fill the box, or misplaced phases."""
    volumes, phase = mesh.volumes, mesh.phase
    if volumes.min() <= 0:
        raise RuntimeError(f"{np.sum(volumes <= 0)} inverted elements")
    # Rounding only: all faces are plane.
    if abs(volumes.sum() / scene.volume - 1) > 1e-9:
        raise RuntimeError(f"the elements fill {volumes.sum() / scene.volume} of the box")
    wanted = scene.phase_at(mesh.points[mesh.cells[:, :4]].mean(axis=1))
    for labels in (phase, wanted):
        volume = np.bincount(labels, volumes, len(scene.materials))
        bad = np.bincount(labels[wanted != phase], volumes[wanted != phase], len(scene.materials))
        for number in np.flatnonzero(bad > MISLABELLED * volume):
            raise RuntimeError(
                f"phase {number}: {bad[number]:.3g} of its {volume[number]:.3g} m3 are misplaced: it may be "
                "thinner than the elements, which a smaller size mends"
            )
    count = np.bincount(phase, minlength=len(scene.materials))
    for number, inclusion in enumerate(scene.inclusions, start=1):
        # Other inclusions can fill a layer or the matrix, but never a sphere or another body.
        if not inclusion.flat and not count[number]:
            raise RuntimeError(f"phase {number}, a {inclusion.kind}, was lost")
