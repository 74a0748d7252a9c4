"""The equations of one scene on one mesh: what is known, what is loaded, what pores cut off.

The temperature is a known part, the mean gradient or the wall temperatures, plus a correction that vanishes where the
known part is the answer. Elements without conductivity (pores) are left out, and so are the bodies that no heat passes,
whose temperature needs no solving, see `components`. Afterwards nodes in pores get a temperature, for elements there
may reach past an interface: that in the limit of a vanishing conductivity.
"""

import time
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from demheat.scene import Scene
from demheat.scene.perfect import as_good
from references.fem import components, good, interfaces
from references.fem.elements import assemble, assemble_loads, wall_weights
from references.fem.medium import Medium
from references.fem.multigrid import solve_free
from references.fem.radiation import radiating
from references.fem.robin import RobinWalls, on_triangles
from references.fem.varying import converged, improved
from references.mesh import twins

# Relative residual of the temperature in pores, which only elements past an interface show.
SMOOTH = 1e-6


class Solved(NamedTuple):
    """Nodal temperatures and what the walls see."""

    temperature: np.ndarray  # (n,) float array, K or degrees Celsius
    wall_temperature: dict[str, float]  # dict of str to float, K or degrees Celsius
    # dict of str to float, W: Heat into the body by the reactions at the nodes: sums to zero to the solver's residual
    wall_heat: dict[str, float]
    stats: dict[str, object]  # dict
    bodies: components.Bodies | None = None  # components.Bodies, or None: That pores leave; None if all phases conduct
    shown: Scene | None = None  # Conductivities that fluxes are read with, if they are not the scene's own


class Given(NamedTuple):
    """The known part of the temperature, lift + level; nodes of each isothermal wall; walls per node; other walls."""

    lift: np.ndarray
    level: float
    nodes: dict[str, np.ndarray]
    shares: np.ndarray
    weights: dict[str, np.ndarray]


class _Assembled(NamedTuple):
    """What loads on one mesh share: matrix over the unit of conductivity, rows of nodes, elements that pass heat."""

    matrix: csr_matrix
    dof: np.ndarray
    unit: float
    passing: np.ndarray
    pores: np.ndarray
    found: components.Bodies | None
    own: np.ndarray | None  # Conductivity over the unit of elements in bodies of good conductors, if there are such
    assembly_s: float


class _Bodies(NamedTuple):
    """Connected bodies: label of each node (-1: none), the bodies that nothing holds, one node of each of those."""

    label: np.ndarray
    loose: np.ndarray
    pins: np.ndarray


def solve_nodes(scene, mesh, tolerance) -> Solved:
    """Nodal temperatures of a scene."""
    return solve_loads([scene], mesh, tolerance)[0]


def _solve_varying(scene, mesh, tolerance):
    """The same where conductivities depend on temperature."""
    kept = {}

    def solve(temperature, tolerance):
        return _solve_linear([scene], mesh, tolerance, kept, start=temperature)[0]

    return converged(solve, tolerance)


def solve_loads(scenes, mesh, tolerance) -> list[Solved]:
    """Nodal temperatures of one body under several loads: one matrix, and one multigrid where all hold the same nodes.

    Pores cut off other bodies for each load, and other good conductors span it: their matrices are their own.
    """
    if scenes[0].varies:
        return [_solve_varying(scene, mesh, tolerance) for scene in scenes]
    joined = [good.find(scene, mesh) for scene in scenes]
    if len(scenes) > 1 and (not scenes[0].mean_conductivities.all() or any(each is not None for each in joined)):
        return [solve_nodes(scene, mesh, tolerance) for scene in scenes]
    if joined[0] is None:
        return _solve_linear(scenes, mesh, tolerance, {})
    return _solve_linear(scenes, mesh, tolerance, {}, joined=joined[0]) or _solve_linear(scenes, mesh, tolerance, {})


