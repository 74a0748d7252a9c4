"""Only here: ties taken for wins, finer values that cost less passed over, advice judged by another way's cost."""

import json

import pandas as pd
import pytest

from studies.frontier import advice, means


def row(scene, way, seconds, spread=0.01, finer=2.0):
    """One search that gets to .1 % of the conductivity; None: it does not. The next values cost so many times more."""
    told = {"0.1": [1.0, seconds, seconds, 1.0, 0.05, spread, 3] if seconds else "not within"}
    cost = seconds or float("nan")
    trail = [[n, 1, 1, [0.05, cost * finer ** (n > 1), 1], None, None, None] for n in (1.0, 2.0, 3.0, 4.0)]
    found = {"conductivity_0.1_s": cost, "conductivity": json.dumps(told), "trail": json.dumps(trail)}
    return {"scene": scene, "way": way, "seconds": 22.0, **found}


ROWS = pd.DataFrame(
    [
        row("third", "dem", 0.1),
        row("third", "fem", 0.5),
        row("third", "multipole", 0.02),
        row("half", "dem", 1.0, spread=0.2),
        row("half", "fft", 1.3, spread=0.2),
        row("half", "fem", 4.0),
        row("unions", "dem", None),
        row("unions", "fem", 0.9),
        row("gyroid", "dem", None),
    ]
)


def test_who_wins_in_numbers():
    said = means.counted(ROWS, "conductivity", 0.1)
    # 1.3 seconds are 1.3 times one, and runs scatter by a fifth each.
    assert said == (
        "To 0.1 % of the conductivity, of 4 scenes where it can be judged: the DEM on 1, 0 of them held back (the next "
        "costs 5 times as much); finite elements on 1, 1 of them held back, where no other gets there; the FFT on "
        "none; a tie on 1; on 1 none gets there."
    )
    assert means.judged(ROWS, "conductivity", 0.01) == []


def test_a_finer_value_that_costs_less_is_the_cheapest():
    """The first that gets there need not be: of the four values the second costs half, and two finer ones are there."""
    (found,) = means.reached(pd.DataFrame([row("third", "fft", 1.0, finer=0.5)]), "third", "conductivity", 0.1)
    assert (found.value, found.cpu_s, found.spread) == (2.0, 0.5, 0.01)


def test_a_run_that_was_not_repeated_does_not_win_by_little():
    """It costs a tenth less than what was run three times, as runs may by chance."""
    (found,) = means.reached(pd.DataFrame([row("third", "fft", 1.0, finer=0.9)]), "third", "conductivity", 0.1)
    assert (found.value, found.cpu_s) == (1.0, 1.0)


def test_multipoles_are_counted_where_they_get_there():
    assert "to 0.1 % on 1 of 1, where the next costs 5 times as much" in means.multipoles(ROWS)


def test_advice_is_judged_by_what_the_way_it_names_costs(monkeypatch):
    named = {"unions": ("dem", 0.3), "gyroid": ("dem", 1.0)}
    monkeypatch.setattr(advice, "_named", lambda scene, target: named[scene])
    # What gets to .1 % gets to 1, too.
    coarse, found = advice.advices(ROWS)
    assert (coarse.target, coarse.least) == (1.0, 0.9)
    assert (found.scene, found.method, found.best, found.least) == ("unions", "dem", "FEM, degree 2", 0.9)
    assert found.factor == float("inf")
    named["unions"] = ("fem", 0.3)
    *_, found = advice.advices(ROWS)
    assert found.factor == 1.0 and found.off == pytest.approx(3.0)
    assert "costs 1 times the least in the median" in advice.in_words(ROWS)


def test_closed_forms_are_in_no_search(monkeypatch):
    monkeypatch.setattr(advice, "_named", lambda scene, target: ("exact", 0.0))
    assert list(advice.advices(ROWS)) == []
