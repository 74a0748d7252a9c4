"""Answers of one method: the tensor with its intervals, refined until they are narrow enough."""

import math
from typing import NamedTuple

import numpy as np

from demheat.cheapest.loads import Loads
from demheat.cheapest.ways import EXTRAPOLATED, HOMES, KNOBS, Way
from demheat.error import of_conductivity_alone
from demheat.field import Field
from demheat.tensor import conductivity_tensor
from references import bracket

# Elements along the longest side of the first mesh for certain bounds; how many meshes, and their edges from one to the
# next: by what is missing, but neither more nor less.
COARSEST, ROUNDS, SMALLER = 5, 5, (0.4, 0.9)


class Answer(NamedTuple):
    """A conductivity tensor and half of each entry's interval, (3, 3) float arrays in W/(m K); how these are known."""

    tensor: np.ndarray
    half: np.ndarray
    how: str


def answer(way: Way, loads: Loads) -> Answer:
    """Tensor and half intervals by one method."""
    module, cut = HOMES[way.method], way.method in KNOBS
    scenes = loads.parts if cut else loads.wholes
    if loads.together if cut else len(scenes) == 3:
        fields = dict(enumerate(module.solve_axes(scenes[0], **way.knobs)))
    else:
        fields = {axis: module.solve(each, **way.knobs) for axis, each in scenes.items()}
    with of_conductivity_alone():
        found = {axis: _known(each, way.method) for axis, each in fields.items()}
    if loads.diagonal:
        tensor = np.diag([found[axis].conductivity for axis in loads.alike])
        half = np.diag([found[axis].half for axis in loads.alike])
        return Answer(tensor, half, found[0].how)
    tensor = conductivity_tensor([fields[axis] for axis in range(3)])
    slopes = [fields[axis].scene.gradient[axis] for axis in range(3)]
    # What is extrapolated takes the place of what was found on elements.
    tensor += np.stack([(fields[j].mean_flux - found[j].mean_flux) / slopes[j] for j in range(3)], axis=1)
    half = np.tile([found[axis].flux / abs(slopes[axis]) for axis in range(3)], (3, 1))
    return Answer((tensor + tensor.T) / 2, np.maximum(half, half.T), found[0].how)


class _Known(NamedTuple):
    """What a field says of its conductivity and mean flux, and how far these may be off."""

    conductivity: float
    half: float
    mean_flux: np.ndarray
    flux: float
    how: str


def _known(field: Field, method: str) -> _Known:
    """By extrapolation where that tells more at less cost, else by the interval about what was found."""
    if method in EXTRAPOLATED:
        try:
            limit = field.extrapolated
        except (NotImplementedError, RuntimeError):
            pass
        else:
            half = max(limit.upper - limit.conductivity, limit.conductivity - limit.lower)
            return _Known(limit.conductivity, half, limit.mean_flux, limit.flux, limit.how)
    error, k = field.error, field.conductivity
    # An interval need not have the answer in its middle.
    return _Known(k, max(error.upper - k, k - error.lower), field.mean_flux, error.flux, error.how)


def half_of(field: Field, method: str) -> float:
    """Half of the interval of a field's conductivity, W/(m K)."""
    with of_conductivity_alone():
        return _known(field, method).half


def excess(found: Answer, accuracy: float) -> float:
    """Largest half of an interval over what is allowed."""
    diagonal = np.diag(found.tensor)
    allowed = accuracy * np.where(np.eye(3) > 0, diagonal, diagonal.mean())
    pairs = zip(found.half.flat, allowed.flat, strict=True)
    return max(((h / a if a > 0 else math.inf) for h, a in pairs if h > 0), default=0.0)


def certain(loads: Loads, accuracy: float) -> tuple[Answer, dict]:
    """Certain bounds, their middle and half of what is between them, and with which knobs."""
    if loads.diagonal:
        found = {axis: bracket.solve(part, width=2 * accuracy) for axis, part in loads.parts.items()}
        middle = np.diag([(found[axis].lower + found[axis].upper) / 2 for axis in loads.alike])
        half = np.diag([(found[axis].upper - found[axis].lower) / 2 for axis in loads.alike])
        return Answer(middle, half, "certain bounds"), {"width": 2 * accuracy}
    # A few elements along the box: they are smaller at its features.
    size = max(loads.parts[0].size) / COARSEST
    for _ in range(ROUNDS):
        both = bracket.solve_tensor(loads.parts[0], size=size)
        found = Answer(both.middle, both.radius, "certain bounds")
        missing = excess(found, accuracy)
        if missing <= 1:
            return found, {"size": both.stats["size"]}
        size = both.stats["size"] * min(max(missing ** (-1 / 3), SMALLER[0]), SMALLER[1])
    raise RuntimeError(f"its bounds are still {missing * accuracy:.2g} apart with size = {size:.3g} m")
