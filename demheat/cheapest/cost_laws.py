"""Laws of error and cost of each method, fitted by the study `frontier` and kept beside this file in `laws.csv`.

The relative error of the conductivity is A (h/s)^p g: h the size of an element, s the scene's smallest width, and
g = strength^a (1 + contrast)^b fraction^c gap^d; of multipoles, whose errors fall by a factor with each degree, (h/s)
stands for exp(-2 degree acosh(1 + gap/2)), with which the waves between two equal spheres decay. Half of the interval
that a method gives has a law of the same form; of multipoles, whose interval is asked for, it is that of the error. The
processor time is
(B + u V/h^3 + v S/h^2 + w n + ...) (1 + contrast)^r with the box's volume V, the interfaces' surface S and the number n
of inclusions; what follows are surfaces whose nearest points must be searched for, the number of such bodies, and
surfaces of functions. The memory is a sum of the first of these. The measures of a scene are those of
`demheat.cheapest.measures`.

`laws.csv` is never changed by hand (`python -m studies.frontier.laws`); what `recommend` prints is multiplied by runs
and loads in `ways`. The laws say what to expect, not what is certain: nine values in ten that they were fitted to lie
within the factors `error_within` and `cost_within`, and of scenes unlike those one in ten lies farther off. They are
for steady heat, on the machine of the study's rows; layers are exact with most methods.
"""

import csv
import math
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from demheat.cheapest.measures import Measures, measures
from demheat.method import DEGREE, PARTICLES, SIZE, VOXELS
from demheat.scene import Scene
from demheat.scene.inputs import chosen, finite

FILE = Path(__file__).with_name("laws.csv")
KNOBS = {each.knob: each for each in (PARTICLES, SIZE, VOXELS, DEGREE)}
KINDS = {"method": str, "knob": str, "rows": int, "scenes": int}
# Edges of elements on a small sphere over its diameter, as `references.mesh` has them: no size asked for makes them
# longer.
ON_SPHERE = 0.165
# Seconds for each square of an element on a surface of one triangle, besides those of any that is searched for, and how
# they grow with the logarithm of the number of triangles: cubes, tetrahedra, octahedra, balls and a knot (see
# docs/decisions/estimates.md).
ON_TRIANGLES = {"dem": 1.7e-4, "fft": 4.5e-5}
DEEPER = 0.38
# Particles (edges of cubes as large) across what triangles enclose, below which intervals tell next to nothing: a knot
# of a tube a tenth of the cell thick had one 33 times as wide as asked for with 1000 of them.
ACROSS = 2.7
# Of the logarithm of the factor within which nine in ten are, about a standard deviation.
LIKELY = 0.6
# Below that a measure makes no difference: exponents of it must not blow up where it vanishes.
LEAST = 1e-3


class Law(NamedTuple):
    """Law of one method."""

    # method, knob: The method's name, and the keyword that refines it
    method: str
    knob: str
    # coarsest, finest: Values of it that were fitted; lengths in edges of the box
    coarsest: float
    finest: float
    # error, refinement, strength, contrast, fraction, gap: A, p, a, b, c and d
    error: float
    refinement: float
    strength: float
    contrast: float
    fraction: float
    gap: float
    error_within: float  # Factor within which nine of ten fitted errors are
    # half, half_refinement and so on: The same of half of the interval
    half: float
    half_refinement: float
    half_strength: float
    half_contrast: float
    half_fraction: float
    half_gap: float
    half_within: float
    # base, bulk, surface, each: B, u, v and w, s
    base: float
    bulk: float
    surface: float
    each: float
    # searched, each_searched, asked: The same of surfaces whose nearest points are no closed form, s
    searched: float
    each_searched: float
    asked: float
    stiffness: float  # r
    cost_within: float
    # bulk_bytes, surface_bytes, each_bytes: At the peak
    bulk_bytes: float
    surface_bytes: float
    each_bytes: float
    bytes_within: float
    # rows, scenes: Values and scenes that the law was fitted to
    rows: int
    scenes: int

    @property
    def error_powers(self) -> np.ndarray:
        """With which the law of the error weighs `error_terms`, (6,) float array."""
        return _powers(self.error, self.refinement, self.strength, self.contrast, self.fraction, self.gap)

    @property
    def half_powers(self) -> np.ndarray:
        """The same of half of the interval."""
        return _powers(
            self.half, self.half_refinement, self.half_strength, self.half_contrast, self.half_fraction, self.half_gap
        )

    @property
    def seconds(self) -> tuple[float, ...]:
        """Of each of `size_terms`."""
        return (self.base, self.bulk, self.surface, self.each, self.searched, self.each_searched, self.asked)

    @property
    def bytes(self) -> tuple[float, ...]:
        """Of each of `size_terms`."""
        return (0.0, self.bulk_bytes, self.surface_bytes, self.each_bytes, 0.0, 0.0, 0.0)


class Predicted(NamedTuple):
    """What a method will do: relative error of the conductivity, processor time in s, memory at its peak in bytes."""

    error: float
    cpu_s: float
    bytes: float


@cache
def laws(file: Path = FILE) -> MappingProxyType:
    """All laws by their method's name."""
    with Path(file).open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    found = [Law(*(KINDS.get(name, float)(row[name]) for name in Law._fields)) for row in rows]
    return MappingProxyType({law.method: law for law in found})


