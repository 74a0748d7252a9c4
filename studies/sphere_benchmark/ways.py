"""How a method is asked for a scene of the benchmark: ours, a module of somebody else's, or a program.

A module has `solve(scene, **knobs)`, which gives what has a `conductivity` and, if it can, `temperature_at(points)` and
`flux_at(points)`; `evolve(scene, times, **knobs)`, which gives such things in turn; or `estimate(scene, **knobs)`, a
number. Its `KNOBS`, a list of dicts, are the keywords of one row each. A program is given the path of the scene's file
without what is known, and prints the conductivity as its last line; with exit status 77 it refuses, and its last line
on the standard error says why.
"""

import contextlib
import importlib
import json
import math
import os
import resource
import subprocess
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

import benchmark
from demheat.declared import load
from demheat.io.known import known_of, scene_of

REFUSED = 77
WARM = "laminate-across"
# Keywords that a `solve` of ours has and its `evolve` has not.
STEADY_ONLY = ("curved",)
VALID = (
    "a module that Python finds, with solve(scene) or estimate(scene), or the path of a program that may be executed"
)


class Answer(NamedTuple):
    """What a method says of a scene."""

    conductivity: float | None  # float or None, W/(m K)
    fields: tuple = ()  # With `temperature_at`; one in a steady state, one for each time else; empty for a number alone
    stats: dict = {}  # Of the row: unknowns, iterations, residual, and peak_mib where a program has it


Way = Callable[[dict], Answer]


def ours(method: str, knobs: dict) -> Way:
    """One of our methods."""
    return partial(_by_module, load(method), knobs)


def guest(method: str, step: int) -> Way:
    """A method that is not ours."""
    path = _program(method)
    return partial(_by_program, path) if path else partial(_by_module, _module(method), knobs_of(method)[step])


def knobs_of(method: str) -> list[dict]:
    """Keywords of each row of a method that is not ours; one empty dict if it has none."""
    return [{}] if _program(method) else list(getattr(_module(method), "KNOBS", [{}]))


def warm_up(method: str, step: int) -> None:
    """Have a module load and compile what it needs; a program pays for its start each time.

    Whatever goes wrong with that scene says nothing of the row's own, which tells of itself.
    """
    if not _program(method):
        with contextlib.suppress(Exception):
            guest(method, step)(benchmark.read(WARM))


def _program(method):
    """Path of a program, None if the method is not one."""
    if "/" not in method and os.sep not in method:
        return None
    path = Path(method).resolve()
    if not path.is_file() or not os.access(path, os.X_OK):
        raise ValueError(f"method = {method!r}: must be {VALID}")
    return path


def _module(method):
    try:
        module = importlib.import_module(method)
    except ModuleNotFoundError as error:
        # What the module itself misses is its own error.
        if error.name is None or not (method + ".").startswith(error.name + "."):
            raise
        module = None
    if not (hasattr(module, "solve") or hasattr(module, "estimate")):
        raise ValueError(f"method = {method!r}: must be {VALID}")
    return module


def _by_module(module, knobs, table):
    scene, known = scene_of(table), known_of(table)
    knobs = _scaled(knobs, scene)
    if known.times is not None:
        if not hasattr(module, "evolve"):
            raise NotImplementedError("no evolve(scene, times): steady states only")
        knobs = {name: value for name, value in knobs.items() if name not in STEADY_ONLY}
        return Answer(None, tuple(module.evolve(scene, sorted(set(known.times.tolist())), **knobs)))
    if not hasattr(module, "solve"):
        if known.conductivity is None:
            raise NotImplementedError("estimate(scene) knows the conductivity alone")
        return Answer(_checked(module.estimate(scene, **knobs)))
    field = module.solve(scene, **knobs)
    stats = getattr(field, "stats", {})
    shown = {name: stats.get(name) for name in ("unknowns", "iterations", "residual")}
    return Answer(None if known.conductivity is None else _checked(field.conductivity), (field,), shown)


def _scaled(knobs, scene):
    """Keywords of a `solve`: sizes in metres."""
    names = {"degree": "order"}
    return {names.get(k, k): v * max(scene.size) if k == "size" else v for k, v in knobs.items()}


def _by_program(path, table):
    if "conductivity" not in table["known"]:
        raise NotImplementedError("a program is asked for conductivities alone")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"{table['name']}.json")
        file.write_text(json.dumps({key: value for key, value in table.items() if key != "known"}), encoding="utf-8")
        done = subprocess.run([path, file], capture_output=True, text=True, cwd=folder)
    if done.returncode:
        told = (done.stderr.strip().splitlines() or ["without a word"])[-1]
        kind = NotImplementedError if done.returncode == REFUSED else RuntimeError
        raise kind(told if kind is NotImplementedError else f"{path.name}: exit status {done.returncode}: {told}")
    # Of the largest child: a row runs in a process of its own.
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    return Answer(_checked((done.stdout.strip().splitlines() or [""])[-1]), (), {"peak_mib": peak})


def _checked(value):
    try:
        number = float(np.asarray(value)) if not isinstance(value, str) else float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"conductivity = {value!r}: must be a finite number of W/(m K)")
    return number
