"""Stored rows are made again: what moved is told, what did not is stamped, and a change is accepted by a command."""

import pytest

from demheat.runtime.machine import machine
from studies.__main__ import main
from studies.harness import accept as acceptance
from studies.harness import provenance, replay, runner, store

CASES = '{"name": "plain", "x": 3.0}, {"name": "slow", "x": 4.0}'


@pytest.fixture
def old(tiny, monkeypatch):
    """Rows of an older commit with costs, and a replay that makes rows in this process and lists them."""
    tiny.write(CASES)
    tiny.made()
    path = tiny.out / f"{tiny.name}.csv"
    costs = {"plain": ("0.5", "0.3"), "second": ("0.2", "0.2"), "slow": ("0.1", "0.1")}
    rows = [
        row
        | {"commit": "0123456789", "when": "then", "noise": "0.01"}
        | dict(zip(("wall_s", "cpu_s"), costs[row["name"]], strict=True))
        for row in tiny.rows().values()
    ]
    rows[2]["wall_s"] = "0.9"
    store.write_rows(path, rows)
    tiny.replayed = []

    def made(tasks):
        for _, study, case in tasks:
            tiny.replayed.append(store.case_key(case))
            yield runner.compute_row(study, case, warm=False)

    class Beside:
        def __enter__(self):
            return made

        def __exit__(self, *error):
            return None

    monkeypatch.setattr(replay, "side_by_side", Beside)
    tiny.path = path
    return tiny


def ran(tiny, *words):
    return main([words[0], tiny.name, "--out", str(tiny.out), *words[1:]])


def test_rows_that_come_back_are_stamped(old, capsys):
    before = old.rows()
    assert ran(old, "replay", "--all") == 0
    for key, row in old.rows().items():
        assert row.pop("replayed_commit") == provenance.commit(old.file) and row.pop("replayed_when")[:2] == "20"
        assert {name: value for name, value in row.items() if value} == {n: v for n, v in before[key].items() if v}
    assert f"{old.out}: 4 rows made again, 0 of them with values that moved" in capsys.readouterr().out
    # And then no older rows are left.
    assert ran(old, "replay", "--all", "--old") == 0
    assert "0 rows made again" in capsys.readouterr().out


def test_a_value_that_moved_is_named(old, capsys):
    old.write(CASES, **{"x * x": "x * x + 1e-6"})
    before = old.rows()
    assert ran(old, "replay") == 1
    said = capsys.readouterr().out
    assert f"{old.name} name=plain,x=1.5: square stored '2.25', found '2.250001', tolerance 1e-08 relative" in said
    assert f"python -m studies accept {old.name}" in said
    # It is noted of the one that was looked at; nothing else changes.
    after = old.rows()
    noted = {key: here for key, row in after.items() if (here := row.pop("moved_commit"))}
    assert noted == {"name=plain,x=1.5": provenance.commit(old.file)} and after == before


def test_what_a_replay_found_moved_is_accepted_whatever_the_cheapest_of_its_group_says(old, capsys):
    """The row of x = 1.5 is cheaper, and the same."""
    old.write(CASES, **{"x * x": "x * x + (x == 3)"})
    before = old.rows()
    assert ran(old, "replay", "--all") == 1
    capsys.readouterr()
    assert ran(old, "accept") == 0
    assert "1 groups moved; 1 rows are made again" in capsys.readouterr().out
    after = old.rows()
    assert after["name=plain,x=3.0"]["square"] == "10.0" and not after["name=plain,x=3.0"]["moved_commit"]
    del old.replayed[:]
    assert ran(old, "accept") == 0 and old.replayed == []
    for key in before.keys() - {"name=plain,x=3.0"}:
        assert {name: after[key][name] for name in before[key]} == before[key]


