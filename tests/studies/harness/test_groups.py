"""Which rows are looked at for those of others."""

import math
from types import SimpleNamespace

import pytest

from studies.harness import groups
from studies.harness.store import case_key


def group(**kinds):
    return tuple(kinds.items())


def test_what_a_row_stands_or_falls_with():
    case = {"name": "dem", "scene": "third", "particles": 10, "seed": 0, "method": "dem", "law": None, "periodic": True}
    assert groups.group_of(SimpleNamespace(), case) == group(name="dem", scene="third", method="dem", periodic=True)
    apart = SimpleNamespace(BY_ITSELF=("seed", "law"))
    assert groups.group_of(apart, case) == group(name="dem", scene="third", seed=0, method="dem", periodic=True)


@pytest.mark.parametrize(("contrast", "other"), [(10.0, False), (1e6, False), (0.0, True), (math.inf, True)])
def test_pores_and_perfect_conductors_are_no_contrasts_between(contrast, other):
    first, second = ({"order": 2, "contrast": each} for each in (100.0, contrast))
    assert (groups.group_of(None, first) != groups.group_of(None, second)) is other
    assert groups.group_of(None, first) == group(order=2)


def test_a_row_that_was_refused_tells_of_no_number():
    refused, right, dear = ({"method": "dem", "seed": seed} for seed in range(3))
    rows = {
        case_key(refused): {"status": "unsupported", "wall_s": "0.1"},
        case_key(right): {"status": "ok", "wall_s": "1.0"},
        case_key(dear): {"status": "ok", "wall_s": "9.0"},
    }
    assert groups.cheapest(SimpleNamespace(), rows, [refused, dear, right]) == {group(method="dem"): right}
    del rows[case_key(right)], rows[case_key(dear)]
    assert groups.cheapest(SimpleNamespace(), rows, [refused]) == {group(method="dem"): refused}


@pytest.mark.parametrize(
    "row, seconds",
    [
        ({"wall_s": "2.0", "made_s": "9"}, 2.0),
        ({"wall_s": "", "made_s": "9"}, 9.0),
        ({}, math.inf),
        ({"wall_s": "x"}, math.inf),
    ],
)
def test_seconds_of_a_row(row, seconds):
    assert groups.cost(row) == seconds


DEM, FEM = group(part="a", method="dem", law="laguerre"), group(part="a", method="fem")
LARGE, OTHER = group(part="b", method="dem", law="laguerre"), group(part="b", method="dem", law="platonic")


def test_a_dear_group_follows_those_of_its_study_that_the_same_code_makes():
    costs = {("one", DEM): 1.0, ("one", FEM): 1.0, ("two", DEM): 0.1, ("one", LARGE): 9.0}
    assert groups.followed(costs, dear=3.0) == {("one", LARGE): [("one", DEM)]}
    assert groups.followed(costs, dear=9.0) == groups.followed(costs, dear=math.inf) == {}


def test_a_dear_group_does_not_follow_one_that_stands_for_itself():
    one, other = (("method", "dem"), ("scene", "layers")), (("method", "dem"), ("scene", "spheres"))
    costs = {("one", one): 1.0, ("one", other): 9.0}
    assert groups.followed(costs, dear=3.0, apart={"one": ("scene",)}) == {}
    assert groups.followed(costs, dear=3.0) == {("one", other): [("one", one)]}


def test_one_without_such_in_its_study_follows_those_of_all_others():
    costs = {("one", DEM): 1.0, ("two", DEM): 0.1, ("three", LARGE): 9.0, ("three", FEM): 1.0}
    assert groups.followed(costs, dear=3.0) == {("three", LARGE): [("two", DEM), ("one", DEM)]}


def test_of_dear_ones_alone_the_cheapest_is_looked_at():
    costs = {("one", LARGE): math.inf, ("two", DEM): 5.0, ("two", OTHER): 4.0}
    assert groups.followed(costs, dear=3.0) == {("one", LARGE): [("two", DEM)]}
