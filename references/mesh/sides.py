"""Nodes doubled on interfaces with a resistance, where the temperature jumps: one for each side that meets there.

Elements are on one side of such interfaces if those around their phases are the same (`demheat.scene.resistances`). A
node has a copy for each side of the elements around it, and periodic twins are those of one side.
"""

from typing import NamedTuple

import numpy as np

from demheat.scene.resistances import between, joined
from references.mesh.cells import Faces, Mesh, Wall, triangles_on


class _Copies(NamedTuple):
    """Sides of nodes: ascending keys, node times the number of sides plus the side."""

    keys: np.ndarray
    sides: int

    @property
    def node(self):
        return self.keys // self.sides

    def of(self, nodes, side):
        """Numbers of the copies of nodes (k, j) on sides (k,)."""
        return np.searchsorted(self.keys, nodes.astype(np.int64) * self.sides + side[:, None]).astype(np.int32)


def split(scene, mesh) -> Mesh:
    """The mesh with nodes doubled where surfaces resist, and the triangles between; the mesh itself if none does."""
    resistance = between(scene)
    if resistance is None:
        return mesh
    sides = joined(scene)
    own = sides[mesh.phase]
    copies = _Copies(np.unique(mesh.cells.astype(np.int64) * len(sides) + own[:, None]), len(sides))
    found = [_inner(mesh, own, copies)]
    found += [_seam(mesh, axis, own) for axis in range(3) if scene.periodic]
    here, there, owners = (np.concatenate(column) for column in zip(*found, strict=True))
    nodes = np.stack([copies.of(here, own[owners[:, 0]]), copies.of(there, own[owners[:, 1]])], axis=1)
    walls = {name: Wall(copies.of(wall[0], own[wall.owners]), wall.owners) for name, wall in mesh.walls.items()}
    return mesh._replace(
        points=mesh.points[copies.node],
        cells=copies.of(mesh.cells, own),
        walls=walls,
        pairs=_pairs(mesh.pairs, copies),
        faces=Faces(nodes, resistance(*mesh.phase[owners].T)),
    )


def _inner(mesh, own, copies):
    """Faces in the box between elements of two sides: nodes of both, the same, and their elements."""
    on = np.bincount(copies.node, minlength=len(mesh.points)) > 1
    triangles, owners = triangles_on(mesh.cells, on)
    one, other = _alike(np.sort(triangles[:, :3], axis=1))
    apart = own[owners[one]] != own[owners[other]]
    one, other = one[apart], other[apart]
    return triangles[one], triangles[one], np.column_stack([owners[one], owners[other]])


def _seam(mesh, axis, own):
    """The same where a face of a periodic cell parts them: nodes of the face "+", then their twins."""
    high, low = (mesh.walls["xyz"[axis] + end] for end in "+-")
    partner, low_nodes = np.full(len(mesh.points), -1), np.zeros(len(mesh.points), bool)
    low_nodes[low.triangles] = True
    # Nodes on edges have twins along other axes, too, which lie on the same face again.
    along = mesh.pairs[low_nodes[mesh.pairs[:, 1]] & ~low_nodes[mesh.pairs[:, 0]]]
    partner[along[:, 0]] = along[:, 1]
    there = partner[high.triangles]
    corners = np.sort(np.concatenate([there[:, :3], low.triangles[:, :3]]), axis=1)
    one, other = np.sort(np.stack(_alike(corners)), axis=0)
    owners = np.column_stack([high.owners[one], low.owners[other - len(there)]])
    apart = own[owners[:, 0]] != own[owners[:, 1]]
    return high.triangles[one[apart]], there[one[apart]], owners[apart]


def _alike(rows):
    """Numbers of the two rows of each pair of equal ones; none is there three times."""
    order = np.lexsort(rows.T)
    same = np.all(rows[order][1:] == rows[order][:-1], axis=1)
    return order[:-1][same], order[1:][same]


def _pairs(pairs, copies):
    """Periodic twins among the copies: those of one side that both have."""
    start, stop = (np.searchsorted(copies.keys, (pairs[:, 0] + end).astype(np.int64) * copies.sides) for end in (0, 1))
    count = stop - start
    copy = np.repeat(stop - np.cumsum(count), count) + np.arange(count.sum())
    wanted = np.repeat(pairs[:, 1], count).astype(np.int64) * copies.sides + copies.keys[copy] % copies.sides
    place = np.minimum(np.searchsorted(copies.keys, wanted), len(copies.keys) - 1)
    both = copies.keys[place] == wanted
    return np.column_stack([copy[both], place[both]]).astype(np.int32)
