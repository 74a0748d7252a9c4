"""Perfect conductors in finite elements: each connected body is one unknown, and the flux in it follows.

The equations of the nodes, A x = b without the elements in bodies, are folded: x = P y, where P gives all nodes of a
body one temperature, and P^T A P y = P^T b. What A x - b leaves at the nodes of a body is the heat that it receives
there; spread through the body by its own elements it makes the little by which temperatures differ in a conductor that
is `demheat.scene.perfect.GOOD` times as good as the rest, and its flux.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from demheat.scene.perfect import INFINITE, touching_spheres
from references.fem import components
from references.fem.elements import assemble
from references.fem.multigrid import solve_free
from references.mesh import twins


class Joined(NamedTuple):
    """Bodies of perfect conductors on a mesh."""

    inside: np.ndarray  # (m,) bool array: Elements in them
    body: np.ndarray  # (n,) int array: Body of each node and of its periodic twins, -1 outside
    shift: np.ndarray  # (n, 3) int array: Boxes by which a node is moved to where its body reaches it
    first: np.ndarray  # (bodies,) int array: The node that stands for each; one that stands for its twins
    fold: csr_matrix  # (n, n): P; rows and columns are nodes that stand for their twins

    def folded(self, each):
        """A matrix of nodes, or a load on them, with one row for each body."""
        down = self.fold.T @ each
        return (down @ self.fold).tocsr() if down.ndim == 2 else down


def check_perfect(scene) -> None:
    """Raise unless what perfect conductors of a scene need is known here."""
    if not scene.perfect:
        return
    touching_spheres(scene)
    text = "beside perfect conductors finite elements know conductivities that are constant"
    scene.require(text, takes=("resistance", "exchange", "anisotropy", "perfect"))
    if scene.radiates:
        raise NotImplementedError(
            f"Scene.walls = {dict(scene.walls)}: beside perfect conductors finite elements know walls with "
            "temperatures, fluxes and convection, none that radiate"
        )


def find(scene, mesh) -> Joined | None:
    """Bodies of the perfect conductors of a scene; None if there are none."""
    inside = np.isinf(scene.mean_conductivities)[mesh.phase]
    if not inside.any():
        return None
    dof, size = twins(len(mesh.points), mesh.pairs), np.array(scene.size)
    jump = np.array(scene.gradient) * size if scene.periodic else np.zeros(3)
    nodes = np.unique(mesh.cells[inside])
    body, shift, climbs = components.gathered(scene, mesh, inside, _met(nodes, dof), jump)
    if climbs.any():
        raise ValueError(INFINITE)
    # A node is in a body if a twin is.
    own, away = nodes, np.rint((mesh.points - mesh.points[dof]) / size).astype(int)
    there, moved = np.full(len(dof), -1), np.zeros((len(dof), 3), int)
    there[dof[own]], moved[dof[own]] = body[own], shift[own] + away[own]
    corners = np.unique(dof[mesh.cells[inside, :4]])
    first = corners[np.unique(there[corners], return_index=True)[1]]
    stands = np.where(there >= 0, first[there], np.arange(len(dof)))
    fold = csr_matrix((np.ones(len(dof)), (np.arange(len(dof)), stands)), shape=(len(dof),) * 2)
    return Joined(inside, there[dof], moved[dof] - away, first, fold)


def _met(nodes, dof):
    """Pairs of nodes that are one another's periodic twins, one after the other where they are several."""
    nodes = nodes[np.argsort(dof[nodes], kind="stable")]
    one, other = nodes[:-1], nodes[1:]
    same = dof[one] == dof[other]
    return np.column_stack([other[same], one[same]])


def known(joined: Joined, scene, given):
    """The known part where bodies have one temperature: that of the wall that they meet, else any."""
    lift, within = given.lift.copy(), joined.body >= 0
    if scene.periodic:
        lift[within] = -joined.shift[within] @ (np.array(scene.gradient) * scene.size)
        return given._replace(lift=lift)
    low, high = np.full(len(joined.first), np.inf), np.full(len(joined.first), -np.inf)
    for name, value in scene.wall_temperatures.items():
        met = np.unique(joined.body[given.nodes[name]])
        met = met[met >= 0]
        low[met], high[met] = np.minimum(low[met], value), np.maximum(high[met], value)
    if np.any(high > low):
        raise ValueError(INFINITE)
    lift[within] = np.where(np.isfinite(low), low - given.level, 0.0)[joined.body[within]]
    return given._replace(lift=lift)


def spread(joined: Joined, mesh, dof, received, held, tolerance):
    """Spread heat that bodies receive at their nodes through them, over the conductivity of their elements.

    Returns what temperatures times that conductivity differ by, what they make of the heat of each node, and stats.
    """
    matrix, _ = assemble(mesh, joined.inside.astype(float), dof, np.zeros(len(dof)))
    heat, body = np.where(matrix.diagonal() > 0, received, 0.0), np.where(matrix.diagonal() > 0, joined.body, -1)
    held = held & (body >= 0)
    # What the equations left over in bodies that no wall holds.
    loose = ~np.isin(body, body[held]) & (body >= 0)
    count = np.bincount(body[loose], minlength=len(joined.first))
    excess = np.bincount(body[loose], heat[loose], len(joined.first)) / np.maximum(count, 1)
    heat[loose] -= excess[body[loose]]
    fixed = held.copy()
    fixed[joined.first[count > 0]] = True
    rest, stats = solve_free(mesh, matrix, heat, fixed, dof, tolerance)
    return rest[dof], matrix @ rest, stats
