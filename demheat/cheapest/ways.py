"""Which methods can find a body's conductivity to an accuracy, and what that would cost: from the laws, unsolved."""

from __future__ import annotations

import math
from collections.abc import Mapping
from importlib import import_module
from typing import NamedTuple

from demheat.cheapest.laws import laws, needed, predicted
from demheat.cheapest.loads import Loads
from demheat.cheapest.measures import measures

# Modules, by the names that their methods have in `METHODS`; in the order of preference where nothing is known.
HOMES = {
    "exact": "references.exact",
    "multipole": "references.multipole",
    "fem": "references.fem",
    "fft": "references.fft",
    "dem": "demheat.dem",
    "bracket": "references.bracket",
}
# Knobs that refine each, and what stands for an element's edge in them: value ~ edge^power.
KNOBS = {"fem": ("size", 1.0), "fft": ("voxels", -1.0), "dem": ("particles", -3.0)}
# An interval is so many times the error, in the median: what is asked of the laws is the error.
INTERVAL = 2.5
# What coarser runs for the interval cost, of the solve.
BESIDES = 1.5


class Way(NamedTuple):
    """One way to an accuracy.

    Attributes
    ----------
    method : str
    knobs : mapping
        To begin with.
    error : float
        Relative, that is to be expected.
    cpu_s : float, s
        All loads and the coarser runs for the interval; NaN if unknown.
    bytes : float
        At the peak; NaN if unknown.
    refused : str
        Why it is none; empty if it is one.
    """

    method: str
    knobs: Mapping
    error: float = math.nan
    cpu_s: float = math.nan
    bytes: float = math.nan
    refused: str = ""


def ways(loads: Loads, accuracy: float, memory: float) -> list[Way]:
    """All ways, the cheapest first, those that are none last.

    Parameters
    ----------
    loads : Loads
    accuracy : float
        Relative.
    memory : float
        Bytes.

    Returns
    -------
    list of Way
    """
    found = [_exact(loads, accuracy), _multipole(loads, accuracy, memory)]
    found += [_refined(name, loads, accuracy, memory) for name in KNOBS]
    return sorted(found, key=lambda way: (bool(way.refused), math.isnan(way.cpu_s), way.cpu_s))


def module_of(method: str):
    """Module of a method, loaded when it is needed.

    Parameters
    ----------
    method : str
        One of `HOMES`.
    """
    return import_module(HOMES[method])


def _exact(loads, accuracy):
    """Closed forms cost next to nothing: they are found by trying."""
    try:
        digits = min(module_of("exact").solve(whole).stats["digits"] for whole in loads.wholes.values())
    except NotImplementedError as error:
        return Way("exact", {}, refused=_line(error))
    if 10.0**-digits > accuracy:
        return Way("exact", {}, refused=f"{digits:.0f} digits only")
    return Way("exact", {}, 10.0**-digits, 0.0, 0.0)


def _multipole(loads, accuracy, memory):
    arrange = import_module("references.multipole.arrangement").arrange

    try:
        for whole in loads.wholes.values():
            arrange(whole, any_matrix=True)
    except NotImplementedError as error:
        return Way("multipole", {}, refused=_line(error))
    whole = next(iter(loads.wholes.values()))
    knobs = {"accuracy": accuracy}
    if "multipole" not in laws() or not whole.inclusions:
        return Way("multipole", knobs, accuracy)
    cost = predicted("multipole", whole, needed("multipole", whole, accuracy, sure=False))
    return _within(Way("multipole", knobs, accuracy, len(loads.wholes) * cost.cpu_s, cost.bytes), memory)


def _refined(name, loads, accuracy, memory):
    knob, power = KNOBS[name]
    part = measures(max(loads.parts.values(), key=lambda each: each.volume))
    value = needed(name, part, accuracy / INTERVAL, sure=False)
    cost = predicted(name, part, value)
    if cost.bytes > memory:
        # Laws are not that good: the finest that fits may do.
        finest = _rounded(value * (1.05 * (cost.bytes / memory) ** (1 / 3)) ** power, power)
        least = predicted(name, part, finest)
        if least.error <= laws()[name].error_within * accuracy:
            value, cost = finest, least
    cpu = BESIDES * len(loads.parts) * cost.cpu_s
    return _within(Way(name, {knob: value}, cost.error, cpu, cost.bytes), memory)


def _rounded(value, power):
    """Lengths as they are; voxels and particles are whole."""
    return value if power > 0 else max(int(value), 1)


def _within(way, memory):
    if way.bytes <= memory:
        return way
    gib = 2**30
    return way._replace(refused=f"needs about {way.bytes / gib:.2g} GiB, {memory / gib:.2g} are to be had")


def _line(error):
    return " ".join(str(error).split())
