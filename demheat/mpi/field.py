"""The Field of all ranks: sums over all, and parts that stay where they are until all ranks ask for them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from demheat.conduction.steady import Solution
from demheat.field import Field, Samples
from demheat.packing.base import wrap
from demheat.sampling.field_of import heat_through, samplers
from demheat.scene import Scene
from demheat.tiles.cells import Cells
from demheat.tiles.slabs import Slabs
from demheat.tiles.sums import Sums, own_of, sums_of, told


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
        **told(scene, sums),
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
