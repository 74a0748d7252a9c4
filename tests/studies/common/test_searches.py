"""Only here: searches that take a lucky value, stop too early or too late, or count costs wrongly."""

import itertools
import json
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from studies.common.searches import means
from studies.common.searches import search as search_module
from studies.common.searches.elements import longest
from studies.common.searches.in_time import IN_TIME, knobs_in_time
from studies.common.searches.scenes import FOR_LAWS, HELD_BACK, SCENES, TUNED, scene_of
from studies.common.searches.search import Point, cheapest, reached, reaching, search
from studies.common.searches.search import foreseen as foreseen_seconds
from studies.common.searches.trails import points_of
from studies.common.searches.ways import NEAR, STEP, WAYS, begun, between, growth, knobs_at, smooth, value_at
from studies.frontier import asked
from studies.frontier.cases import all_cases, foreseen

DEM = WAYS["dem"]


class Machine:
    """Runs whose error falls with N^(-2/3) and whose cost grows with N, no two runs of which cost the same."""

    def __init__(self, error=lambda n: 100 * n ** (-2 / 3), cost=lambda n: 1e-4 * n):
        self.error, self.cost, self.asked = error, cost, []

    def __call__(self, value, wanted):
        self.asked.append((value, wanted))
        scatter = 1 + 0.01 * (len(self.asked) % 3)
        one = (self.cost(value) * scatter, self.cost(value), 1.0)
        return Point(value, {"conductivity": self.error(value)}, {"conductivity": [one], "all": [one]}, value, True)


def only_conductivity(quantity, target):
    return quantity == "conductivity" and target >= 0.03


def test_the_cheapest_value_is_found_to_a_fifth_of_its_cost():
    machine = Machine()
    trail = search(DEM, machine, budget=1e3, judged=only_conductivity)
    values = [point.value for point in trail.points]
    assert values == sorted(values) and trail.ended == "done"
    for target in (3.0, 1.0, 0.3, 0.1):
        place = reached(trail.points, "conductivity", target)
        least = (100 / target) ** 1.5
        assert trail.points[place].error_of("conductivity") <= target
        # Neighbours are no farther apart in cost, and the coarser one misses; the first value may be good enough.
        assert place == 0 or values[place - 1] < least <= values[place] <= 1.01 * NEAR * least


def test_values_that_decide_are_run_three_times_in_turns():
    machine = Machine()
    trail = search(DEM, machine, budget=1e3, judged=only_conductivity)
    place = cheapest(trail.points, "conductivity", 0.3)
    point = trail.points[place]
    assert len(point.costs["conductivity"]) == 3 and point.spread("conductivity") == pytest.approx(0.02, abs=0.011)
    again = [value for value, wanted in machine.asked if wanted == ("conductivity",)]
    half = len(again) // 2
    assert again[:half] == again[half:] == sorted(again[:half])
    # The others once.
    assert min(len(each.costs["conductivity"]) for each in trail.points) == 1


def test_what_costs_least_is_run_again_though_a_coarser_value_reaches_the_target():
    """Here all coarse ones cost more than the fine ones that other targets are sought with."""
    machine = Machine(cost=lambda n: 10.0 if n < 6000 else 1e-4 * n)
    trail = search(DEM, machine, budget=1e4, judged=only_conductivity)
    first, best = (which(trail.points, "conductivity", 1.0) for which in (reached, cheapest))
    assert first < best and [len(trail.points[place].costs["conductivity"]) for place in (first, best)] == [1, 3]


def test_an_error_that_crosses_zero_wins_nothing_by_it():
    """At one value the error is nought by luck: those after it are not."""
    lucky = value_at(DEM, 4)
    machine = Machine(error=lambda n: 0.0 if n == lucky else 100 * n ** (-2 / 3))
    trail = search(DEM, machine, budget=1e3, judged=only_conductivity)
    for target in (0.3, 0.1):
        assert trail.points[reached(trail.points, "conductivity", target)].value > lucky


def points(errors, walked=None):
    walked = walked or [True] * len(errors)
    return [
        Point(n, {"flux": error}, {"flux": [(1.5**n, 1.0, 1.0)], "all": [(1.5**n, 1.0, 1.0)]}, n, each)
        for n, (error, each) in enumerate(zip(errors, walked, strict=True))
    ]


