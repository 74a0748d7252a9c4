"""Only here: ties taken for wins, finer values that cost less passed over, advice judged by another way's cost."""

import json

import pandas as pd
import pytest

from studies.common.searches import means, tables
from studies.frontier import advice, second


def row(scene, way, seconds, spread=0.01):
    """One search that gets to .1 % of the conductivity; None: it does not."""
    told = {"0.1": [1.0, seconds, seconds, 1.0, 0.05, spread, 3] if seconds else "not within"}
    cost = seconds or float("nan")
    found = {"conductivity_0.1_s": cost, "conductivity": json.dumps(told), "trail": "[]"}
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
    (line,) = tables.winners(ROWS, "conductivity", (0.1,)).to_dict("records")
    won = {"DEM": "1 (1, 0): 5 times", "finite elements": "1 (1, 1): alone", "FFT": "0", "tie": 1, "none": 1}
    assert line == {"to": "0.1 % of the conductivity", "scenes": 4} | won
    more = pd.DataFrame([*ROWS.to_dict("records"), row("ellipsoids", "dem", 0.4)])
    assert tables.winners(more, "conductivity", (0.1,))["DEM"].item() == "2 (2, 1): 5 times, alone on 1"


def test_what_gets_farther_at_less_cost_is_the_cheapest():
    """A search may find the finer target with less: 3 % then costs what .1 % does, with that run's scatter."""
    found = row("third", "fft", 1.0)
    found["conductivity"] = json.dumps(
        {"3": [1.0, 1.0, 1.0, 1.0, 2.0, 0.3, 3], "0.1": [2.0, 0.5, 0.5, 1.0, 0.05, 0.01, 3]}
    )
    (best,) = means.reached(pd.DataFrame([found]), "third", "conductivity", 3.0)
    assert (best.value, best.cpu_s, best.spread) == (2.0, 0.5, 0.01)


def test_multipoles_are_counted_where_they_get_there():
    assert "to 0.1 % on 1 of 1 (the next costs 5 times as much)" in means.multipoles(ROWS)
    # A tie is no win, and where no other gets there is told.
    more = [row("half", "multipole", 1.1, spread=0.2), row("unions", "multipole", 1.8), row("gyroid", "multipole", 1.0)]
    said = means.multipoles(pd.DataFrame([*ROWS.to_dict("records"), *more]))
    costs = "the next costs 5 times as much; on 1 no other gets there; a tie on 1; 2 times the cheapest on 1"
    assert f"0.1 % on 2 of 4 ({costs})" in said


def test_peers_that_tie_are_said_to():
    theirs = [row("third", "ngsolve", 0.11), row("half", "ngsolve", 0.5), row("unions", "ngsolve", 9.0)]
    said = means.beside_peers(pd.DataFrame([*ROWS.to_dict("records"), *theirs]))
    assert "to 0.1 % of third in 0.11 s (DEM in 0.1, a tie);" in said and "of half in 0.5 s (DEM in 1)" in said
    assert "unions" not in said


def test_what_ran_once_scatters_as_much_as_most():
    """A quarter dearer is a tie with what ran once, and none with what ran thrice."""
    for spread, tie in ((None, True), (0.02, False)):
        rows = pd.DataFrame([row("third", "dem", 1.0, spread=spread), row("third", "fft", 1.25)])
        assert (len(means.best(rows, "third", "conductivity", 0.1).tied) == 2) is tie


def test_scenes_of_one_body_are_told():
    again = [row("third at 0.01", "dem", 0.1), row("third at 0.01", "fft", 9.0)]
    said = means.counted(pd.DataFrame([*ROWS.to_dict("records"), *again]), "conductivity", 0.1)
    assert "the DEM on 2 (1 body), 0 of them held back (the next costs 5 to 90 times as much)" in said
    assert "finite elements on 1, 1 of them held back" in said


def told(target, **given):
    """What `effective` did to one accuracy."""
    usual = {"named": "dem", "guess_s": 1.0, "method": "dem", "took_s": 2.0, "half": 0.5, "error": 0.1, "rounds": 1}
    usual |= {"why": float("nan"), "other": float("nan"), "other_s": float("nan")} | given
    return {f"asked_{target}_{key}": value for key, value in usual.items()}


ASKED = {
    **{"scene": "unions", "way": "effective", "status": "ok"},
    **told("1", guess_s=8.0, other="fft", other_s=0.5),
    **told("0.1", named="exact", method="exact", guess_s=0.0, took_s=0.01),
    **told("0.01", method="", took_s=30.0, half=0.02, error=0.04, why="seconds = 20 are over"),
}


