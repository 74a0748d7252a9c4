"""Good conductors in finite elements: each connected body is one unknown, and what differs in it is solved apart.

Bodies conduct without bound, or `APART` times better than the rest. The equations of the nodes without the elements in
bodies, A x = b, are folded: y is one temperature in each body, by P^T A P with P from bodies to nodes. What A y - b
leaves at the nodes of a body is the heat that it receives there: with it the equations of its own elements, K, give z,
by which temperatures differ in it. If it conducts without bound that is all, and z tells its flux. Else both are solved
again for what A (y + z) + K z leaves: a round leaves of the error about as much as the rest conducts of what bodies do.
As z is kept apart it has all of its digits, of which a sum at a contrast of 1e12 would leave four.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags

from demheat.scene.perfect import GOOD, INFINITE, as_good, recast, touching_spheres
from references.fem import components
from references.fem.elements import assemble
from references.fem.multigrid import solve_free
from references.mesh import twins

# So many times better than all the rest are good conductors of finite conductivity.
APART = 1e5
# Rounds at most, and what each must leave of the last one's residual.
ROUNDS, SLOW = 12, 0.3
# Of the tolerance, for what differs in bodies: it tells their own flux alone.
LOOSER = 100.0
# Part of its own conductance by which a node holds the level of a body that nothing else holds.
WEAK = 1e-3


class Joined(NamedTuple):
    """Bodies of good conductors on a mesh."""

    inside: np.ndarray  # (m,) bool array: Elements in them
    body: np.ndarray  # (n,) int array: Body of each node and of its periodic twins, -1 outside
    shift: np.ndarray  # (n, 3) int array: Boxes by which a node is moved to where its body reaches it
    first: np.ndarray  # (bodies,) int array: The node that stands for each; one that stands for its twins
    fold: csr_matrix  # (n, n): P; rows and columns are nodes that stand for their twins
    held: np.ndarray  # (bodies,) float array: Temperature of the wall that each meets, NaN where none
    spans: np.ndarray  # (bodies,) bool array: Whether each joins two temperatures
    perfect: bool  # Whether they conduct without bound

    def folded(self, each):
        """A matrix of nodes, or a load on them, with one row for each body."""
        down = self.fold.T @ each
        return (down @ self.fold).tocsr() if down.ndim == 2 else down


class Solved(NamedTuple):
    """One temperature in each body, and by what temperatures differ there, on nodes that stand for their twins."""

    y: np.ndarray  # (n,) float array
    z: np.ndarray  # (n,) float array
    left: np.ndarray  # (n,) float array: What enters at nodes, in the unit of the matrix
    stats: dict


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
    """Bodies of good conductors of a scene, but for those of finite conductivity that span the load; None without."""
    k = scene.mean_conductivities
    if scene.perfect:
        found = _joined(scene, mesh, np.isinf(k)[mesh.phase])
        if np.any(found.spans):
            raise ValueError(INFINITE)
        return found if len(found.first) else None
    some = np.unique(k[k > 0])
    for low in some[:-1][some[1:] >= APART * some[:-1]] if not (scene.varies or scene.radiates) else ():
        inside = (k > low)[mesh.phase]
        found = _joined(scene, mesh, inside)
        if not np.all(found.spans):
            inside &= ~np.append(found.spans, True)[found.body[mesh.cells[:, 0]]]
            return _joined(scene, mesh, inside) if np.any(found.spans) else found
    return None


def _joined(scene, mesh, inside):
    dof, size = twins(len(mesh.points), mesh.pairs), np.array(scene.size)
    jump = np.array(scene.gradient) * size if scene.periodic else np.zeros(3)
    nodes = np.unique(mesh.cells[inside])
    body, shift, climbs = components.gathered(scene, mesh, inside, _met(nodes, dof), jump)
    # A node is in a body if a twin is.
    away = np.rint((mesh.points - mesh.points[dof]) / size).astype(int)
    there, moved = np.full(len(dof), -1), np.zeros((len(dof), 3), int)
    there[dof[nodes]], moved[dof[nodes]] = body[nodes], shift[nodes] + away[nodes]
    corners = np.unique(dof[mesh.cells[inside, :4]])
    first = corners[np.unique(there[corners], return_index=True)[1]]
    stands = np.where(there >= 0, np.append(first, -1)[there], np.arange(len(dof)))
    fold = csr_matrix((np.ones(len(dof)), (np.arange(len(dof)), stands)), shape=(len(dof),) * 2)
    low, high = np.full(len(first), np.inf), np.full(len(first), -np.inf)
    for name, value in scene.wall_temperatures.items():
        met = np.unique(there[mesh.walls[name].triangles])
        met = met[met >= 0]
        low[met], high[met] = np.minimum(low[met], value), np.maximum(high[met], value)
    held, spans = np.where(np.isfinite(low), low, np.nan), climbs | (high > low)
    return Joined(inside, there[dof], moved[dof] - away, first, fold, held, spans, scene.perfect)


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
    else:
        lift[within] = np.nan_to_num(joined.held - given.level)[joined.body[within]]
    return given._replace(lift=lift)


def solve_joined(joined: Joined, mesh, dof, equations, load, known, tolerance, kept) -> Solved | None:
    """Solve for loads at nodes.

    `equations` are the matrix of the rest on nodes, the same folded, and the conductivity of elements in bodies over
    its unit; `known` which rows of the folded one are fixed, and which nodes are held. None if no rounds are enough.
    """
    (matrix, small, own), (fixed, held) = equations, known
    inner, _ = assemble(mesh, own, dof, np.zeros(len(dof)))
    y, z, size, within = np.zeros(len(load)), np.zeros(len(load)), np.inf, {}
    least = float(own[own > 0].min(initial=np.inf))
    free = ~fixed & (small.diagonal() > 0), (joined.body >= 0) & ~held & (inner.diagonal() > 0)
    roots = np.sqrt(small.diagonal()[free[0]]), np.sqrt((matrix.diagonal() + inner.diagonal() / least)[free[1]])
    whole, stats = _norm(joined.folded(load)[free[0]] / roots[0]), {"iterations": 0}
    for done in range(1, ROUNDS + 1):
        left = _left(joined, matrix, inner, load, y, z)
        aim = 0.5 * tolerance * whole / max(_norm(joined.folded(left)[free[0]] / roots[0]), 1e-300)
        aim = tolerance if done == 1 else min(aim, 0.5)
        change, found = solve_free(mesh, small, joined.folded(left), fixed, dof, aim, kept=kept)
        y += joined.fold @ change
        left = _left(joined, matrix, inner, load, y, z)
        change, more = _within(joined, mesh, dof, inner, left, held, LOOSER * aim if done == 1 else aim, within)
        z += change
        stats = found | {"iterations": stats["iterations"] + found["iterations"] + more["iterations"], "rounds": done}
        left, last = _left(joined, matrix, inner, load, y, z), size
        if joined.perfect:
            return Solved(y, z, -left, stats)
        size = (
            np.hypot(_norm(joined.folded(left)[free[0]] / roots[0]), _norm(left[free[1]] / roots[1]) / LOOSER) / whole
        )
        if size <= tolerance:
            return Solved(y, z, -left, stats | {"residual": size})
        if size > SLOW * last:
            return None
    return None


def _norm(values):
    return float(np.sqrt(np.einsum("i,i->", values, values)))


def _left(joined, matrix, inner, load, y, z):
    """What loads leave at nodes; what z changes outside of bodies without bound is nothing."""
    return load - matrix @ (y if joined.perfect else y + z) - inner @ z


def _within(joined, mesh, dof, inner, received, held, tolerance, kept):
    """By what temperatures differ in bodies that receive heat at their nodes."""
    heat = np.where(inner.diagonal() > 0, received, 0.0)
    body = np.where(inner.diagonal() > 0, joined.body, -1)
    held = held & (body >= 0)
    # What the equations left over in bodies that no wall holds.
    loose = ~np.isin(body, body[held]) & (body >= 0)
    count = np.bincount(body[loose], minlength=len(joined.first))
    excess = np.bincount(body[loose], heat[loose], len(joined.first)) / np.maximum(count, 1)
    heat[loose] -= excess[body[loose]]
    # What fixes the level there hardly weighs: multigrid would take longer for a node that is held.
    level = np.zeros(len(heat))
    level[joined.first[count > 0]] = WEAK * inner.diagonal()[joined.first[count > 0]]
    return solve_free(mesh, inner + diags(level), heat, held, dof, min(tolerance, 0.5), kept=kept)


def bounded(joined: Joined | None, scene, mesh):
    """The scene whose good conductors leave temperatures their digits, and by how much less they conduct there."""
    if joined is None or joined.perfect:
        return as_good(scene), 1.0
    k = scene.mean_conductivities
    own, rest = (np.unique(mesh.phase[some]) for some in (joined.inside, ~joined.inside))
    best, least = k[rest].max(initial=0.0), float(k[own].min(initial=np.inf))
    times = least / (GOOD * best) if best > 0 else 1.0
    if not 1.0 < times < np.inf or len(np.intersect1d(own, rest)) or scene.anisotropic:
        return scene, 1.0
    return recast(scene, lambda each: each / times if each >= least else each), times
