"""Answers of one method: the tensor with its intervals, refined until they are narrow enough."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from demheat.cheapest.laws import predicted
from demheat.cheapest.loads import Loads
from demheat.cheapest.measures import measures
from demheat.cheapest.ways import KNOBS, Way, module_of
from demheat.tensor import conductivity_tensor

# Refinements until an accuracy counts as out of reach, and the edge of elements from one to the next: by what is
# missing, but neither more nor less.
ROUNDS, SMALLER = 5, (0.4, 0.9)
COARSEST = 5
# Orders with which intervals fall, at least: errors scatter.
ORDERS = {"fem": 2.5, "fft": 1.0, "dem": 1.8}
# Edges on a sphere over its radius, which the mesher takes anyway: below that only does a size matter.
ON_SPHERE = 0.33


class Answer(NamedTuple):
    """A conductivity tensor and half of each entry's interval, (3, 3) float arrays in W/(m K); how these are known."""

    tensor: np.ndarray
    half: np.ndarray
    how: str


def reached(way: Way, loads: Loads, accuracy: float, memory: float) -> tuple[Answer, dict, int]:
    """Answer of one way, refined until its intervals are narrow enough; its knobs then, and the rounds that took.

    Parameters
    ----------
    way : Way
    loads : Loads
    accuracy : float
    memory : float, bytes

    Returns
    -------
    answer : Answer
    knobs : dict
    rounds : int

    Raises
    ------
    RuntimeError
        If it does not get there, or not in the memory.
    """
    if way.method == "bracket":
        return _bracketed(loads, accuracy)
    knobs = dict(way.knobs)
    for rounds in range(1, ROUNDS + 1):
        found = _answer(way.method, loads, knobs)
        missing = _excess(found, accuracy)
        if missing <= 1:
            return found, knobs, rounds
        if way.method not in KNOBS:
            break
        knobs = _finer(way.method, loads, knobs, missing)
        need = _bytes(way.method, loads, knobs)
        if need > memory:
            raise RuntimeError(f"would need {need / 2**30:.2g} GiB for {knobs}, {memory / 2**30:.2g} are to be had")
    raise RuntimeError(f"half of its interval is still {missing * accuracy:.2g} with {knobs}")


def _answer(method, loads, knobs):
    """Tensor and half intervals by one method."""
    module, cut = module_of(method), method in KNOBS
    scenes = loads.parts if cut else loads.wholes
    if loads.together if cut else len(scenes) == 3:
        fields = dict(enumerate(module.solve_axes(scenes[0], **knobs)))
    else:
        fields = {axis: module.solve(each, **knobs) for axis, each in scenes.items()}
    errors = {axis: each.error for axis, each in fields.items()}
    if loads.diagonal:
        tensor = np.diag([fields[axis].conductivity for axis in loads.alike])
        half = np.diag([(errors[axis].upper - errors[axis].lower) / 2 for axis in loads.alike])
        return Answer(tensor, half, errors[0].how)
    tensor = conductivity_tensor([fields[axis] for axis in range(3)])
    half = np.tile([errors[axis].flux / abs(fields[axis].scene.gradient[axis]) for axis in range(3)], (3, 1))
    return Answer((tensor + tensor.T) / 2, np.maximum(half, half.T), errors[0].how)


def _excess(found, accuracy):
    """Largest half of an interval over what is allowed."""
    diagonal = np.diag(found.tensor)
    allowed = accuracy * np.where(np.eye(3) > 0, diagonal, diagonal.mean())
    pairs = zip(found.half.flat, allowed.flat, strict=True)
    return max(((h / a if a > 0 else math.inf) for h, a in pairs if h > 0), default=0.0)


def _finer(method, loads, knobs, missing):
    (name, power), least, most = KNOBS[method], *SMALLER
    factor = min(max(0.9 * missing ** (-1 / ORDERS[method]), least), most)
    value = knobs[name]
    if method == "fem":
        value = min(value, ON_SPHERE * min(measures(part).narrowest for part in loads.parts.values()) / 2)
    value *= factor**power
    return {name: value if power > 0 else math.ceil(value)}


def _bytes(method, loads, knobs):
    (value,) = knobs.values()
    return max(predicted(method, measures(part), value).bytes for part in loads.parts.values())


def _bracketed(loads, accuracy):
    """Certain bounds: their middle, and half of what is between them."""
    bracket = module_of("bracket")
    if loads.diagonal:
        found = {axis: bracket.solve(part, width=2 * accuracy) for axis, part in loads.parts.items()}
        middle = np.diag([(found[axis].lower + found[axis].upper) / 2 for axis in loads.alike])
        half = np.diag([(found[axis].upper - found[axis].lower) / 2 for axis in loads.alike])
        return Answer(middle, half, "certain bounds"), {"width": 2 * accuracy}, 1
    # A few elements along the box: they are smaller at its features.
    size = max(loads.parts[0].size) / COARSEST
    for rounds in range(1, ROUNDS + 1):
        both = bracket.solve_tensor(loads.parts[0], size=size)
        found = Answer(both.middle, both.radius, "certain bounds")
        missing = _excess(found, accuracy)
        if missing <= 1:
            return found, {"size": both.stats["size"]}, rounds
        size = both.stats["size"] * min(max(missing ** (-1 / 3), SMALLER[0]), SMALLER[1])
    raise RuntimeError(f"its bounds are still {missing * accuracy:.2g} apart with size = {size:.3g} m")