def test_advice_is_judged_by_what_effective_did():
    rows = pd.DataFrame([*ROWS.to_dict("records"), ASKED])
    claims = dict((text, value) for text, value, _ in advice.claims(rows))
    # Eight were said and two taken; another takes half a second; of three intervals one does not hold. Elements alone
    # were found to get there on that scene.
    assert list(claims.values()) == [4.0, 4.0, 4.0, None, pytest.approx(2 / 3)]
    named = ASKED | told("1", named="fem") | {"scene": "ellipsoids"}
    searches = [row("ellipsoids", "dem", 1.0), row("ellipsoids", "fem", 4.0)]
    df = pd.DataFrame([*searches, named])
    (single,) = (value for text, value, _ in advice.claims(df) if "one solve" in text)
    assert single == 4.0
    said = advice.advised(rows)
    assert said.startswith("Of 3 pairs of scene and accuracy 1 have a closed form; `effective` got there on 1 of the")
    assert "a factor of 3 on 0, 4 in the median" in said and said.endswith("on 1 time was over.")
    # Rows of `effective` are no search.
    assert set(means.longest(rows)["way"]) <= set(means.WAYS)


SLOWER = pd.DataFrame(
    [
        row("third", "dem", 0.3),
        row("third", "fem", 0.9),
        # A tie here, on this machine the FFT alone; the DEM gets there on none but one.
        row("half", "dem", 4.0),
        row("half", "fft", 2.0),
        row("unions", "dem", 1.0),
        row("unions", "fem", 2.7),
        row("gyroid", "dem", 1.0),
        row("third", "multipole", 0.1),
        row("half", "fem", 9.0),
    ]
)


def test_who_wins_on_a_second_machine():
    ways = second.reached(ROWS, SLOWER)
    pairs = second.compared(ways)
    assert [scene for scene, _ in pairs] == ["third", "half", "unions"]
    # What ties on one of the machines is no other winner.
    assert list(second.others(pairs)) == [("unions", 0.1)]
    assert second.factors(ways) == pytest.approx({"dem": 3.5, "fem": 2.25, "fft": 2 / 1.3})
    assert [second.alone(pairs, number, "fft", 0.1) for number in (0, 1)] == [0, 1]
    # A scene of which a way is missing there is left out.
    assert second.whole(second.searches(ROWS), SLOWER.iloc[1:]) == {"half", "unions", "gyroid"}
    # Of multipoles, which know no other shapes than spheres, nothing is asked.
    others = SLOWER[SLOWER["way"] != "multipole"]
    assert second.whole(second.searches(ROWS), others) == {"third", "half", "unions", "gyroid"}


def test_searches_of_other_seconds_are_compared_and_counted():
    longer = SLOWER.assign(seconds=[55.0, *SLOWER["seconds"][1:]])
    assert second.compared(second.reached(ROWS, longer)).keys() == second.compared(second.reached(ROWS, SLOWER)).keys()
    assert second._seconds(ROWS, SLOWER) == "the same seconds"
    both = len(second.searches(ROWS).keys() & second.searches(SLOWER).keys())
    assert second._seconds(ROWS, longer) == f"the same seconds but for 1 of {both}"


def test_ways_that_were_one_methods_alone(monkeypatch):
    """What the record does not have on a scene counts in the second column alone, and must be there for all."""
    more = [{"scene": scene, "way": "dem-loose", "seconds": 22.0} for scene in ("third", "half")]
    monkeypatch.setattr(second, "second_cases", lambda: more)
    loose = pd.DataFrame([*SLOWER.to_dict("records"), row("half", "dem-loose", 1.9)])
    pairs = second.compared(second.fairer(ROWS, loose))
    assert {scene for scene, _ in pairs} == {"half", "unions", "gyroid"}
    # The FFT alone before, in two seconds; a tie with them.
    assert [second.families(each) for each in pairs["half", 0.1]] == [{"fft"}, {"dem", "fft"}]
    assert second.others(pairs) == {}
    assert second.families(second.compared(second.reached(ROWS, loose))["half", 0.1][1]) == {"fft"}


def test_rows_that_others_disturbed_are_not_kept(tmp_path):
    path = tmp_path / "second.csv"
    rows = [row("third", "dem", 0.1) | {"noise": noise, "commit": "abc"} for noise in (0.01, 0.5)]
    pd.DataFrame([*rows, row("third", "fem", None) | {"noise": 0.0, "trail": ""}]).to_csv(tmp_path / "frontier.csv")
    assert second.keep(tmp_path, path) == 1
    assert list(second.there(path)["noise"]) == [0.01]
    # Of other scenes what there is stays, of these it does not.
    rows = [row(scene, "dem", 0.1) | {"noise": 0.02, "commit": "abc"} for scene in ("half", "gyroid")]
    for there, noise in ((rows, [0.01, 0.02, 0.02]), (rows[:1], [0.01, 0.02, 0.02])):
        pd.DataFrame(there).to_csv(tmp_path / "frontier.csv")
        assert second.keep(tmp_path, path) == len(noise)
        assert list(second.there(path)["noise"]) == noise
