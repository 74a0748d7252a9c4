"""One place that chooses how compiled loops use threads.

Numba's workqueue layer is always present and lets its threads sleep between loops; OpenMP's spin, which costs whole
time slices on a shared machine. Set NUMBA_THREADING_LAYER to choose another, NUMBA_NUM_THREADS=1 for one thread.
The workqueue layer must not be entered by two Python threads at once: run two solves in two processes.
"""

import os
from contextlib import contextmanager

import numba

if "NUMBA_THREADING_LAYER" not in os.environ:
    numba.config.THREADING_LAYER = "workqueue"


@contextmanager
def limited(threads: int | None):
    """Let compiled loops use so many threads for a while.

    Parameters
    ----------
    threads : int or None
        From 1 to the number that the process began with; None changes nothing.
    """
    before = numba.get_num_threads()
    numba.set_num_threads(before if threads is None else threads)
    try:
        yield
    finally:
        numba.set_num_threads(before)
