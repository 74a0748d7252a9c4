"""What a slab adds to the numbers of a Field: flux, volumes, heat at walls."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from demheat.conduction.steady import Solution
from demheat.network.base import SIDES, Network
from demheat.sampling.field_of import between_walls
from demheat.sampling.fluxes import mean_flux
from demheat.scene import Scene
from demheat.tiles.cells import Cells, own_part


class Sums(NamedTuple):
    """What adds up over slabs.

    Attributes
    ----------
    flux : (3,) float array, W/m2
        Mean flux density, the slab's part of it.
    volumes : (phases,) float array, m3
    walls : (loaded walls, 3) float array
        Of each: area times temperature where that is known, m2 K; that area, m2; heat that enters, W.
    """

    flux: np.ndarray
    volumes: np.ndarray
    walls: np.ndarray


def own_of(cells: Cells, solution: Solution) -> tuple[Network, Solution]:
    """Network and solution of a slab's own particles only."""
    mine = cells.network.wall_particle < cells.own
    walls = {name: getattr(solution, name)[mine] for name in ("wall_temperature", "wall_heat")}
    return own_part(cells.network, cells.own), solution._replace(**walls)


def sums_of(scene: Scene, network: Network, solution: Solution) -> Sums:
    """What a slab adds."""
    flux = (mean_flux if scene.periodic else between_walls)(network, scene, solution)
    volumes = np.bincount(network.phase, network.volumes, len(scene.materials))
    walls = np.zeros((len(scene.walls or {}), 3))
    for row, name in zip(walls, scene.walls or {}, strict=True):
        here = network.wall_side == SIDES.index(name)
        known = here & np.isfinite(solution.wall_temperature)
        area = network.wall_area[known]
        row[:] = area @ solution.wall_temperature[known], area.sum(), solution.wall_heat[here].sum()
    return Sums(flux, volumes, walls)


def told(scene: Scene, sums: Sums) -> dict:
    """Arguments of a Field from the sums over all slabs."""
    names = list(scene.walls or {})
    warm, area, heat = sums.walls.T
    mean = np.divide(warm, area, out=np.full(len(names), np.nan), where=area > 0)
    return {
        "mean_flux": sums.flux,
        "fractions": sums.volumes / sums.volumes.sum(),
        "wall_temperature": dict(zip(names, mean.tolist(), strict=True)),
        "wall_heat": dict(zip(names, heat.tolist(), strict=True)),
    }
