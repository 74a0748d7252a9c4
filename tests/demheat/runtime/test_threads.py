"""Only here: a threading layer other than asked, pieces of work lost or begun after one that failed."""

import os
import subprocess
import sys
import time

import pytest

from demheat.runtime.threads import shared_out, thread_limit

CODE = "import demheat.runtime.threads, numba; print(numba.config.THREADING_LAYER)"


@pytest.mark.parametrize("asked, given", [(None, "workqueue"), ("omp", "omp")])
def test_layer_is_workqueue_unless_asked_otherwise(asked, given):
    env = {name: value for name, value in os.environ.items() if name != "NUMBA_THREADING_LAYER"}
    if asked:
        env["NUMBA_THREADING_LAYER"] = asked
    result = subprocess.run([sys.executable, "-c", CODE], env=env, capture_output=True, text=True, check=True)
    assert result.stdout.strip() == given


@pytest.mark.parametrize("threads", [1, 2])
def test_pieces_make_up_the_work(threads):
    done = []
    with thread_limit(threads):
        shared_out(lambda first, last: done.append((first, last)), 10, piece=4)
    assert sorted(done) == [(0, 4), (4, 8), (8, 10)]
    assert threads > 1 or done == sorted(done)


@pytest.mark.parametrize("threads", [1, 2])
def test_no_piece_is_begun_after_one_that_failed(threads):
    done = []

    def work(first, last):
        if first == 2:
            raise ZeroDivisionError
        time.sleep(1e-3)
        done.append(first)

    with thread_limit(threads), pytest.raises(ZeroDivisionError):
        shared_out(work, 1000, piece=1)
    # A second thread may be in the midst of others.
    assert len(done) < 100 and 2 not in done