def test_all_that_is_finer_must_be_within_the_target_two_steps_of_the_walk_at_least():
    assert reached(points([3, 1, 0.5, 0.4]), "flux", 1.0) == 1
    assert reached(points([3, 1, 0.5]), "flux", 1.0) is None
    # A value between two steps is no step, and counts where it is not within.
    assert reached(points([3, 1, 0.5, 0.4], [True, True, False, True]), "flux", 1.0) is None
    assert reached(points([3, 1, 2, 0.4, 0.3, 0.3], [True, True, False, True, True, True]), "flux", 1.0) == 3
    # Many may be within by luck.
    assert reached(points([3, 1, 0.5, 0.4, 0.3, 7, 0.9, 0.5]), "flux", 1.0) is None
    assert reached(points([3, 1, 0.5, 0.4, 0.3, 7, 0.9, 0.5, 0.4]), "flux", 1.0) == 6
    assert reached(points([3, math.nan, 0.5, 0.4]), "flux", 1.0) is None
    assert reached(points([1, 1, 1, 1]), "temperature", 1.0) is None


def elements(size):
    """Unknowns of elements that no size above .1 makes longer, and whose number along an edge is whole."""
    return round(1 / min(size, 0.1)) ** 3


class Mesher(Machine):
    """Runs of elements, whose errors and costs go with their number."""

    def __init__(self):
        self.asked = []

    def __call__(self, size, wanted):
        self.asked.append((size, wanted))
        number = elements(size)
        one = (1e-3 * number, 1e-3 * number, 1.0)
        errors, costs = {"conductivity": 100 / number}, {"conductivity": [one], "all": [one]}
        return Point(size, errors, costs, number, walked=True)


def test_sizes_that_make_the_same_elements_are_one_step_and_cost_nothing():
    mesher = Mesher()
    trail = search(WAYS["fem"], mesher, budget=60.0, judged=only_conductivity)
    made = [point.unknowns for point in trail.points]
    assert len(set(made)) == len(made) >= 4 and elements(trail.points[0].value) == made[0] == 1000
    # Steps are taken four at once there.
    every = [size for size, wanted in mesher.asked if wanted == search_module.QUANTITIES]
    alike = sum(elements(size) == 1000 for size in every)
    assert alike <= 5 < sum(value_at(WAYS["fem"], number) >= 0.1 for number in range(20))
    runs = sum(len(point.costs["all"]) * point.cost("all") for point in trail.points)
    assert trail.spent == pytest.approx(runs)
    # No value is tried twice between the same neighbours.
    assert len(set(every)) == len(every)


def test_three_steps_may_take_all_of_a_budget():
    """Where the first costs much nothing is reached by half of it."""
    dear = Machine(error=lambda n: 0.01, cost=lambda n: 10.0 + 1e-4 * n)
    trail = search(DEM, dear, budget=35.0, judged=only_conductivity)
    assert len(trail.points) == 3 and reached(trail.points, "conductivity", 1.0) == 0
    assert len(search(DEM, dear, budget=28.0, judged=only_conductivity).points) == 2


def same(errors, unknowns):
    found = points(errors)
    for point, number in zip(found, unknowns, strict=True):
        point.unknowns = number
    return found


def test_one_mesh_run_three_times_is_no_two_finer_values():
    assert reached(same([0.5] * 3, [7, 7, 7]), "flux", 1.0) is None
    assert reached(same([0.5, 0.5, 0.4], [7, 7, 8]), "flux", 1.0) is None
    # Neither the unknowns alone nor the error alone.
    assert reached(same([0.5, 0.4, 0.3], [7, 7, 7]), "flux", 1.0) == 0
    assert reached(same([0.5, 0.5, 0.5], [7, 8, 9]), "flux", 1.0) == 0
    # The cheapest of those that are the same counts.
    assert [*reaching(same([0.5, 0.5, 0.4, 0.3], [7, 7, 8, 9]), "flux", 1.0)] == [0, 1]


def test_rows_that_took_one_mesh_for_several_are_judged_anew():
    """Three runs of one mesh, and then of another two."""
    trail = [[0.35, 7, 1, [0.5, 2.0, 3], None, None, None], [0.3, 7, 1, [0.5, 2.1, 1], None, None, None]]
    told = json.dumps({"1": [0.35, 2.0, 2.0, 1.0, 0.5, 0.1, 3]})

    def best(*more):
        row = {"scene": "third", "way": "fem", "seconds": 4.0, "conductivity": told}
        return means.best(pd.DataFrame([row | {"trail": json.dumps([*trail, *more])}]), "third", "conductivity", 1.0)

    assert best([0.2, 7, 1, [0.5, 2.0, 1], None, None, None]) is None
    finer = [[size, number, 1, [0.4, 3.0, 1], None, None, None] for size, number in ((0.1, 8), (0.05, 9))]
    assert best(*finer).first.value == 0.35


