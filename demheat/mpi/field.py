"""The Field of all ranks: sums over all, and parts that stay where they are until all ranks ask for them."""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from demheat.conduction.steady import Solution
from demheat.field import Field, Samples
from demheat.mpi.cells import Cells, own_part
from demheat.mpi.slabs import Slabs
from demheat.network.base import SIDES, Network
from demheat.packing.base import wrap
from demheat.sampling.field_of import between_walls, heat_through, samplers
from demheat.sampling.fluxes import mean_flux
from demheat.scene import Scene


class Sums(NamedTuple):
    """What adds up over slabs."""

    flux: np.ndarray  # (3,) float array, W/m2: Mean flux density, the slab's part of it
    volumes: np.ndarray  # (phases,) float array, m3
    # (loaded walls, 3) float array: Of each: area times temperature where that is known, m2 K; that area, m2; heat that
    # enters, W
    walls: np.ndarray


def field_of(
    scene: Scene, cells: Cells, solution: Solution, slabs: Slabs, comm, *, estimator: Callable | None = None
) -> Field:
    """The Field of a distributed solution: every rank must ask for the same at the same time."""
    network, own = own_of(cells, solution)
    sums = Sums(*(_sum(comm, each) for each in sums_of(scene, network, own)))
    at = cache(lambda: samplers(scene, cells.network, solution)[1:])
    where = {"scene": scene, "slabs": slabs, "comm": comm}
    return Field(
        scene=scene,
        **_told(scene, sums),
        sampler=lambda: _gathered(samplers(scene, network, own)[0](), cells.own, comm),
        temperature_at=lambda points: _at(points, lambda: at()[0], slope=solution.mean_gradient, **where),
        flux_at=lambda points: _at(points, lambda: at()[1], slope=None, **where),
        through=lambda axis, position: float(_sum(comm, heat_through(network, own, axis, position))),
        estimator=estimator,
    )


def _sum(comm, values):
    """Over all ranks."""
    return np.asarray(comm.allreduce(np.asarray(values, dtype=float)))


def _gathered(samples, own, comm):
    """Samples of all ranks on each of them, rank by rank."""
    return Samples(*(np.concatenate(comm.allgather(np.ascontiguousarray(column[:own]))) for column in samples))


def _at(points, evaluate, *, slope, scene, slabs, comm):
    """Values at points, each by the rank in whose slab it lies."""
    inside = wrap(points, np.array(scene.size), np.broadcast_to(scene.periodic, 3))
    here = slabs.owner(inside) == slabs.rank
    # A rank without points sums up nothing, but takes part.
    found = evaluate()(inside[here])
    values = np.zeros((len(points), *found.shape[1:]))
    values[here] = found
    values = _sum(comm, values)
    return values if slope is None else values + (points - inside) @ slope


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


def _told(scene, sums):
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
