"""The Field of all ranks: sums over all, and parts that stay where they are until all ranks ask for them."""

from __future__ import annotations

from functools import cache

import numpy as np

from demheat.conduction.steady import Solution
from demheat.field import Field, Samples
from demheat.mpi.cells import Cells, own_part
from demheat.mpi.slabs import Slabs
from demheat.network.base import SIDES
from demheat.packing.base import wrap
from demheat.sampling.field_of import between_walls, heat_through, samplers
from demheat.sampling.fluxes import mean_flux
from demheat.scene import Scene


def field_of(scene: Scene, cells: Cells, solution: Solution, slabs: Slabs, comm, **more) -> Field:
    """The Field of a distributed solution: every rank must ask for the same at the same time.

    Parameters
    ----------
    scene : Scene
    cells : Cells
    solution : Solution
        Of all particles that the rank sees.
    slabs : Slabs
    comm : mpi4py.MPI.Comm
    **more
        Of the Field: stats, estimator.

    Returns
    -------
    Field
        Its `samples` gather all particles on every rank; temperatures and fluxes at points are those of the ranks in
        whose slabs the points lie.
    """
    network = own_part(cells.network, cells.own)
    mine = cells.network.wall_particle < cells.own
    own = solution._replace(wall_temperature=solution.wall_temperature[mine], wall_heat=solution.wall_heat[mine])
    local = (mean_flux if scene.periodic else between_walls)(network, scene, own)
    volumes = np.bincount(network.phase, network.volumes, len(scene.materials))
    temperature, heat = _walls(scene, network, own, comm)
    at = cache(lambda: samplers(scene, cells.network, solution)[1:])
    told = {"scene": scene, "slabs": slabs, "comm": comm}
    return Field(
        scene=scene,
        mean_flux=_sum(comm, local),
        fractions=_sum(comm, volumes) / _sum(comm, volumes).sum(),
        sampler=lambda: _gathered(samplers(scene, network, own)[0](), cells.own, comm),
        temperature_at=lambda points: _at(points, lambda: at()[0], slope=solution.mean_gradient, **told),
        flux_at=lambda points: _at(points, lambda: at()[1], slope=None, **told),
        wall_temperature=temperature,
        wall_heat=heat,
        through=lambda axis, position: float(_sum(comm, heat_through(network, own, axis, position))),
        **more,
    )


def _sum(comm, values):
    """Over all ranks."""
    return np.asarray(comm.allreduce(np.asarray(values, dtype=float)))


def _walls(scene, network, solution, comm):
    """Mean temperature of each loaded wall, and the heat that enters by it."""
    temperature, heat = {}, {}
    for name in scene.walls or {}:
        here = network.wall_side == SIDES.index(name)
        known = here & np.isfinite(solution.wall_temperature)
        area = network.wall_area[known]
        warm, whole = _sum(comm, [float(area @ solution.wall_temperature[known]), float(area.sum())])
        temperature[name] = warm / whole if whole > 0 else float("nan")
        heat[name] = float(_sum(comm, solution.wall_heat[here].sum()))
    return temperature, heat


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
