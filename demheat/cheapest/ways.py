"""Which methods can find a body's conductivity to an accuracy, and what that would cost: from the laws, unsolved."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from demheat import dem
from demheat.cheapest.cost_laws import ON_SPHERE, needed_to_show, predicted, work
from demheat.cheapest.loads import Loads
from demheat.cheapest.measures import PORE, Measures, measures
from demheat.runtime.extras import lacking
from demheat.scene import Scene
from demheat.scene.edges import SMOOTH, edge_order
from demheat.scene.inputs import one_line
from references import bracket, exact, fem, fft, multipole

# Modules, by the names that their methods have in `METHODS`; in the order of preference where nothing is known.
HOMES = {
    "exact": exact,
    "multipole": multipole,
    "fem": fem,
    "fft": fft,
    "dem": dem,
    "bracket": bracket,
}
# Knobs that refine each, and what stands for an element's edge in them: value ~ edge^power.
KNOBS = {"fem": ("size", 1.0), "fft": ("voxels", -1.0), "dem": ("particles", -3.0)}
# What each is given besides: of what iterates to a hundredth of a per cent, the conductivity is within a millionth of
# the grid's own (`fft.solve`).
FIXED = {"fft": {"tolerance": 1e-3}}
# Half intervals from which on that is as good as none.
COARSE = 1e-4
# What few methods take of a scene: those that are refined.
TAKES = {
    "fem": ("resistance", "anisotropy", "dependence", "image", "perfect"),
    "fft": ("resistance", "anisotropy", "image", "perfect"),
    "dem": ("resistance", "dependence", "image", "perfect"),
}
# Methods whose answers are extrapolated (`Field.extrapolated`), where their scene lets them: the interval of that is
# narrower than the one about the answer, and its coarser runs cost less.
EXTRAPOLATED = ("fem", "fft")
# Orders with which intervals fall, at least: errors scatter.
ORDERS = {"fem": 2.5, "fft": 1.0, "dem": 1.8}
# Edges of elements from one run to the next, and how many times.
SMALLEST, LARGEST, ROUNDS = 0.4, 0.9, 8
# The same where a body has parts too thin for the first ones, and how many times that is tried.
SHORTER, ANEW = 0.6, 2
# How much closer than its interval was off multipoles are asked to come, and how many times.
CLOSER, MORE_DEGREES = 0.5, 3
# Processor seconds of the first run at most, and the edges of elements to get there, again and again.
FIRST, COARSER = 3.0, 1.25
# Such a step is worth it where it leaves this part of the cost, or less.
LEAST_SAVED = 0.98
# Voxels along each axis with which the FFT's rule is that of any finer grid.
ENOUGH = (32, 32, 32)
# What coarser runs for the interval cost, with the solve, over the solve; and those of an extrapolation.
BESIDES, FOR_LIMIT = 1.5, 1.3
# Beside sharp edges of triangles the first interval is wider than laws of smooth bodies tell: there is a second run.
AGAIN = 2.0
# Parts of an image's voxels along each axis from one run to the next at most; voxels of the block that tells the error.
MOST_PARTS, BLOCK = 3, 64**3


class Way(NamedTuple):
    """One way to an accuracy."""

    method: str
    knobs: Mapping  # To begin with
    error: float = math.nan  # Relative, that is to be expected
    cpu_s: float = math.nan  # s: All loads and the coarser runs for the interval; NaN if unknown
    bytes: float = math.nan  # At the peak; NaN if unknown
    refused: str = ""  # Why it is none; empty if it is one
    doubt: str = ""  # Why it may be none: what the laws expect it to need; empty if there is no doubt
    rounds: int = 0  # Times that it was refined

    @property
    def rank(self):
        """By which ways are tried."""
        return bool(self.refused), bool(self.doubt), math.isnan(self.cpu_s), self.cpu_s


def ways(loads: Loads, accuracy: float, memory: float) -> list[Way]:
    """All ways, the cheapest first, then those in doubt, and those that are none last."""
    found = [_exact(loads, accuracy), _multipole(loads, accuracy, memory)]
    found += [_refined(name, loads, accuracy, memory) for name in KNOBS]
    return sorted(found, key=lambda way: way.rank)


def finer(way: Way, loads: Loads, missing: float, memory: float) -> Way:
    """The same way on smaller elements, as far as its interval says, and what that is now expected to cost."""
    told = f"half of its interval is {missing:.2g} times what is allowed with {knobs_of(way) or 'nothing to refine'}"
    if way.method == "multipole" and way.rounds < MORE_DEGREES:
        closer = _multipole(loads, CLOSER * way.knobs["accuracy"] / missing, memory)
        return closer._replace(rounds=way.rounds + 1)
    if way.method not in KNOBS or way.rounds >= ROUNDS:
        return way._replace(refused=told)
    if loads.body.image is not None:
        return finer_image(way, loads, missing, memory, told)
    return _on_shorter(way, loads, min(0.9 * missing ** (-1 / ORDERS[way.method]), LARGEST), memory, told)


def shorter(way: Way, loads: Loads, memory: float, why: str) -> Way:
    """The same way on shorter elements where they were too long for the body; refused where that helped not, twice."""
    if way.method not in KNOBS or way.rounds >= ANEW or loads.body.image is not None:
        return way._replace(refused=why)
    return _on_shorter(way, loads, SHORTER, memory, why)


def _on_shorter(way, loads, edge, memory, told):
    """The same on elements whose edges are so many times as long, but no shorter than is taken at once."""
    knob, power = KNOBS[way.method]
    value, (law, part) = way.knobs[knob], _law(way.method, loads)
    if way.method == "fem":
        # Longer edges than those on the spheres change nothing there.
        value = min(value, ON_SPHERE * part.narrowest)
    cost = predicted(law, part, _scaled(value, edge, power))
    if cost.bytes > memory:
        return way._replace(refused=f"{told}; narrower ones would need {_gib(cost.bytes)}")
    knobs = {**way.knobs, knob: _scaled(value, max(edge, SMALLEST), power)}
    spent = _all(cost, loads, _has_limit(way.method, law, loads))
    return way._replace(knobs=knobs, cpu_s=spent, bytes=cost.bytes, doubt="", rounds=way.rounds + 1)


def _exact(loads, accuracy):
    """Closed forms cost next to nothing: they are found by trying."""
    try:
        digits = min(exact.solve(whole).stats["digits"] for whole in loads.wholes.values())
    except NotImplementedError as error:
        return Way("exact", {}, refused=one_line(error))
    if 10.0**-digits > accuracy:
        return Way("exact", {}, refused=f"{digits:.0f} digits only")
    return Way("exact", {}, 10.0**-digits, 0.0, 0.0)


def _multipole(loads, accuracy, memory):
    try:
        found = [_law_of("multipole", whole, loads.of_body) for whole in loads.wholes.values()]
    except NotImplementedError as error:
        return Way("multipole", {}, refused=one_line(error))
    knobs = {"accuracy": accuracy}
    if not loads.body.inclusions:
        return Way("multipole", knobs, accuracy)
    law, m = found[0]
    cost = predicted(law, m, needed_to_show(law, m, accuracy))
    return _within(Way("multipole", knobs, accuracy, len(loads.wholes) * cost.cpu_s, cost.bytes), memory)


def _refined(name, loads, accuracy, memory):
    if why := lacking(name):
        return Way(name, {}, refused=why)
    try:
        loads.body.require(takes=TAKES[name])
    except NotImplementedError as error:
        return Way(name, {}, refused=one_line(error))
    if loads.body.image is not None:
        return on_image(name, loads, accuracy, memory)
    (knob, power), (law, part) = KNOBS[name], _law(name, loads)
    limit = _has_limit(name, law, loads)
    value = needed_to_show(law, part, accuracy)
    cost, first = predicted(law, part, value), value
    # Laws of the error may be far off: begin with what costs little, its interval says how far to go from there.
    while predicted(law, part, first).cpu_s > FIRST:
        coarser = _scaled(first, COARSER, power)
        if predicted(law, part, coarser).cpu_s > LEAST_SAVED * predicted(law, part, first).cpu_s:
            # What is left is paid for each inclusion, whatever the elements.
            break
        first = coarser
    way = _within(
        Way(name, {**_fixed(name, accuracy), knob: first}, cost.error, _all(cost, loads, limit), cost.bytes), memory
    )
    least = predicted(law, part, first).bytes
    if least > memory:
        return way._replace(refused=f"needs {_gib(least)} to begin with")
    if name == "fem":
        # Loads what is heavy.
        from references.fem.cusps import cusp

        return way._replace(refused=next(filter(None, map(cusp, loads.parts.values())), ""))
    return way


def _fixed(name, accuracy):
    return FIXED.get(name, {}) if accuracy >= COARSE else {}


def on_image(name, loads, accuracy, memory):
    """A way on an image: voxels are its own, and are split where that is too coarse; by the FFT, the cheapest there."""
    if name != "fft":
        return Way(name, {}, doubt="on an image the FFT costs less")
    way = _on_voxels(loads, 1, _fixed(name, accuracy))
    return way._replace(refused=f"needs {_gib(way.bytes)}") if way.bytes > memory else way


def finer_image(way, loads, missing, memory, told):
    """The same on voxels that are split further."""
    if way.method != "fft":
        return way._replace(refused=told)
    parts, fixed = way.knobs["voxels"][0] // loads.body.image.shape[0], dict(way.knobs)
    del fixed["voxels"]
    finer = _on_voxels(loads, parts * min(max(math.ceil(missing / parts), 2), MOST_PARTS), fixed)
    if finer.bytes > memory:
        return way._replace(refused=f"{told}; smaller ones would need {_gib(finer.bytes)}")
    return finer._replace(rounds=way.rounds + 1)


def _on_voxels(loads, parts, fixed):
    """The FFT on the voxels of an image, each split into some parts along each axis."""
    k, shape = loads.body.mean_conductivities, [n * parts for n in loads.body.image.shape]
    contrast = math.log(k.max() / max(k.min(), k.max() / PORE)) if k.max() else 0.0
    m, whole = loads.of_body._replace(contrast=contrast), math.prod(shape)
    # The interval is that of a block, whose voxels are split in two.
    split = 9 * min(whole, BLOCK)
    costs = [work("fft-plain", m, number) for number in (whole, split)]
    cpu_s = len(loads.wholes) * sum(each.cpu_s for each in costs)
    return Way("fft", {**fixed, "voxels": tuple(shape)}, cpu_s=cpu_s, bytes=max(each.bytes for each in costs))


def _law(method, loads):
    """Name of a method's law and the measures that it is asked of, those of the largest part."""
    return _law_of(method, loads.largest, loads.of_largest)