def test_rows_of_a_moved_group_that_are_the_same_stay_to_the_last_digit(old):
    """The cheapest of plain moves, the other by less than its tolerance."""
    old.write(CASES, **{"x * x": "x * x + (x == 1.5) + 1e-12 * (x == 3)"})
    assert ran(old, "accept") == 0
    found, here = old.rows(), provenance.commit(old.file)
    assert [found[f"name=plain,x={x}"]["square"] for x in (1.5, 3.0)] == ["3.25", "9.0"]
    assert [found[f"name=plain,x={x}"]["replayed_commit"] for x in (1.5, 3.0)] == ["", here]


def test_a_group_of_which_some_rows_have_new_values_is_made_to_its_end(old):
    """Whatever the next one says: an `accept` was killed."""
    here, rows = provenance.commit(old.file), old.rows()
    store.write_rows(old.path, [row | {"values_commit": here if row["x"] == "1.5" else ""} for row in rows.values()])
    groups, _ = replay.bear_out({old.name: runner.load(old.name)}, old.out, say=lambda line: None)
    assert [group for _, group in groups] == [(("name", "plain"),)]
    assert not any("plain" in key for key in old.replayed)


def test_the_cheapest_of_a_group_bears_out_the_others(old):
    """plain has two rows: the one of x = 1.5 took less time."""
    old.write(CASES, **{"x * x": 'x * x + (name == "plain")'})
    replay.bear_out({old.name: runner.load(old.name)}, old.out, say=lambda line: None)
    assert old.replayed == ["name=slow,x=4.0", "name=second,x=2.0", "name=plain,x=1.5"]
    here = provenance.commit(old.file)
    assert [row["replayed_commit"] for row in old.rows().values()] == ["", here, "", here]
    # Nor is what is borne out looked at again, or made, nor what is known to have moved; it is not proved, though.
    del old.replayed[:]
    replay.bear_out({old.name: runner.load(old.name)}, old.out, say=lambda line: None)
    assert old.replayed == []
    assert old.ran() == ["plain", "plain"]
    del old.replayed[:]
    assert ran(old, "replay", "--all", "--old") == 0 and old.replayed == []
    old.write(CASES, **{"x * x": "x * x + 1"})
    assert ran(old, "replay", "--all", "--old") == 1 and len(old.replayed) == 4


def test_an_accepted_change_gives_moved_rows_new_values_and_leaves_costs_and_the_others(old, capsys):
    old.write(CASES, limit=10, **{"x * x": 'x * x * (2 if name == "plain" else 1)'})
    before = {row["name"] + row["x"]: row for row in old.rows().values()}
    assert ran(old, "accept") == 0
    said = capsys.readouterr().out
    assert "1 groups moved; 2 rows are made again" in said
    assert "|     | squares are small | 16  | 18  | <= 10 | FAIL    |" in said
    after = {row["name"] + row["x"]: row for row in old.rows().values()}
    assert [after[name]["square"] for name in ("plain1.5", "plain3.0")] == ["4.5", "18.0"]
    for name, row in after.items():
        kept = ("cpu_s", "wall_s", "commit", "when", "noise")
        assert {each: row[each] for each in kept} == {each: before[name][each] for each in kept}
        new = (provenance.commit(old.file), machine()) if name.startswith("plain") else ("", "")
        assert (row["values_commit"], row["values_machine"]) == new
    # What is accepted is this code's.
    del old.replayed[:]
    assert ran(old, "accept") == 0 and old.replayed == []


def test_rows_for_their_values_say_how_long_the_new_code_took(old):
    old.write(CASES, **{"def run(": 'def VALUES(case):\n    return case["name"] == "slow"\n\ndef run('})
    study, rows = runner.load(old.name), old.rows()
    for case in study.CASES:
        stored = rows[store.case_key(case)] | {"made_s": "50", "load": "9"}
        row = acceptance.renewed(study, case, stored, stored | {"made_s": 2.0, "load": 1.0})
        assert (row["made_s"], row["load"]) == ((2.0, 1.0) if case["name"] == "slow" else ("50", "9"))


