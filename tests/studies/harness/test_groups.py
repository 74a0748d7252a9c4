"""Which rows are looked at for those of others."""

import math

import pytest

from studies.harness import groups


def group(**kinds):
    return tuple(kinds.items())


def test_what_a_row_stands_or_falls_with():
    case = {"name": "dem", "scene": "third", "particles": 10, "seed": 0, "method": "dem", "law": None, "packing": "lsa"}
    assert groups.group_of(case) == group(name="dem", method="dem", packing="lsa")


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


def test_one_without_such_in_its_study_follows_those_of_all_others():
    costs = {("one", DEM): 1.0, ("two", DEM): 0.1, ("three", LARGE): 9.0, ("three", FEM): 1.0}
    assert groups.followed(costs, dear=3.0) == {("three", LARGE): [("two", DEM), ("one", DEM)]}


def test_of_dear_ones_alone_the_cheapest_is_looked_at():
    costs = {("one", LARGE): math.inf, ("two", DEM): 5.0, ("two", OTHER): 4.0}
    assert groups.followed(costs, dear=3.0) == {("one", LARGE): [("two", DEM)]}
