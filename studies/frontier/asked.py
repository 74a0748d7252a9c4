"""`recommend` and `effective` asked for an accuracy: what was said, done and paid, and what other methods would have.

Not a search but the whole promise: the tensor with an interval as narrow as asked, whatever coarser runs that takes.
"""

from __future__ import annotations

import json
import math
import tempfile
import warnings
from functools import cache
from typing import NamedTuple

from demheat import effective, recommend, referee
from studies.frontier.scenes import HELD_BACK, scene_of
from studies.frontier.truth import truth_of
from studies.harness import methods
from studies.harness.repeated import forget

# The way that such rows have, and the per cents that are asked for.
WAY, ASKED = "effective", (1.0, 0.1, 0.01)
# Of which others are asked the same, within the wall time that was taken: who needs more costs more.
OTHERS = ("multipole", "fem", "fft", "dem")
# Bytes, of a usual machine: what is named must not change with the one that asks. Seconds after which nobody waits.
MEMORY, LONGEST_S = 8 * 2**30, 20.0
# Wall seconds that another is given at least.
LEAST_S = 0.05
DIGITS = 4


def row_of(name: str) -> dict:
    """Columns of a row, by accuracy: JSON of `Told`'s fields."""
    truth = truth_of(name)
    return {f"asked_{target:g}": json.dumps(_told(name, truth, target)) for target in ASKED}


def warm_up(name: str) -> None:
    """Load and compile all methods; work out what is true."""
    truth_of(name)
    for method in OTHERS:
        methods.warm_up(method)


def conductivity(name: str) -> float:
    """What no time decides: along the load, W/(m K), to the largest of the per cents."""
    return _along(name, effective(scene_of(name), accuracy=ASKED[0] / 100, memory=MEMORY))


class Told(NamedTuple):
    """Of one scene and accuracy; costs in processor seconds, errors in per cent."""

    scene: str
    target: float
    named: str  # By `recommend`
    guess: float
    method: str  # That `effective` ended with; empty where it did not get there, `why` then says it
    cpu_s: float
    half: float  # Of its interval
    error: float
    rounds: int
    why: str
    others: dict  # Processor seconds of others that get there in the same wall time, by method

    @property
    def off(self) -> float:
        """Factor, 1 or more, between what was said and what it took."""
        return max(self.guess / self.cpu_s, self.cpu_s / self.guess)

    @property
    def factor(self) -> float:
        """How many times as much it cost as the cheapest."""
        return self.cpu_s / min([self.cpu_s, *self.others.values()])


def _told(name, truth, target):
    scene, accuracy = scene_of(name), target / 100
    said = recommend(scene, accuracy, memory=MEMORY)
    told = {"named": said.method, "guess": _digits(said.cpu_s)}
    try:
        found = _asked(scene, accuracy, LONGEST_S)
    except (RuntimeError, TimeoutError) as error:
        return told | {"method": "", "why": " ".join(str(error).split())[:200]}
    k = _along(name, found)
    return told | {
        "method": found.method if not found.cut else "",
        "cpu_s": _digits(found.cost["cpu_s"]),
        "half": _digits(100 * _half(name, found) / k),
        "error": _digits(100 * abs(referee.value_error(k, truth.conductivity))),
        "rounds": found.cost["rounds"],
        "why": found.cut,
        "others": {} if found.cut else _others(scene, accuracy, found),
    }


def _others(scene, accuracy, found):
    """Processor seconds of those that get there, too, in the same wall time."""
    costs = {}
    for method in OTHERS:
        if method == found.method:
            continue
        try:
            other = _asked(scene, accuracy, max(found.cost["wall_s"], LEAST_S), method=method)
        except (RuntimeError, TimeoutError, MemoryError):
            continue
        if not other.cut:
            costs[method] = _digits(other.cost["cpu_s"])
    return costs


def _asked(scene, accuracy, seconds, **method):
    forget()
    with tempfile.TemporaryDirectory() as folder, methods.packings_in(folder), warnings.catch_warnings():
        # What coarse elements do not resolve, and where the time was over, is in the row.
        warnings.simplefilter("ignore", UserWarning)
        return effective(scene, accuracy=accuracy, memory=MEMORY, seconds=seconds, **method)


def _along(name, found):
    return float(found.tensor[_axis(name), _axis(name)])


def _half(name, found):
    return float(found.upper[_axis(name), _axis(name)] - found.lower[_axis(name), _axis(name)]) / 2


def _axis(name):
    scene = scene_of(name)
    return scene.gradient.index(max(scene.gradient, key=abs)) if scene.periodic else scene.axis


def _digits(value):
    return None if not math.isfinite(value) else float(f"{value:.{DIGITS}g}")


def all_told(df) -> list[Told]:
    """All that rows hold, in order."""
    if f"asked_{ASKED[0]:g}" not in df:
        return []
    rows = df[df["way"].eq(WAY) & df["scene"].isin(HELD_BACK) & df[f"asked_{ASKED[0]:g}"].notna()]
    return [
        _read(row["scene"], target, row[f"asked_{target:g}"]) for row in rows.to_dict("records") for target in ASKED
    ]


@cache
def _read(scene, target, text):
    blank = dict.fromkeys(("guess", "cpu_s", "half", "error"), math.nan) | {"rounds": 0, "why": "", "others": {}}
    known = {key: value for key, value in json.loads(text).items() if value is not None}
    return Told(scene, target, **blank | known)