def law_and_measures(method: str, scene: Scene) -> tuple[str, Measures]:
    """Name of a method's law, of the FFT that of the rule which its solver takes by itself, and what it is asked of."""
    return _law_of(method, scene, measures(scene))


def _law_of(method, scene, m):
    if method == "fft":
        # Loads what is heavy, as do multipoles.
        from references.fft.rules import automatic

        rule = automatic("cg", scene, ENOUGH)
        return "fft" if rule == "laminate" else f"fft-{rule}", m
    if method == "fem" and m.asked:
        # Surfaces of functions are met by a lattice, whose elements do not follow them as curved ones do.
        return "fem-lattice", m
    if method == "multipole":
        from references.multipole.arrangement import arrange

        # Mirror images in walls are spheres like others.
        m = m._replace(count=len(arrange(scene, any_matrix=True).spheres.radii))
    return method, m


def _scaled(value, edge, power):
    """A knob for elements with edges so many times as long; voxels and particles are whole."""
    value *= edge**power
    return float(value) if power > 0 else max(int(value), 1)


def _has_limit(name, law, loads):
    """Whether answers are extrapolated: not beside edges, in coats or on plain voxels."""
    body = loads.body
    if name not in EXTRAPOLATED or law == "fft-plain" or body.varies or (name == "fft" and body.resistances.any()):
        return False
    return not any(np.any(part.parents()) or edge_order(part) < SMOOTH for part in loads.parts.values())


def _all(cost, loads, limit=False):
    again = AGAIN if any(shape.drawn.sharp for shape in loads.body.inclusions) else 1.0
    return again * (FOR_LIMIT if limit else BESIDES) * len(loads.parts) * cost.cpu_s


def knobs_of(way) -> str:
    """Knobs of a way, or of what was found by one, in words; empty without one."""
    return ", ".join(f"{name} = {_worded(value)}" for name, value in way.knobs.items())


def _worded(value):
    if isinstance(value, tuple):
        return " x ".join(map(str, value))
    return str(value) if isinstance(value, int) else f"{value:.3g}"


def _within(way, memory):
    if way.bytes <= memory:
        return way
    return way._replace(doubt=f"expected to need {_gib(way.bytes)}, {_gib(memory)} may be used")


def _gib(number):
    return f"{number / 2**30:.2g} GiB"