@pytest.mark.parametrize("name", ["third", "laminate", "image", "gyroid"])
def test_elements_begin_where_they_heed_what_is_asked(name):
    """Longer ones are the same, half as long ones are not."""
    from references.fem.bricks import bricks
    from references.mesh import make
    from references.mesh.lattice import cubes

    scene = scene_of(name)
    way, edge = begun(WAYS["fem"], scene), scene.volume ** (1 / 3)
    assert way.first == longest(scene) and 0.02 < way.first < WAYS["fem"].first
    made = {
        "image": lambda size: bricks(scene, size)[1].size,
        # So coarse it is refused.
        "gyroid": lambda size: cubes(np.array(scene.size), size).prod(),
    }.get(name, lambda size: len(make(scene, size=size, order=1).points))
    counts = [made(factor * way.first * edge) for factor in (2.0, 1.05, 0.5)]
    # On a sphere one node more or less.
    assert counts[0] == pytest.approx(counts[1], rel=3e-3) and counts[1] < 0.9 * counts[2]
    assert begun(WAYS["fem"]._replace(first=0.01), scene).first == 0.01


def test_what_a_target_would_take_is_read_off_the_fall_of_errors():
    """Halved with each step of 1.5: an eighth takes three steps more; what falls no more takes for ever."""
    seen = points([2.0**-n for n in range(8)])
    assert foreseen_seconds(seen, "flux", 2.0**-10) == pytest.approx(1.5**10, rel=1e-9)
    assert foreseen_seconds(points([1.0] * 8), "flux", 0.5) == math.inf
    # What crosses zero says nothing: the largest error from there on does.
    crossed = points([2.0**-n for n in range(7)] + [1e-9, 2.0**-8])
    assert 1.5**9 < foreseen_seconds(crossed, "flux", 2.0**-10) < 1.5**11


def test_a_search_ends_with_its_budget_or_where_nobody_would_wait():
    machine = Machine()
    trail = search(DEM, machine, budget=2.0, judged=only_conductivity)
    assert trail.ended == "budget" and trail.spent <= 2.0
    slow = search(DEM, Machine(cost=lambda n: 0.05 * n), budget=1e6, judged=only_conductivity)
    assert slow.ended == "budget" and max(point.cost() for point in slow.points) <= search_module.MOST_S


def test_a_search_goes_on_where_errors_rise_for_a_while():
    """As those of one sphere that fills half: six values tell nothing of the next."""

    def error(n):
        return 0.2 + 1e-5 * n if 500 < n < 12_000 else 100 * n ** (-2 / 3)

    trail = search(DEM, Machine(error=error), budget=1e3, judged=only_conductivity)
    place = reached(trail.points, "conductivity", 0.1)
    assert place is not None and trail.points[place].value > 12_000
    # And ends with half of its seconds, but for repeats, where they never fall again.
    stuck = search(DEM, Machine(error=lambda n: 0.2), budget=10.0, judged=only_conductivity)
    assert stuck.ended == "budget" and 2.5 < stuck.spent <= 10.0


def test_a_way_that_is_refused_has_no_points():
    def refused(value, wanted):
        raise ValueError("not this scene")

    trail = search(DEM, refused, budget=1.0, judged=only_conductivity)
    assert trail.points == [] and trail.ended == "not this scene"


@pytest.mark.parametrize("name", [name for name, way in WAYS.items() if way.knob not in ("order", "parts")])
def test_steps_cost_half_as_much_again(name):
    way = WAYS[name]
    values = [value_at(way, number) for number in range(10, 22)]
    grown = [growth(way, *pair) for pair in itertools.pairwise(values)]
    # Voxels that divide well do not come as they are wanted; what is nearly the same is left out.
    least = 1.0 if way.knob == "voxels" else 0.99 * STEP
    assert least <= min(grown) and max(grown) < STEP**2.2
    low, high = values[3:5]
    middle = between(way, *((low, high) if way.knob != "size" else (high, low)))
    assert middle is None or min(low, high) < middle < max(low, high)
    assert middle is not None or way.knob == "voxels"


def test_an_image_is_coarsened_first():
    way, image = WAYS["fft-image"], SimpleNamespace(volume=1.0, image=SimpleNamespace(shape=(32, 32, 2)))
    assert [value_at(way, number) for number in range(5)] == [0.25, 0.5, 1, 2, 3]
    assert [knobs_at(way, value, image)["voxels"] for value in (0.25, 1, 2)] == [(8, 8, 1), (32, 32, 2), (64, 64, 4)]


