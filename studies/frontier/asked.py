"""`recommend` and `effective` asked for an accuracy: what was said, done and paid, and what other methods would have.

Not a search but the whole promise: the tensor with an interval as narrow as asked, whatever coarser runs that takes.
Laws tell seconds of the machine that searches were made on; on another the same seconds are found by how long some of
their solves take there (`pace`).
"""

import math
import statistics
import tempfile
import warnings
from contextlib import contextmanager
from dataclasses import replace
from typing import NamedTuple

from demheat import effective, recommend, referee
from demheat.declared import load
from demheat.runtime.process_state import cpu_seconds
from studies.common.searches.scenes import HELD_BACK, scene_of
from studies.common.searches.truth import truth_of
from studies.common.searches.ways import ASKED, ASKED_S, WAYS, knobs_at
from studies.harness import methods
from studies.harness.repeated import forget

# Per cents that are asked for.
TARGETS = (1.0, 0.1, 0.01)
# Of which others are asked the same, within the wall time that was taken: who needs more costs more.
OTHERS = ("multipole", "fem", "fft", "dem")
# Bytes, of a usual machine: what is named must not change with the one that asks.
MEMORY = 8 * 2**30
# Scene, way and value of solves, and the processor seconds that they took on the machine of the searches, as their rows
# have them; each is made so many times.
PACED = (
    ("83 spheres", "dem", 9649, 0.3155),
    ("half", "fem", 0.10940012117716702, 0.5742),
    ("83 spheres", "fft-loose", 48, 0.08667),
    ("83 spheres", "multipole-loose", 6, 0.1411),
)
TIMES = 5
# Wall seconds that another is given at least.
LEAST_S = 0.05
DIGITS = 4
WORDS = ("named", "method", "why", "other")


def row_of(name: str) -> dict:
    """Columns of a row, `Told`'s fields by accuracy."""
    truth, slower = truth_of(name), pace()
    every = {target: _told(name, truth, target, slower) for target in TARGETS}
    row = {column(target, key): value for target, told in every.items() for key, value in told.items()}
    return {"pace": _digits(slower)} | row


def pace() -> float:
    """How many times as long solves take as on the machine of the searches: the geometric mean over all methods."""
    return statistics.geometric_mean(_median(*each) / seconds for *each, seconds in PACED)


def _median(name, way, value):
    """Processor seconds that a solve takes, packing and meshing with it: the median of some runs."""
    found, how = [], WAYS[way]
    for _ in range(TIMES):
        scene = replace(scene_of(name))
        with _anew():
            begun = cpu_seconds()
            load(how.method).solve(scene, **knobs_at(how, value, scene))
            found.append(cpu_seconds() - begun)
    return statistics.median(found)


def column(target: float, field: str) -> str:
    """Name of a column."""
    return f"asked_{target:g}_{field}"


def warm_up(name: str) -> None:
    """Load and compile all methods; work out what is true."""
    truth_of(name)
    for method in OTHERS:
        methods.warm_up(method)


def conductivity(name: str) -> float:
    """What no time decides: along the load, W/(m K), to the largest of the per cents."""
    return _along(name, effective(scene_of(name), accuracy=TARGETS[0] / 100, memory=MEMORY))


class Told(NamedTuple):
    """Of one scene and accuracy; costs in processor seconds of the machine of the searches, errors in per cent."""

    scene: str
    target: float
    named: str  # By `recommend`
    guess_s: float
    method: str  # That `effective` ended with; empty where it did not get there, `why` then says it
    took_s: float
    half: float  # Of its interval
    error: float
    rounds: int
    why: str
    other: str  # That gets there at least cost of others, if any does in the same wall time
    other_s: float

    @property
    def off(self) -> float:
        """Factor, 1 or more, between what was said and what it took."""
        return max(self.guess_s / self.took_s, self.took_s / self.guess_s)

    @property
    def factor(self) -> float:
        """How many times as much it cost as the cheapest."""
        return self.took_s / min(self.took_s, self.other_s) if self.other else 1.0


def _told(name, truth, target, slower):
    scene, accuracy = scene_of(name), target / 100
    said = recommend(scene, accuracy, memory=MEMORY)
    told = {"named": said.method, "guess_s": _digits(said.cpu_s)}
    try:
        found = _asked(scene, accuracy, ASKED_S * slower)
    except (RuntimeError, TimeoutError) as error:
        return told | {"method": "", "why": " ".join(str(error).split())[:200]}
    k = _along(name, found)
    other, other_s = ("", math.nan) if found.cut else _cheapest_other(scene, accuracy, found)
    return told | {
        "method": found.method if not found.cut else "",
        "took_s": _digits(found.cost["cpu_s"] / slower),
        "half": _digits(100 * _half(name, found) / k),
        "error": _digits(100 * abs(referee.value_error(k, truth.conductivity))),
        "rounds": found.cost["rounds"],
        "why": found.cut,
        "other": other,
        "other_s": _digits(other_s / slower),
    }


def _cheapest_other(scene, accuracy, found):
    """The cheapest of those that get there, too, in the same wall time, and its processor seconds."""
    costs = {"": math.inf}
    for method in OTHERS:
        if method == found.method:
            continue
        try:
            other = _asked(scene, accuracy, max(found.cost["wall_s"], LEAST_S), method=method)
        except (RuntimeError, TimeoutError, MemoryError):
            continue
        if not other.cut:
            costs[method] = other.cost["cpu_s"]
    best = min(costs, key=costs.get)
    return best, costs[best]


def _asked(scene, accuracy, seconds, **method):
    with _anew():
        return effective(scene, accuracy=accuracy, memory=MEMORY, seconds=seconds, **method)


@contextmanager
def _anew():
    """Nothing is kept from before; what coarse elements do not resolve, and where the time was over, is in the row."""
    forget()
    with tempfile.TemporaryDirectory() as folder, methods.packings_in(folder), warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        yield


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
    if column(TARGETS[0], "named") not in df:
        return []
    rows = df[df["way"].eq(ASKED) & df["scene"].isin(HELD_BACK) & df["status"].eq("ok")]
    return [_read(row, target) for row in rows.to_dict("records") for target in TARGETS]


def _read(row, target):
    known = {key: row.get(column(target, key)) for key in Told._fields[2:]}
    # Of a word there may be none.
    words = {key: "" if value != value else value for key, value in known.items() if key in WORDS}
    return Told(row["scene"], target, **known | words)
