"""Rows whose costs do not count are found: those of uncommitted changes, and of a machine in use."""

import pytest

from studies.__main__ import main
from studies.harness import runner, sound, store

GOOD = {"commit": "0123456789", "noise": "0.02"}


@pytest.fixture
def stored(tiny):
    """Two rows, as if of a clean commit and a quiet machine; `change` alters the second."""
    tiny.made()
    path = tiny.out / f"{tiny.name}.csv"

    def change(**columns):
        first, second = (row | GOOD for row in tiny.rows().values())
        store.write_rows(path, [first, second | columns])
        return sound.checked(runner.load(tiny.name), path)["name=second,x=2.0"]

    change()
    tiny.change = change
    return tiny


@pytest.mark.parametrize(
    ("columns", "wrong"),
    [
        ({}, ()),
        # Of another commit: a cost of that day all the same.
        ({"commit": "9876543210"}, ()),
        ({"commit": "0123456789+1a2b3c"}, ("dirty",)),
        ({"noise": "0.101"}, ("noisy",)),
        ({"noise": "0.1"}, ()),
        # Nobody knows; a row that was refused has no costs to spoil.
        ({"noise": ""}, ("noisy",)),
        ({"noise": "", "cpu_s": "", "status": "unsupported"}, ()),
        ({"compile_s": "0.11", "wall_s": "1.0"}, ("noisy",)),
        ({"compile_s": "0.09", "wall_s": "1.0"}, ()),
        ({"noise": "0.9", "commit": "1+"}, ("dirty", "noisy")),
        # No repository: nothing to be dirty.
        ({"commit": ""}, ()),
    ],
)
def test_what_is_wrong_with_a_row(stored, columns, wrong):
    assert stored.change(**columns) == wrong


def test_rows_without_the_columns_are_read(stored):
    rows = [{k: v for k, v in row.items() if k not in ("noise", "host", "beside")} for row in stored.rows().values()]
    store.write_rows(stored.out / f"{stored.name}.csv", rows)
    assert main(["check", stored.name, "--out", str(stored.out)]) == 0
    assert main(["render", stored.name, "--out", str(stored.out)]) == 0


def test_the_command_lists_them_and_only_a_release_fails(stored, capsys, monkeypatch):
    def checked(*words):
        status = main(["check", stored.name, "--out", str(stored.out), *words])
        return status, capsys.readouterr().out.splitlines()

    here = f"{stored.out}: 2 rows: 0 missing"
    assert checked() == (
        0,
        [
            f"{stored.name:24}    2 rows: 0 dirty, 0 noisy; 2 of 0123456789; none replayed",
            "made anew by two processors that nobody else uses: 2 rows in about 1 min",
            f"{here}, 2 of other code and not replayed by this one, 0 dirty, 0 noisy",
        ],
    )
    assert checked("--release")[0] == 1
    monkeypatch.setattr(sound, "of_this_code", lambda commit, file: commit == "0123456789")
    assert checked("--release")[0] == 0
    stored.change(commit="9876543210", replayed_commit="0123456789", replayed_when="2026-11-24T10:00:00+00:00")
    status, lines = checked("--release")
    assert status == 0 and "1 of 9876543210; 1 replayed, last 2026-11-24" in lines[0]
    stored.change(commit="1+", noise="0.5")
    status, lines = checked()
    assert status == 0 and "    dirty, noisy: name=second,x=2.0" in lines
    assert lines[-1] == f"{here}, 0 of other code and not replayed by this one, 1 dirty, 1 noisy"
    assert checked("--release")[0] == 1


def test_a_missing_row_is_named_and_fails(stored, capsys):
    first = next(iter(stored.rows().values()))
    store.write_rows(stored.out / f"{stored.name}.csv", [first])
    assert main(["check", stored.name, "--out", str(stored.out)]) == 1
    assert "    missing: name=second,x=2.0" in capsys.readouterr().out.splitlines()


def test_many_rows_are_named_on_demand(tiny, capsys):
    tiny.write(", ".join(f'{{"name": "more", "x": {k}.0}}' for k in range(3, 8)))
    tiny.made()
    store.write_rows(tiny.out / f"{tiny.name}.csv", [row | GOOD | {"noise": "1"} for row in tiny.rows().values()])
    words = ["check", tiny.name, "--out", str(tiny.out)]
    assert main(words) == 0
    short = capsys.readouterr().out.splitlines()
    assert main([*words, "--rows"]) == 0
    assert [len(short), len(capsys.readouterr().out.splitlines())] == [3 + 4, 3 + 7]
    assert "    noisy: and 4 more" in short


def test_a_study_without_rows(tiny, capsys):
    assert main(["check", tiny.name, "--out", str(tiny.out)]) == 2
    assert f"{tiny.name}.csv; run the study first" in capsys.readouterr().err


def test_a_clean_run_repeats_what_is_unsound(stored, monkeypatch):
    monkeypatch.setattr(sound, "of_this_code", lambda commit, file: commit == GOOD["commit"])
    assert stored.ran() == [] and stored.ran(force="unsound") == []
    stored.change(noise="0.4")
    assert stored.ran() == [] and stored.ran(force="unsound") == ["second"]


def test_columns_of_costs_are_told_by_their_names():
    class Study:
        COSTS = ("efficiency",)

    costs = ["cpu_s", "dem-plain_cpu_s", "three_s", "peak_mib", "triad_gbs", "us_per_cell", "peer_us_per_cell"]
    costs += ["million_particle_steps", "efficiency"]
    assert sound.cost_columns(Study, [*costs, "steps", "k_ratio", "error_percent", "contrast", "cov"]) == costs
    assert "efficiency" not in sound.cost_columns(runner, costs)


def test_rows_say_what_others_did(tiny):
    tiny.ran()
    for row in tiny.rows().values():
        assert 0 <= float(row["noise"]) <= 1 and row["triad_gbs"] == "12.5" and row["repeats"] == "1"


def test_rows_say_what_they_compiled(tiny):
    """A row of one call says it; of several calls the first compiles, and the cheapest counts."""
    kernel = "def run(name, x):\n    numba.njit(lambda x: x + 1)(1)"
    tiny.write(**{"import os, time": "import numba, os, time", "def run(name, x):": kernel})
    tiny.ran()
    for row in tiny.rows().values():
        assert 0 < float(row["compile_s"]) <= float(row["wall_s"])


def test_short_rows_are_repeated(tiny, tmp_path):
    tiny.write(**{"REPEATS = 1": ""})
    tiny.ran(quick=True)
    row = tiny.rows()["name=plain,x=1.5"]
    assert row["repeats"] == "5" and float(row["cpu_spread"]) >= 0
    assert (tmp_path / "log").read_text().split() == ["warm", "plain", *["run", "plain"] * 5]