@pytest.mark.parametrize(("study", "least"), [("frontier", 200), ("fluxes", 100)])
def test_stored_rows_are_judged_as_their_trails_say(study, least):
    """Value, cost, error and number of runs at each target, or why there is none."""
    rows = pd.read_csv(Path(__file__).parents[3] / "results" / f"{study}.csv").dropna(subset=["trail"])
    assert len(rows) > least
    for row in rows.to_dict("records"):
        tried = points_of(row["trail"])
        for quantity in search_module.QUANTITIES:
            told = json.loads(row[quantity]) if isinstance(row.get(quantity), str) else {}
            for target, found in told.items():
                place = cheapest(tried, quantity, float(target))
                assert isinstance(found, list) is (place is not None), (row["scene"], row["way"], quantity, target)
                if place is not None:
                    value, seconds, _, _, error, _, runs = found
                    # Of two that cost the same to four digits the row knows more.
                    point = next(tried[k] for k in reaching(tried, quantity, float(target)) if tried[k].value == value)
                    assert point.cost(quantity) <= tried[place].cost(quantity) * (1 + 1e-3)
                    assert (error, runs) == (point.errors[quantity], len(point.costs[quantity]))
                    # Both are rounded to four digits.
                    assert seconds == pytest.approx(point.cost(quantity), rel=1e-3)


def test_voxels_divide_well():
    assert [smooth(n, 4) for n in (8, 22, 44, 90, 101)] == [8, 20, 40, 96, 96] or smooth(22, 4) in (20, 24)
    assert all(smooth(n, 2) % 2 == 0 for n in range(6, 90))
    box = SimpleNamespace(volume=4.0, size=(1.0, 1.0, 4.0))
    # As many voxels as in a cube of the same volume.
    assert math.prod(knobs_at(WAYS["fft"], 40, box)["voxels"]) == pytest.approx(40**3, rel=0.05)


def test_steps_through_time_err_by_a_part_of_what_elements_do():
    """Tied to the square of an edge, in edges of the box; a method by itself has its own steps."""
    cube = SimpleNamespace(volume=8.0)
    coarse, fine = (knobs_in_time(WAYS["dem-time"], n, cube)["accuracy"] for n in (1000, 8000))
    assert coarse == pytest.approx(3e-4) and coarse / fine == pytest.approx(4.0)
    halved = [knobs_in_time(WAYS["fem-time"], edge, cube) for edge in (0.2, 0.1)]
    assert halved[0]["size"] == pytest.approx(0.4) and halved[0]["accuracy"] == pytest.approx(4 * halved[1]["accuracy"])
    assert "accuracy" not in knobs_in_time(WAYS["dem-time-own"], 1000, cube)


def test_scenes_are_enough_and_none_is_named_twice():
    assert len(HELD_BACK) >= 10 and not set(HELD_BACK) & TUNED_NAMES
    cases = list(all_cases())
    assert {case["scene"] for case in cases} == {*SCENES, *FOR_LAWS, *IN_TIME}
    assert not set(SCENES) & set(FOR_LAWS)
    # The aim is an hour, and it is missed by half of one, on a machine half as fast by three quarters: searches spend
    # their seconds on any. To start a process, to find what is true and to draw scenes are part of these; how fast the
    # machine is, is found beside them.
    stored = Path(__file__).parents[3] / "results" / "frontier.csv"
    rows = pd.read_csv(stored, usecols=["made_s", "pace"])
    # Of a slower machine, seconds of that of the searches.
    took = (rows["made_s"] / rows["pace"].fillna(1.0)).sum()
    pacing = rows["pace"].notna().sum() * asked.TIMES * sum(seconds for *_, seconds in asked.PACED)
    assert took - pacing < min(6600, 60 * foreseen())


def test_what_a_machine_is_measured_by_are_costs_of_the_record():
    rows = pd.read_csv(Path(__file__).parents[3] / "results" / "frontier.csv", usecols=["scene", "way", "trail"])
    for scene, way, value, seconds in asked.PACED:
        trails = rows.loc[(rows["scene"] == scene) & (rows["way"] == way), "trail"].dropna().map(json.loads)
        tried = {point[0]: point[3][1] for trail in trails for point in trail if point[3]}
        # Values of sizes are told in more digits than these.
        assert tried[min(tried, key=lambda each: abs(each - value))] == seconds


TUNED_NAMES = set(TUNED)
