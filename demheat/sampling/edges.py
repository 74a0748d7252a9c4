"""What a network knows at the edges of its phases: temperatures on interfaces and held walls, slopes at others.

At walls that exchange heat with surroundings it knows how both hang together: the slope and the film's share of the
temperature. Where conductivities depend on temperature all are those of Kirchhoff's transform: its slope times the
conductivity at factor 1 is the flux.
"""

from typing import NamedTuple

import numpy as np

from demheat.network.base import SIDES, branches, radical_distances, row_numbers, wall_normals
from demheat.scene import STEFAN_BOLTZMANN, Convection

# Facets smaller than this part of their cell's size lie away from the line between the two centres. Facets lie on an
# interface if the phases change within this part of the cell's width on either side of them.
SMALL, NEAR = 0.05, 0.05


class Edges(NamedTuple):
    """Points on the edges of cells, ordered by cell."""

    start: np.ndarray  # (n + 1,) int array: Where the points of each cell begin
    # places, normals: (m, 3) float arrays, m and outward unit vectors
    places: np.ndarray
    normals: np.ndarray
    values: np.ndarray  # (m,) float array, K: Temperature, less the linear field of a mean gradient
    slopes: np.ndarray  # (m,) float array, K/m: Of the whole temperature along the normal, on the cell's side
    # (m,) float array, 1/m: What is known is the slope and so many times the value, added: 0 at walls with a flux or
    # none, infinite at interfaces and held walls, where it is the value, between at films, coefficient of exchange over
    # conductivity
    film: np.ndarray


def edges_of(scene, network, solution):
    """Edges of all cells of a network with facets.

    A facet that lies on an interface has the temperature that the heat through it makes on the way from either centre:
    the same for both. In packings that do not conform facets between phases lie elsewhere, and are left out.
    """
    parts = _interfaces(scene, network, solution), _walls(scene, network, solution)
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    owner, _, _, values, slopes, _ = columns
    kept = np.isfinite(values) & np.isfinite(slopes)
    order = np.flatnonzero(kept)[np.argsort(owner[kept], kind="stable")]
    count = np.bincount(owner[order], minlength=len(network.volumes))
    return Edges(np.concatenate([[0], np.cumsum(count)]), *(column[order] for column in columns[1:]))


def transformed(scene, phase, temperature):
    """Kirchhoff's transform of temperatures in phases, or themselves where no conductivity depends on them."""
    return scene.dependences.integral(phase, temperature) if scene.varies else temperature


def _interfaces(scene, network, solution):
    row, k = row_numbers(network.indptr), scene.conductivities[network.phase]
    other = network.indices
    size = SMALL * np.cbrt(network.volumes) ** 2
    here = (network.phase[row] != network.phase[other]) & (network.conductance > 0) & (network.area > size[row])
    row, other = row[here], other[here].astype(np.int64)
    ends = np.concatenate([[0], np.cumsum(here)])[network.indptr]
    step = branches(network.centers, network.size, ends, other, network.image[here])
    normal, weight = step / np.linalg.norm(step, axis=1)[:, None], network.radii**2
    away = radical_distances(np.einsum("ij,ij->i", step, step), weight[row], weight[other])
    rise = solution.temperature[other] - solution.temperature[row] + step @ solution.mean_gradient
    slope = network.conductance[here] * rise / (k[row] * network.area[here])
    level = transformed(scene, network.phase, solution.temperature)
    value = level[row] + away * (slope - normal @ solution.mean_gradient)
    place = network.centers[row] + away[:, None] * normal
    step = NEAR * np.cbrt(network.volumes[row])[:, None] * normal
    on = (scene.phase_at(place - step) == network.phase[row]) & (scene.phase_at(place + step) == network.phase[other])
    return tuple(column[on] for column in (row, place, normal, value, slope, np.full(len(row), np.inf)))


def _walls(scene, network, solution):
    cell, k = network.wall_particle.astype(np.int64), scene.conductivities[network.phase]
    normal = wall_normals(network)
    place = network.centers[cell] + network.wall_distance[:, None] * normal
    passing = k[cell] * network.wall_area
    slope = np.divide(solution.wall_heat, passing, out=np.full(len(cell), np.nan), where=passing > 0)
    value, film = solution.wall_temperature, k[cell]
    if scene.varies:
        film = film * scene.dependences.factor(network.phase[cell], value)
        value = transformed(scene, network.phase[cell], value)
    return cell, place, normal, value, slope, _film(scene, network, solution, film)


def _film(scene, network, solution, k):
    """Coefficient of exchange over conductivity at each wall facet, infinite where a temperature is held, 1/m."""
    film = np.zeros(len(k))
    for name, load in (scene.walls or {}).items():
        here = network.wall_side == SIDES.index(name)
        if name in scene.wall_temperatures:
            film[here] = np.inf
        elif name in scene.wall_exchanges:
            by = load.coefficient if isinstance(load, Convection) else _tangent(load, solution.wall_temperature[here])
            film[here] = np.divide(by, k[here], out=np.zeros(here.sum()), where=k[here] > 0)
    return film


def _tangent(load, surface):
    return 4.0 * load.emissivity * STEFAN_BOLTZMANN * np.nan_to_num(surface) ** 3
