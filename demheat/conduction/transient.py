"""Temperatures of a network in time, under a scene's walls and sources."""

import numpy as np

from demheat.conduction.integrators.march import march
from demheat.conduction.integrators.pace import pace_of
from demheat.conduction.integrators.system import semi_discrete
from demheat.conduction.robin import loaded_areas, radiating_walls, with_convection
from demheat.conduction.steady import Solution
from demheat.network.base import SIDES
from demheat.scene import Convection, Flux, Radiation
from demheat.scene.functions import changing_loads, initial_at, load_at


def capacities(network, scene):
    """Heat capacity of each particle: density times specific heat times volume."""
    per_volume = np.array([material.density * material.heat_capacity for material in scene.materials])
    return per_volume[network.phase] * network.volumes


def evolve(
    network,
    scene,
    times,
    *,
    power=None,
    transits=(),
    held_centers=None,
    integrator="auto",
    accuracy=1e-3,
    step=None,
):
    """Temperatures, wall temperatures and wall heat of a network at the asked times."""
    start, capacity = initial_at(scene, network.centers), capacities(network, scene)
    system = semi_discrete(network, scene, capacity, power=power, held_centers=held_centers, level=float(start.mean()))
    pace = pace_of(changing_loads(scene), transits, float(times[-1]), accuracy)
    for state in march(system, start, times, integrator=integrator, accuracy=accuracy, step=step, pace=pace):
        yield state.time, Solution(state.temperature, np.zeros(3), *_walls(network, scene, system, state), state.stats)


def check_callables(scene):
    """Raise ValueError unless the functions of a scene give numbers at time 0, in the middle of the body and near it.

    What they give elsewhere and later is checked where they are asked for.
    """
    for load in changing_loads(scene):
        load(0.0)
    # Within a sphere inscribed in the box as well.
    initial_at(scene, np.array(scene.size) * [[0.5, 0.5, 0.5], [0.4, 0.5, 0.6], [0.7, 0.4, 0.5]])


def _walls(network, scene, system, state):
    """Temperature and entering heat of each wall facet at a time."""
    here = state.temperature[network.wall_particle]
    temperature, heat = here.copy(), np.zeros(len(here))
    held_centers = np.isin(network.wall_particle, system.held)
    given = _given_on(network, system, state) if held_centers.any() else None
    tied = with_convection(network, scene).wall_conductance
    for name, load in (scene.walls or {}).items():
        value, at = load_at(name, load, state.time), network.wall_side == SIDES.index(name)
        if isinstance(load, Flux):
            heat[at] = value * loaded_areas(network, scene, name)
        elif not isinstance(load, Radiation):
            heat[at] = tied[at] * (value - here[at])
            if held_centers.any():
                held = at & held_centers
                heat[held] = given[network.wall_particle[held]]
        if not isinstance(load, Flux | Convection | Radiation):
            temperature[at] = value
    for wall in radiating_walls(network, scene):
        heat[wall.facet] = wall.heat(state.temperature, state.time)
    own, is_open = network.wall_conductance, ~np.isin(network.wall_side, _sides(scene.wall_temperatures))
    temperature += np.divide(heat, own, out=np.zeros_like(own), where=is_open & (own > 0))
    return temperature, heat


def _sides(names):
    return [SIDES.index(name) for name in names]


def _given_on(network, system, state):
    """Heat that each held particle passes on to its neighbours, (n,) float array, W."""
    ties = system.ties
    flow = ties.conductance * (_tied(system, state) - state.temperature[ties.row])
    return np.bincount(ties.node, flow, minlength=len(network.volumes))


def _tied(system, state):
    """Temperature of the held node of each tie."""
    x = np.zeros(len(system.capacity))
    system.hold(x, state.time)
    return x[system.ties.node] + system.level