def test_a_row_that_cannot_be_made_again_stays(old, capsys):
    """The cheapest of its group has moved, and this one fails now: it must not give way to nothing."""
    old.write(CASES, **{"def run(name, x):": "def run(name, x):\n    x = x * 2 if x < 3 else 1 / (x - 3)"})
    before = old.rows()
    assert ran(old, "accept") == 1
    said = capsys.readouterr().out
    assert f"not made again: {old.name} name=plain,x=3.0: failed, ZeroDivisionError in run" in said
    after = old.rows()["name=plain,x=3.0"]
    assert {name: value for name, value in after.items() if value} == {
        name: value for name, value in before["name=plain,x=3.0"].items() if value
    }
    assert old.rows()["name=plain,x=1.5"]["square"] == "9.0"


def test_a_row_whose_process_was_killed_says_nothing(old, monkeypatch, capsys):
    """By the system, for want of memory: the stored row has neither moved nor come back."""

    def ended(how):
        monkeypatch.setattr(runner, "compute_row", lambda study, case, warm: runner.failed(study, case, how))
        ran(old, "replay", "--all")

    before = old.rows()
    ended("process killed by SIGKILL; nothing on its output")
    assert old.rows() == before
    assert "not here, process killed by SIGKILL" in capsys.readouterr().out
    ended("process killed by SIGSEGV; nothing on its output")
    assert all(row["moved_commit"] for row in old.rows().values())


def test_new_values_lose_what_was_said_of_the_old_ones(old):
    store.write_rows(old.path, [row | {"replayed_commit": "1", "borne_commit": "1"} for row in old.rows().values()])
    old.write(CASES, **{"x * x": "x * x + 1"})
    assert ran(old, "accept") == 0
    assert {row["replayed_commit"] + row["borne_commit"] for row in old.rows().values()} == {""}


def test_a_killed_accept_goes_on(old):
    """Rows that have new values are not made again; the others of their group still are."""
    old.write(CASES, **{"x * x": "x * x + 1"})
    study = runner.load(old.name)
    rows = old.rows()
    done = rows["name=plain,x=1.5"] | {"square": "3.25", "values_commit": provenance.commit(old.file)}
    store.write_rows(old.path, [done, *list(rows.values())[1:]])
    assert ran(old, "accept") == 0
    assert "name=plain,x=1.5" not in old.replayed
    assert [row["square"] for row in old.rows().values()] == [str(case["x"] ** 2 + 1) for case in study.CASES]


@pytest.fixture
def dear(old, monkeypatch):
    """Rows of which that of `slow` alone takes less than what is dear: the others follow it."""
    monkeypatch.setattr(acceptance, "DEAR", 0.15)
    return old


def test_a_group_that_follows_moves_with_its_leader(dear, capsys):
    """And no row is made twice."""
    dear.write(CASES, **{"x * x": "x * x + 1"})
    assert ran(dear, "accept") == 0
    said = capsys.readouterr().out
    assert "3 groups have rows of other code; one row of each of 1 is made again" in said
    assert f"    {dear.name} name=plain takes long: follows {dear.name}" in said
    assert "3 groups moved; 4 rows are made again" in said
    assert dear.replayed[0] == "name=slow,x=4.0" and sorted(dear.replayed) == sorted(dear.rows())
    assert [float(row["square"]) for row in dear.rows().values()] == [
        float(row["x"]) ** 2 + 1 for row in dear.rows().values()
    ]


def test_a_group_that_follows_is_borne_out_with_its_leader(dear):
    assert ran(dear, "accept") == 0 and dear.replayed == ["name=slow,x=4.0"]
    here, rows = provenance.commit(dear.file), dear.rows()
    assert [row["borne_commit"] or row["replayed_commit"] for row in rows.values()] == [here] * 4
    assert {row["borne_commit"] for row in rows.values()} == {here, ""}
    assert ran(dear, "accept") == 0 and dear.replayed == ["name=slow,x=4.0"]


