"""What a row computes: the search of one way on one scene, or one value of its knob alone."""

import gc
import json
import math
import tempfile
import warnings
from dataclasses import replace

from demheat import budget, referee
from demheat.declared import load
from demheat.runtime.process_state import stopwatch
from studies.common.searches import in_time
from studies.common.searches.peer import found
from studies.common.searches.scenes import scene_of
from studies.common.searches.search import MOST_S, QUANTITIES, TARGETS, Point, cheapest, foreseen, search
from studies.common.searches.truth import truth_of
from studies.common.searches.ways import WAYS, begun, knobs_at
from studies.harness import methods
from studies.harness.cost import measured
from studies.harness.repeated import forget

# A target is judged where what is true is known so many times better.
KNOWN = 3.0
# What coarse elements do not resolve is what the errors show.
QUIET = ".*(do not fit into gaps|no particle lies|thin|narrow|miss them|smaller than a voxel|not wide|few across).*"
DIGITS = 4
# Of a search for conductivities; of one for fields at points, and of bodies that warm up.
MEANS, FIELDS, WARMING = ("conductivity", "extrapolated"), ("temperature", "flux"), ("temperature",)


def searched(name: str, way: str, seconds: float, quantities: tuple = MEANS) -> dict:
    """Row of a search for some quantities within so many processor seconds."""
    scene, truth = scene_of(name), truth_of(name)
    how = begun(WAYS[way], scene)
    quantities = WARMING if how.marches else quantities

    def judged(quantity, target):
        if quantity not in quantities:
            return False
        if how.marches:
            return True
        if quantity == "extrapolated" and not how.extrapolates:
            return False
        if quantity in ("temperature", "flux") and truth.field is None:
            return False
        return target >= 100 * KNOWN * truth.off

    # What is loaded is no garbage, which each run looks for before it begins.
    gc.collect()
    gc.freeze()

    def run(value, wanted):
        return _point(how, name, scene, truth, value, [each for each in wanted if each in quantities])

    trail = search(how, run, budget=seconds, judged=judged)
    if not trail.points:
        raise NotImplementedError(trail.ended)
    row = {"true_k": truth.conductivity, "true_off": truth.off, "true_by": truth.source}
    for quantity in quantities:
        for target in TARGETS:
            place = cheapest(trail.points, quantity, target) if judged(quantity, target) else None
            cost = math.nan if place is None else trail.points[place].cost(quantity)
            row[f"{quantity}_{target:g}_s"] = _digits(cost)
        row[quantity] = json.dumps(_found(trail.points, quantity, judged), separators=(",", ":"))
    row |= {"trail": _told(trail.points), "ended": trail.ended, "spent_s": trail.spent, "tried": len(trail.points)}
    return row


def at_point(name: str, way: str) -> dict:
    """Conductivity at the value of the knob that stands for the row, and what that is extrapolated to; no costs.

    Of a body that warms up the error of its temperature.
    """
    how, scene = WAYS[way], scene_of(name)
    row = {"point": how.point}
    if how.marches:
        return row | {"point_temperature": in_time.error_of(name, in_time.marched(how, name, how.point))}
    # Elements that are too coarse there: finer ones of the search need not be.
    with budget(MOST_S), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=QUIET)
        try:
            field = _solved(how, scene, how.point)
            row["point_k"] = field.conductivity
            if how.extrapolates and math.isfinite(limit := _limit(field)):
                row["point_limit_k"] = limit
        except NotImplementedError:
            raise
        except (ValueError, RuntimeError) as error:
            row["point_note"] = " ".join(str(error).split())
    return row


def fields_at_point(name: str, way: str) -> dict:
    """Errors of temperatures and fluxes at points, %, at the value of the knob that stands for the row; no costs."""
    how, truth = WAYS[way], truth_of(name)
    with budget(MOST_S), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=QUIET)
        field = _solved(how, scene_of(name), how.point)
        found = _at_points(field, truth, field.temperature_at(truth.points), field.flux_at(truth.points))
    return {"point": how.point, **{f"point_{quantity}": error for quantity, error in found.items()}}


def _solved(way, scene, value):
    """A field, or what a program of others found."""
    if way.peer:
        return found(way, scene, value)
    return load(way.method).solve(scene, **knobs_at(way, value, scene))


def _point(way, name, scene, truth, value, wanted):
    """Errors and costs at one value, a packing made on the spot, of a scene that nobody has asked anything yet."""
    scene = replace(scene)
    if way.peer:
        return _of_peer(found(way, scene, value), value, truth)
    forget()
    with (
        tempfile.TemporaryDirectory() as folder,
        methods.packings_in(folder),
        budget(MOST_S),
        warnings.catch_warnings(),
    ):
        warnings.filterwarnings("ignore", message=QUIET)
        if way.marches:
            (errors, costs, unknowns), whole = measured(_marched, way, name, value)
        else:
            (errors, costs, unknowns), whole = measured(_asked, way, scene, truth, value, wanted)
    costs = {name: [(*cost, whole["peak_mib"])] for name, cost in costs.items()}
    return Point(value, errors, costs, unknowns, walked=True)


