"""The heat balance of a network under a steady load: its equations, what they leave over, and what walls receive."""

from typing import NamedTuple

import numpy as np

from demheat.conduction.products import apply, flows, row_sums
from demheat.conduction.robin import RobinWalls, robin_of
from demheat.network.base import SIDES, Network
from demheat.network.links_kernels import links_of


class System(NamedTuple):
    """A x = heat with A = diag(diagonal) - conductance; rows of isolated components are empty."""

    network: Network
    diagonal: np.ndarray  # (n,) float array, W/K
    heat: np.ndarray  # (n,) float array, W
    gradient: np.ndarray  # (3,) float array, K/m
    ties: np.ndarray  # (w,) float array, W/K: Conductance to held walls and surroundings
    held: np.ndarray  # (w,) float array, K: Their temperature above the level
    level: float  # K: Temperatures are solved for relative to it, which spares digits
    robin: RobinWalls | None = None
    passing: np.ndarray | None = None  # (n,) float array, W: What passes where there are no fluctuations


def system_of(network, scene, reached, robin=None):
    """The equations of a network under a steady load."""
    n = len(network.volumes)
    gradient = np.array(scene.gradient if scene.periodic else (0.0, 0.0, 0.0))
    diagonal = conducted(network)
    if scene.periodic:
        received, passing, _ = flows(network, gradient, np.zeros(n))
        return System(network, diagonal, received, gradient, np.empty(0), np.empty(0), 0.0, passing=passing)
    robin = robin_of(network, scene) if robin is None else robin
    ties = robin.ties(network.wall_conductance)
    level = level_of(scene)
    held = np.nan_to_num(robin.outside - level)
    heat = np.bincount(network.wall_particle, ties * held + _imposed(network, scene), minlength=n)
    diagonal += np.bincount(network.wall_particle, ties, minlength=n)
    cut_off = np.count_nonzero(heat[~reached])
    if cut_off:
        raise ValueError(
            f"Scene.walls: {cut_off} particles receive an imposed flux but are cut off from every wall temperature; "
            "no steady state exists"
        )
    diagonal[~reached] = 0.0
    return System(network, diagonal, heat, gradient, ties, held, level, robin)


def level_of(scene):
    """What temperatures are counted from between walls: their mean."""
    return float(np.mean(list(scene.imposed_temperatures.values())))


def linear_start(network, scene, reached):
    """Linear field between two opposite temperatures, else zero, relative to the level, (n,) float array, K."""
    temperatures = {} if scene.periodic else scene.imposed_temperatures
    start = np.zeros(len(reached))
    for axis, letter in enumerate("xyz"):
        if {letter + "-", letter + "+"} == set(temperatures):
            low, high = temperatures[letter + "-"], temperatures[letter + "+"]
            start = (high - low) * (network.centers[:, axis] / network.size[axis] - 0.5)
    start[~reached] = 0.0
    return start


def conducted(network):
    """Sum of the conductances of each particle's links, (n,) float array, W/K."""
    return row_sums(network.indptr, network.conductance)


def _imposed(network, scene):
    """Heat that imposed fluxes bring in through each wall facet, W."""
    return np.array([scene.wall_fluxes.get(name, 0.0) for name in SIDES])[network.wall_side] * network.wall_area


def residual(system, x):
    """Heat that each particle receives in excess, (n,) float array, W; components without an equation get none."""
    r = np.empty_like(x)
    apply(links_of(system.network), system.diagonal, x, r)
    np.subtract(system.heat, r, out=r)
    r[system.diagonal == 0.0] = 0.0
    return r


def throughput(system, x):
    """Heat that passes through each particle, (n,) float array, W."""
    network = system.network
    if system.passing is not None and not x.any():
        return system.passing
    _, through, _ = flows(network, system.gradient, x)
    if len(system.ties):
        particle = network.wall_particle
        through += np.bincount(particle, np.abs(system.ties * (system.held - x[particle])), minlength=len(x))
    return through


def at_walls(system, scene, x):
    """Temperature and entering heat of each wall facet, two (w,) float arrays, K and W."""
    if scene.periodic:
        return np.empty(0), np.empty(0)
    network, inside = system.network, x[system.network.wall_particle]
    imposed, conductance = _imposed(network, scene), network.wall_conductance
    rise = np.divide(imposed, conductance, out=np.zeros_like(conductance), where=conductance > 0)
    is_held = np.isfinite(system.robin.outside)
    temperature = np.where(is_held, system.robin.surface(conductance, inside), inside + rise)
    heat = np.where(is_held, system.ties * (system.held - (inside - system.level)), imposed)
    return temperature, np.where(np.isnan(heat), 0.0, heat)
