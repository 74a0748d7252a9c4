"""One way's cheapest values of its knob for each accuracy: walked up, halved between neighbours, and run again.

A value *reaches* a target if its error is within it, and so are those of all finer ones tried, two steps of the walk at
least: an error that crosses zero wins nothing by it. Values that make the same unknowns and the same error (elements
may be as small as curvature asks, whatever else is asked) are one step, however many were tried.
"""

import math
import statistics
from collections.abc import Callable
from dataclasses import dataclass, field

from studies.common.searches.ways import NEAR, Way, between, growth, value_at

TARGETS = (3.0, 1.0, 0.3, 0.1, 0.03, 0.01, 0.003)  # per cent
QUANTITIES = ("conductivity", "extrapolated", "temperature", "flux")
# Processor seconds and MiB beyond which nobody waits.
MOST_S, MOST_MIB = 120.0, 8192.0
# Steps of the walk beyond a value that must be there, at least, and be within the target as all that is finer must.
FINER = 2
# Runs at values that decide.
RUNS = 3
# Parts of a row's budget after which the walk, and halving, end; but of steps that a target cannot be reached without,
# which may take all of it.
WALK, HALVE = 0.5, 0.7
# Digits to which two errors are the same: those that rows keep.
DIGITS = 4
# Steps of which the slope of errors over costs is taken, and the least that is believed.
SLOPE, LEAST = 6, 0.15
# Halves between two neighbours at most; steps of the walk at most.
HALVES, LONGEST = 3, 60
# A step is worth walking if it is expected to cost so much more; and how many are taken at once where one cost so much.
GROWN, STRIDES = 1.2, ((1.2, 1), (1.1, 2), (0.0, 4))


@dataclass
class Point:
    """What was found at one value: errors, %, and costs, by quantity."""

    value: float
    errors: dict
    costs: dict  # of lists of (cpu_s, wall_s, MiB), a run each
    unknowns: int
    walked: bool

    def error_of(self, quantity):
        """Per cent; not-a-number if nobody asked."""
        return self.errors.get(quantity, math.nan)

    def same_as(self, other):
        """Whether it is another's over again, by all that was asked of both."""
        both = self.errors.keys() & other.errors.keys()
        return all(self.mark(quantity) == other.mark(quantity) for quantity in both)

    def mark(self, quantity):
        """What tells its solution from others, whatever the knob."""
        return self.unknowns, f"{self.error_of(quantity):.{DIGITS}g}"

    def cost(self, quantity="conductivity"):
        """Processor seconds, median of the runs."""
        return statistics.median(each[0] for each in self.costs[quantity])

    def spread(self, quantity):
        """Of these over their median; not-a-number of one run."""
        seconds = [each[0] for each in self.costs[quantity]]
        return (max(seconds) - min(seconds)) / statistics.median(seconds) if len(seconds) > 1 else math.nan


@dataclass
class Trail:
    """All that was tried of a way."""

    points: list = field(default_factory=list)
    spent: float = 0.0
    ended: str = ""

    def add(self, point):
        """Keep a point in the order of values that get finer."""
        self.points.append(point)
        self.spent += sum(each[0] for each in point.costs["all"])


def search(way: Way, run: Callable, *, budget: float, judged: Callable) -> Trail:
    """Try values of a way's knob; `run(value, quantities)` makes a Point, `judged(quantity, target)` what counts."""
    trail = Trail()
    _walk(way, run, trail, budget, judged)
    finest = way.knob == "size"
    trail.points.sort(key=lambda point: -point.value if finest else point.value)
    _halve(way, run, trail, budget, judged)
    _repeat(run, trail, budget, judged)
    return trail


def _walk(way, run, trail, budget, judged):
    number, last = 0, None
    while number < LONGEST:
        value = value_at(way, number)
        number += 1
        if last is not None and growth(way, last.value, value) < GROWN:
            continue
        ahead = _next_cost(trail)
        if ahead > MOST_S or trail.spent + ahead > budget * (WALK if len(trail.points) > FINER else 1.0):
            trail.ended = "budget"
            return
        try:
            point = run(value, QUANTITIES)
        except (MemoryError, TimeoutError, RuntimeError, ValueError) as error:
            if not trail.points and isinstance(error, (ValueError, RuntimeError)) and number < LONGEST // 4:
                # Too coarse for the scene.
                continue
            trail.ended = " ".join(str(error).split())[:120]
            return
        if last is not None:
            number += _stride(point.cost() / last.cost()) - 1
            if point.same_as(last):
                # Nothing new: neither a step nor a cost of the way.
                continue
        point.walked = True
        trail.add(point)
        last = point
        if max(each[2] for each in point.costs["all"]) > MOST_MIB / 2:
            trail.ended = "memory"
            return
        if not _sought(trail, judged):
            trail.ended = "done"
            return


def _stride(grown):
    """Steps to take at once, where one of them hardly costs more, as what is paid for each inclusion is most of it."""
    return next(stride for least, stride in STRIDES if grown >= least)


