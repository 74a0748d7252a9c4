"""One row of a sweep: the case, what the function returned, what that cost and where it was made."""

from collections.abc import Callable, Mapping
from functools import singledispatch
from numbers import Real

import numpy as np

from demheat.cheapest.effective import Effective
from demheat.field import Field
from demheat.runtime.machine import here
from demheat.runtime.process_state import stopwatch
from demheat.scene.inputs import one_line, shown
from demheat.version import __version__

# Column of a file that finds a row again; what every row ends with.
CASE = "case"
TAIL = ("error", "wall_s", "cpu_s", "when", "machine", "host", "version")
ENTRIES = {"k_xx": (0, 0), "k_yy": (1, 1), "k_zz": (2, 2), "k_yz": (1, 2), "k_xz": (0, 2), "k_xy": (0, 1)}


def row_of(function: Callable, case: Mapping) -> dict:
    """Call the function in this process; what it raises is the row's error."""
    spent, values, error = stopwatch(), {}, ""
    try:
        values = _apart(values_of(function(**case)), case)
    except Exception as raised:
        error = f"{type(raised).__name__}: {one_line(raised)}"
    return {**case, **values, "error": error, **spent(), **origin()}


def failed(case: Mapping, error: str) -> dict:
    """Row of a case that did not come to an end."""
    return {**case, "error": " ".join(error.split()), "wall_s": None, "cpu_s": None, **origin()}


def origin() -> dict:
    """When, where and by which version of the package a row is made."""
    return here() | {"version": __version__}


@singledispatch
def values_of(result) -> dict:
    """What a row holds of what a function returned."""
    if isinstance(result, str | Real | np.generic):
        return {"value": _plain("value", result)}
    raise ValueError(f"the function returned {shown(result):.80}: must be a number, text, dict, Field or Effective")


@values_of.register
def _(result: Mapping) -> dict:
    return {str(name): _plain(name, value) for name, value in result.items()}


@values_of.register
def _(result: Field) -> dict:
    known = {name: result.stats.get(name) for name in ("unknowns", "iterations", "residual")}
    return {"conductivity": float(result.conductivity), **known}


@values_of.register
def _(result: Effective) -> dict:
    tensor = {name: float(result.tensor[place]) for name, place in ENTRIES.items()}
    return {**tensor, "accuracy": result.accuracy, "method": result.method}


def _plain(name, value):
    value = value.item() if isinstance(value, np.generic) else value
    if not isinstance(value, str | int | float | None):
        raise ValueError(f"the function returned {name} = {shown(value):.80}: must be a number or text")
    return value


def _apart(values, case):
    """Values that stand in no other column; the function may repeat what it was given."""
    clash = sorted(name for name in values if name in (CASE, *TAIL) or (name in case and values[name] != case[name]))
    if clash:
        raise ValueError(f"the function returned {clash}: must not be names of its case or columns that every row has")
    return values
