"""State that libraries keep for the whole process: changed by one thread at a time, and put back."""

import os
import threading
from contextlib import contextmanager

import numpy as np

_RANDOM, _BLAS = threading.RLock(), threading.RLock()
# How many are in `one_blas_thread` now, and what the first of them found.
_within, _found = [0], []


@contextmanager
def seeded():
    """NumPy's global generator in a known state, afterwards in that of before: pyamg estimates spectral radii with it.

    One thread at a time; what other code draws meanwhile, in a thread of its own, comes from the known state.
    """
    with _RANDOM:
        state = np.random.get_state()  # noqa: NPY002
        np.random.seed(0)  # noqa: NPY002
        try:
            yield
        finally:
            np.random.set_state(state)  # noqa: NPY002


@contextmanager
def one_blas_thread():
    """BLAS with one thread: in short products between compiled loops more of them only spin.

    Some builds of BLAS count by thread: each puts back what it found. Others count for the process: there the last one
    to leave puts back what the first one found.
    """
    from threadpoolctl import threadpool_limits

    with _BLAS:
        mine = threadpool_limits(1, "blas")
        if _within[0] == 0:
            _found.append(mine)
        _within[0] += 1
    try:
        yield
    finally:
        with _BLAS:
            mine.restore_original_limits()
            _within[0] -= 1
            if _within[0] == 0:
                _found.pop().restore_original_limits()


def open_after_fork(lock):
    """Have a lock free in the children of this process: it forks only while no other thread holds the lock.

    Parameters
    ----------
    lock : threading.RLock

    Returns
    -------
    The same lock.
    """
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(before=lock.acquire, after_in_parent=lock.release, after_in_child=lock.release)
    return lock


for _lock in (_RANDOM, _BLAS):
    open_after_fork(_lock)
