"""What can be checked of one Field without another: heat in against heat out, conductivity against its bounds."""

from __future__ import annotations

import math
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np

from demheat.field import check_field

if TYPE_CHECKING:
    from demheat.field import Field


def heat_balance(field: Field) -> float:
    """Sum of the heat that enters through the walls over the largest of them; 0 in a perfect steady balance.

    Raises
    ------
    ValueError
        In a periodic cell, where heat crosses no wall.

    Examples
    --------
    >>> from demheat import gallery, referee, solve
    >>> abs(referee.heat_balance(solve(gallery.sphere_in_cube(5.0), particles=1000))) < 1e-6
    True
    """
    check_field(field)
    if field.scene.periodic:
        raise ValueError("field.scene is periodic: no heat enters through walls, there is no balance to check")
    heats = np.array(list(field.wall_heat.values()))
    largest = np.abs(heats).max(initial=0.0)
    return float(heats.sum() / largest) if largest > 0 else 0.0


def bound_violation(field: Field | float, lower: float, upper: float) -> float:
    """How far the effective conductivity lies outside bounds, relative to the bound passed; 0 between them."""
    for name, value in (("lower", lower), ("upper", upper)):
        if isinstance(value, bool) or not isinstance(value, Real):
            raise ValueError(f"{name} = {value!r}: must be a number, W/(m K)")
    if not 0 <= lower <= upper:
        raise ValueError(f"lower = {lower!r}, upper = {upper!r}: must be 0 <= lower <= upper")
    k = getattr(field, "conductivity", field)
    if isinstance(k, bool) or not isinstance(k, Real):
        raise ValueError(f"field = {field!r}: must be a Field, or a conductivity")
    k = float(k)
    if k < lower:
        return k / lower - 1.0
    if k > upper:
        return k / upper - 1.0 if upper > 0 else math.inf
    return 0.0 * k  # not-a-number stays one
