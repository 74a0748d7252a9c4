"""Stored trails read again: a row's word on who reaches a target is held against what was tried."""

import json
import math
from functools import cache

from studies.common.searches.search import QUANTITIES, Point, reaching


@cache
def points_of(trail: str) -> tuple:
    """Points of a trail as a row keeps it, each with as many runs as there were, all at the median of their costs."""
    return tuple(_point(*each) for each in json.loads(trail))


def _point(value, unknowns, walked, *parts):
    there = {name: part for name, part in zip(QUANTITIES, parts, strict=True) if part}
    errors = {name: math.nan if part[0] is None else part[0] for name, part in there.items()}
    costs = {name: [(part[1], math.nan, math.nan)] * part[2] for name, part in there.items()}
    return Point(value, errors, costs, unknowns, bool(walked))


def borne_out(row: dict, quantity: str, target: float, value: float) -> bool:
    """Whether a value reaches a target by what its row tried; where that is not kept it does.

    Older searches took sizes that make the same elements for finer ones.
    """
    trail = row.get("trail")
    points = points_of(trail) if isinstance(trail, str) else ()
    return not points or any(points[place].value == value for place in reaching(points, quantity, target))
