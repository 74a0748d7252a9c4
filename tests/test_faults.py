"""What a row has started outlives no killed run; and Python started in odd ways makes the same rows.

`tests/tools/try_faults.py` tries many more faults, and takes hours.
"""

import os
import signal
from pathlib import Path

import faults
import pytest
from faults import Toy


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


# Assertions and docstrings left out; warnings as errors; letters of another alphabet, without the mode that saves it.
ODD = {
    "-OO, a locale of ASCII": (["-OO"], {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}),
    "-W error, another order of sets, no home": (["-W", "error"], {"PYTHONHASHSEED": "7", "HOME": None}),
}


@pytest.mark.parametrize("odd", ODD)
def test_odd_ways_to_start_python(tmp_path, odd):
    """Two rows, of which each starts Python anew: enough for an order of rows."""
    toy, (python, changes) = Toy(tmp_path, faults.STUDY.replace('case["x"] < 4', 'case["x"] < 2')), ODD[odd]
    status, said, error = toy.run(python=python, **changes)
    assert (status, error) == (0, ""), said
    assert [(row["third"], row["place"]) for row in toy.rows().values()] == [
        ("0.0", "Zürich, °C"),
        ("0.3333333333333333", "Zürich, °C"),
    ]
    # Rows are those of the same code: a usual run has nothing to add.
    assert "2 already there, 0 to run" in toy.run()[1]
    toy.clear()
