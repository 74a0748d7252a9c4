"""Runs that are killed, run at one time, or on machines that lack something: nothing lost, nothing wrong, one line."""

import os
import random
import signal
from pathlib import Path

import faults
import pytest
from faults import Toy


@pytest.fixture
def toy(tmp_path):
    toy = Toy(tmp_path)
    yield toy
    toy.clear()


@pytest.fixture(scope="module")
def right(tmp_path_factory):
    return faults.unkilled(tmp_path_factory.mktemp("right") / "toy")


# A dozen seconds; that a killed run resumes is seen by the tests of the harness, too: `make test-slow`.
@pytest.mark.slow
def test_killed_at_random_moments_and_resumed(toy, right):
    """All but costs is as if nobody had killed it, and no process is left, of rows' children neither."""
    (rows, seconds), moments = right, random.Random(3)
    before = {}
    for group in (False, True):
        wrong, _ = faults.killed(toy, moments.uniform(0.3, 0.7) * seconds, group)
        assert wrong + faults.compared(toy, rows, before) == []
        before = toy.rows()
    status, said, _ = toy.run()
    assert status == 0 and toy.rows() == rows and f"{len(before)} already there" in said
    assert sorted(path.suffix for path in toy.out.iterdir() if path.name[0] != ".") == [".csv", ".md", ".png", ".svg"]


def test_what_a_row_has_started_ends_with_a_killed_run(tmp_path):
    toy = Toy(tmp_path, faults.STUDY.replace("time.sleep(0.1)", "time.sleep(60)"))
    run = toy.start()
    try:
        while not any("sleep" in name for name in map(command, toy.running())):
            assert run.poll() is None
        os.kill(run.pid, signal.SIGKILL)
        assert toy.gone()
    finally:
        toy.clear()
        run.communicate()


def command(number):
    try:
        return Path(f"/proc/{number}/cmdline").read_text()
    except OSError:
        return ""


def test_two_runs_on_one_folder_at_one_time(toy, right):
    runs = [toy.start(), toy.start()]
    said = [run.communicate(timeout=600)[1] for run in runs]
    assert [run.returncode for run in runs] == [0, 0], said
    assert toy.rows() == right[0] and toy.gone()


# Assertions and docstrings left out; warnings as errors; letters of another alphabet, without the mode that saves it.
ODD = {
    "-OO, a locale of ASCII": (["-OO"], {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}),
    "-W error, another order of sets, no home": (["-W", "error"], {"PYTHONHASHSEED": "7", "HOME": None}),
}


@pytest.mark.parametrize("odd", ODD)
def test_odd_ways_to_start_python(tmp_path, right, odd):
    """Two rows, of which each starts Python anew: enough for an order of rows."""
    toy, (python, changes) = Toy(tmp_path, faults.STUDY.replace('case["x"] < 4', 'case["x"] < 2')), ODD[odd]
    status, said, error = toy.run(python=python, **changes)
    assert (status, error) == (0, ""), said
    assert list(toy.rows().items()) == list(right[0].items())[:2]
    # Rows are those of the same code: a usual run has nothing to add.
    assert "2 already there, 0 to run" in toy.run()[1]
    toy.clear()
