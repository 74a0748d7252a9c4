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


# All is compiled anew without docstrings: a dozen CPU-seconds.
@pytest.mark.slow
def test_odd_ways_to_start_python(tmp_path):
    """Assertions and docstrings left out, warnings as errors, ASCII alone, sets in another order, nobody's home."""
    # Two rows, of which each starts Python anew: enough for an order of rows.
    toy = Toy(tmp_path, faults.STUDY.replace('case["x"] < 4', 'case["x"] < 2'))
    odd = {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0", "PYTHONHASHSEED": "7", "HOME": None}
    status, said, error = toy.run(python=["-OO", "-W", "error"], **odd)
    assert (status, error) == (0, ""), said
    assert [(row["third"], row["place"]) for row in toy.rows().values()] == [
        ("0.0", "Zürich, °C"),
        ("0.3333333333333333", "Zürich, °C"),
    ]
    # Rows are those of the same code: a usual run has nothing to add.
    assert "2 already there, 0 to run" in toy.run()[1]
    toy.clear()