def _solve_linear(scenes, mesh, tolerance, kept, *, start=None, joined=None):
    """Of each load; `start` has the temperatures at which all conducts, and from which the solution is improved.

    None if what is `joined` does not lead to a solution.
    """
    begin, body = time.perf_counter(), as_good(scenes[0])
    conductivity, own = body.mean_conductivities[mesh.phase], None
    givens = [given_part(scene, mesh, conductivity > 0) for scene in scenes]
    dof = twins(len(mesh.points), mesh.pairs)
    pores, found = conductivity == 0, None
    if pores.any():
        found = components.find(scenes[0], mesh)
        conductivity = np.where(found.still, 0.0, conductivity)
    passing, unit = conductivity > 0, conductivity.max()
    if unit == 0:
        return [_at_rest(scenes[0], mesh, givens[0], found)]
    if joined is not None:
        givens, unit = [good.known(joined, scenes[0], givens[0])], conductivity[~joined.inside].max(initial=0) or unit
        own, conductivity = (np.where(some, conductivity, 0.0) for some in (joined.inside, ~joined.inside))
    lifts = [given.lift for given in givens]
    matrix, loads = assemble_loads(mesh, conductivity / unit, dof, lifts, _medium(body, mesh, start))
    if mesh.faces is not None:
        matrix = (matrix + interfaces.exchange(mesh, dof) / unit).tocsr()
        loads = [load - _jumping(scenes[0], mesh, dof, lift) / unit for load, lift in zip(loads, lifts, strict=True)]
    own = None if own is None else own / unit
    system = _Assembled(matrix, dof, unit, passing, pores, found, own, time.perf_counter() - begin)
    each = zip(scenes, givens, loads, strict=True)
    solved = [_solved(one, mesh, system, tolerance, kept, start, joined) for one in each]
    return None if solved[0] is None else solved


def _jumping(scene, mesh, dof, lift):
    """What passes interfaces as the known part differs from side to side: in edges with held walls, at bodies."""
    rest = lift - mesh.points @ np.array(scene.gradient or np.zeros(3))
    here, there = np.swapaxes(rest[mesh.faces.nodes], 0, 1)
    return interfaces.passed(mesh, dof, rest) if np.any(here != there) else 0.0


def _medium(scene, mesh, temperature):
    """What the mean conductivity of elements does not say, if there is such."""
    return Medium(scene, mesh, temperature) if scene.anisotropic or temperature is not None else None


def _solved(one, mesh, system, tolerance, kept, start, joined):
    """One load on a matrix; `kept` is what the solver keeps for the next one."""
    begin, (scene, given, load) = time.perf_counter(), one
    matrix, dof, unit, passing, pores, found, own, assembly_s = system
    robin, outside = _robin(scene, mesh, passing), scene.imposed_temperatures
    matrix = (matrix + robin.stiffness() / unit).tocsr() if robin.walls else matrix
    tied = robin.tangent(np.ones(len(load))).diagonal() + robin.stiffness().diagonal()
    # What bodies of one temperature leave of matrices and loads.
    folded = joined.folded if joined is not None else lambda each: each
    equations, fixed = folded(matrix), folded(given.shares) > 0
    bodies = _bodies(equations, fixed | (folded(tied) > 0), pores=found is not None)
    imposed = np.zeros(len(load))
    for name, value in scene.wall_fluxes.items():
        imposed += value / unit * given.weights[name]
    _check_loose(mesh, folded(imposed), bodies)
    if robin.walls:
        # The known part lies on walls that others with surroundings may meet at an edge.
        imposed += (robin.constant(outside, given.level) - robin.stiffness() @ given.lift) / unit
    load += imposed
    fixed[bodies.pins] = True
    shown, times = good.bounded(joined, scene, mesh)
    if joined is not None:
        parts, known = (matrix, equations, own), (fixed, given.shares > 0)
        apart = good.solve_joined(joined, mesh, dof, parts, load, known, tolerance, kept)
        if apart is None:
            return None
        correction, heat, stats = apart.y + times * apart.z, unit * apart.left, apart.stats
    elif robin.radiates:
        body, known = (scene, robin, unit), given.lift + given.level
        correction, stats = radiating(mesh, matrix, load, fixed, dof, tolerance, known=known, body=body)
    elif start is not None:
        before = start - given.level - given.lift
        correction, stats = improved(mesh, matrix, load, fixed, dof, tolerance, start=before, kept=kept)
    else:
        correction, stats = solve_free(mesh, matrix, load, fixed, dof, tolerance, kept=kept)
    temperature = given.lift + correction[dof]
    temperature += given.level
    if joined is None:
        heat = unit * (matrix @ correction - load) - robin.radiated(outside, temperature)
    stats |= {"islands": 0 if found is None else int(np.count_nonzero(~found.passing))}
    if found is not None:
        components.settle(found, scene, mesh, temperature)
        shift, more = _pore_shift(mesh, pores, temperature - given.level, dof, given, found)
        temperature += shift
        stats["iterations"] += more["iterations"]
        stats["residual"] = max(stats["residual"], more["residual"])
    stats |= {"assembly_s": assembly_s, "solve_s": time.perf_counter() - begin}
    reached = temperature if found is None else components.reached(found, scene, temperature)
    walls = at_walls(scene, given, reached, heat, robin.entering(outside, temperature))
    return Solved(temperature, *walls, stats, found, shown)


