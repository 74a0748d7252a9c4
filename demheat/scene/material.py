"""What a body is made of."""

from __future__ import annotations

from dataclasses import dataclass

from demheat.scene.inputs import LEAST, MOST, moderate, number

WITHIN = f", of {LEAST:g} to {MOST:g} where it is not 0"


@dataclass(frozen=True)
class Material:
    """A homogeneous, isotropic material.

    Parameters
    ----------
    conductivity : float, W/(m K)
        Finite and not negative; 0 is a perfect insulator (a pore), see `demheat.field`.
    density : float, kg/m3, optional
        Needed by transients only.
    heat_capacity : float, J/(kg K), optional
        Specific heat, needed by transients only.

    Examples
    --------
    >>> from demheat import Material
    >>> Material(conductivity=205.0, density=2700.0, heat_capacity=900.0)
    Material(conductivity=205.0, density=2700.0, heat_capacity=900.0)
    >>> Material(conductivity=-1.0)
    Traceback (most recent call last):
        ...
    ValueError: Material.conductivity = -1.0: must be a finite number >= 0 W/(m K), of 1e-50 to 1e+50 where it is not 0
    """

    conductivity: float
    density: float | None = None
    heat_capacity: float | None = None

    def __post_init__(self):
        number(self, "conductivity", f"a finite number >= 0 W/(m K){WITHIN}", lambda v: v >= 0 and moderate(v))
        for name in ("density", "heat_capacity"):
            if getattr(self, name) is not None:
                number(self, name, f"a finite number > 0{WITHIN}", lambda v: v > 0 and moderate(v))


def check_material(name: str, value) -> None:
    """Raise ValueError unless a value is a Material.

    Parameters
    ----------
    name : str
        Of the argument, for the message.
    value : Material
    """
    if not isinstance(value, Material):
        raise ValueError(f"{name} = {value!r}: must be a Material")
