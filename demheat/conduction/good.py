"""Good conductors in a network: each connected body of them is one unknown, and what differs in it is solved apart.

Temperatures are y + z: y is one temperature in each body, z is what differs in bodies alone. A round solves for y, with
bodies as nodes, then for z, in bodies, with the heat that y brings there; both are blind to the contrast between bodies
and the rest, and a round leaves of the error about as much as the rest conducts of what bodies do. As z is kept apart
it has all of its digits: of a sum at a contrast of 1e12 rounding would leave four of them. The vectors of bodies are
those of deflation (Vuik, Segal and Meijerink, J. Comput. Phys. 152 (1999) 385).
"""

from typing import NamedTuple

import numpy as np
from scipy import sparse

from demheat.conduction import components
from demheat.conduction.balance import System, at_walls, level_of, linear_start, system_of, throughput
from demheat.conduction.multigrid import preconditioner
from demheat.conduction.preconditioned import by_diagonal, preconditioned
from demheat.conduction.products import apply, dot, row_sums
from demheat.conduction.steady import AMG_UNKNOWNS, COARSE, Solution, reached_by
from demheat.network.base import SIDES, row_numbers, without_links
from demheat.network.links_kernels import Links, links_of
from demheat.runtime.process_state import one_blas_thread
from demheat.runtime.progress import stage
from demheat.scene.perfect import GOOD, recast
from demheat.scene.resistances import between

# So many times better than all the rest are good conductors. Below it rounds are many where bodies touch in points.
APART = 1e5
# Rounds at most, and what each must leave of the last one's residual: mostly it takes off three digits or more.
ROUNDS, SLOW = 12, 0.3
# How often one round alone is aimed anew: what passes is often far less than what is left at first.
AGAIN = 5


class Bodies(NamedTuple):
    """Connected bodies of chosen particles."""

    label: np.ndarray  # (n,) int array: Body of each particle, -1 outside
    shift: np.ndarray  # (n, 3) int array: Boxes by which a particle is moved to where its body reaches it
    within: np.ndarray  # (m,) bool array: Links in bodies
    at_wall: np.ndarray  # (w,) bool array: Facets of bodies at walls with a temperature
    held: np.ndarray  # (bodies,) float array: Temperature of the wall that each meets, NaN where none
    spans: np.ndarray  # (bodies,) bool array: Whether each joins two temperatures


class _Parts(NamedTuple):
    """Equations of the rest with bodies as nodes, and those in bodies."""

    outer: System
    node: np.ndarray  # (n,) int array: Node of each particle; bodies come first
    known: np.ndarray  # (nodes,) bool array: Bodies that walls hold
    links: Links
    diagonal: np.ndarray
    inner: Links
    inner_diagonal: np.ndarray


def bodies_of(network, scene, inside) -> Bodies:
    """Bodies of particles that links join, but for links that a surface resists."""
    row, other, phase = row_numbers(network.indptr), network.indices, network.phase
    within, resistance = inside[row] & inside[other] & (network.conductance > 0), between(scene)
    if resistance is not None:
        unlike = np.flatnonzero(within & (phase[row] != phase[other]))
        within[unlike] = resistance(phase[row[unlike]], phase[other[unlike]]) == 0
    links, feet = network.over or (np.empty(0, int),) * 2
    within[links] = False
    alone = network._replace(conductance=np.where(within, network.conductance, 0.0))
    gradient = np.array(scene.gradient if scene.periodic else (0.0, 0.0, 0.0))
    found, count = components.gathered(alone, inside, gradient * network.size)
    low, high, at_wall = np.full(count, np.inf), np.full(count, -np.inf), np.zeros(len(network.wall_side), bool)
    for name, value in scene.wall_temperatures.items():
        here = (network.wall_side == SIDES.index(name)) & (network.wall_conductance > 0)
        here &= inside[network.wall_particle]
        here[feet] = False
        at_wall |= here
        met = np.unique(found.label[network.wall_particle[here]])
        low[met], high[met] = np.minimum(low[met], value), np.maximum(high[met], value)
    held = np.where(np.isfinite(low), low, np.nan)
    return Bodies(found.label, found.shift, within, at_wall, held, found.climbs[:count] | (high > low))


