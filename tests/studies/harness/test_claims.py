"""Claims: judged by their limits, but not on costs that do not count nor on rows that are missing."""

import math
from types import ModuleType

import pandas as pd
import pytest

from studies.harness import claims, runner
from studies.harness.store import case_key
from studies.harness.table import judged, render

CASES = [{"name": name, "size": size} for name in ("ours", "theirs") for size in (1, 2, 3)]


@pytest.fixture
def study(monkeypatch):
    made = ModuleType("made")
    made.CASES, made.QUICK, made.__file__ = CASES, (lambda case: case["size"] == 1), __file__

    def claims(df):
        ours, theirs = (df[df["name"] == name] for name in ("ours", "theirs"))
        yield "ours: worst error", ours["error_percent"].max(), 1.0
        yield "dearest of ours, s", ours["cpu_s"].max(), 10.0
        yield "least time of theirs over ours", theirs["cpu_s"].min() / ours["cpu_s"].min(), ">= 1"
        yield "theirs are cheaper, cases", (theirs["cpu_s"] < ours["cpu_s"].min()).sum(), 3
        yield "theirs: memory, MiB", theirs["peak_mib"].max(), 100.0
        yield "theirs: worst error", theirs["error_percent"].max(), 0.1

    made.claims = claims
    return made


def frame(**changed):
    """Good rows of all cases; columns change where they are given, by the number of the row."""
    good = {"status": "ok", "commit": "abc", "noise": 0.01, "error_percent": 0.5, "peak_mib": 50.0}
    df = pd.DataFrame([{"case": case_key(case), **case, **good, "cpu_s": 2.0 + case["size"]} for case in CASES])
    for column, (number, value) in changed.items():
        df.loc[number, column] = value
    return df


def verdicts(study, df):
    """By sentence; a check holds, too."""
    return {each.sentence: each.verdict.replace(claims.CHECK, "ok") for each in judged(study, df)}


def test_good_rows_are_judged(study):
    found = verdicts(study, frame())
    assert found.pop("theirs: worst error") == "FAIL"
    assert set(found.values()) == {"ok"} and len(found) == 6


@pytest.mark.parametrize("wrong", [{"noise": 0.5}, {"noise": math.nan}, {"commit": "abc+"}])
def test_costs_that_do_not_count_are_not_judged(study, wrong):
    """Of one row of theirs: whatever rests on ours alone, and all errors, is judged as before."""
    ((column, value),) = wrong.items()
    found = verdicts(study, frame(**{column: (3, value)}))
    unjudged = {sentence for sentence, verdict in found.items() if verdict == "not judged"}
    assert unjudged == {"least time of theirs over ours", "theirs are cheaper, cases", "theirs: memory, MiB"}
    assert found["theirs: worst error"] == "FAIL" and found["dearest of ours, s"] == "ok"


@pytest.mark.parametrize("number", [0, 1, 2])
def test_any_row_may_be_the_dearest_or_the_cheapest(study, number):
    """One that is neither as it stands could be either, had it been measured well."""

    def of_all(df):
        yield "dearest", df["cpu_s"].max(), 10.0
        yield "cheapest", df["cpu_s"].min(), ">= 1"

    study.claims = of_all
    found = verdicts(study, frame(noise=(number, 0.5)))
    assert found["dearest"] == found["cheapest"] == "not judged"


def test_a_ratio_of_two_costs_that_do_not_count(study):
    """Both would change by the same factor if it were one for all."""
    df = frame().assign(commit="abc+")
    assert verdicts(study, df)["least time of theirs over ours"] == "not judged"


def test_what_is_not_judged_neither_holds_nor_fails(study):
    cheap = next(each for each in judged(study, frame(noise=(0, 0.9))) if each.sentence == "dearest of ours, s")
    assert not cheap.ok and not cheap.failed and cheap.why == claims.COSTLY and cheap.value == 5.0


def test_a_run_that_has_not_ended_fails_nothing_for_want_of_rows(study):
    df = frame().iloc[:2]
    found = {each.sentence: each for each in judged(study, df)}
    assert found["theirs: memory, MiB"].why == claims.UNFINISHED and found["ours: worst error"].ok
    assert not any(each.failed for each in found.values())
    # Of a run that has ended nothing is excused, a quick one neither.
    quick = frame(error_percent=(0, math.nan)).iloc[[0, 3]]
    assert not claims.unfinished(study, quick) and not claims.unfinished(study, frame())
    assert [each.sentence for each in judged(study, quick) if each.failed][0] == "ours: worst error"


def test_claims_before_one_that_cannot_be_judged_stand(study, capsys):
    def broken(df):
        yield "first", 1.0, 2.0
        raise KeyError("no such column")

    study.claims = broken
    found = judged(study, frame())
    assert [each.verdict for each in found] == ["ok", "check", "FAIL"] and "KeyError" in found[-1].sentence
    assert judged(study, frame().iloc[:2])[-1].verdict == "not judged" and "KeyError" in capsys.readouterr().err


def test_limits():
    claim = claims.claim
    assert claim("a", 0.06, 0.06).ok and not claim("a", 0.061, 0.06).ok
    assert claim("a", 1.7, ">= 1.7").ok and not claim("a", 1.69, ">= 1.7").ok
    assert claim("a", 0, "= 0").ok and not claim("a", float("nan"), "<= 1").ok
    with pytest.raises(ValueError, match="limit = 'about 3'"):
        claim("a", 3, "about 3")


@pytest.mark.parametrize(
    ("sentence", "value", "limit", "verdict"),
    [
        ("error", 0.5, 1.0, "check"),
        ("error", 0.5, ">= 0.2", "check"),
        ("error", 2.0, 1.0, "FAIL"),
        # Far from its limit, at it, or nothing at all.
        ("error", 0.3, 1.0, "ok"),
        ("error", 1.0, 1.0, "ok"),
        ("misses", 0.0, 1.0, "ok"),
        ("misses", 0.0, "= 0", "ok"),
        # From elsewhere, by any study's words or its own.
        ("The paper's network: error", 0.5, 1.0, "ok"),
        # Of what is no paper's own, and of a word within another.
        ("error with the paper's 5000 particles", 0.5, 1.0, "check"),
        ("peak memory per unknown, bytes", 578.0, 600.0, "check"),
        ("order in the spacing", 2.0, ">= 1.5", "ok"),
        ("as was guessed", 9.0, ">= 8", "ok"),
    ],
)
def test_what_holds_nearly_is_a_check(study, sentence, value, limit, verdict):
    study.claims, study.ELSEWHERE = lambda df: [(sentence, value, limit)], ("guessed",)
    assert judged(study, frame())[-1].verdict == verdict


def test_half_of_the_rows_make_a_page(tiny):
    """Of a run that was killed: what needs the others is not judged, what is there is shown."""
    needed = 'df[df["name"] == "last"].iloc[0]["x"]'
    tiny.write(
        '{"name": "more", "x": 3.0}, {"name": "last", "x": 4.0}',
        **{'df["square"].max()': needed, 'axes.plot(df["x"]': f"axes.plot([{needed}] * len(df)"},
    )
    tiny.made()
    path = tiny.out / f"{tiny.name}.csv"
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(lines[:3]))
    found, page = render(runner.load(tiny.name), path)
    assert [each.verdict for each in found] == ["ok", "not judged", "not judged"]
    assert "Not judged, rows are missing: 2 claims." in page and "- rows: 2 of 4 cases" in page
    assert not path.with_suffix(".png").exists() and "![" not in page
