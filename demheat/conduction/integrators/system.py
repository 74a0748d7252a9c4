"""The heat balance of a network in time, C dT/dt = sum H (T_q - T_p) + heat, with held nodes for imposed temperatures.

Every wall with an imposed temperature is a node of its own, behind the particles; so is a particle whose centre the
papers hold at a wall's temperature. Held nodes have empty rows and no inverse capacity: nothing moves them but the
load. Where a wall exchanges heat with a fluid, the node is the fluid, behind a film. What a wall radiates depends on
the state as no link does: explicit steps ask for it at each of their stages.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import demheat.runtime.threads  # noqa: F401 (chooses the threading layer)
from demheat.conduction.integrators import transient_kernels as kernels
from demheat.conduction.robin import loaded_areas, radiating_walls, with_convection
from demheat.network.base import SIDES, row_numbers
from demheat.network.links_kernels import Links
from demheat.scene import Radiation
from demheat.scene.functions import load_at

# Columns of every account of heat: one per side, then the sources.
ACCOUNTS = len(SIDES) + 1


class System(NamedTuple):
    """Arrays of the balance over N nodes: the n particles, then one node for each of the seven sides.

    Temperatures are relative to `level`, which spares digits.
    """

    links: Links  # Rows of held nodes are empty, their columns are not
    capacity: np.ndarray  # (N,) float array, J/K: Zero for held nodes
    inverse: np.ndarray  # (N,) float array, K/J: 1 / capacity, zero for held nodes
    diagonal: np.ndarray  # (N,) float array, W/K: Sum of each row's conductances
    held: np.ndarray  # (k,) int array: Nodes with imposed temperatures, surroundings among them
    ties: kernels.Ties  # Ties: The links from free particles to held nodes once more
    held_at: Callable  # callable (time, s) -> (k,) float array, K
    # callable (time, s) -> (N,) float array, W, and (8,) float array, W: Imposed fluxes and sources: into each node,
    # and their totals by side, sources last
    heat_at: Callable
    level: float
    particles: int
    # callable (state, (N,) float array, K; time, s) -> as `heat_at`, optional: What walls that radiate let in
    radiation: Callable | None = None
    # System, optional: One whose rates none of this one's exceeds, with links only: where walls radiate they are held
    # there
    bound: "System | None" = None

    def heat(self, x, time):
        """Heat flow into each node that no link brings, of a state at a time: of `heat_at`, and what walls radiate."""
        heat, totals = self.heat_at(time)
        if self.radiation is None:
            return heat, totals
        more, by_side = self.radiation(x, time)
        return heat + more, totals + by_side

    def hold(self, x, time):
        """Set held nodes to their temperatures at a time."""
        x[self.held] = self.held_at(time)

    def inflow(self, x, totals):
        """Heat flow into the free particles."""
        out = totals.copy()
        kernels.received(self.ties, x, out)
        return out


def semi_discrete(network, scene, capacity, *, power=None, held_centers=None, level=0.0):
    """Balance of a network under a scene's loads."""
    n = len(capacity)
    if not np.all(np.isfinite(capacity) & (capacity > 0)):
        raise ValueError(f"capacity: {np.sum(~(capacity > 0))} of {n} are not > 0; all must be finite and > 0 J/K")
    held, sides = _held(network, scene, held_centers, n)
    network = with_convection(network, scene)
    walls = radiating_walls(network, scene)
    tied = [name for name in scene.imposed_temperatures if not isinstance(scene.walls[name], Radiation)]
    links = _links(network, tied, np.isin(np.arange(n), held), n)
    capacity = np.concatenate([capacity, np.zeros(len(SIDES))])
    capacity[held] = 0.0
    inverse = np.divide(1.0, capacity, out=np.zeros_like(capacity), where=capacity > 0)
    side_of = np.full(n + len(SIDES), -1)
    side_of[held] = sides
    system = System(
        links=links,
        capacity=capacity,
        inverse=inverse,
        diagonal=_diagonal(links, capacity),
        held=held,
        ties=_ties(links, side_of),
        held_at=_held_at(scene, sides, level),
        heat_at=_heat_at(network, scene, capacity > 0, power),
        level=level,
        particles=n,
    )
    if not walls:
        return system
    # A film conducts no better than none: the rates of held walls are never exceeded.
    links = _links(network, list(scene.imposed_temperatures), np.isin(np.arange(n), held), n)
    bound = system._replace(links=links, diagonal=_diagonal(links, capacity), ties=_ties(links, side_of))
    return system._replace(radiation=_radiation(walls, system), bound=bound)


