"""Robin's condition at walls with surroundings: a film between these and the surface, in series with the facet's own.

Convection lets in h A (T_a - T_s). Radiation, e sigma A (T_a^4 - T_s^4), is the same to first order about a surface
temperature T: with h = 4 e sigma T^3 and surroundings at T + (T_a^4 - T^4) / (4 T^3), as Newton's method takes it.
"""

from typing import NamedTuple

import numpy as np

from demheat.network.base import SIDES
from demheat.scene import ROUND_AXES, STEFAN_BOLTZMANN, Convection, Radiation
from demheat.scene.functions import load_at

# No surface is linearised about less than this part of the hottest temperature: flat as the fourth power is there, what
# it then errs by is less than rounding.
COLDEST = 1e-4
# Newton's method on a convex function of one temperature, from above: it loses a quarter of what is too much in each
# step at least, then doubles its digits.
STEPS, SAME = 60, 1e-14


class RobinWalls(NamedTuple):
    """Between surroundings and the surfaces of wall facets."""

    # (w,) float array, W/K: Infinite at walls that hold a temperature, 0 at those with a flux or none
    conductance: np.ndarray
    outside: np.ndarray  # (w,) float array, K: Temperature beyond the film; NaN where there is none

    def ties(self, own):
        """Conductance from outside to the particles, given the facets' own, (w,) float array, W/K."""
        return in_series(self.conductance, own)

    def surface(self, own, inside):
        """Temperature of surfaces."""
        film = np.where(np.isinf(self.conductance), 0.0, self.conductance)
        whole = own + film
        mixed = (own * inside + film * np.nan_to_num(self.outside)) / np.where(whole > 0, whole, 1.0)
        mixed = np.where(own > 0, mixed, inside)
        return np.where(np.isinf(self.conductance), self.outside, mixed)


def in_series(one, other):
    """Conductance of two in series; either may be 0, the first infinite."""
    whole = one + other
    part = np.divide(one, whole, out=np.zeros(len(whole)), where=np.isfinite(whole) & (whole > 0))
    return np.where(np.isinf(one), other, part * other)


def robin_of(network, scene, surface=None) -> RobinWalls:
    """What lies outside of all wall facets, at loads that do not depend on time."""
    film, outside = np.zeros(len(network.wall_side)), np.full(len(network.wall_side), np.nan)
    for name, value in scene.imposed_temperatures.items():
        here, load = network.wall_side == SIDES.index(name), scene.walls[name]
        outside[here], film[here] = value, np.inf
        if isinstance(load, Convection):
            film[here] = load.coefficient * loaded_areas(network, scene, name)
        elif isinstance(load, Radiation):
            at = surface[here]
            film[here] = 4.0 * load.emissivity * STEFAN_BOLTZMANN * at**3 * loaded_areas(network, scene, name)
            outside[here] = 0.75 * at + 0.25 * value**4 / at**3
    return RobinWalls(film, outside)


def radiated(network, scene, surface):
    """Heat that radiation brings in through each wall facet at its surface's temperature, (w,) float array, W."""
    heat = np.zeros(len(network.wall_side))
    for name, load in scene.wall_exchanges.items():
        if isinstance(load, Radiation):
            here = network.wall_side == SIDES.index(name)
            per_area = load.emissivity * STEFAN_BOLTZMANN * (load.temperature**4 - surface[here] ** 4)
            heat[here] = per_area * loaded_areas(network, scene, name)
    return heat


def hottest(network, scene) -> float:
    """A temperature that no radiating surface of a steady state exceeds, K: all fluxes left by radiation alone."""
    entering, leaving, around = 0.0, 0.0, 0.0
    for name, value in scene.wall_fluxes.items():
        entering += max(value, 0.0) * float(loaded_areas(network, scene, name).sum())
    for name, load in scene.wall_exchanges.items():
        if isinstance(load, Radiation):
            leaving += load.emissivity * STEFAN_BOLTZMANN * float(loaded_areas(network, scene, name).sum())
            around = max(around, load.temperature)
    alone = (around**4 + entering / leaving) ** 0.25
    return max(alone, *scene.imposed_temperatures.values()) or 1.0


def radiating_surface(own, black, inside, around):
    """Surface temperature at which what a facet conducts is what it radiates: b T^4 + g T = b T_a^4 + g T_p."""
    inside = np.maximum(inside, 0.0)
    known = black * around**4 + own * inside
    surface = np.maximum(inside, around)
    for _ in range(STEPS):
        slope = 4.0 * black * surface**3 + own
        change = np.divide(black * surface**4 + own * surface - known, slope, out=np.zeros_like(slope), where=slope > 0)
        surface = np.maximum(surface - change, 0.0)
        if np.all(np.abs(change) <= SAME * surface):
            break
    return surface


def loaded_areas(network, scene, name):
    """Areas of a wall's facets, summing to the body's own surface there.

    Planes that stand for a round wall enclose the exact volume with a few parts in 10^4 more of area: a flux density
    would bring in so much more heat.
    """
    areas = network.wall_area[network.wall_side == SIDES.index(name)]
    if name != "round":
        return areas
    across = ROUND_AXES[scene.domain]
    # Round area times radius over the number of round axes is the volume.
    return areas * (len(across) * scene.volume / (scene.size[across[0]] / 2) / areas.sum())


class Radiating(NamedTuple):
    """A wall that radiates, in time."""

    name: str
    load: Radiation
    side: int
    # facet, particle: (v,) int arrays: Those facets that conduct, among all, and their particles
    facet: np.ndarray
    particle: np.ndarray
    # own, black: (v,) float arrays, W/K and W/K4: As in `radiating_surface`
    own: np.ndarray
    black: np.ndarray

    def heat(self, temperature, time):
        """Heat that enters through each facet."""
        around = load_at(self.name, self.load, time)
        surface = radiating_surface(self.own, self.black, temperature[self.particle], around)
        return self.black * (around**4 - surface**4)


def radiating_walls(network, scene) -> list[Radiating]:
    """Walls of a scene that radiate, on a network."""
    found = []
    for name, load in scene.wall_exchanges.items():
        if isinstance(load, Radiation):
            side = SIDES.index(name)
            here = np.flatnonzero(network.wall_side == side)
            black = load.emissivity * STEFAN_BOLTZMANN * loaded_areas(network, scene, name)
            kept = network.wall_conductance[here] > 0
            here = here[kept]
            own = network.wall_conductance[here]
            found.append(Radiating(name, load, side, here, network.wall_particle[here], own, black[kept]))
    return found


def with_convection(network, scene):
    """The network with convection in series with the conductances of its wall facets."""
    conductance = network.wall_conductance.copy()
    for name, load in scene.wall_exchanges.items():
        if isinstance(load, Convection):
            here = network.wall_side == SIDES.index(name)
            conductance[here] = in_series(load.coefficient * loaded_areas(network, scene, name), conductance[here])
    return network._replace(wall_conductance=conductance)
