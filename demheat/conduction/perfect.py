"""Perfect conductors in a network: each body of them is one unknown, and the flux in it follows from what reaches it.

The network is that of a body whose perfect conductors are `GOOD` times as good as the rest: its links between phases
are those of the other side alone. Particles of one body are one node of the equations. What the node receives at each
of its particles, spread through the body, makes the little by which temperatures differ in so good a conductor: less
than the solver leaves, and its flux.
"""

from dataclasses import fields, replace

import numpy as np
from scipy import sparse

from demheat.conduction import components
from demheat.conduction.balance import at_walls, system_of
from demheat.conduction.multigrid import preconditioner
from demheat.conduction.preconditioned import by_diagonal, preconditioned
from demheat.conduction.products import apply, dot
from demheat.conduction.steady import AMG_UNKNOWNS, COARSE, Solution, Unsolved
from demheat.network.base import SIDES, row_numbers
from demheat.network.links_kernels import Links, links_of
from demheat.runtime.process_state import one_blas_thread
from demheat.runtime.progress import stage
from demheat.scene.perfect import INFINITE, touching_spheres
from demheat.scene.resistances import between
from demheat.scene.shapes.base import TOUCH

# Of the best of the rest: half of the digits are left for what differs in it, half of them for the flux beside it.
GOOD = 1e8


def check_perfect(scene) -> None:
    """Raise unless perfect conductors are bodies apart: not the matrix, and no spheres that touch."""
    if not scene.perfect:
        return
    what = "beside perfect conductors particles know constant conductivities above 0 and held temperatures"
    scene.require(what, pores=False, takes=("resistance", "perfect"))
    if scene.matrix.perfect:
        raise NotImplementedError("Scene.matrix: particles know perfect conductors as inclusions")
    if touching_spheres(scene) is not None:
        raise NotImplementedError(
            "perfect spheres touch each other or a held wall: particles know those apart, or that resist"
        )


def as_good(scene):
    """The scene with `GOOD` times the conductivity of the rest in place of infinity."""
    if not scene.perfect:
        return scene
    k = scene.conductivities
    good = GOOD * float(k[np.isfinite(k)].max())
    return replace(scene, inclusions=[_as(each, good) for each in scene.inclusions])


def _as(shape, good):
    if not shape.material.perfect:
        return shape
    changed = {"material": replace(shape.material, conductivity=good)}
    if "shapes" in {field.name for field in fields(shape)}:
        changed["shapes"] = [_as(each, good) for each in shape.shapes]
    return replace(shape, **changed)


def solve_perfect(network, scene, *, solver, tolerance, max_iterations):
    """Temperatures of a scene with perfect conductors, in the network of the scene `as_good`."""
    inside, scene = np.isinf(scene.conductivities)[network.phase], as_good(scene)
    outer, inner = _parted(network, scene, inside)
    gradient = np.array(scene.gradient if scene.periodic else (0.0, 0.0, 0.0))
    found, count = components.gathered(inner, inside, gradient * network.size)
    held = _held(network, scene, found, count)
    node = np.where(inside, found.label, count + np.cumsum(~inside) - 1)
    system = system_of(outer, scene, np.ones(len(node), bool))
    # Less the mean gradient, all of a body at one temperature, which is that of the wall that it meets.
    x = np.where(inside, -((network.centers + found.shift * network.size) @ gradient), 0.0)
    known = np.append(np.isfinite(held), np.zeros(node.max() + 1 - count, bool))
    at_wall = known[node]
    x[at_wall] = held[node[at_wall]] - system.level
    links, diagonal = _merged(outer, system.diagonal, node, known)
    heat = np.where(known, 0.0, np.bincount(node, _left(system, x)))
    chosen = solver if solver != "auto" else "amg" if len(diagonal) > AMG_UNKNOWNS else "cg"
    y, iterations, left = _solved(links, diagonal, heat, chosen, tolerance, max_iterations)
    if not left <= tolerance:
        raise Unsolved(
            f"solve ({chosen}): relative residual {left:.2e} after {iterations} iterations, asked for {tolerance:.1e}"
        )
    x += y[node]
    if scene.periodic:
        x -= np.average(x, weights=network.volumes)
    warmth, entering = at_walls(system, scene, x + system.level)
    stats = {"unknowns": len(diagonal), "iterations": iterations, "residual": left, "solver": chosen, "islands": 0}
    ties = np.bincount(network.wall_particle, system.ties, len(x)) if len(system.ties) else np.zeros(len(x))
    more = _within(inner, found.label, np.where(at_wall, ties, 0.0), _left(system, x), (tolerance, max_iterations))
    if len(entering):
        met = at_wall[network.wall_particle] & (system.ties > 0)
        entering[met] = -(system.ties * more[network.wall_particle])[met]
    return Solution(x + more + system.level, system.gradient, warmth, entering, stats)


