"""Bodies that warm up, a slab, a ball and a beam of the papers: temperatures at points are held against series."""

from collections.abc import Callable
from functools import cache

import numpy as np

from demheat import referee
from demheat.declared import load
from demheat.scene import Scene
from studies.common.searches.ways import Way, knobs_at


def _slab():
    from studies.common.slab import slab

    return slab()


def _ball():
    from studies.common.sphere_in_time import sphere

    return sphere()


def _beam():
    from studies.common.terreros import beam

    return beam()


IN_TIME: dict[str, Callable[[], Scene]] = {"slab": _slab, "ball": _ball, "beam": _beam}
# Times at which temperatures are compared, s: those of the papers' figures.
TIMES = {"slab": (0.05, 0.1, 0.2), "ball": (1.0, 5.0, 10.0), "beam": (0.001, 0.01, 0.05, 0.1)}
# Points at random, the same for every method.
POINTS, SEED = 400, 2026
# What steps in time may err by, over the square of an element's edge in edges of the box: of the whole march, and of
# each of some hundred steps; errors in space go with that square.
STEPS = {"dem": 3e-2, "fem": 3e-3}
# Beyond these no scheme asks for less, or knows more.
LOOSEST, FINEST = 1e-3, 1e-7


@cache
def points_of(name: str) -> np.ndarray:
    """Where temperatures are compared, (n, 3) float array, m."""
    scene = IN_TIME[name]()
    # Elements' chords leave a little of a round body out.
    inside = 0.98 * (np.random.default_rng(SEED).uniform(size=(4 * POINTS, 3)) - 0.5)
    for axes in {"box": (), "sphere": ((0, 1, 2),), "cylinder-x": ((1, 2),)}[scene.domain]:
        inside = inside[np.linalg.norm(inside[:, axes], axis=1) < 0.49]
    return (0.5 + inside[:POINTS]) * scene.size


@cache
def exact_of(name: str) -> tuple:
    """Exact fields at the times."""
    from references import series

    return tuple(series.evolve(IN_TIME[name](), TIMES[name], points_per_axis=1))


def knobs_in_time(way: Way, value: float, scene: Scene) -> dict:
    """Keywords of `evolve` at a value of the knob, the steps' accuracy tied to it; by itself that of the method."""
    knobs = knobs_at(way, value, scene)
    if way.own:
        return knobs
    edge = value if way.knob == "size" else value ** (-1 / 3)
    return knobs | {"accuracy": float(np.clip(STEPS[way.method] * edge**2, FINEST, LOOSEST))}


def marched(way: Way, name: str, value: float) -> list:
    """Fields at all times, each with its temperatures at the points, (n,) float arrays."""
    scene, points = IN_TIME[name](), points_of(name)
    fields = load(way.method).evolve(scene, TIMES[name], **knobs_in_time(way, value, scene))
    return [(field, field.temperature_at(points)) for field in fields]


def error_of(name: str, found: list) -> float:
    """The largest over the times of the root mean square over the points, % of the span."""
    points, pairs = points_of(name), zip(found, exact_of(name), strict=True)
    return max(
        referee.temperature_error(field, exact, points, values=warm, unit="%").rms for (field, warm), exact in pairs
    )
