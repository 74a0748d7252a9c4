"""What a body is made of."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from demheat.scene.dependence import Dependence
from demheat.scene.inputs import LEAST, MOST, moderate, number
from demheat.scene.tensors import checked_conductivity

WITHIN = f", of {LEAST:g} to {MOST:g} where it is not 0"


@dataclass(frozen=True)
class Material:
    """A homogeneous material.

    Parameters
    ----------
    conductivity : float, W/(m K), or (3, 3) array_like
        Not negative; 0 is a perfect insulator (a pore), `math.inf` a perfect conductor, which few methods take: see
        `demheat.field`. A symmetric positive definite tensor where it differs with direction, see
        `demheat.scene.tensors.orthotropic`; it is kept as three tuples.
    density : float, kg/m3, optional
        Needed by transients only.
    heat_capacity : float, J/(kg K), optional
        Specific heat, needed by transients only.
    dependence : Dependence, or sequence of pairs of temperature and factor, optional
        How the conductivity follows the temperature: by which factor it differs from `conductivity`.

    Examples
    --------
    >>> from demheat import Material
    >>> Material(conductivity=205.0, density=2700.0, heat_capacity=900.0).conductivity
    205.0
    >>> Material(conductivity=-1.0)
    Traceback (most recent call last):
        ...
    ValueError: Material.conductivity = -1.0: must be a number >= 0 W/(m K)...
    """

    conductivity: float | tuple[tuple[float, float, float], ...]
    density: float | None = None
    heat_capacity: float | None = None
    dependence: Dependence | Sequence[tuple[float, float]] | None = None

    def __post_init__(self):
        checked = checked_conductivity("Material.conductivity", self.conductivity)
        object.__setattr__(self, "conductivity", checked)
        for name in ("density", "heat_capacity"):
            if getattr(self, name) is not None:
                number(self, name, f"a finite number > 0{WITHIN}", lambda v: v > 0 and moderate(v))
        if self.dependence is not None and not isinstance(self.dependence, Dependence):
            try:
                object.__setattr__(self, "dependence", Dependence(self.dependence))
            except ValueError as error:
                raise ValueError(str(error).replace("Dependence.points", "Material.dependence", 1)) from None
        if self.dependence is not None and self.perfect:
            raise ValueError(
                f"Material.dependence = {self.dependence!r} of a perfect conductor: must be None, or the conductivity "
                "finite"
            )

    @property
    def isotropic(self) -> bool:
        """Whether it conducts alike in all directions: its conductivity is then a float."""
        return isinstance(self.conductivity, float)

    @property
    def perfect(self) -> bool:
        """Whether it conducts without bound: all of a body of it has one temperature."""
        return self.conductivity == math.inf

    @property
    def tensor(self) -> np.ndarray:
        """Its conductivity as a tensor, (3, 3) float array, W/(m K)."""
        return np.diag([self.conductivity] * 3) if self.isotropic else np.array(self.conductivity)

    @property
    def mean_conductivity(self) -> float:
        """Its conductivity, or the mean of a tensor over all directions, W/(m K)."""
        return self.conductivity if self.isotropic else float(np.trace(self.tensor)) / 3

    def turned(self, order: Sequence[int]) -> Material:
        """The same material with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        if self.isotropic:
            return self
        return replace(self, conductivity=self.tensor[np.ix_(order, order)])


def check_material(name: str, value) -> None:
    """Raise ValueError unless a value is a Material."""
    if not isinstance(value, Material):
        raise ValueError(f"{name} = {value!r}: must be a Material")