def _left(system, x):
    """Heat that each particle receives in excess, W; also those that have no links of their own."""
    received = np.empty_like(x)
    apply(links_of(system.network), system.diagonal, x, received)
    return system.heat - received


def _parted(network, scene, inside):
    """The network without links in bodies, and with these alone."""
    row, other, phase = row_numbers(network.indptr), network.indices, network.phase
    within = inside[row] & inside[other]
    unlike = np.flatnonzero(within & (phase[row] != phase[other]) & (network.conductance > 0))
    resistance = between(scene)
    resisting = np.zeros(len(unlike)) if resistance is None else resistance(phase[row[unlike]], phase[other[unlike]])
    if np.any(resisting == 0):
        first = unlike[np.flatnonzero(resisting == 0)[0]]
        raise NotImplementedError(
            f"perfect conductors Scene.inclusions[{phase[row[first]] - 1}] and [{phase[other[first]] - 1}] touch, or "
            "their gap is too thin for these particles: must be apart, resist, or be more particles"
        )
    within[unlike] = False
    return tuple(network._replace(conductance=np.where(each, network.conductance, 0.0)) for each in (~within, within))


def _held(network, scene, found, count):
    """Temperature of the wall that each body meets, NaN where none; raise where there are two."""
    low, high, body = np.full(count, np.inf), np.full(count, -np.inf), found.label[network.wall_particle]
    for name, value in scene.imposed_temperatures.items():
        here = (network.wall_side == SIDES.index(name)) & (network.wall_area > 0) & (body >= 0)
        for phase in np.unique(network.phase[network.wall_particle[here]]):
            _check_reached(scene, int(phase) - 1, name)
        low[body[here]] = np.minimum(low[body[here]], value)
        high[body[here]] = np.maximum(high[body[here]], value)
    if np.any(found.climbs[:count]) or np.any(high > low):
        raise ValueError(INFINITE)
    return np.where(np.isfinite(low), low, np.nan)


def _check_reached(scene, number, name):
    """Raise if cells of an inclusion reach a wall that it does not."""
    axis = "xyz".index(name[0])
    ends, length = scene.inclusions[number].bounds(), scene.size[axis]
    gap = ends[0][axis] if name[1] == "-" else length - ends[1][axis]
    if gap > TOUCH * length:
        raise NotImplementedError(
            f"the gap of {gap:.3g} m between a perfect conductor, Scene.inclusions[{number}], and wall {name} is too "
            "thin for these particles: must be more particles"
        )


def _merged(network, diagonal, node, known):
    """Links and diagonal of the equations of nodes; those that are known have none."""
    row, kept = row_numbers(network.indptr), network.conductance > 0
    one, two = node[row[kept]], node[network.indices[kept].astype(np.int64)]
    free = ~(known[one] | known[two])
    ends = one[free], two[free]
    links = sparse.coo_array((network.conductance[kept][free], ends), shape=(len(known), len(known))).tocsr()
    indices = links.indices.astype(network.indices.dtype)
    diagonal = np.where(known, 0.0, np.bincount(node, diagonal, minlength=len(known)))
    return Links(links.indptr.astype(np.int64), indices, links.data), diagonal


def _solved(links, diagonal, heat, solver, tolerance, most):
    """Solution, iterations, and the residual that is left, of the heat that enters."""
    size, x, left = np.sqrt(dot(heat, heat)), np.zeros(len(heat)), np.empty_like(heat)
    if size == 0:
        return x, 0, 0.0
    with one_blas_thread(), stage("equations") as done:
        how = by_diagonal(diagonal) if solver == "cg" else preconditioner(links, diagonal, COARSE[solver])
        iterations = preconditioned(links, diagonal, how, heat.copy(), x, 0.9 * tolerance * size, most, done)
    apply(links, diagonal, x, left)
    np.subtract(heat, left, out=left)
    return x, int(iterations), float(np.sqrt(dot(left, left)) / size)


def _within(network, label, ties, heat, how):
    """By what temperatures differ in good bodies that take up heat here and give it there, to walls or none."""
    inside, count = label >= 0, int(label.max(initial=-1)) + 1
    diagonal = np.bincount(row_numbers(network.indptr), network.conductance, minlength=len(label)) + ties
    # Of bodies that no wall holds what the equations left over is spread.
    own = np.where(np.bincount(label[inside], ties[inside], count)[label] == 0, label, -1)
    free = own >= 0
    spread = np.bincount(own[free], heat[free], count) / np.maximum(np.bincount(own[free], minlength=count), 1)
    heat = np.where(inside & (diagonal > 0), heat - np.where(free, spread[own], 0.0), 0.0)
    x, _, _ = _solved(links_of(network), diagonal, heat, "cg", *how)
    return x
