"""What drives a transient at a time: temperatures and fluxes of walls, heat sources."""

from typing import NamedTuple

import numpy as np

from demheat.scene import UniformSource
from references.fem.robin import RobinWalls
from references.fem.sources import deposit


class Loading(NamedTuple):
    """The loads at one time."""

    temperature: np.ndarray  # (k,) float array, K: Of the held nodes, from the level of the run
    heat: np.ndarray  # (n,) float array, W: Into each node
    powers: np.ndarray  # (m,) float array, W: Of each of `Loads.names`; 0 for held walls
    wall_temperature: dict[str, float]  # K: Of held walls
    outside: dict[str, float]  # K: Of the surroundings of walls that exchange heat


class Loads:
    """Loads of a scene on the nodes of a space."""

    def __init__(self, scene, space, *, level):
        self.scene, self.space, self.level = scene, space, level
        self.names = (*scene.walls, "sources", "lost")
        self.walls = {name: space.walls[name].nodes for name in scene.wall_temperatures}
        self.count = np.zeros(len(space.points))  # held walls that meet at each node
        for nodes in self.walls.values():
            self.count[nodes] += 1
        self.held = np.flatnonzero(self.count)
        steady = sum(source.power_density for source in scene.sources if isinstance(source, UniformSource))
        self.heating = steady * space.volumes
        walls = {name: (load, space.walls[name].surface()) for name, load in scene.wall_exchanges.items()}
        self.robin = RobinWalls(walls, len(space.points))
        self.stiffness = (space.stiffness + self.robin.stiffness()).tocsr() if walls else space.stiffness
        self.moving = [source for source in scene.sources if not isinstance(source, UniformSource)]
        self._known = {}

    def at(self, time):
        """`Loading` at a time in seconds."""
        if time not in self._known:
            if len(self._known) > 3:  # a step asks for two times, each of them twice at most
                self._known.clear()
            self._known[time] = self._at(time)
        return self._known[time]

    def _at(self, time):
        now = self.scene.at(time)
        temperature, heat = np.zeros(len(self.count)), self.heating.copy()
        powers = dict.fromkeys(self.names, 0.0)
        for name, value in now.wall_temperatures.items():
            temperature[self.walls[name]] += value - self.level
        # On an edge where two held walls meet, the mean of both.
        temperature[self.held] /= self.count[self.held]
        for name, value in now.wall_fluxes.items():
            entering = value * self.space.walls[name].weights
            heat += entering
            powers[name] = entering.sum()
        outside = {name: load.temperature for name, load in now.wall_exchanges.items()}
        heat += self.robin.constant(outside, self.level)
        powers["sources"] = self.heating.sum()
        for source in self.moving:
            made = deposit(self.scene, self.space, source, time)
            heat += made.heat
            powers["sources"] += made.power
            powers["lost"] += made.lost
        return Loading(temperature[self.held], heat, np.array(list(powers.values())), now.wall_temperatures, outside)

    def radiated(self, y, loading):
        """What walls radiate into each node, (n,) float array, W, or 0."""
        return self.robin.radiated(loading.outside, y + self.level) if self.robin.radiates else 0.0

    def rates(self, entering, y, loading):
        """Heat of each of the names, as `shares` has it, and what is exchanged with surroundings."""
        powers = self.shares(entering, loading)
        for name, heat in self.robin.entering(loading.outside, y + self.level).items():
            powers[self.names.index(name)] = heat
        return powers

    def shares(self, entering, loading):
        """Heat of each of the names: held walls by what their nodes draw in, the rest as loaded."""
        powers = loading.powers.copy()
        for place, name in enumerate(self.names):
            if name in self.walls:
                nodes = self.walls[name]
                # Where held walls meet they share the heat.
                powers[place] = np.sum(entering[nodes] / self.count[nodes])
        return powers
