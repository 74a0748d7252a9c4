"""Functions that users give in a scene, called in one place: with copies, and errors that say where they arose."""

from functools import partial

import numpy as np

from demheat.scene.inputs import MOST, finite
from demheat.scene.parts import HOTTEST, Flux, Radiation, driver


def load_at(name, load, time, *, kelvin=False) -> float:
    """Value of a wall's load at a time, K or W/m2; of surroundings their temperature."""
    value = driver(load)
    if not callable(value):
        return float(value)
    what = f"Scene.walls[{name!r}] at {time} s"
    try:
        found = value(time)
    except Exception as error:
        raise ValueError(f"{what}: the function raises {type(error).__name__}: {error}") from error
    if kelvin or isinstance(load, Radiation):
        return finite(what, found, f"a finite temperature >= 0 K of at most {HOTTEST:g}", lambda v: 0 <= v <= HOTTEST)
    return finite(what, found, f"a finite number of at most {MOST:g}", lambda v: abs(v) <= MOST)


def changing_loads(scene):
    """Loads of walls that are functions of time, (time, s) -> float; what is not finite is an error."""
    return [
        partial(load_at, name, load, kelvin=scene.radiates and not isinstance(load, Flux))
        for name, load in (scene.walls or {}).items()
        if callable(driver(load))
    ]


def initial_at(scene, points) -> np.ndarray:
    """Temperature of a scene at time 0, (n,) float array, K."""
    if not callable(scene.initial):
        return np.full(len(points), float(scene.initial))
    try:
        values = np.array(scene.initial(np.array(points, dtype=float)))
    except Exception as error:
        what = f"{type(error).__name__}: {error}"
        raise ValueError(f"Scene.initial: the function raises {what} for {len(points)} points (n, 3)") from error
    if values.shape != (len(points),) or values.dtype.kind not in "iuf":
        what = f"shape {values.shape} of {values.dtype}"
        raise ValueError(f"Scene.initial: gives {what} for {len(points)} points; must be real numbers, (n,)")
    least, most = (0.0, HOTTEST) if scene.radiates else (-MOST, MOST)
    odd = np.flatnonzero(~((values >= least) & (values <= most)))
    if len(odd):
        what = f"{values[odd[0]]} at {points[odd[0]].tolist()} m"
        valid = f"from 0 K to {most:g} K where a wall radiates" if scene.radiates else f"finite, at most {MOST:g}"
        raise ValueError(f"Scene.initial = {what}: must be {valid}, at all points of the body")
    return values.astype(float)
