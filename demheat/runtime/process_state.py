"""State that libraries keep for the whole process, changed by one thread at a time and put back; its processor time."""

import os
import threading
import time
from collections.abc import Callable
from contextlib import contextmanager
from functools import cache

import numpy as np

_RANDOM, _BLAS = threading.RLock(), threading.RLock()
# How many are in `one_blas_thread` now, and what the first of them found.
_within, _found = [0], []
# Seconds of processor time of processes that work for this one and have not ended.
_elsewhere = []


def cpu_seconds() -> float:
    """Processor seconds of this process, of its finished children, and of the mesher's process that it keeps."""
    # Of itself to the microsecond: `os.times` counts in hundredths of a second.
    return time.process_time() + sum(os.times()[2:4]) + sum(_elsewhere)


def stopwatch() -> Callable[[], dict[str, float]]:
    """What says, whenever it is called, how many wall and processor seconds have passed since now."""
    wall, cpu = time.perf_counter(), cpu_seconds()
    return lambda: {"wall_s": time.perf_counter() - wall, "cpu_s": cpu_seconds() - cpu}


def count_elsewhere(seconds: float) -> None:
    """Have `cpu_seconds` count what a process took for this one that has not ended."""
    _elsewhere.append(seconds)


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
    """BLAS with one thread: in short products between compiled loops more of them only spin, and they change its sums.

    Builds with OpenMP count by thread: each puts back what it found. Others count for the process: there the first to
    come sets the number, and the last one to leave puts back what that one found.
    """
    if _counts_by_thread():
        from threadpoolctl import threadpool_limits

        with threadpool_limits(1, "blas"):
            yield
        return
    with _BLAS:
        if _within[0] == 0:
            blas = _libraries()
            _found.append((blas, blas.info()))
            _set_all(blas, [each | {"num_threads": 1} for each in _found[0][1]])
        _within[0] += 1
    try:
        yield
    finally:
        with _BLAS:
            _within[0] -= 1
            if _within[0] == 0:
                _set_all(*_found.pop())


def _libraries():
    """Those of BLAS that are loaded by now, to be looked for once: some milliseconds, as long as a small solve."""
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController().select(user_api="blas")


@cache
def _counts_by_thread():
    """Whether BLAS has a number of threads for each thread that calls it."""
    return any(each.get("threading_layer") == "openmp" for each in _libraries().info())


def _set_all(blas, numbers):
    """Set numbers of threads by library, as its `info` gives them, for the process.

    threadpoolctl obeys that thread alone which has set numbers first, as long as it lives: so one that ends at once
    asks, or else, if the caller has asked before, the caller.
    """
    asking = threading.Thread(target=blas.limit, kwargs={"limits": numbers})
    asking.start()
    asking.join()
    if [each["num_threads"] for each in blas.info()] != [each["num_threads"] for each in numbers]:
        blas.limit(limits=numbers)


def open_after_fork(lock):
    """Have a lock free in the children of this process: it forks only while no other thread holds the lock."""
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(before=lock.acquire, after_in_parent=lock.release, after_in_child=lock.release)
    return lock


for _lock in (_RANDOM, _BLAS):
    open_after_fork(_lock)
