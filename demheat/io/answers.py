"""Answers of any program to scenes of the benchmark, as a file of JSON; its keys stand in `benchmark/README.md`."""

import json
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from demheat.io.words import as_toml, nearest
from demheat.scene.inputs import reals

FORMAT = "conduction-answers/1"


class Given(NamedTuple):
    """One answer of a program: to one scene, at one resolution."""

    scene: str
    resolution: str = ""  # In words, as "64^3 voxels"
    conductivity: float = math.nan  # W/(m K), along the load
    lower: float = math.nan  # W/(m K): Between which values the program expects it
    upper: float = math.nan
    tensor: np.ndarray | None = None  # (3, 3) float array, W/(m K)
    temperatures: np.ndarray | None = None  # K: At the points of the scene's file, in its order
    cpu_s: float = math.nan
    wall_s: float = math.nan
    memory_mib: float = math.nan
    unknowns: float = math.nan
    refused: str = ""  # Why there is no answer
    remark: str = ""


class Answers(NamedTuple):
    """What a file holds."""

    path: Path
    program: str
    version: str
    method: str  # In words
    machine: str  # On which costs were measured: those of different ones cannot be compared
    answers: tuple[Given, ...]


NUMBERS = ("conductivity", "lower", "upper", "cpu_s", "wall_s", "memory_mib", "unknowns")
COSTS = NUMBERS[3:]
WORDS = ("scene", "resolution", "refused", "remark")
HEAD = ("program", "version", "method", "machine")
VALID = "must be an object with format, program and answers, as docs/benchmark.md has it"


def read_answers(path) -> Answers:
    """The answers of a file, or a ValueError that names what is wrong in it."""
    path = Path(path)
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError:
        raise ValueError(f"{path}: must be text in UTF-8") from None
    except (json.JSONDecodeError, RecursionError) as error:
        raise ValueError(f"{path}: is no JSON: {error}; {VALID}") from None
    if not isinstance(table, dict) or table.get("format") != FORMAT:
        found = (
            "no object" if not isinstance(table, dict) else as_toml(table["format"]) if "format" in table else "missing"
        )
        raise ValueError(f"{path}: format = {found}: must be {FORMAT!r}{_hint(table)}")
    _check_keys(path, "", table, ("format", "answers", *HEAD))
    head = {name: _word(path, "", name, table.get(name, "")) for name in HEAD}
    if not head["program"]:
        raise ValueError(f"{path}: program: missing; must be the program's name")
    given = table.get("answers")
    if not isinstance(given, list) or not given:
        raise ValueError(f"{path}: answers = {as_toml(given)}: must be a list of objects, one for each answer")
    answers = tuple(_given(path, f"answers[{n}]", each) for n, each in enumerate(given))
    _check_once(path, answers)
    return Answers(path, **head, answers=answers)


def _hint(table):
    """What else a file may be."""
    if isinstance(table, dict) and {"scene", "known"} <= {*table}:
        return "; this is a scene, and what is judged are answers to scenes"
    return "" if isinstance(table, dict) and "format" in table else f"; {VALID}"


def _check_once(path, answers):
    """Raise ValueError if a scene is answered twice at one resolution: which of them counts nobody could tell."""
    seen = {}
    for n, each in enumerate(answers):
        before = seen.setdefault((each.scene, each.resolution), n)
        if before != n:
            at = f" at resolution {each.resolution!r}" if each.resolution else ""
            raise ValueError(
                f"{path}: answers[{n}]: scene {each.scene!r}{at} is answered in answers[{before}] already; must be "
                "there once, or have a resolution of its own"
            )


def _given(path, place, table):
    if not isinstance(table, dict):
        raise ValueError(f"{path}: {place} = {as_toml(table)}: must be an object")
    _check_keys(path, place, table, Given._fields)
    values = {name: _word(path, place, name, table[name]) for name in WORDS if name in table}
    values |= {name: _number(path, place, name, table[name]) for name in NUMBERS if table.get(name) is not None}
    for name, shape in (("tensor", (3, 3)), ("temperatures", None)):
        if table.get(name) is not None:
            values[name] = _array(path, place, name, table[name], shape)
    if not values.get("scene"):
        raise ValueError(f"{path}: {place}.scene: missing; must be the name of a scene")
    if not {"conductivity", "temperatures", "refused"} & {*values}:
        raise ValueError(f"{path}: {place}: must have a conductivity, temperatures, or refused, the reason why not")
    low, high = values.get("lower", math.nan), values.get("upper", math.nan)
    if math.isnan(low) != math.isnan(high):
        there, lacks = ("upper", "lower") if math.isnan(low) else ("lower", "upper")
        raise ValueError(f"{path}: {place}: has {there} and no {lacks}; must have both, or neither")
    if low > high:
        raise ValueError(f"{path}: {place}: lower = {low:g}, upper = {high:g}: lower must not be above upper")
    return Given(**values)


def _check_keys(path, place, table, known):
    for name in table:
        if name not in known:
            near = nearest(name, known) or f"; must be one of {', '.join(known)}"
            raise ValueError(f"{path}: {place or 'the file'} has {name!r}, which is not known{near}")


def _word(path, place, name, value):
    if not isinstance(value, str):
        raise ValueError(f"{path}: {f'{place}.' if place else ''}{name} = {as_toml(value)}: must be text")
    return value


def _number(path, place, name, value):
    good = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    least = ", >= 0" if name in COSTS else ", W/(m K)"
    if not good or (name in COSTS and value < 0):
        quoted = ", without quotes" if isinstance(value, str) else ""
        raise ValueError(f"{path}: {place}.{name} = {as_toml(value)}: must be a finite number{least}{quoted}")
    return float(value)


def _array(path, place, name, value, shape):
    what = "three rows of three" if shape else "a list of"
    try:
        found = reals(name, value, "")
    except ValueError:
        found = np.full(1, math.nan)
    if not np.all(np.isfinite(found)) or (found.shape != shape if shape else found.ndim != 1):
        raise ValueError(f"{path}: {place}.{name} = {as_toml(value)}: must be {what} finite numbers")
    return found
