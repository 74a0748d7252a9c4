"""What a scene is made of: materials, inclusions, imposed fluxes and heat sources, each checked as it is made."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Integral, Real

import numpy as np

WORDS = {2: "two", 3: "three"}


@dataclass(frozen=True)
class Material:
    """A homogeneous, isotropic material.

    Parameters
    ----------
    conductivity : float, W/(m K)
        Finite and not negative; 0 is a perfect insulator (a pore).
    density : float, kg/m3, optional
        Needed by transients only.
    heat_capacity : float, J/(kg K), optional
        Specific heat, needed by transients only.
    """

    conductivity: float
    density: float | None = None
    heat_capacity: float | None = None

    def __post_init__(self):
        number(self, "conductivity", "a finite number >= 0 W/(m K)", lambda v: v >= 0)
        for name in ("density", "heat_capacity"):
            if getattr(self, name) is not None:
                number(self, name, "a finite number > 0", lambda v: v > 0)


@dataclass(frozen=True)
class Sphere:
    """A spherical inclusion.

    Parameters
    ----------
    center : (3,) sequence of float, m
    radius : float, m
    material : Material
    """

    center: tuple[float, float, float]
    radius: float
    material: Material

    def __post_init__(self):
        object.__setattr__(self, "center", vector("Sphere.center", self.center))
        number(self, "radius", "a finite number > 0 m", lambda v: v > 0)
        check_material("Sphere.material", self.material)

    def contains(self, offsets):
        """Which points, given as (n, 3) offsets from the centre in metres, lie inside (surface included)."""
        return np.einsum("ij,ij->i", offsets, offsets) <= self.radius**2


@dataclass(frozen=True)
class Layer:
    """A plane layer, start <= coordinate <= stop along one axis, across the whole box.

    Parameters
    ----------
    axis : {0, 1, 2}
    start, stop : float, m
    material : Material
    """

    axis: int
    start: float
    stop: float
    material: Material

    def __post_init__(self):
        if not isinstance(self.axis, Integral) or self.axis not in (0, 1, 2):
            raise ValueError(f"Layer.axis = {self.axis!r}: must be 0, 1 or 2")
        object.__setattr__(self, "axis", int(self.axis))
        number(self, "start", "a finite number of metres")
        number(self, "stop", f"a finite number > start = {self.start}", lambda v: v > self.start)
        check_material("Layer.material", self.material)


@dataclass(frozen=True)
class Flux:
    """Heat flux imposed on a wall.

    Parameters
    ----------
    value : float or callable (time, s) -> float, W/m2
        Positive *into* the body.
    """

    value: float | Callable[[float], float]

    def __post_init__(self):
        if not callable(self.value):
            number(self, "value", "a finite number of W/m2, or a function of time")


@dataclass(frozen=True)
class Heating:
    """Heat source spread over the whole body.

    Parameters
    ----------
    power_density : float, W/m3
        Positive.
    """

    power_density: float

    def __post_init__(self):
        number(self, "power_density", "a finite number > 0 W/m3", lambda v: v > 0)


@dataclass(frozen=True)
class MovingCylinder:
    """Heat source: a cylinder right through the box, along one axis, that moves at constant velocity.

    Source: Terreros et al. (2013), section 5, whose source heats a sheet.

    Parameters
    ----------
    axis : {0, 1, 2}
        Direction of the cylinder.
    diameter : float, m
    power_density : float, W/m3
        Positive.
    start : (2,) sequence of float, m
        Where its axis is at time 0; coordinates along the two other axes, in ascending order.
    velocity : (2,) sequence of float, m/s
    clip : bool
        What lies outside of the body is lost. If False, a source that leaves the body is an error.
    """

    axis: int
    diameter: float
    power_density: float
    start: tuple[float, float]
    velocity: tuple[float, float] = (0.0, 0.0)
    clip: bool = False

    def __post_init__(self):
        if not isinstance(self.axis, Integral) or self.axis not in (0, 1, 2):
            raise ValueError(f"MovingCylinder.axis = {self.axis!r}: must be 0, 1 or 2")
        object.__setattr__(self, "axis", int(self.axis))
        number(self, "diameter", "a finite number > 0 m", lambda v: v > 0)
        number(self, "power_density", "a finite number > 0 W/m3", lambda v: v > 0)
        for name in ("start", "velocity"):
            object.__setattr__(self, name, vector(f"MovingCylinder.{name}", getattr(self, name), length=2))
        if not isinstance(self.clip, bool):
            raise ValueError(f"MovingCylinder.clip = {self.clip!r}: must be True or False")

    def position(self, time):
        """Where its axis is at a time in seconds, (2,) float array, m."""
        return np.array(self.start) + np.array(self.velocity) * time


def vector(name, value, *, length=3):
    """Finite numbers as a tuple of floats, or a ValueError that says what would be valid."""
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        array = None
    if array is None or array.shape != (length,) or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} = {value!r}: must be {WORDS[length]} finite numbers")
    return tuple(array.tolist())


def finite(name, value, valid, accept=lambda v: True):
    """A number as a float, or a ValueError that says what would be valid; no strings, arrays or huge integers."""
    try:
        good = isinstance(value, Real) and math.isfinite(value) and accept(value)
    except OverflowError:
        good = False
    if not good:
        raise ValueError(f"{name} = {value!r}: must be {valid}")
    return float(value)


def axis_number(axis):
    """An axis as an int, or a ValueError."""
    if isinstance(axis, bool) or not isinstance(axis, Integral) or axis not in (0, 1, 2):
        raise ValueError(f"axis = {axis!r}: must be 0, 1 or 2")
    return int(axis)


def number(owner, field, valid, accept=lambda v: True):
    """Check and cast a field of a frozen dataclass by `finite`."""
    name = f"{type(owner).__name__}.{field}"
    object.__setattr__(owner, field, finite(name, getattr(owner, field), valid, accept))


def check_material(name, value):
    """Raise ValueError unless the value is a Material."""
    if not isinstance(value, Material):
        raise ValueError(f"{name} = {value!r}: must be a Material")