def _robin(scene, mesh, passing):
    """Robin's condition at walls with surroundings, on what passes heat behind them."""
    walls = {}
    for name, load in scene.wall_exchanges.items():
        triangles, owners = mesh.walls[name]
        walls[name] = load, on_triangles(mesh, triangles[passing[owners]])
    return RobinWalls(walls, len(mesh.points))


def _at_rest(scene, mesh, given, found):
    """The solution where pores let no heat pass: exactly none, without a system."""
    temperature = given.lift + given.level
    components.settle(found, scene, mesh, temperature)
    components.extend(found, mesh, temperature)
    stats = {"unknowns": 0, "iterations": 0, "residual": 0.0, "islands": len(found.passing)}
    stats |= {"assembly_s": 0.0, "solve_s": 0.0}
    shown = components.reached(found, scene, temperature)
    still = dict.fromkeys(scene.wall_exchanges, 0.0)
    return Solved(temperature, *at_walls(scene, given, shown, np.zeros(len(shown)), still), stats, found)


def known_part(scene, mesh) -> tuple[np.ndarray, float, dict[str, np.ndarray], np.ndarray]:
    """What is known of the temperature: the mean gradient, or that of held walls."""
    lift, shares = np.zeros(len(mesh.points)), np.zeros(len(mesh.points))
    if scene.periodic:
        return mesh.points @ np.array(scene.gradient), 0.0, {}, shares
    # Counted from one of the temperatures, a large common offset costs no digits.
    level = next(iter(scene.imposed_temperatures.values()))
    nodes = {name: np.unique(mesh.walls[name].triangles) for name in scene.wall_temperatures}
    for name, value in scene.wall_temperatures.items():
        lift[nodes[name]] += value - level
        shares[nodes[name]] += 1
    # On an edge where two isothermal walls meet, the mean of both.
    lift[shares > 0] /= shares[shares > 0]
    return lift, level, nodes, shares


def given_part(scene, mesh, solid) -> Given:
    """Read the load of the scene."""
    lift, level, nodes, shares = known_part(scene, mesh)
    weights = {}
    for name in (*scene.wall_fluxes, *scene.wall_exchanges):
        triangles, owners = mesh.walls[name]
        weights[name] = wall_weights(mesh, triangles[solid[owners]])
        if name in scene.wall_fluxes and not weights[name].any():
            raise ValueError(f"Scene.walls[{name!r}]: a Flux needs a wall that conducts somewhere")
    return Given(lift, level, nodes, shares, weights)


def _bodies(matrix, held, pores):
    present = matrix.diagonal() > 0
    label = np.where(present, 0, -1)
    if pores:
        _, component = connected_components(matrix, directed=False)
        label[present] = component[present]
    loose = np.setdiff1d(label[present], label[held & present])
    if not held.any():  # in a periodic cell the largest body is the main one: it comes first
        loose = loose[np.argsort(-np.bincount(label[present])[loose], kind="stable")]
    pins = np.array([np.argmax(label == body) for body in loose], dtype=int)
    return _Bodies(label, loose, pins)


def _check_loose(mesh, imposed, bodies):
    for pin, body in zip(bodies.pins, bodies.loose, strict=True):
        heat = imposed[bodies.label == body]
        # Fluxes that balance leave rounding only.
        if abs(heat.sum()) > 1e-8 * np.abs(heat).sum():
            raise ValueError(f"Scene.walls: a flux enters a part, near {mesh.points[pin]}, that no temperature reaches")


def _pore_shift(mesh, pores, temperature, dof, given, found):
    """What to add to the temperature in pores: the limit of a vanishing conductivity, Laplace's equation there."""
    fixed = (found.node >= 0) | (given.shares > 0)
    fixed[dof[fixed]] = True
    matrix, load = assemble(mesh, pores.astype(float), dof, temperature)
    shift, stats = solve_free(mesh, matrix, load, fixed, dof, SMOOTH)
    return shift[dof], stats


def at_walls(scene, given, temperature, heat, exchanged) -> tuple[dict, dict]:
    """Mean temperature of each loaded wall, and the heat that enters there."""
    mean, entering = scene.wall_temperatures, dict(exchanged)
    for name, nodes in given.nodes.items():
        entering[name] = float(np.sum(heat[nodes] / given.shares[nodes]))
    for name, weights in given.weights.items():
        here = np.flatnonzero(weights)
        known = here[np.isfinite(temperature[here])]
        if len(known) == len(here) > 0:
            mean[name] = float(weights @ np.nan_to_num(temperature) / weights.sum())
        else:
            mean[name] = float(weights[known] @ temperature[known] / weights[known].sum()) if len(known) else np.nan
        if name in scene.wall_fluxes:
            entering[name] = float(scene.wall_fluxes[name] * weights.sum())
    return mean, entering
