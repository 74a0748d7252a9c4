"""What a replay compares, and how near values must come."""

from types import ModuleType

import pytest

import studies.hard_cases as hard_cases
from demheat.runtime.machine import machine
from studies.harness.provenance import versions
from studies.harness.tolerance import Tolerance, moved, value_columns

CASE = {"name": "dem", "contrast": 10.0}
HERE = {"machine": machine(), "versions": versions()}
STORED = {"case": "name=dem,contrast=10.0", "name": "dem", "contrast": "10.0", "status": "ok"} | HERE


def study(**tolerances):
    found = ModuleType("study")
    found.TOLERANCES, found.COSTS = tolerances, ("ratio",)
    return found


def columns_moved(column, stored, found, here=None, **origin):
    row = {"status": "ok", column: found}
    return [each.column for each in moved("mine", here or study(), CASE, STORED | {column: stored} | origin, row)]


@pytest.mark.parametrize(
    ("column", "stored", "found", "differs"),
    [
        ("k_ratio", "1.3943256949", 1.3943256949 * (1 + 5e-9), False),
        ("k_ratio", "1.3943256949", 1.3943256949 * (1 + 5e-8), True),
        ("k_ratio", "1.3943256949", float("nan"), True),
        ("k_ratio", "", None, False),
        ("k_ratio", "1.0", None, True),
        ("k_ratio", "", 1.0, True),
        # A difference of two such values, in per cent.
        ("error_percent", "1e-05", 1.05e-5, False),
        ("error_percent", "1e-05", 1.3e-5, True),
        # Nought but for rounding.
        ("heat_imbalance", "3e-09", 5e-9, False),
        ("heat_imbalance", "3e-09", 5e-7, True),
        ("unknowns", "1337", 1337, False),
        ("unknowns", "1337", 1338, True),
        ("iterations", "59", 60, False),
        ("iterations", "59", 65, True),
        ("profile", "1.0 2.0 3.0", "1.0 2.0 3.001", True),
        ("profile", "1.0 2.0 3.0", "1.0 2.0", True),
        ("integrator", "euler", "rkl2", True),
        ("verdicts", '[["dem", "warned", -0.5912864124158446]]', '[["dem", "warned", -0.5912864124158449]]', False),
        ("verdicts", '[["dem", "warned", -0.5912864124158446]]', '[["dem", "wrong", -0.5912864124158446]]', True),
        ("k", "nan", "1.0", True),
        ("k", "nan", None, False),
        ("k", "", float("nan"), False),
        # Costs, and how the row was made.
        ("cpu_s", "1.0", 2.0, False),
        ("ratio", "1.0", 2.0, False),
        ("packing_cached", "True", False, False),
        ("fft_note", "one", "another", False),
    ],
)
def test_what_is_compared_and_how(column, stored, found, differs):
    assert columns_moved(column, stored, found) == ([column] if differs else [])


def test_a_study_declares_its_own():
    loose = study(**{"k_.*": Tolerance(1e-2, 0.0)})
    assert columns_moved("k_ratio", "1.0", 1.005, loose) == []
    assert columns_moved("k_ratio", "1.0", 1.05, loose) == ["k_ratio"]
    # The same form as one that all studies have.
    assert columns_moved("k", "1.0", 1.005, study(**{r".*": Tolerance(1e-2, 0.0)})) == []


def test_a_study_says_what_of_a_cell_counts():
    mine = study()
    mine.COMPARED_AS = {"verdicts": lambda cell: cell.partition(":")[0]}
    assert columns_moved("verdicts", "ok 1.0: one", "ok 1.0: another", mine) == []
    assert columns_moved("verdicts", "ok 1.0: one", "ok 1.1: one", mine) == ["verdicts"]


def test_verdicts_of_hard_cases_are_compared_without_their_words():
    cells = ['[["fft", "refused", NaN, NaN, "one"]]', '[["fft", "refused", NaN, NaN, "other"]]']
    worse = '[["fft", "wrong", 0.2, 0.1, "one"]]'
    assert columns_moved("verdicts", *cells, hard_cases) == []
    assert columns_moved("verdicts", cells[0], worse, hard_cases) == ["verdicts"]


