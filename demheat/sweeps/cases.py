"""Cases of a sweep: a grid or a list, checked."""

import itertools
from collections.abc import Iterable, Mapping

import numpy as np

from demheat.scene.inputs import shown
from demheat.sweeps.rows import CASE, TAIL

PLAIN = (str, int, float, bool, type(None))
VALID = "a dict of lists, or a list of dicts with names as keys"


def case_list(cases: Mapping | Iterable[Mapping], *, plain: bool) -> list[dict]:
    """Cases as dicts; of a dict of lists every combination, the last name fastest."""
    made = _product(cases) if isinstance(cases, Mapping) else _listed(cases)
    if not made:
        raise ValueError(f"cases = {shown(cases)}: must be at least one")
    made = [{name: _python(value) for name, value in case.items()} for case in made]
    for case in made:
        taken = sorted(set(case) & {CASE, *TAIL})
        if taken:
            raise ValueError(f"cases: must have no values called {taken}, as columns that every row has")
        odd = [name for name, value in case.items() if plain and not isinstance(value, PLAIN)]
        if odd:
            raise ValueError(f"cases: {odd[0]} = {shown(case[odd[0]])}: must be a number or text to be kept in `out`")
    if plain and len({key_of(case) for case in made}) < len(made):
        raise ValueError("cases: must differ from each other to be kept in `out`; two are alike")
    return made


def key_of(case: Mapping) -> str:
    """Name of a case in a file, as "contrast=5.0,particles=1000": the same whatever the order of its values."""
    return ",".join(f"{name}={case[name]}" for name in sorted(case))


def _product(grid):
    columns = [_values(name, values) for name, values in grid.items()]
    return [dict(zip(grid, values, strict=True)) for values in itertools.product(*columns)] if columns else []


def _values(name, values):
    """Values of one name: no text, which is a sequence too, and no set, which has no order."""
    ordered = isinstance(values, list | tuple | range) or (isinstance(values, np.ndarray) and values.ndim == 1)
    if not isinstance(name, str) or not ordered or not len(values):
        raise ValueError(f"cases: {name!r} = {shown(values)}: must be a name and a list of its values")
    return values


def _listed(cases):
    good = isinstance(cases, Iterable) and not isinstance(cases, str | bytes | np.ndarray)
    listed = list(cases) if good else [None]
    if not all(isinstance(each, Mapping) and each and all(isinstance(name, str) for name in each) for each in listed):
        raise ValueError(f"cases = {shown(cases)}: must be {VALID}")
    return listed


def _python(value):
    """A number of NumPy's as one of Python's."""
    return value.item() if isinstance(value, np.generic) else value
