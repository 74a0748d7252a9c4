"""How long rows take, by those that are stored; and rows that nobody asks for their costs."""

import math

import pytest

from studies.harness import lasting, runner, sound, store, table

VALUES = {"def run(": 'def VALUES(case):\n    return case["name"] != "plain"\n\ndef run('}
ROW = {"status": "ok", "note": "", "commit": "1", "machine": "m", "threads": "2", "versions": "v", "load": "0"}


def stored(tiny, *rows, **changes):
    """A study with rows of these columns besides those that every row has, in the order of its cases."""
    tiny.write('{"name": "slow", "x": 3.0}', **changes)
    study = runner.load(tiny.name)
    rows = [ROW | {"case": store.case_key(case), **case, **row} for case, row in zip(study.CASES, rows, strict=False)]
    store.write_rows(tiny.out / f"{tiny.name}.csv", rows)
    return study, tiny.out / f"{tiny.name}.csv"


def test_a_row_takes_its_runs_and_what_comes_besides(tiny):
    study, path = stored(tiny, {"wall_s": 2.0, "repeats": 3}, {"wall_s": 50.0, "made_s": 7.5})
    found = list(lasting.seconds(study, path, study.CASES).values())
    assert found[:2] == [6.0 + lasting.START, 7.5] and math.isnan(found[2])


def test_an_extrapolated_cost_is_no_time_that_went_by(tiny):
    times = ("2026-11-24T10:00:00+00:00", "2026-11-24T10:01:00+00:00", "then")
    study, path = stored(tiny, *({"wall_s": 1000.0, "when": when} for when in times))
    found = list(lasting.seconds(study, path, study.CASES).values())
    assert found == [1000.0 + lasting.START, 60.0 + lasting.START, 1000.0 + lasting.START]


def test_values_alone_take_one_thread_of_two(tiny):
    rows = ({"wall_s": 2.0, "cpu_s": 3.0}, {"wall_s": 2.0, "cpu_s": 3.0}, {"made_s": 5.0})
    study, path = stored(tiny, *rows, **VALUES)
    found = list(lasting.seconds(study, path, study.CASES).values())
    assert found == [2.0 + lasting.START, (3.0 + lasting.ALONE) / 2, 2.5]


def test_what_others_took_is_no_time_of_a_row(tiny):
    rows = ({"made_s": 8.0, "load": 8.0}, {"made_s": 8.0, "load": 8.0}, {"made_s": 8.0, "load": 1.5})
    study, path = stored(tiny, *rows, **VALUES)
    # The first has costs: it was made on a quiet machine, or says that it was not.
    assert list(lasting.seconds(study, path, study.CASES).values()) == [8.0, 8.0 / 4 / 2, 8.0 / 2]


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        ([30.0, 31.0], "2 rows in about 2 min"),
        ([7200.0], "1 rows in about 2 h 00 min"),
        ([60.0, math.nan], "2 rows in about 1 min, and 1 of which nobody knows"),
    ],
)
def test_in_words(seconds, words):
    assert lasting.time_in_words(seconds) == words


def test_rows_for_their_values_are_made_first_side_by_side_and_without_costs(tiny, monkeypatch):
    for variable in ("NUMBA_THREADING_LAYER", "OMP_WAIT_POLICY"):
        monkeypatch.setenv(variable, "")
    tiny.write('{"name": "slow", "x": 3.0}', **VALUES)

    def compute(name, study, case):
        return runner.compute_row(study, case)

    together = []

    def beside(tasks):
        for task in tasks:
            together.append(task[2]["name"])
            yield runner.compute_row(*task[1:])

    compute.beside = beside
    assert tiny.ran(compute=compute) == ["second", "slow", "plain"] and together == ["second", "slow"]
    rows = {row["name"]: row for row in tiny.rows().values()}
    assert float(rows["plain"]["cpu_s"]) >= 0 and rows["second"]["square"] == "4.0"
    for column in (*store.COST, "beside", "noise"):
        assert rows["second"].get(column, "") == rows["slow"].get(column, "") == ""
    # One thread or two, here or elsewhere: it is the same value.
    path = tiny.out / f"{tiny.name}.csv"
    store.write_rows(path, [row | {"threads": "1", "machine": "another"} for row in rows.values()])
    assert tiny.ran(compute=compute) == ["plain"]


def test_costs_that_nobody_asks_are_neither_used_nor_wrong(tiny):
    noisy = {"wall_s": 2.0, "cpu_s": 3.0, "peak_mib": 5.0, "noise": 0.5, "square": 4.0, "when": "then"}
    study, path = stored(tiny, noisy, noisy, noisy, **VALUES)
    df = table.read_frame(study, path)
    assert df["cpu_s"].notna().tolist() == df["peak_mib"].notna().tolist() == [True, False, False]
    assert df["square"].notna().all()
    assert list(sound.checked(study, path).values()) == [("noisy",), (), ()]
    assert [len(runner.still_to_run(study, path, force=force)[1]) for force in ("unsound", True)] == [3, 3]