@pytest.mark.parametrize(
    "method, origin, near, far",
    [
        ("dem", {"machine": "another"}, 5e-5, 5e-4),
        ("fem", {"machine": "another"}, 4e-3, 2e-2),
        ("fem", {}, 5e-9, 5e-8),
        ("dem", {"versions": "others"}, 4e-3, 2e-2),
        ("dem", {"machine": "", "versions": ""}, 4e-3, 2e-2),
        # Values that are not of the machine of the costs.
        ("dem", {"machine": "another", "values_commit": "1", "values_machine": machine()}, 5e-9, 5e-8),
        ("dem", {"values_commit": "1", "values_machine": "another"}, 5e-5, 5e-4),
        ("dem", {"values_commit": "1", "values_machine": ""}, 5e-5, 5e-4),
        ("dem", {"values_commit": "1"}, 5e-5, 5e-4),
        ("dem", {"values_commit": "", "values_machine": ""}, 5e-9, 5e-8),
    ],
)
def test_a_row_from_elsewhere_is_held_to_less(method, origin, near, far):
    for value, differs in ((1.0 + near, False), (1.0 + far, True)):
        row, stored = {"status": "ok", "k_ratio": value}, STORED | {"k_ratio": "1.0"} | origin
        assert bool(moved("mine", study(), CASE | {"method": method}, stored, row)) == differs


@pytest.mark.parametrize(
    ("origin", "stored", "found", "differs"),
    [
        ({"machine": "another"}, "192", 180, False),
        ({"versions": "others"}, "252", 243, False),
        ({"machine": "another"}, "192", 170, True),
        ({}, "192", 180, True),
    ],
)
@pytest.mark.parametrize("column", ["iterations", "fft_iterations"])
def test_iterations_elsewhere_may_end_a_tenth_earlier(column, origin, stored, found, differs):
    assert columns_moved(column, stored, found, **origin) == [column] * differs


@pytest.mark.parametrize(("found", "differs"), [(-0.01881069682599934, False), (-0.0172, True)])
def test_errors_of_what_iterates_elsewhere_may_be_a_thousandth_of_a_per_cent_off(found, differs):
    stored = "-0.01902206722299571"
    assert columns_moved("error_percent", stored, found, machine="another") == ["error_percent"] * differs
    assert columns_moved("error_percent", stored, found) == ["error_percent"]
    # In another unit that might be much.
    assert columns_moved("error", stored, found, machine="another") == ["error"]


@pytest.mark.parametrize(("upper", "differs"), [(1.0019, False), (1.0011, True)])
def test_an_interval_is_as_wide_as_it_was(upper, differs):
    """From another machine its ends may be anywhere in it."""
    stored = STORED | {"dual_lower": "1.0", "dual_upper": "1.002", "machine": "another"}
    row = {"status": "ok", "dual_lower": 1.0, "dual_upper": upper}
    wrong = [each.column for each in moved("mine", study(), CASE | {"method": "fem"}, stored, row)]
    assert wrong == ["dual_upper less dual_lower"] * differs


def test_a_status_that_changes_is_named_with_its_note():
    (wrong,) = moved("mine", study(), CASE, STORED, {"status": "failed", "note": "RuntimeError: no convergence"})
    assert (wrong.column, wrong.stored) == ("status", "ok") and "no convergence" in wrong.found


def test_what_is_red_says_all_that_a_reader_needs():
    (wrong,) = moved("mine", study(), CASE, STORED | {"k_ratio": "1.0"}, {"status": "ok", "k_ratio": 2.0})
    text = "mine name=dem,contrast=10.0: k_ratio stored '1.0', found '2.0', tolerance 1e-08 relative, 1e-12 absolute"
    assert str(wrong) == f"{text}; if it is meant: python -m studies accept mine"


def test_parameters_are_no_values():
    assert value_columns(study(), CASE, ["case", "name", "contrast", "k", "wall_s", "unknowns", "note"]) == [
        "k",
        "unknowns",
    ]