def _of_peer(answer, value, truth):
    """The same of a program that counts its own cost."""
    cost = [tuple(answer.cost[name] for name in ("cpu_s", "wall_s", "peak_mib"))]
    error = 100 * abs(referee.value_error(answer.conductivity, truth.conductivity))
    return Point(
        value, {"conductivity": error}, {"conductivity": cost, "all": list(cost)}, answer.unknowns, walked=True
    )


def _asked(way, scene, truth, value, wanted):
    """A solve, and besides what is wanted of it: errors, and processor and wall seconds, each with the solve's."""
    spent = stopwatch()
    field = _solved(way, scene, value)
    costs = {"conductivity": _now(spent)}
    errors = {"conductivity": 100 * abs(referee.conductivity_error(field, truth.conductivity))}
    if way.extrapolates and "extrapolated" in wanted:
        before = _now(spent)
        errors["extrapolated"] = 100 * abs(referee.value_error(_limit(field), truth.conductivity))
        costs["extrapolated"] = _with(costs["conductivity"], before, spent)
    if truth.field is not None and {"temperature", "flux"} & set(wanted):
        before = _now(spent)
        warm, flux = field.temperature_at(truth.points), field.flux_at(truth.points)
        costs |= dict.fromkeys(("temperature", "flux"), _with(costs["conductivity"], before, spent))
        errors |= _at_points(field, truth, warm, flux)
    costs["all"] = _now(spent)
    return errors, costs, field.stats["unknowns"]


def _marched(way, name, value):
    """The same through time, where to look at temperatures is part of it."""
    spent = stopwatch()
    found = in_time.marched(way, name, value)
    cost = _now(spent)
    errors = {"temperature": in_time.error_of(name, found)}
    return errors, dict.fromkeys(("conductivity", "temperature", "all"), cost), found[-1][0].stats["unknowns"]


def _now(spent):
    found = spent()
    return found["cpu_s"], found["wall_s"]


def _with(solve, before, spent):
    """Seconds of the solve and of what came after a moment."""
    return tuple(each + now - then for each, now, then in zip(solve, _now(spent), before, strict=True))


def _limit(field):
    """What a field is extrapolated to, W/(m K); not-a-number where its method or scene refuses."""
    try:
        return field.extrapolated.conductivity
    except (NotImplementedError, RuntimeError):
        return math.nan


def _at_points(field, truth, warm, flux):
    """Root mean squares of temperature and flux at the points, % of the span and of the mean flux."""
    return {
        "temperature": referee.temperature_error(field, truth.field, truth.points, values=warm, unit="%").rms,
        "flux": referee.flux_error(field, truth.field, truth.points, values=flux, unit="%").rms,
    }


def _found(points, quantity, judged):
    """By target: value, processor and wall seconds, MiB, error, spread, runs; or in a word why not."""
    found = {}
    for target in TARGETS:
        if not judged(quantity, target):
            continue
        place = cheapest(points, quantity, target)
        if place is not None:
            point = points[place]
            runs = point.costs[quantity]
            wall, mib = sorted(each[1] for each in runs)[len(runs) // 2], max(each[2] for each in runs)
            told = (point.cost(quantity), wall, mib, point.errors[quantity], point.spread(quantity))
            found[f"{target:g}"] = [point.value, *map(_digits, told), len(runs)]
        else:
            ahead = foreseen(points, quantity, target)
            told = f"foreseen {ahead:.2g}" if ahead <= MOST_S else "not within"
            found[f"{target:g}"] = told if ahead > 0 else "not sought"
    return found


def _told(points):
    """All points: value, unknowns, whether walked, and by quantity error and cost."""
    rows = []
    for point in points:
        parts = [
            [_digits(point.errors[each]), _digits(point.cost(each)), len(point.costs[each])]
            if each in point.errors and each in point.costs
            else None
            for each in QUANTITIES
        ]
        rows.append([point.value, point.unknowns, int(point.walked), *parts])
    return json.dumps(rows, separators=(",", ":"))


def _digits(value):
    return None if value is None or value != value else float(f"{value:.{DIGITS}g}")


def warm_up(name: str, way: str) -> None:
    """Load and compile what a way needs, at a size that costs next to nothing; work out what is true."""
    how = WAYS[way]
    truth_of(name)
    if how.marches:
        in_time.marched(how, "slab", how.first)
    elif not how.peer:
        methods.warm_up(how.method, **how.knobs)
