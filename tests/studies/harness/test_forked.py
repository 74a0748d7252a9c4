"""Rows in copies of one process that has loaded the libraries: they are what rows in fresh processes are."""

import os
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from studies.harness import forked, provenance, runner

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="rows are copies of a process on Linux")
NOTED = '"square": x * x, "process": os.getpid(), "first": os.getppid(), "threads": os.environ["OMP_NUM_THREADS"]'
NOTED += ', "began": __import__("studies.harness.quiet", fromlist="START").START.time'
# What a row is not told by its case: when it was made, and what it took.
OWN = ("when", "load", "wall_s", "cpu_s", "peak_mib", "base_mib", "noise", "beside", "process", "first", "began")
OWN += ("made_s",)


@pytest.fixture
def study(tiny):
    """Study whose rows say which process they were made in."""

    def made(extra="", **changes):
        tiny.write(extra, **{'"square": x * x': NOTED, **changes})
        return runner.load(tiny.name)

    return made


def test_a_row_is_that_of_a_fresh_process(study):
    tiny = study()
    with forked.forking() as compute:
        rows = [compute(tiny.__name__, tiny, case) for case in tiny.CASES]
    start = partial(runner.started, environment=provenance.row_environment())
    others = [runner.spawn_row(tiny.__name__, tiny, case, start=start) for case in tiny.CASES]
    for row, other in zip(rows, others, strict=True):
        # A process that lived for less than a fifth of a second does not know its noise.
        assert row.keys() | {"noise"} == other.keys() | {"noise"} and row["status"] == "ok"
        assert {name: row[name] for name in row if name not in OWN} == {n: other[n] for n in other if n not in OWN}


def test_each_row_has_a_process_of_its_own_all_of_one_first(study):
    tiny = study()
    with forked.forking() as compute:
        rows = [compute(tiny.__name__, tiny, case) for case in [*tiny.CASES, *tiny.CASES]]
    assert len({row["process"] for row in rows}) == 4
    # What others do is counted from the beginning of each, not of the first.
    assert len({row["began"] for row in rows}) == 4
    (first,) = {row["first"] for row in rows}
    # It is gone with the run.
    assert first != os.getpid() and not Path(f"/proc/{first}").exists()


def test_a_row_that_dies_or_takes_too_long_is_told_and_the_next_is_made(study, tmp_path):
    more = '{"name": "dies", "x": 3.0}, {"name": "sleeps", "x": 4.0}, {"name": "plain", "x": 5.0}'
    child = 'import subprocess; child = subprocess.Popen(["sleep", "60"]); _log(f"pid {child.pid}"); time.sleep(60)'
    tiny = study(more, **{"TIMEOUT = 60.0": "TIMEOUT = 5.0", "time.sleep(60)": child})
    with forked.forking() as compute:
        dead, late, well = (compute(tiny.__name__, tiny, case) for case in tiny.CASES[2:])
    assert dead["status"] == "failed" and "SIGABRT" in dead["note"]
    assert late["status"] == "timeout" and "5 s" in late["note"]
    assert well["status"] == "ok" and well["first"] != well["process"]
    pid = int((tmp_path / "log").read_text().split("pid ")[1].split()[0])
    for _ in range(100):
        if not Path(f"/proc/{pid}").exists():
            break
        time.sleep(0.05)
    else:
        raise AssertionError("what a row started goes on after it")


def test_after_a_change_of_the_sources_rows_are_copies_of_another(study, monkeypatch):
    tiny, seen = study(), iter(["as it was", "as it was", "changed"])
    monkeypatch.setattr(forked, "_sources", lambda: next(seen))
    with forked.forking() as compute:
        one, same, other = (compute(tiny.__name__, tiny, tiny.CASES[0])["first"] for _ in range(3))
    assert one == same != other


def test_a_first_process_that_was_killed_is_replaced(study):
    tiny = study()
    with forked.forking() as compute:
        first = compute(tiny.__name__, tiny, tiny.CASES[0])["first"]
        os.kill(first, 9)
        time.sleep(0.2)
        again = compute(tiny.__name__, tiny, tiny.CASES[0])
    assert again["status"] == "ok" and again["first"] != first


def test_changed_sources_are_seen(tmp_path, monkeypatch):
    monkeypatch.setattr(provenance, "ROOT", tmp_path)
    (tmp_path / "demheat").mkdir()
    file = tmp_path / "demheat" / "one.py"
    file.write_text("1\n")
    before = forked._sources()
    os.utime(file, ns=(1, 1))
    assert list(before) == [file] and forked._sources() != before
