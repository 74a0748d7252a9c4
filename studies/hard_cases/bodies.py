"""Hard cases without a conductivity: walls that meet, and heat in time. What is judged is the temperature."""

import math

import numpy as np

from demheat import referee
from demheat.scene import Flux, Material, Scene
from studies.common.answers import answer
from studies.hard_cases.rows import row_of
from studies.hard_cases.scenes import LOW
from studies.hard_cases.verdicts import Verdict, refused
from studies.hard_cases.ways import DECLARED, ways
from studies.harness import methods

POINTS = 40
# Of the span: as `ways.allowed` of conductivities.
LEAST, MOST = 0.02, 0.20
STEPS = 300  # of equal size, so that a thousandth of the limit costs no more than the limit
ABOVE = 0.3  # share of steps from the limit to twice it, which explicit Euler must refuse
# How a transient is asked for: method, integrator and law of the DEM, or elements.
IN_TIME = (
    ("dem", {"integrator": "euler"}),
    ("dem-calibrated", {"integrator": "euler", "law": "calibrated"}),
    ("dem", {"integrator": "rkl2"}),
    ("dem", {"integrator": "tr-bdf2"}),
    ("dem", {"integrator": "auto"}),
    ("fem", {"order": 2}),
    ("fem-bricks", {"elements": "hexahedra"}),
)
# Terms of the series of a corner: what is left falls like the square of their number.
TERMS = 400


def corner(seed: int) -> dict:
    """A homogeneous box, two walls that meet held, a flux through a third: exact by Fourier's series."""
    rng = np.random.default_rng([seed, 1, 16])
    scene = _corner_scene(rng)
    points = rng.uniform(0.05, 0.95, (POINTS, 3)) * scene.size
    exact = _corner_temperature(scene, points)
    verdicts = []
    for way in ways("corner", scene, rng):
        solve = methods.load(way.method.module).solve
        field, said, refusal = answer(lambda solve=solve, way=way: solve(scene, **way.knobs))
        if refusal is not None:
            verdicts.append(refused(way.name, refusal))
            continue
        limit = _allowed(way.method, way.element, min(scene.size))
        off = referee.rms(referee.value_error(field.temperature_at(points), exact, scale=float(np.ptp(exact))))
        verdicts.append(_verdict(way.name, off, limit, said))
    return row_of(verdicts, "series")


def _corner_scene(rng):
    """Heat comes in through x+, leaves through x- and y-."""
    size, k = rng.uniform(0.3, 1.0, 3) * 10 ** rng.uniform(-9, 9), 10 ** rng.uniform(-6, 6)
    walls = {"x-": LOW, "y-": LOW, "x+": Flux(k / float(size[0]) * rng.uniform(1, 50))}
    return Scene(size, Material(k), walls=walls)


def _corner_temperature(scene, points):
    """Sum of sines across and hyperbolic sines along, from the cold walls."""
    a, b, _ = scene.size
    rate = (np.arange(TERMS) + 0.5) * np.pi / b
    x, y = points[:, :1], points[:, 1:2]
    # sinh(rate x) / cosh(rate a), without overflow.
    along = (np.exp(rate * (x - a)) - np.exp(-rate * (x + a))) / (1 + np.exp(-2 * rate * a))
    amplitude = 2 * scene.wall_fluxes["x+"] / (scene.matrix.conductivity * b * rate**2)
    return LOW + np.sum(amplitude * along * np.sin(rate * y), axis=1)


def in_time(seed: int) -> dict:
    """A slab in time, with steps from a thousandth to twice the limit of explicit Euler."""
    rng = np.random.default_rng([seed, 2, 16])
    scene, knobs = _slab(rng), {"particles": int(10 ** rng.uniform(2.3, 3.3)), "seed": int(rng.integers(100))}
    verdicts = []
    for name, how in IN_TIME:
        factor = rng.uniform(1, 2) if rng.random() < ABOVE else 10 ** rng.uniform(-3, 0)
        more, element = (knobs, (scene.volume / knobs["particles"]) ** (1 / 3)), 0.0
        if name.startswith("fem"):
            element = max(scene.size) / int(rng.integers(4, 9))
            more = {"size": element}
        else:
            more, element = more
        verdicts.append(_timed(scene, name, {**more, **how}, element, factor))
    return row_of(verdicts, "series")


def _slab(rng):
    """Between two walls, held or heated, one temperature at first."""
    edge = 10 ** rng.uniform(-9, 9)
    size = np.array((1.0, *rng.uniform(0.4, 1.0, 2)))[rng.permutation(3)] * edge
    k = 10 ** rng.uniform(-6, 6)
    axis = "xyz"[int(np.argmax(size))]
    hot = LOW + 10.0 if rng.random() < 0.6 else Flux(10.0 * k / edge)
    metal = Material(k, density=10 ** rng.uniform(0, 4), heat_capacity=10 ** rng.uniform(0, 3))
    return Scene(size, metal, walls={axis + "-": LOW, axis + "+": hot}, initial=LOW)


def _timed(scene, name, knobs, element, factor):
    """Verdict on a run of so many steps; those of the limit and above by one that is implicit."""
    from references import exact

    method = methods.all_methods()[name]
    evolve, rate = methods.load(method.module).evolve, scene.matrix.conductivity
    rate /= scene.matrix.density * scene.matrix.heat_capacity
    step = factor * _limit(scene, element, rate, knobs)
    times = (STEPS * step,)
    chosen = {} if knobs.get("integrator") == "auto" else {"step": step}
    field, said, refusal = answer(lambda: list(evolve(scene, times, **knobs, **chosen))[-1])
    label = f"{name}, {knobs.get('integrator', 'tr-bdf2')}"
    if refusal is not None:
        return refused(label, refusal)
    (reference,) = exact.evolve(scene, times)
    # Particles at walls are held at their temperature by the paper's law: what is nearer than one is the wall's.
    near = element / max(scene.size) if name == "dem-calibrated" else 0.02
    points = np.random.default_rng(0).uniform(near, 1 - near, (POINTS, 3)) * scene.size
    span = max(10.0, *(abs(value - LOW) for value in reference.wall_temperature.values()))
    off = referee.rms(referee.value_error(field.temperature_at(points), reference.temperature_at(points), scale=span))
    reach = min(math.sqrt(rate * times[0]), max(scene.size))
    return _verdict(label, off, _allowed(method, element, reach), said)


def _limit(scene, element, rate, knobs):
    """Largest stable step of explicit Euler: the network's own; for elements the square of their size over 6 rates."""
    if "size" in knobs:
        return element**2 / (6 * rate)
    from demheat import dem

    probe = {**knobs, "integrator": "euler"}
    (field,) = dem.evolve(scene, (1e-3 * element**2 / rate,), **probe)
    return field.stats["step_limit"]


def _allowed(method, element, feature):
    """Error of the temperature over the span: what is declared, with the first order of an element over a feature."""
    declared = (method if method.errors else methods.all_methods()["fem-p1"]).errors.temperature
    at_declared = DECLARED / method.resolution.size(method.coarse)
    return float(np.clip(declared * at_declared * element / feature, LEAST, MOST)) if element else LEAST


def _verdict(name, off, limit, said):
    if math.isfinite(off) and off <= limit:
        return Verdict(name, "verified", off, limit, "; ".join(said))
    return Verdict(name, "warned" if said and math.isfinite(off) else "wrong", off, limit, "; ".join(said))
