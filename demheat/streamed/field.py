"""The Field of a body in slabs on disk: sums over the slabs, and parts that are read when they are asked for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from demheat.conduction.balance import at_walls, system_of
from demheat.conduction.steady import Solution
from demheat.field import Field, Samples
from demheat.packing.base import wrap
from demheat.sampling.field_of import heat_through, samplers
from demheat.streamed.store import Parts
from demheat.tiles.cells import Cells
from demheat.tiles.places import NOBODY
from demheat.tiles.sums import Sums, own_of, sums_of, told


def field_of(parts: Parts, solution: Solution, *, estimator: Callable, stats: dict) -> Field:
    """The Field of a body in slabs."""
    solved = Solved(parts, solution)
    sums = [sums_of(parts.scene, *own_of(*each)) for each in solved]
    return Field(
        scene=parts.scene,
        **told(parts.scene, Sums(*(sum(column) for column in zip(*sums, strict=True)))),
        sampler=solved.samples,
        temperature_at=lambda points: solved.at(points, 0, slope=solution.mean_gradient),
        flux_at=lambda points: solved.at(points, 1),
        through=solved.heat_through,
        estimator=estimator,
        stats=stats,
    )


class Solved:
    """Slabs and their solutions, read one after the other; of the last one that points lay in what it samples by."""

    def __init__(self, parts: Parts, solution: Solution):
        self.parts, self.solution = parts, solution
        self._last: tuple[int, tuple[Callable, ...]] = NOBODY, ()

    def __iter__(self):
        return (self.slab(number) for number in range(len(self.parts.cuts)))

    def slab(self, number: int) -> tuple[Cells, Solution]:
        """What a slab sees, and the solution there."""
        scene, cells = self.parts.scene, self.parts.cells(number)
        numbers = self.parts.store.get(number, "numbers")
        temperature = np.where(numbers == NOBODY, np.nan, self.solution.temperature[numbers])
        system = system_of(cells.network, scene, np.ones(len(numbers), dtype=bool))
        walls = at_walls(system, scene, temperature)
        return cells, Solution(temperature, self.solution.mean_gradient, *walls, {})

    def samples(self) -> Samples:
        """Those of all slabs."""
        found = []
        for cells, solution in self:
            own = samplers(self.parts.scene, *own_of(cells, solution))[0]()
            found.append([np.ascontiguousarray(column[: cells.own]) for column in own])
        return Samples(*map(np.concatenate, zip(*found, strict=True)))

    def heat_through(self, axis: int, position: float) -> float:
        """Heat that crosses a plane, W."""
        return sum(heat_through(*own_of(*each), axis, position) for each in self)

    def at(self, points: np.ndarray, which: int, slope: np.ndarray | None = None) -> np.ndarray:
        """Temperature or flux at points, by the slabs in which they lie."""
        scene = self.parts.scene
        inside = wrap(points, np.array(scene.size), np.broadcast_to(scene.periodic, 3))
        owner = self.parts.cuts[0].owner(inside)
        values = np.zeros((len(points), 3) if which else len(points))
        # The one that is still there first.
        for number in sorted(np.unique(owner), key=lambda number: number != self._last[0]):
            here = owner == number
            values[here] = self._sampled_by(number)[which](inside[here])
        return values if slope is None else values + (points - inside) @ slope

    def _sampled_by(self, number):
        """Temperature and flux at points in a slab, as two functions."""
        if self._last[0] != number:
            self._last = NOBODY, ()
            cells, solution = self.slab(number)
            self._last = number, samplers(self.parts.scene, cells.network, solution)[1:]
        return self._last[1]
