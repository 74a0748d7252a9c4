"""Units and axes around the schemes: the scaled problem of a scene on a grid, and its answers as the user has them."""

from typing import NamedTuple

import numpy as np

from demheat.scene import Scene
from references.fft.checks import PRECISIONS, Knobs
from references.fft.grid import Grid
from references.fft.link_kernels import Links
from references.fft.problem import Problem, SolvedGrid
from references.threads import Team
from references.voxels.links import links


class Units(NamedTuple):
    """What the problem is divided by, so that neither size nor conductivity meets the limits of float32."""

    length: float
    conductivity: float
    slope: float

    @property
    def flux(self):
        """Of fluxes, W/m2."""
        return self.conductivity * self.slope

    @property
    def temperature(self):
        """Of temperatures, K."""
        return self.slope * self.length


def order_of(scene: Scene) -> tuple:
    """Axes of the scene that are axes 0, 1, 2 of the grid: between walls the load's first."""
    return (0, 1, 2) if scene.periodic else (scene.axis, *(a for a in range(3) if a != scene.axis))


def linear_part(box: Scene) -> tuple:
    """Mean gradient, and the temperature at the origin."""
    if box.periodic:
        return np.array(box.gradient), 0.0
    low, high = box.wall_temperatures["x-"], box.wall_temperatures["x+"]
    return np.array([(high - low) / box.size[0], 0.0, 0.0]), low


def units_of(grid: Grid) -> Units:
    """Units of a grid's problem."""
    conductivity = grid.voxels.conductivity[grid.voxels.fractions > 0].max()
    return Units(max(grid.scene.size), float(conductivity) or 1.0, float(np.linalg.norm(grid.slope)))


def problem_of(grid: Grid, units: Units, knobs: Knobs, team: Team) -> Problem:
    """The problem that a scheme solves."""
    return Problem(
        voxels=_scaled(grid.voxels, units),
        links=_links(grid, units) if knobs.rule == "links" else None,
        gradient=direction(grid, units),
        walls=not grid.scene.periodic,
        dtype=PRECISIONS[knobs.precision],
        team=team,
        tolerance=knobs.tolerance,
        max_iterations=knobs.max_iterations,
    )


def direction(grid: Grid, units: Units) -> np.ndarray:
    """The gradient of length 1."""
    # Equal wall temperatures: any load's solution, times zero.
    return grid.slope / units.slope if units.slope else np.array([1.0, 0.0, 0.0])


def _scaled(voxels, units):
    return voxels._replace(
        spacing=voxels.spacing / units.length,
        conductivity=voxels.conductivity / units.conductivity,
        tensor=voxels.tensor / units.conductivity,
        tensors=None if voxels.tensors is None else voxels.tensors / units.conductivity,
    )


def _links(grid, units):
    found = Links(*links(grid.scene, grid.voxels.phase.shape, phase=grid.voxels.phase))
    # In place: they take as much as three fields.
    for link in found:
        link /= units.conductivity
    return found


def mean_flux(grid: Grid, units: Units, solution: SolvedGrid) -> np.ndarray:
    """Along Fourier's direction in the user's axes, (3,) float array, W/m2."""
    flux = np.empty(3)
    flux[list(grid.order)] = 0.0 - units.flux * solution.mean_flux
    return flux


def wall_heat(scene: Scene, units: Units, solution: SolvedGrid) -> dict:
    """Heat into the body through each of the two walls, W."""
    if scene.periodic:
        return {}
    area, name = scene.volume / scene.size[scene.axis], "xyz"[scene.axis]
    low, high = (float(units.flux * end * area) for end in solution.ends)
    return {name + "-": 0.0 - low, name + "+": high}
