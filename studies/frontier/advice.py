"""What `recommend` names beforehand, beside what searches found: its laws are of other scenes than those held back."""

from __future__ import annotations

import math
import statistics
from functools import cache
from typing import NamedTuple

from demheat.cheapest import recommend
from demheat.cheapest.loads import loads_of
from demheat.cheapest.ways import BESIDES, FOR_LIMIT
from studies.frontier import means
from studies.frontier.scenes import scene_of
from studies.frontier.ways import WAYS

# Per cent of the conductivity.
ASKED = (1.0, 0.1, 0.01)
# Bytes, of a usual machine: what is named must not change with the one that asks.
MEMORY = 8 * 2**30


class Advice(NamedTuple):
    """Of one scene and accuracy: the method named, what it is guessed and was found to cost, and the cheapest, s."""

    scene: str
    target: float
    method: str
    guessed: float
    found: float
    best: str
    least: float

    @property
    def factor(self):
        """How many times as much as the cheapest it costs; infinite if it was not found to get there."""
        return self.found / self.least

    @property
    def off(self):
        """Factor, 1 or more, between what was guessed and what was found."""
        return max(self.guessed / self.found, self.found / self.guessed)


def advices(df):
    """All that can be judged: where any way was found to get there."""
    for scene in means.scenes_of(df, held_back=True):
        for target in ASKED:
            ways = means.reached(df, scene, "conductivity", target, any_shape=False)
            # Closed forms are in no search.
            if ways and _named(scene, target)[0] != "exact":
                yield _advice(scene, target, ways)


def _advice(scene, target, ways):
    method, guessed = _named(scene, target)
    own = [each.cpu_s for each in ways if each.family == method and WAYS[each.way].own]
    found = min(own, default=math.inf)
    return Advice(scene, target, method, guessed, found, ways[0].title, ways[0].cpu_s)


@cache
def _named(scene, target):
    """Method that is named, and seconds that one solve of it is guessed to take."""
    found = recommend(scene_of(scene), target / 100, memory=MEMORY)
    # Of one load, without the coarser runs of an interval; which were counted goes by the method.
    loads = loads_of(scene_of(scene))
    counted = len(loads.parts) * (FOR_LIMIT if found.method in ("fem", "fft") else BESIDES)
    return found.method, found.cpu_s / (len(loads.wholes) if found.method == "multipole" else counted)


def in_words(df):
    """What it is worth, in numbers."""
    found = list(advices(df))
    there = [each for each in found if each.found < math.inf]
    factors = sorted(each.factor for each in there)
    within = statistics.median(each.off for each in there)
    lost = len(found) - len(there)
    return (
        f"of {len(found)} pairs of scene and accuracy what it names costs {statistics.median(factors):.2g} times the "
        f"least in the median and {factors[-1]:.2g} times at most, and its guess of that cost is {within:.2g} times "
        f"off in the median; on {lost} what it names was not found to get there."
    )
