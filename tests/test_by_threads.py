"""The bits of every method do not depend on how many threads compute, nor on whose libraries' they are."""

import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

TESTS = Path(__file__).parent
SETTINGS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What `by_threads.py` finds with so many threads, by a process of its own for each number."""
    folder = tmp_path_factory.mktemp("threads")

    @cache
    def numbers(threads):
        path = folder / f"{threads}.npz"
        env = os.environ | dict.fromkeys(SETTINGS, str(threads))
        env |= {"PYTHONPATH": os.pathsep.join([str(TESTS.parent), str(TESTS)]), "DEMHEAT_CACHE": str(folder)}
        words = [sys.executable, "-W", "error", str(TESTS / "by_threads.py"), str(path)]
        done = subprocess.run(words, env=env, capture_output=True, text=True, timeout=600)
        assert (done.returncode, done.stderr) == (0, "")
        with np.load(path) as values:
            return dict(values)

    return numbers


# Work that four threads share is cut at more places than between two.
@pytest.mark.parametrize("threads", [pytest.param(2, marks=pytest.mark.slow), 4])
def test_bits_are_those_of_one_thread(found, threads):
    one, more = found(1), found(threads)
    assert len(one) > 20 and all(len(values) for values in one.values())
    assert [name for name in one if not np.array_equal(one[name], more[name])] == []


def test_the_generator_that_all_share_is_left_alone(found):
    assert not any(found(threads)["generator moved"].any() for threads in (1, 4))