def good_bodies(network, scene) -> Bodies | None:
    """Bodies of good conductors that do not span the load; None if there are none.

    Where several conductivities are far apart, the first gap that leaves such bodies above it counts.
    """
    k = scene.mean_conductivities
    some = np.unique(k[k > 0])
    for low in some[:-1][some[1:] >= APART * some[:-1]]:
        inside = k[network.phase] > low
        bodies = bodies_of(network, scene, inside)
        if bodies.spans.all():
            continue
        return bodies_of(network, scene, inside & ~np.append(bodies.spans, True)[bodies.label])
    return None


def solve_good(network, scene, bodies, *, solver, tolerance, max_iterations, rounds=ROUNDS):
    """Temperatures of a network with good conductors, and the network and the scene that they are to be read with.

    None if no rounds are enough. One round alone is that of bodies without bound: what z changes outside is not asked.
    """
    pores = components.bodies(network, scene)
    network = network if pores is None else without_links(network, pores.still)
    reached = reached_by(network, scene)
    parts = _parts(network, scene, reached, bodies)
    chosen = solver if solver != "auto" else "amg" if len(parts.diagonal) > AMG_UNKNOWNS else "cg"
    y, z, total, kept, size = _first(network, scene, reached, bodies), np.zeros(len(reached)), 0, {}, np.inf
    done = 0
    while done < rounds:
        done += 1
        for _ in range(AGAIN if rounds == 1 else 1):
            left = _left(parts, y, z)
            # What passes is known only once the solution nearly is.
            aim = 0.5 * tolerance * max(_passing(parts, y + z), _norm(left)), max_iterations
            heat = np.where(parts.known, 0.0, np.bincount(parts.node, left, len(parts.known)))
            change, count, left = _solved(kept, "y", parts.links, parts.diagonal, heat, chosen, *aim)
            y, total = y + change[parts.node], total + count
            if left <= tolerance * _passing(parts, y + z) or total >= max_iterations:
                break
        heat = _spread(_left(parts, y, z), bodies, parts.inner_diagonal)
        change, count, _ = _solved(kept, "z", parts.inner, parts.inner_diagonal, heat, chosen, *aim)
        z, total = z + change, total + count
        last, size, passing = size, left if rounds == 1 else _norm(_left(parts, y, z)), _passing(parts, y + z)
        size = size / passing if passing > 0 else float(size > 0)
        if size <= tolerance or total >= max_iterations or size > SLOW * last:
            break
    if not size <= tolerance:
        return None
    stats = {"unknowns": int(np.count_nonzero(parts.diagonal)), "iterations": total, "residual": size, "solver": chosen}
    stats |= {"islands": int((~reached).sum()), "bodies": len(bodies.held), "rounds": done}
    return _read(network, scene, bodies, (y, z), reached, pores, stats)


def _parts(network, scene, reached, bodies):
    within, n = bodies.within, len(reached)
    links = links_of(network._replace(conductance=np.where(within, network.conductance, 0.0)))
    at_wall = bodies.at_wall
    ties = np.bincount(network.wall_particle[at_wall], network.wall_conductance[at_wall], n)
    outer = network._replace(
        conductance=np.where(within, 0.0, network.conductance),
        wall_conductance=np.where(at_wall, 0.0, network.wall_conductance),
    )
    outer = system_of(outer, scene, reached)
    inside, count = bodies.label >= 0, len(bodies.held)
    node = np.where(inside, bodies.label, count + np.cumsum(~inside) - 1)
    known = np.append(np.isfinite(bodies.held), np.zeros(n - np.count_nonzero(inside), bool))
    merged = _merged(outer, node, known)
    return _Parts(outer, node, known, *merged, links, row_sums(network.indptr, links.conductance) + ties)


def _merged(system, node, known):
    """Links and diagonal of the equations of nodes; those that are known have none."""
    network = system.network
    open_ = network.conductance > 0
    one, two = node[row_numbers(network.indptr)[open_]], node[network.indices[open_].astype(np.int64)]
    conductance, own = network.conductance[open_], one == two
    diagonal = np.bincount(node, system.diagonal, len(known)) - np.bincount(one[own], conductance[own], len(known))
    free = ~(known[one] | known[two] | own)
    links = sparse.coo_array((conductance[free], (one[free], two[free])), shape=(len(known),) * 2).tocsr()
    indices = links.indices.astype(network.indices.dtype)
    return Links(links.indptr.astype(np.int64), indices, links.data), np.where(known, 0.0, diagonal)


