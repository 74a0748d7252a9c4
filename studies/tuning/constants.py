"""The constants of twins at interfaces: what they are, where they were found, and how one is set for a while.

They are no knobs of `solve`: here they are set in their modules, one at a time, and set back.
"""

from collections.abc import Callable
from contextlib import contextmanager
from typing import NamedTuple

from demheat.laws import Laguerre
from demheat.packing.twins import conforming, gaps, interfaces, patterns

HOMES = (conforming, gaps, interfaces, patterns)


class Constant(NamedTuple):
    """One constant, lengths in mean radii of the packing."""

    meaning: str
    unit: float  # the value at factor 1: as shipped
    found_on: str
    setting: Callable[[float], dict[str, object]]  # a value -> what becomes of the names of the modules


def _named(*names):
    return lambda value: dict.fromkeys(names, value)


def _offset(value):
    # A twin at OFFSET weighs as much as a mean particle, whatever OFFSET is.
    return {"OFFSET": value, "EXCESS": 1.0 - value**2}


def _margin_of(value):
    return {"margin": lambda radius: value * radius**2}


def _excess(value):
    return {"EXCESS": value} | _margin_of(MARGIN)


def _least_offset(value):
    least = value / patterns.LEAST_OFFSET
    names = ("LEAST_OFFSET", "LEAST_SPACING", "FINE")
    return {name: least * getattr(patterns, name) for name in names}


CLOSE = Laguerre().gap_spacing
MARGIN = float(conforming.margin(1.0))
# What the margin was before it became wider: with the other sign of EXCESS.
BEFORE = MARGIN - 2 * conforming.EXCESS
SPHERE = "centred sphere, four contrasts"
CONSTANTS = {
    "OFFSET": Constant("of twins from the interface", conforming.OFFSET, SPHERE, _offset),
    "BEND": Constant(
        "twins stand nearer to a bent interface by this times R times the sum of its curvatures",
        conforming.BEND,
        "one sphere, 27 in order, unequal ones",
        _named("BEND"),
    ),
    "SPACING": Constant("of twins along the interface", patterns.SPACING, SPHERE, _named("SPACING")),
    "MARGIN": Constant(
        "squared distance of a particle to the interface less its weight, at least, squared mean radii",
        MARGIN,
        "seven random dispersions",
        _margin_of,
    ),
    "NARROW": Constant(
        "gaps narrower than this hold twins alone", conforming.NARROW, "by reasoning, and 83 spheres", _named("NARROW")
    ),
    "LESS": Constant(
        "by so much times R times the sum of curvatures less", conforming.LESS, "83 spheres, dense ones", _named("LESS")
    ),
    "EXCESS": Constant(
        "weight of a twin beyond its squared offset, squared mean radii", conforming.EXCESS, "by reasoning", _excess
    ),
    # A choice of the law: `studies.tuning.rows` sets it there.
    "GAP_SPACING": Constant(
        "of twins in a gap, over its width",
        CLOSE,
        "by reasoning",
        _named(),
    ),
    "THINNING": Constant(
        "spacing of points chosen from a fine pattern, over the one wanted",
        patterns.THINNING,
        "density of even patterns",
        _named("THINNING"),
    ),
    # No constants: what tiles and twins of today are held against.
    "RELAXED": Constant("a relaxed packing in place of tiles", 1.0, "nothing", lambda _: {}),
    "BEFORE": Constant(
        "relaxed packings, twins at half a radius or a quarter of a gap, as in 0.2.0",
        1.0,
        "centred sphere, four contrasts",
        lambda _: {"BEND": 0.0, "NARROW": 4.0 * conforming.OFFSET},
    ),
    "LEAST_OFFSET": Constant(
        "least offset of a pair that is kept", patterns.LEAST_OFFSET, "by reasoning", _least_offset
    ),
}


@contextmanager
def constant_set(name, factor):
    """Solve with one constant times a factor."""
    values = CONSTANTS[name].setting(factor * CONSTANTS[name].unit) if name else {}
    before = [(home, each, getattr(home, each)) for home in HOMES for each in values if hasattr(home, each)]
    try:
        for home, each, _ in before:
            setattr(home, each, values[each])
        yield
    finally:
        for home, each, value in before:
            setattr(home, each, value)
