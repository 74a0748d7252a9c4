"""What a call costs, on calls whose cost is known."""

import subprocess
import sys
import time

import numpy as np
import pytest

from studies.harness import cost


def test_peak_memory_is_of_the_call_alone():
    if not cost._reset_peak():
        pytest.skip("this system cannot reset a process's peak memory")
    before = np.ones(40_000_000)
    del before
    doubles = 16_000_000
    _, spent = cost.measured(lambda: float(np.ones(doubles).sum()))
    # 122 MiB asked for; the kernel counts pages in batches per processor: some MiB of slack both ways.
    assert spent["peak_mib"] == pytest.approx(doubles * 8 / cost.MIB, abs=16)
    assert spent["peak_by"] == "VmHWM"
    assert cost.measured(lambda: None)[1]["peak_mib"] < 16


def test_processor_seconds_count_this_process_and_its_children():
    def spin(seconds=0.2):
        end = time.process_time() + seconds
        while time.process_time() < end:
            pass

    value, spent = cost.measured(lambda: spin() or "done")
    assert value == "done" and spent["cpu_s"] >= 0.2
    # Of children user's and system's time are told in whole hundredths, rounded down: 0.2 may be read as 0.19.
    code = "import time\nwhile time.process_time() < 0.25: pass"
    _, spent = cost.measured(subprocess.run, [sys.executable, "-c", code], check=True)
    assert spent["cpu_s"] >= 0.2


def test_peak_memory_without_the_kernels_help(monkeypatch):
    monkeypatch.setattr(cost, "_reset_peak", lambda: False)
    _, spent = cost.measured(lambda: None)
    assert spent["peak_by"] == "ru_maxrss" and spent["peak_mib"] >= 0


def test_triad_is_a_memory_bandwidth():
    # Below any machine's that runs this, above any cache's: a wrong unit or count of bytes falls out.
    assert 0.5 < cost.triad_gbs(elements=2_000_000, repeats=2) < 3000