def _first(network, scene, reached, bodies):
    """Temperatures to begin with, those of the mean gradient taken off: in bodies one."""
    y, inside = linear_start(network, scene, reached), bodies.label >= 0
    label = bodies.label[inside]
    if scene.periodic:
        path = network.centers[inside] + bodies.shift[inside] * network.size
        y[inside] = -(path @ np.array(scene.gradient))
        y[inside] -= (np.bincount(label, y[inside]) / np.bincount(label))[label]
        return y
    mean = np.bincount(label, y[inside]) / np.bincount(label) if len(label) else np.empty(0)
    y[inside] = np.where(np.isfinite(bodies.held), bodies.held - level_of(scene), mean)[label]
    return y


def _left(parts, y, z):
    """Heat that each particle receives in excess, (n,) float array, W."""
    outer, inner = np.empty_like(y), np.empty_like(y)
    apply(links_of(parts.outer.network), parts.outer.diagonal, y + z, outer)
    apply(parts.inner, parts.inner_diagonal, z, inner)
    return parts.outer.heat - outer - inner


def _spread(heat, bodies, diagonal):
    """What bodies receive, less what the equations left over in those that no wall holds."""
    label = np.where(diagonal > 0, bodies.label, -1)
    free = (label >= 0) & np.isnan(np.append(bodies.held, 0.0))[label]
    count = len(bodies.held)
    over = np.bincount(label[free], heat[free], count) / np.maximum(np.bincount(label[free], minlength=count), 1)
    return np.where(label >= 0, heat, 0.0) - np.where(free, np.append(over, 0.0)[label], 0.0)


def _passing(parts, x):
    return _norm(throughput(parts.outer, x))


def _norm(heat):
    return float(np.sqrt(dot(heat, heat)))


def _solved(kept, name, links, diagonal, heat, solver, aim, most):
    """Solution of the equations, iterations, and the norm of what is left; a preconditioner is kept."""
    x, left = np.zeros(len(heat)), heat.copy()
    if _norm(heat) <= aim:
        return x, 0, _norm(heat)
    with one_blas_thread(), stage("equations") as done:
        if name not in kept:
            kept[name] = by_diagonal(diagonal) if solver == "cg" else preconditioner(links, diagonal, COARSE[solver])
        iterations = preconditioned(links, diagonal, kept[name], left, x, aim, most, done)
    return x, int(iterations), _norm(left)


def _read(network, scene, bodies, parts, reached, pores, stats):
    """The solution, beside what conducts as well as leaves its digits: so good that what differs is not seen."""
    y, z = parts
    network, scene, times = _bounded(network, scene, bodies)
    z = times * z
    system = system_of(network, scene, reached)
    x = np.where(reached, y + z, np.nan)
    if scene.periodic and pores is None:
        x -= np.average(x, weights=network.volumes)
    x += system.level
    if pores is not None:
        if scene.periodic:
            components.level_off(x, np.where(pores.still, -1, pores.label), network.volumes)
        x = np.where(pores.still, pores.temperature, x)
    warmth, entering = at_walls(system, scene, x)
    if len(entering):
        met = bodies.at_wall
        entering[met] = -(network.wall_conductance * z[network.wall_particle])[met]
    return network, scene, Solution(x, system.gradient, warmth, entering, stats, None if pores is None else pores.still)


def _bounded(network, scene, bodies):
    """Network and scene whose good conductors are at most `GOOD` times the rest, and by how much less they conduct."""
    k, inside = scene.mean_conductivities, bodies.label >= 0
    own, rest = (np.unique(network.phase[some]) for some in (inside, ~inside))
    best = k[rest].max(initial=0.0)
    times = float(k[own].min(initial=np.inf)) / (GOOD * best) if best > 0 else 1.0
    if not 1.0 < times < np.inf or scene.image is not None or len(np.intersect1d(own, rest)):
        return network, scene, 1.0
    least = float(k[own].min())
    less = recast(scene, lambda each: each / times if each >= least else each)
    conductance = np.where(bodies.within, network.conductance / times, network.conductance)
    walls = np.where(bodies.at_wall, network.wall_conductance / times, network.wall_conductance)
    return network._replace(conductance=conductance, wall_conductance=walls), less, times
