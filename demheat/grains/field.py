"""What is known of a bed of grains once it is solved: temperatures, the heat of each pair, and the conductivity."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain
from os import PathLike
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from demheat.grains.pairs import AtWalls, Pairs
from demheat.network.base import SIDES, Network
from demheat.packing.base import Packing
from demheat.runtime.paths import checked_path, replaced
from demheat.scene.frozen import ReadOnly, read_only, table_of

COLUMNS = ("first", "second", "gap_m", "contact_radius_m", "contact_W_K", "medium_W_K", "heat_W")


class Load(NamedTuple):
    """What drives the heat: temperatures of walls and the depth of the layers they act in, or a mean gradient, K/m."""

    walls: Mapping[str, float] | None
    gradient: tuple | None
    layer: float | None


@dataclass(frozen=True, repr=False)
class GrainField:
    """A solved bed of grains.

    Parameters
    ----------
    packing : Packing
    load : Load
    pairs : Pairs
    at_walls : AtWalls or None
        None in a periodic cell.
    temperature : (n,) float array, K or degrees Celsius
        NaN of grains that no temperature reaches; in a periodic cell that of the mean gradient included.
    heat : (m,) float array, W
        From the second to the first grain of each pair.
    heat_from_walls : (w,) float array, W
        Into the grains at walls.
    mean_flux : (3,) float array, W/m2
        Average over the box.
    network : Network
        As `demheat.io.packings.write` draws it.
    stats : mapping
        unknowns, iterations, residual, solver, islands.

    Examples
    --------
    >>> from demheat import grains
    >>> from demheat.packing import make_packing
    >>> row = make_packing([[1, 1, 0.99], [1, 1, 2.97]], [1.0, 1.0], (2, 2, 3.96), False, {})
    >>> field = grains.solve(row, 16.0, walls={"z-": 0.0, "z+": 1.0}, gap=grains.Gap(conductivity=0.026))
    >>> field.heat.shape, field.wall_heat["z+"] > 0 > field.wall_heat["z-"]
    ((1,), True)
    """

    packing: Packing
    load: Load
    pairs: Pairs
    at_walls: AtWalls | None
    temperature: np.ndarray
    heat: np.ndarray
    heat_from_walls: np.ndarray
    mean_flux: np.ndarray
    network: Network
    stats: Mapping[str, object]

    def __post_init__(self):
        for name in ("temperature", "heat", "heat_from_walls", "mean_flux"):
            object.__setattr__(self, name, read_only(getattr(self, name)))
        object.__setattr__(self, "stats", ReadOnly(self.stats))

    @property
    def conductivity(self) -> float:
        """Effective conductivity of the box along the load, W/(m K).

        In a periodic cell -<q>.g / (g.g); between two opposite walls mean flux times length over the difference of
        temperatures. With layers that is the heat that passes times the mean distance, weighted with heat, of the
        grains that give it from those that take it.

        Raises
        ------
        ValueError
            If the walls are not one opposite pair, or have one temperature.
        """
        if self.load.gradient is not None:
            gradient = np.array(self.load.gradient)
            return float(-self.mean_flux @ gradient / (gradient @ gradient)) + 0.0
        names = sorted(self.load.walls)
        if len(names) != 2 or names[0][0] != names[1][0]:
            raise ValueError(f"walls = {names}: only two opposite ones define a conductivity")
        low, high = (self._level(names[0][0] + end) for end in "-+")
        if high == low:
            raise ValueError("walls: both have the same temperature, no conductivity follows")
        axis = "xyz".index(names[0][0])
        return float(-self.mean_flux[axis] * self.packing.size[axis] / (high - low)) + 0.0

    def _level(self, wall):
        """Temperature of a wall; of a layer that of its grains, which is a little off it, weighted with their heat."""
        heat, here = self.heat_from_walls, self.at_walls.side == SIDES.index(wall)
        if self.load.layer is None or not np.any(heat[here]):
            return self.load.walls[wall]
        return float(heat[here] @ self.temperature[self.at_walls.grain[here]] / heat[here].sum())

    @property
    def wall_heat(self) -> dict[str, float]:
        """Heat that enters the bed through each wall with a temperature, W."""
        sides = {name: SIDES.index(name) for name in self.load.walls or {}}
        return {name: float(self.heat_from_walls[self.at_walls.side == side].sum()) for name, side in sides.items()}

    @property
    def coordination(self) -> float:
        """Mean number of contacts of a grain with others."""
        return 2.0 * np.count_nonzero(self.pairs.radius) / self.packing.number

    @property
    def imbalance(self) -> np.ndarray:
        """Heat that each grain receives in all, (n,) float array, W: 0 but for what the solver leaves."""
        n, pairs = self.packing.number, self.pairs
        left = np.bincount(pairs.first, self.heat, n) - np.bincount(pairs.second, self.heat, n)
        return left + (0.0 if self.at_walls is None else np.bincount(self.at_walls.grain, self.heat_from_walls, n))

    def write(self, path: str | PathLike[str], *, ids: ArrayLike | None = None) -> None:
        """Write the pairs and their heat into a file; an interrupted write leaves no file, and an old one as it was.

        Parameters
        ----------
        path : path
            Ends in .csv: a row for each pair with the heat that its second grain gives to the first, then for each
            grain at a wall, with the wall's name for the second. Or in .npz: the same as arrays, and the temperatures.
        ids : (n,) sequence of int, optional
            Names of the grains, as `demheat.io.packings.ids` reads them; by default their numbers from 0.

        Raises
        ------
        ValueError
            If an argument is not as described.
        """
        path = checked_path(path)
        if path.suffix.lower() not in (".csv", ".npz"):
            raise ValueError(f"path = {str(path)!r}: the suffix must be .csv or .npz")
        if not path.parent.is_dir():
            raise ValueError(f"path = {str(path)!r}: there is no folder {str(path.parent)!r}")
        names = np.arange(self.packing.number) if ids is None else np.asarray(ids)
        if names.shape != (self.packing.number,) or names.dtype.kind not in "iu":
            raise ValueError(f"ids of shape {names.shape}: must be {self.packing.number} whole numbers")
        with replaced(path) as part, open(part, "xb") as stream:
            if path.suffix.lower() == ".npz":
                np.savez(stream, **self._arrays(names))
            else:
                rows = chain([COLUMNS], self._rows(names))
                stream.writelines(f"{','.join(map(str, row))}\n".encode() for row in rows)

    def _rows(self, names):
        """Rows of the table: of pairs, then of grains at walls."""
        pairs, walls = self.pairs, self.at_walls
        columns = pairs.gap, pairs.radius, pairs.contact, pairs.medium, self.heat
        lists = (column.tolist() for column in (names[pairs.first], names[pairs.second], *columns))
        yield from zip(*lists, strict=True)
        if walls is None:
            return
        width = walls.distance - self.packing.radii[walls.grain]
        if self.load.layer is not None:
            # Held where they are: no gap.
            width = np.full(len(width), np.nan)
        columns = width, walls.radius, walls.contact, walls.medium, self.heat_from_walls
        sides = [SIDES[side] for side in walls.side]
        yield from zip(names[walls.grain].tolist(), sides, *(column.tolist() for column in columns), strict=True)

    def _arrays(self, names):
        pairs = self.pairs
        arrays = {"ids": names, "temperature": self.temperature, "conductance": pairs.conductance, "heat": self.heat}
        arrays |= {name: getattr(pairs, name) for name in ("first", "second", "gap", "radius", "contact", "medium")}
        arrays |= {"mean_flux": self.mean_flux}
        if self.at_walls is not None:
            walls = self.at_walls
            arrays |= {"wall_grain": walls.grain, "wall_side": walls.side, "wall_heat": self.heat_from_walls}
        return arrays

    def __repr__(self):
        return f"GrainField({', '.join(f'{name}: {value}' for name, value in self._told().items())})"

    def _repr_html_(self):
        """A short table for notebooks."""
        return table_of(self._told())

    def _told(self):
        told = {"grains": f"{self.packing.number}", "pairs": f"{len(self.heat)}"}
        try:
            return told | {"conductivity": f"{self.conductivity:.6g} W/(m K)"}
        except ValueError:
            return told | {"mean flux": f"({', '.join(f'{each:.4g}' for each in self.mean_flux)}) W/m2"}
