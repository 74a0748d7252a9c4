"""One scene with what is known of it, as it will be written; and what a witness's field says at points.

Each module of recipes has `entries()`: pairs of a name and what makes its `Entry`, so that one scene may be made alone.
"""

from typing import NamedTuple

import numpy as np

from demheat.referee import span
from demheat.scene import Material, Scene

MATRIX = Material(1.0)
CUBE = (1.0, 1.0, 1.0)
WALLS = {"x-": 1.0, "x+": 0.0}
GRADIENT = (1.0, 0.0, 0.0)
# Where fields are told, in lengths of the box: some on its planes of symmetry, some not.
POINTS = np.array(
    [
        *[(0.5, 0.5, 0.5), (0.5, 0.08, 0.5), (0.92, 0.5, 0.5)],
        *[(0.21, 0.37, 0.64), (0.71, 0.18, 0.33), (0.87, 0.79, 0.12), (0.06, 0.91, 0.77), (0.34, 0.56, 0.05)],
    ]
)
# Points nearer to an interface, in lengths of the box, are left out: their phase is no question of rounding then.
AWAY = 0.004
# Of numbers that come out of a formula, relative.
ROUNDING = 1e-12


class Entry(NamedTuple):
    """A scene to be written."""

    name: str
    group: str
    title: str
    scene: Scene
    known: dict  # As the file has it


def number(value, relative, error_is, *, least=ROUNDING) -> dict:
    """A conductivity and its error, as the file has it."""
    return {"value": value, "error": _rounded(max(relative, least) * abs(value)), "error_is": error_is}


def fields(field, relative, *, points=None) -> dict:
    """What a witness's field says at points, as the file has it."""
    scene = field.scene
    points = told(scene) if points is None else points
    warm, flows = field.temperature_at(points), field.flux_at(points)
    if scene.periodic:
        warm = warm - warm[0]
    found = [
        {"position": at, "temperature": t, "flux": q}
        for at, t, q in zip(points.tolist(), warm.tolist(), flows.tolist(), strict=True)
    ]
    passing = float(np.linalg.norm(field.mean_flux))
    relative = max(relative, ROUNDING)
    return {
        "temperature_error": _rounded(relative * span(scene)),
        "flux_error": _rounded(relative * passing),
        "points": found,
    }


def told(scene) -> np.ndarray:
    """Points of a scene at which its field is told, (n, 3) float array, m."""
    size = np.array(scene.size)
    points = POINTS * size
    away = AWAY * size.max() * np.concatenate([np.eye(3), -np.eye(3)])
    phase = scene.phase_at(points)
    alike = np.all([scene.phase_at(np.clip(points + step, 0, size)) == phase for step in away], axis=0)
    return points[alike & (scene.mean_conductivities[phase] > 0)]


def _rounded(error):
    """An error to one digit, upwards."""
    power = np.floor(np.log10(error))
    return float(f"{np.ceil(error / 10**power * (1 - 1e-9)):.0f}e{power:.0f}")
