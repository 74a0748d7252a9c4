"""Rows on a Dask cluster of two workers: those of a local run, whoever is killed meanwhile; skipped without Dask."""

import importlib.util
import os
import random
import signal
import sys

import pytest

from demheat.beyond import cluster
from studies.__main__ import main
from studies.harness import runner
from studies.harness.cluster import spread_over

# What differs between two runs of the same row: seconds, memory, load, the hour.
MEASURED = {"wall_s", "cpu_s", "peak_mib", "base_mib", "when", "load", "beside", "noise", "triad_gbs", "made_s"}
needs_dask = pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="Dask is not installed")


def unmeasured(rows):
    return [{name: value for name, value in row.items() if name not in MEASURED} for row in rows.values()]


@needs_dask
def test_rows_of_two_workers_are_those_of_a_local_run(tiny, capsys):
    tiny.write('{"name": "refuses", "x": 3.0}, {"name": "dies", "x": 4.0}')
    tiny.ran()
    local = tiny.rows()
    assert tiny.run("--workers", "2", "--force") == 1  # one died
    rows = tiny.rows()
    assert unmeasured(rows) == unmeasured(local) and list(rows) == list(local)
    assert [row["status"] for row in rows.values()] == ["ok", "ok", "unsupported", "failed"]
    # They were made anew, and came home one by one.
    assert all(rows[key]["wall_s"] != local[key]["wall_s"] for key in list(rows)[:2])
    printed = capsys.readouterr().out
    assert "dashboard http://127.0.0.1:" in printed and all(f"\n[{k}/4] " in printed for k in (1, 2, 3, 4))
    assert all(row["host"] for row in rows.values())


@needs_dask
def test_killed_workers_lose_no_row(tiny):
    """Three times, while both compute, one of them is killed, drawn by a seed."""
    names = [f'{{"name": "slow", "x": {k}.0}}' for k in range(3, 9)]
    tiny.write(", ".join(names))
    drawn, killed = random.Random(20), []

    def say(line):
        if line.startswith(("[1/", "[3/", "[5/")):
            found = client.run(os.getpid, on_error="return").values()
            killed.append(drawn.choice(sorted(pid for pid in found if isinstance(pid, int))))
            os.kill(killed[-1], signal.SIGKILL)

    with cluster.cluster(workers=2) as client:
        runner.run_study(tiny.name, tiny.out, say=say, spread=spread_over(client))
    rows = tiny.rows()
    assert len(set(killed)) == 3
    assert len(rows) == 8 and {row["status"] for row in rows.values()} == {"ok"}


@needs_dask
def test_a_worker_with_other_code_is_refused(tiny, monkeypatch):
    """Its rows would be made for nothing: none of them holds here."""

    found = {"tcp://dying": OSError("closed"), "tcp://other": {"commit": "another", "versions": "those"}}

    class Client:
        def run(self, function, *args, on_error):
            return found

    def refused(words):
        with pytest.raises(ValueError, match=words):
            runner.run_study(tiny.name, tiny.out, say=lambda line: None, spread=spread_over(Client()))
        assert tiny.rows() == {}

    refused("worker tcp://other has commit another, versions those: must be as here")
    found["tcp://other"] = ModuleNotFoundError("studies")
    refused(f"a worker cannot make rows of '{tiny.name}': ModuleNotFoundError: studies")


@needs_dask
def test_an_address_without_a_scheduler_is_refused_in_a_line(tiny, capsys):
    assert tiny.run("--scheduler", "nowhere") == 2
    said = capsys.readouterr().err
    assert "scheduler = 'nowhere': must be the address of a Dask scheduler" in said and said.count("\n") == 1


def test_without_dask_a_line_says_what_to_install(tiny, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert tiny.run("--workers", "2") == 2
    assert "pip install 'demheat[distributed]'" in capsys.readouterr().err and not tiny.out.exists()


@pytest.mark.parametrize("number", ["0", "-1", "two", "1.5", "9999999"])
def test_a_number_of_workers_that_is_none(number, capsys):
    with pytest.raises(SystemExit):
        main(["run", "fig14_single_inclusion", "--workers", number])
    assert "must be a whole number from 1" in capsys.readouterr().err


def test_rows_of_another_machine_hold_where_rows_may_be_made_anywhere(tiny):
    from studies.harness import store

    tiny.made()
    path = tiny.out / f"{tiny.name}.csv"
    store.write_rows(path, [row | {"machine": "another", "threads": "64"} for row in tiny.rows().values()])
    asked = []
    tiny.ran(spread=lambda name, study, cases: asked.append(cases))
    assert asked == [] and len(runner.still_to_run(runner.load(tiny.name), path)[1]) == 2
