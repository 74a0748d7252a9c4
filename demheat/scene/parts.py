"""What acts on a scene: fluxes, convection and radiation at walls, heat sources; each checked as it is made."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from demheat.scene.inputs import LEAST, MOST, moderate, number, vector, whole

WITHIN = f", from {LEAST:g} to {MOST:g}"
# Of a black body, W/(m2 K4): exact in the SI of 2019, to the digits printed there.
STEFAN_BOLTZMANN = 5.670374419e-8
# Fourth powers are to be held by floating point, with a conductivity or an area beside them.
HOTTEST = 1e20


@dataclass(frozen=True)
class Flux:
    """Heat flux imposed on a wall.

    Parameters
    ----------
    value : float or callable (time, s) -> float, W/m2
        Positive *into* the body.

    Examples
    --------
    >>> from demheat import Flux, Material, Scene
    >>> heated = Scene((0.1, 0.1, 0.1), Material(33.0), walls={"y-": 25.0, "y+": Flux(3300.0)})
    >>> heated.wall_fluxes
    {'y+': 3300.0}
    """

    value: float | Callable[[float], float]

    def __post_init__(self):
        if not callable(self.value):
            number(self, "value", f"a finite number of W/m2 of at most {MOST:g}, or a function of time", moderate)


@dataclass(frozen=True)
class Convection:
    """Heat exchanged by a wall with a fluid: coefficient times (temperature - that of the wall's surface) comes in.

    Parameters
    ----------
    coefficient : float, W/(m2 K)
        Positive.
    temperature : float or callable (time, s) -> float, K or degrees Celsius
        Of the fluid, away from the wall.

    Examples
    --------
    >>> from demheat import Convection, Material, Scene, solve
    >>> air = Convection(coefficient=20.0, temperature=0.0)
    >>> wall = Scene((0.1, 0.1, 0.1), Material(2.0), walls={"x-": 100.0, "x+": air})
    >>> print(f"{solve(wall, particles=1000).wall_heat['x-']:.4f} W, by hand {0.1**2 * 100 / (0.1 / 2 + 1 / 20):.4f} W")
    10.0000 W, by hand 10.0000 W
    """

    coefficient: float
    temperature: float | Callable[[float], float]

    def __post_init__(self):
        number(self, "coefficient", f"a finite number > 0 W/(m2 K){WITHIN}", _positive)
        if not callable(self.temperature):
            valid = f"a finite temperature of at most {MOST:g}, or a function of time"
            number(self, "temperature", valid, lambda v: abs(v) <= MOST)


@dataclass(frozen=True)
class Radiation:
    """Heat exchanged by a grey wall with black surroundings: emissivity sigma (T_surroundings^4 - T_wall^4) comes in.

    With one such wall all temperatures of a scene are in kelvin, and none may be below 0.

    Parameters
    ----------
    emissivity : float
        Above 0, at most 1.
    temperature : float or callable (time, s) -> float, K
        Of the surroundings.

    Examples
    --------
    >>> from demheat import Material, Radiation, Scene, solve
    >>> sky = Radiation(emissivity=0.9, temperature=300.0)
    >>> wall = Scene((0.1, 0.1, 0.1), Material(1.0), walls={"x-": 1000.0, "x+": sky})
    >>> hot = solve(wall, particles=1000).wall_temperature["x+"]
    >>> given, passed = 0.9 * 5.670374e-8 * (hot**4 - 300.0**4), 1.0 * (1000.0 - hot) / 0.1
    >>> print(f"{given / passed:.4f}")
    1.0000
    """

    emissivity: float
    temperature: float | Callable[[float], float]

    def __post_init__(self):
        number(self, "emissivity", "a number > 0, at most 1", lambda v: 0 < v <= 1 and moderate(v))
        if not callable(self.temperature):
            valid = f"a finite temperature >= 0 K of at most {HOTTEST:g}, or a function of time"
            number(self, "temperature", valid, lambda v: 0 <= v <= HOTTEST)


def driver(load):
    """What drives a wall: its temperature, flux density, or temperature of surroundings; a number or a function."""
    if isinstance(load, Flux):
        return load.value
    return load.temperature if isinstance(load, Convection | Radiation) else load


def driven(load, value):
    """A wall's load with another driver."""
    if isinstance(load, Flux):
        return Flux(value)
    return replace(load, temperature=value) if isinstance(load, Convection | Radiation) else value


@dataclass(frozen=True)
class UniformSource:
    """Heat source spread over the whole body.

    Parameters
    ----------
    power_density : float, W/m3
        Positive.

    Examples
    --------
    >>> from demheat import Material, Scene, UniformSource, evolve
    >>> brick = Material(1.0, density=2000.0, heat_capacity=1000.0)
    >>> body = Scene((0.1, 0.1, 0.1), brick, initial=20.0, sources=[UniformSource(power_density=2e6)])
    >>> (field,) = evolve(body, [3.0], particles=1000)  # nothing leaves: 1 K each second
    >>> print(f"{field.temperature_at([0.05, 0.05, 0.05])[0]:.3f}")
    23.000
    """

    power_density: float

    def __post_init__(self):
        number(self, "power_density", f"a finite number > 0 W/m3{WITHIN}", _positive)


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

    Examples
    --------
    >>> from demheat import MovingCylinder
    >>> torch = MovingCylinder(axis=2, diameter=0.008, power_density=1e8, start=(0.02, 0.015), velocity=(0.0033, 0.0))
    >>> torch.position(2.0).tolist()
    [0.0266, 0.015]
    """

    axis: int
    diameter: float
    power_density: float
    start: tuple[float, float]
    velocity: tuple[float, float] = (0.0, 0.0)
    clip: bool = False

    def __post_init__(self):
        axis = whole("MovingCylinder.axis", self.axis, "0, 1 or 2", lambda v: 0 <= v <= 2)
        object.__setattr__(self, "axis", axis)
        number(self, "diameter", f"a finite number > 0 m{WITHIN}", _positive)
        number(self, "power_density", f"a finite number > 0 W/m3{WITHIN}", _positive)
        for name in ("start", "velocity"):
            object.__setattr__(self, name, vector(f"MovingCylinder.{name}", getattr(self, name), length=2))
        if not isinstance(self.clip, bool):
            raise ValueError(f"MovingCylinder.clip = {self.clip!r}: must be True or False")

    def position(self, time: float) -> np.ndarray:
        """Where its axis is at a time in seconds, (2,) float array, m."""
        return np.array(self.start) + np.array(self.velocity) * time


def _positive(value):
    return value > 0 and moderate(value)
