"""Nodes of a mesh shared out to ranks by slabs: who has which rows, and what assembles them."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from references.fem.elements import assemble_loads
from references.fem.medium import Medium
from references.mesh import twins


class Share(NamedTuple):
    """A rank's part of the equations on a mesh that all ranks have."""

    dof: np.ndarray  # (n,) int array: Row of each node
    rows: np.ndarray  # (k,) int array: All rows, those of the first rank first
    own: np.ndarray  # (m,) int array: The rank's own
    numbers: np.ndarray  # (n,) int32 array: Of the unknowns in that order; -1 where a temperature is known
    comm: object

    @property
    def free(self) -> np.ndarray:
        """Which of its own rows are unknowns, (m,) bool array."""
        return self.numbers[self.own] >= 0

    def whole(self, values: np.ndarray) -> np.ndarray:
        """Values of all ranks' rows on each of them, 0 elsewhere, (n,) float array."""
        found = np.zeros(len(self.dof))
        found[self.rows] = np.concatenate(self.comm.allgather(values))
        return found


def shares_of(mesh, held, comm) -> Share:
    """Rows shared out evenly across the longest side of a mesh."""
    dof = twins(len(mesh.points), mesh.pairs)
    rows, axis = np.unique(dof), np.argmax(np.ptp(mesh.points, axis=0))
    fixed = held.copy()
    if not held.any():
        fixed[rows[0]] = True
    rows = rows[np.argsort(mesh.points[rows, axis], kind="stable")]
    free = rows[~fixed[rows]]
    if comm.size > len(rows):
        raise ValueError(f"ranks = {comm.size}: the mesh has {len(rows)} nodes; must be at most as many")
    numbers = np.full(len(dof), -1, dtype=np.int32)
    numbers[free] = np.arange(len(free))
    return Share(dof, rows, np.array_split(rows, comm.size)[comm.rank], numbers, comm)


def assembled(scene, mesh, share: Share, lift, unit) -> tuple[csr_matrix, np.ndarray]:
    """A rank's own rows, whole: of all elements that touch one of its nodes."""
    mine = np.zeros(len(share.dof), dtype=bool)
    mine[share.own] = True
    cells = np.flatnonzero(mine[share.dof[mesh.cells]].any(axis=1))
    part = mesh._replace(**{name: getattr(mesh, name)[cells] for name in ("cells", "phase", "volumes", "curved")})
    conductivity = scene.mean_conductivities[part.phase] / unit
    medium = Medium(scene, part) if scene.anisotropic else None
    matrix, (load,) = assemble_loads(part, conductivity, share.dof, [lift], medium)
    return matrix[share.own], load[share.own]


def unknown_rows(matrix: csr_matrix, share: Share) -> tuple[csr_matrix, np.ndarray]:
    """The equations of a rank's own unknowns, scaled to a unit diagonal."""
    root = np.sqrt(share.whole(np.asarray(matrix[np.arange(len(share.own)), share.own]).ravel()))
    ours = matrix[share.free]
    kept = share.numbers[ours.indices] >= 0
    row = np.repeat(share.own[share.free], np.diff(ours.indptr))[kept]
    column = ours.indices[kept]
    pointers = np.concatenate([[0], np.cumsum(kept)])[ours.indptr]
    values = ours.data[kept] / (root[row] * root[column])
    shape = len(pointers) - 1, int(share.numbers.max()) + 1
    found = csr_matrix((values, share.numbers[column], pointers), shape=shape)
    found.sort_indices()
    return found, root
