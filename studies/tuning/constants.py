"""The constants of twins at interfaces: what they are, where they were found, and how one is set for a while.

They are no knobs of `solve`: here they are set in their modules, one at a time, and set back.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import contextmanager
from typing import NamedTuple
from unittest.mock import patch

import numpy as np

from demheat.laws import Laguerre
from demheat.packing import conforming, gaps, interfaces, patterns

HOMES = (conforming, gaps, interfaces, patterns)


class Constant(NamedTuple):
    """One constant, lengths in mean radii of the packing."""

    meaning: str
    unit: float  # the value at factor 1: as shipped, of CURVATURE as proposed
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


def _curvature(value):
    """Twins of a sphere stand nearer to it by this times its curvature in mean radii, by a half at most."""
    shipped, wide = conforming._room, conforming.OFFSET

    def room(points, normals, own, interfaces, radius):
        curvature = np.append(1.0 / interfaces.spheres.radii, np.zeros(len(interfaces.others)))[own]
        nearer = np.minimum(value * radius * curvature, 0.5)
        return np.minimum(wide * (1.0 - nearer) * radius, shipped(points, normals, own, interfaces, radius))

    return {"_room": room}


def _nothing(points, *_):
    """No gap, no wall: as if all were far away."""
    return np.full(len(points), np.inf)


def _room(value):
    """Scales how much of a gap twins take up: a quarter from either side of an interface, half of it towards a wall."""
    shipped = conforming._room

    def room(points, normals, own, interfaces, radius):
        with patch.object(conforming, "OFFSET", np.inf):
            free = shipped(points, normals, own, interfaces, radius)
        with patch.object(interfaces, "gap", _nothing), patch.object(interfaces, "way_to_wall", _nothing):
            wide = shipped(points, normals, own, interfaces, radius)
        return np.minimum(wide, value * free)

    return {"_room": room}


CLOSE = Laguerre().gap_spacing
MARGIN = float(conforming.margin(1.0))
# What the margin was before it became wider: with the other sign of EXCESS.
NARROW = MARGIN - 2 * conforming.EXCESS
SPHERE, UNSAID = "centred sphere, four contrasts", "nobody wrote it down"
CONSTANTS = {
    "OFFSET": Constant("of twins from the interface", conforming.OFFSET, SPHERE, _offset),
    # Not shipped: what would lower the errors of most scenes, and raise those of dense dispersions.
    "CURVATURE": Constant(
        "twins of a sphere stand nearer to it by this times its curvature, times mean radii",
        1.1,
        "eleven scenes drawn like those here, from seeds 0 to 2",
        _curvature,
    ),
    "SPACING": Constant("of twins along the interface", patterns.SPACING, SPHERE, _named("SPACING")),
    "MARGIN": Constant(
        "squared distance of a particle to the interface less its weight, at least, squared mean radii",
        MARGIN,
        "seven random dispersions",
        _margin_of,
    ),
    "CLEARANCE": Constant(
        "a particle nearer than the twins beside it plus this gives way",
        conforming.CLEARANCE,
        UNSAID,
        _named("CLEARANCE"),
    ),
    "EXCESS": Constant(
        "weight of a twin beyond its squared offset, squared mean radii", conforming.EXCESS, "by reasoning", _excess
    ),
    "ROOM": Constant("part that twins take up of a narrow gap, over a quarter", 1.0, "by reasoning", _room),
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