def _diagonal(links, capacity):
    return np.bincount(row_numbers(links.indptr), links.conductance, minlength=len(capacity))


def _radiation(walls, system):
    """Function of state and time that gives what walls radiate into each node, and the totals by side."""

    def at(x, time):
        heat, totals, temperature = np.zeros(len(x)), np.zeros(ACCOUNTS), x[: system.particles] + system.level
        for wall in walls:
            entering = wall.heat(temperature, time)
            heat += np.bincount(wall.particle, entering, minlength=len(x))
            totals[wall.side] += entering.sum()
        return heat, totals

    return at


def initial_state(system, temperature, time):
    """State of a system."""
    x = np.zeros(len(system.capacity))
    x[: system.particles] = temperature - system.level
    system.hold(x, time)
    return x


def _held(network, scene, held_centers, n):
    """Held nodes and their sides."""
    imposed = [SIDES.index(name) for name in scene.imposed_temperatures]
    nodes, sides = [n + np.array(imposed, dtype=np.int64)], [np.array(imposed, dtype=np.int64)]
    if held_centers is not None:
        here = held_centers[network.wall_particle] & np.isin(network.wall_side, imposed)
        nodes.append(network.wall_particle[here].astype(np.int64))
        sides.append(network.wall_side[here].astype(np.int64))
    return np.concatenate(nodes), np.concatenate(sides)


def _links(network, names, empty, n):
    """Links of the network with links to the nodes of some walls at their ends, rows of held particles emptied."""
    imposed = np.isin(network.wall_side, [SIDES.index(name) for name in names])
    tied = imposed & ~empty[network.wall_particle] & (network.wall_conductance > 0)
    order = np.flatnonzero(tied)[np.argsort(network.wall_particle[tied], kind="stable")]
    particle = network.wall_particle[order]
    kept = ~empty[row_numbers(network.indptr)] & (network.conductance > 0)
    number = np.bincount(row_numbers(network.indptr)[kept], minlength=n)
    ends = np.cumsum(number)[particle]
    indices = np.insert(network.indices[kept].astype(np.int64), ends, n + network.wall_side[order])
    conductance = np.insert(network.conductance[kept], ends, network.wall_conductance[order])
    number = np.concatenate([number + np.bincount(particle, minlength=n), np.zeros(len(SIDES), dtype=np.int64)])
    return Links(np.concatenate([[0], np.cumsum(number)]), indices.astype(np.uint32), conductance)


def _ties(links, side_of):
    """Links to held nodes, from the side that holds each node, -1 where none does."""
    ties = np.flatnonzero(side_of[links.indices] >= 0)
    node = links.indices[ties].astype(np.int64)
    return kernels.Ties(row_numbers(links.indptr)[ties], node, links.conductance[ties], side_of[node])


def _held_at(scene, sides, level):
    loads = {SIDES.index(name): (name, load) for name, load in scene.imposed_temperatures.items()}
    place = np.searchsorted(sorted(loads), sides)
    changing = any(callable(load) for _, load in loads.values())

    def held_at(time):
        values = np.array([load_at(*loads[side], time) - level for side in sorted(loads)])
        return values[place] if len(place) else np.empty(0)

    if changing:
        return held_at
    fixed = held_at(0.0)
    return lambda time: fixed


def _heat_at(network, scene, free, power):
    """Function of time that gives the heat flow into each node and the totals by side, sources last."""
    n = len(network.volumes)
    fluxes = []
    for name, load in scene.wall_fluxes.items():
        here = network.wall_side == SIDES.index(name)
        areas = np.bincount(network.wall_particle[here], loaded_areas(network, scene, name), minlength=len(free)) * free
        fluxes.append((SIDES.index(name), name, load, areas))
    if power is None and not any(callable(load) for _, _, load, _ in fluxes):
        fixed = _heat(fluxes, None, free, n, 0.0)
        return lambda time: fixed
    return lambda time: _heat(fluxes, power, free, n, time)


def _heat(fluxes, power, free, n, time):
    heat, totals = np.zeros(len(free)), np.zeros(ACCOUNTS)
    for side, name, load, areas in fluxes:
        value = load_at(name, load, time)
        heat += value * areas
        totals[side] = value * areas.sum()
    if power is not None:
        given = power(time) * free[:n]
        heat[:n] += given
        totals[-1] = given.sum()
    return heat, totals
