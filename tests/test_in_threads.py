"""Several Python threads at once, in processes of their own: what goes wrong there ends the process."""

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
ENGINE = ["laguerre", "amg", "calibrated", "platonic", "euler", "rkl2", "tr-bdf2", "tr-bdf2-multigrid", "one field"]
PACKINGS = ["lsa", "relax", "statistics", "halo"]
WITNESSES = ["fft", "eyre-milton", "fem", "multipole", "exact", "bounds"]
FEW = ["laguerre", "relax", "halo"]
FORKS = """
import os, threading
import numpy as np
import in_threads
def flux(): return in_threads.relax()[0]
found, workers = flux(), [threading.Thread(target=lambda: [flux() for _ in range(9)]) for _ in range(2)]
for worker in workers: worker.start()
ends = []
for _ in range(4):
    child = os.fork()
    if child == 0:
        os._exit(0 if np.array_equal(flux(), found) else 1)
    ends.append(os.waitpid(child, 0)[1])
for worker in workers: worker.join()
assert ends == [0] * 4, ends
"""


def run(words, tmp_path, *, threads=2, layer=None):
    env = {name: value for name, value in os.environ.items() if name != "NUMBA_THREADING_LAYER"}
    env |= {"NUMBA_NUM_THREADS": str(threads), "DEMHEAT_CACHE": str(tmp_path)}
    env |= {"PYTHONPATH": os.pathsep.join([str(TESTS.parent), str(TESTS)])}
    if layer:
        env["NUMBA_THREADING_LAYER"] = layer
    done = subprocess.run([sys.executable, *words], env=env, capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")


# Some CPU-seconds each; what the engine shares between threads the first one sees.
SLOW = [pytest.param(jobs, threads, marks=pytest.mark.slow) for jobs, threads in ((FEW, 1), (WITNESSES, 2))]


@pytest.mark.parametrize("jobs, threads", [(ENGINE + PACKINGS, 2), *SLOW])
def test_bits_are_those_of_one_thread(jobs, threads, tmp_path):
    run([str(TESTS / "in_threads.py"), *jobs], tmp_path, threads=threads)


@pytest.mark.slow
def test_bits_are_those_of_one_thread_with_tbb(tmp_path):
    try:
        ctypes.CDLL("libtbb.so.12")
    except OSError:
        pytest.skip("the library of the tbb layer is not found")
    run([str(TESTS / "in_threads.py"), *FEW], tmp_path, layer="tbb")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_children_forked_while_threads_compute(tmp_path):
    # Python warns, since 3.12, of any fork while there are threads.
    run(["-W", "ignore::DeprecationWarning", "-c", FORKS], tmp_path)