def predicted(method: str, scene: Scene | Measures, value: float) -> Predicted:
    """Error and cost of a method that are to be expected."""
    law, m = law_of(method), _measured(scene)
    finite("value", value, f"a finite number > 0, of {law.knob!r}", lambda v: v > 0)
    return predicted_by(law, m, value)


def needed_to_show(method: str, scene: Scene | Measures, accuracy: float) -> float | int:
    """Coarsest value of a method's resolution with which half of its interval will most likely be as narrow.

    To run twice costs more.
    """
    law = law_of(method)
    finite("accuracy", accuracy, "a number between 0 and 1", lambda v: 0 < v < 1)
    if not law.half_refinement > 0:
        raise ValueError(f"method = {method!r}: its intervals were not found to narrow with the resolution")
    m = _measured(scene)
    terms = error_terms(law.knob, m, 1.0)
    terms[1] = 0.0
    goal = math.log(accuracy) - LIKELY * math.log(law.half_within)
    # Logarithm of h/s, or of what stands for it.
    return _value(law, m, (goal - terms @ law.half_powers) / law.half_refinement)


def _value(law, m, refined):
    """Of the knob, no coarser than the coarsest that was fitted."""
    if law.knob == DEGREE.knob:
        return max(math.ceil(-refined / _decay(m)), int(law.coarsest))
    h = m.smallest * math.exp(refined)
    if law.knob == SIZE.knob:
        coarsest = law.coarsest * m.edge
        # Among triangles a lattice is as coarse everywhere.
        return coarsest if h >= ON_SPHERE * m.narrowest and not m.triangles else min(h, coarsest)
    per_edge = m.edge / h
    if m.triangles and law.knob == PARTICLES.knob:
        per_edge = max(per_edge, ACROSS * m.edge / m.narrowest)
    return max(math.ceil(per_edge**3 if law.knob == PARTICLES.knob else per_edge), int(law.coarsest))


def predicted_by(law: Law, m: Measures, value: float) -> Predicted:
    """What a law predicts."""
    error = math.exp(error_terms(law.knob, m, value) @ law.error_powers)
    cpu_s, memory = _work(law, m, size_terms(law.knob, m, value))
    return Predicted(error, cpu_s + on_triangles(law.method, m, value), memory)


def on_triangles(method: str, m: Measures, value: float) -> float:
    """Seconds besides of finding the nearest of many triangles, as a tree is the deeper the more of them there are."""
    each, knob = ON_TRIANGLES.get(method.split("-")[0], 0.0), law_of(method).knob
    if not (each and m.triangles):
        return 0.0
    return each * (1 + DEEPER * math.log(m.triangles)) * m.drawn / element(knob, m, value) ** 2


def work(method: str, m: Measures, number: float) -> Predicted:
    """What so many elements cost that no surface is looked for in; of the error nothing is known."""
    return Predicted(math.nan, *_work(law_of(method), m, np.array([1.0, number, *[0.0] * 5])))


def _work(law, m, sizes):
    cpu_s = sizes @ law.seconds * math.exp(law.stiffness * stiff_term(m))
    return float(cpu_s), float(sizes @ law.bytes)


def law_of(method: str) -> Law:
    """Law of a method by its name; ValueError if there is none."""
    chosen("method", method, tuple(laws()))
    return laws()[method]


def error_terms(knob: str, m: Measures, value: float) -> np.ndarray:
    """Logarithms that the law of the error weighs, (6,) float array: 1, h/s, strength, 1 + contrast, fraction, gap."""
    if knob == DEGREE.knob:
        refined = -_decay(m) * value
    else:
        h = element(knob, m, value)
        refined = math.log((min(h, ON_SPHERE * m.narrowest) if knob == SIZE.knob else h) / m.smallest)
    strength, fraction = (math.log(max(value, LEAST)) for value in (m.strength, m.fraction))
    # Beyond a radius neighbours are far.
    return np.array([1.0, refined, strength, math.log1p(m.contrast), fraction, math.log(min(m.gap, 1.0))])


def stiff_term(m: Measures) -> float:
    """Logarithm that the law of the cost weighs."""
    return math.log1p(m.contrast)


def size_terms(knob: str, m: Measures, value: float) -> np.ndarray:
    """Numbers that cost and memory are made of, (7,) float array, see `Law.seconds`; waves of multipoles are bulk."""
    if knob == DEGREE.knob:
        return np.array([1.0, m.count * ((value + 1) ** 2 - 1), 0.0, m.count, 0.0, 0.0, 0.0])
    h = element(knob, m, value)
    surfaces = np.array([m.surface, m.searched, m.asked]) / h**2
    return np.array([1.0, (m.edge / h) ** 3, surfaces[0], m.count, surfaces[1], m.count_searched, surfaces[2]])


def element(knob: str, m: Measures, value: float) -> float:
    """Size of an element, m."""
    resolution = KNOBS[knob]
    return m.edge * resolution.size(value / m.edge if resolution.metric else value)


def _measured(scene):
    return scene if isinstance(scene, Measures) else measures(scene)


def _decay(m):
    return 2 * math.acosh(1 + m.gap / 2)


def _powers(amount, *exponents):
    return np.array([math.log(amount), *exponents])