@pytest.mark.parametrize(
    "columns, made, borne",
    [
        (("values_commit",), ["name=plain,x=1.5", "name=plain,x=3.0", "name=second,x=2.0"], 0),
        (("replayed_commit",), [], 3),
        # Found the same as what this code has made: that says nothing of what others have.
        (("commit", "replayed_commit"), ["name=second,x=2.0"], 2),
    ],
)
def test_a_killed_accept_knows_what_its_leaders_did(dear, columns, made, borne):
    here = provenance.commit(dear.file)
    rows = [row | dict.fromkeys(columns if row["name"] == "slow" else (), here) for row in dear.rows().values()]
    store.write_rows(dear.path, rows)
    assert ran(dear, "accept") == 0 and sorted(dear.replayed) == made
    assert [row.get("borne_commit") for row in dear.rows().values()].count(here) == borne


@pytest.mark.parametrize(
    "seconds, looked, borne", [(0.15, ["slow"], []), (0.3, ["slow", "second"], ["plain", "plain"])]
)
def test_a_leader_that_is_not_here_says_nothing_of_those_that_follow(dear, monkeypatch, seconds, looked, borne):
    monkeypatch.setattr(acceptance, "DEAR", seconds)
    dear.write(CASES, **{"not for x = 3": "yade is not installed", 'name == "refuses"': 'name == "slow"'})
    assert ran(dear, "accept") == 0
    assert [key.split(",")[0] for key in dear.replayed] == [f"name={name}" for name in looked]
    assert [row["name"] for row in dear.rows().values() if row.get("borne_commit")] == borne


@pytest.mark.parametrize("action", ["replay", "accept", "check"])
def test_a_folder_without_rows_is_told_in_a_line(tiny, tmp_path, capsys, action):
    assert main([action, tiny.name, "--out", str(tiny.out)]) == 2
    assert f"{tiny.name}.csv; run the study first" in capsys.readouterr().err
    for folder in (tmp_path / "none", tmp_path):
        assert main([action, "--out", str(folder)]) == 2
        said = capsys.readouterr().err
        assert said.startswith(f"studies: --out {folder}: must be a folder with rows") and said.count("\n") == 1


@pytest.mark.parametrize("action", ["replay", "accept"])
def test_rows_that_cannot_be_read_or_written_stay_as_they_are(old, capsys, monkeypatch, action):
    whole = old.path.read_bytes()
    old.path.write_bytes(whole[: len(whole) // 2])
    assert ran(old, action) == 2
    said = capsys.readouterr().err
    assert f"{old.path}: must hold rows of a study as CSV" in said and said.count("\n") == 1
    assert old.path.read_bytes() == whole[: len(whole) // 2] and old.replayed == []
    old.path.write_bytes(whole)

    def full(*args, **knobs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(store.tempfile, "TemporaryFile", full)
    assert ran(old, action) == 2
    assert "must be a folder that can be written" in capsys.readouterr().err
    assert old.path.read_bytes() == whole and old.replayed == []


def test_rows_of_another_version_are_not_lost(old):
    rows = list(old.rows().values())
    store.write_rows(old.path, [row | {"code": "5e59c7"} for row in [*rows, rows[0] | {"case": "name=gone,x=9.0"}]])
    assert ran(old, "replay", "--all") == 0
    assert [*old.rows()][-1] == "name=gone,x=9.0" and {row["code"] for row in old.rows().values()} == {"5e59c7"}


def test_rows_side_by_side_are_made_in_processes_of_one_thread(tiny, monkeypatch):
    tiny.made()
    study = runner.load(tiny.name)
    with replay.side_by_side(2) as compute:
        rows = list(compute([(tiny.name, study, case) for case in study.CASES]))
    assert [row["square"] for row in rows] == [2.25, 4.0]
    assert {row["threads"] for row in rows} == {1} and {row["status"] for row in rows} == {"ok"}