def _next_cost(trail):
    """What the next step is expected to cost with all that is asked of it."""
    walked = [sum(each[0] for each in point.costs["all"]) for point in trail.points]
    if len(walked) < 2:
        return 0.0
    return walked[-1] * min(max(walked[-1] / walked[-2], 1.1), 3.0)


def _sought(trail, judged):
    """Whether a target is not reached yet, though errors may have stopped to fall: that may be chance."""
    for quantity in QUANTITIES:
        for target in TARGETS:
            if not judged(quantity, target) or reached(trail.points, quantity, target) is not None:
                continue
            if math.isfinite(trail.points[-1].error_of(quantity)) or len(trail.points) <= 3:
                return True
    return False


def reached(points, quantity, target):
    """Place of the first point that is within a target with all finer ones, two steps of the walk at least, or None."""
    return next(reaching(points, quantity, target), None)


def reaching(points, quantity, target):
    """Places of all such points: a finer one may cost less."""
    missed = [place for place, point in enumerate(points) if not point.error_of(quantity) <= target]
    walked = _steps(points, quantity)
    if len(walked) > FINER:
        yield from range(missed[-1] + 1 if missed else 0, walked[-FINER])


def _steps(points, quantity):
    """Places of the steps of the walk; of those that are the same the first."""
    found: dict = {}
    for place, point in enumerate(points):
        if point.walked:
            found.setdefault(point.mark(quantity), place)
    return list(found.values())


def foreseen(points, quantity, target):
    """Processor seconds that a target should take, by how errors have fallen with what they cost; 0 if few tell."""
    seen = [
        (point.cost(quantity), point.errors[quantity]) for point in points if point.walked and _finite(point, quantity)
    ]
    if not seen:
        return math.inf if len(points) > 3 else 0.0
    if len(seen) < SLOPE:
        return 0.0
    # The largest error from each on: what crosses zero says nothing.
    worst = [max(error for _, error in seen[k:]) for k in range(len(seen))]
    if worst[-1] <= target:
        return seen[-1][0]
    one, other = len(seen) - SLOPE, len(seen) - 1
    grown, fallen = seen[other][0] / seen[one][0], worst[one] / worst[other]
    slope = math.log(max(fallen, 1.0)) / math.log(max(grown, 1.01))
    if slope < LEAST:
        return math.inf
    return seen[-1][0] * (worst[-1] / target) ** (1 / slope)


def _finite(point, quantity):
    return math.isfinite(point.error_of(quantity))


def cheapest(points, quantity, target):
    """Place of the point that reaches a target at least cost, or None."""
    return min(reaching(points, quantity, target), key=lambda place: points[place].cost(quantity), default=None)


def deciding(points, judged, among=reached):
    """Places of points that reach a target, the first ones or the cheapest, with the quantities that they do so of."""
    found = {}
    for quantity in QUANTITIES:
        for target in TARGETS:
            place = among(points, quantity, target) if judged(quantity, target) else None
            if place is not None:
                found.setdefault(place, []).append(quantity)
    return found


def _halve(way, run, trail, budget, judged):
    """Put values between neighbours of which one reaches a target and the other does not, cheap ones first."""
    tried = set()
    for _ in range(HALVES):
        for place in sorted(deciding(trail.points, judged), reverse=True):
            if place == 0:
                continue
            low, high = trail.points[place - 1], trail.points[place]
            value = between(way, low.value, high.value) if way.knob != "size" else between(way, high.value, low.value)
            near = high.cost() <= NEAR * low.cost()
            if near or value is None or value in tried or trail.spent + high.cost("all") > HALVE * budget:
                continue
            tried.add(value)
            try:
                point = run(value, QUANTITIES)
            except (MemoryError, TimeoutError, RuntimeError, ValueError):
                continue
            if point.same_as(low) or point.same_as(high):
                continue
            point.walked = False
            trail.add(point)
            trail.points.insert(place, trail.points.pop())


def _repeat(run, trail, budget, judged):
    """Run what decides again and again, one after the other: a cost by luck is found out, and another decides then."""
    while True:
        found = deciding(trail.points, judged, among=cheapest)
        few = [place for place in sorted(found) if _fewest(trail.points[place], found[place]) < RUNS]
        if not any([_once_more(run, trail, trail.points[place], found[place], budget) for place in few]):
            return


def _once_more(run, trail, point, quantities, budget):
    """Run a value again; whether there was budget for it."""
    if trail.spent + point.cost("all") > budget:
        return False
    again = run(point.value, tuple(dict.fromkeys(quantities)))
    trail.spent += sum(each[0] for each in again.costs["all"])
    for name, costs in again.costs.items():
        point.costs[name] += costs
    return True


def _fewest(point, quantities):
    """Runs of the quantity that was asked for least often."""
    return min(len(point.costs[each]) for each in quantities)
