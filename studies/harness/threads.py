"""How many threads a row may use."""

from __future__ import annotations

import os


def threads():
    """Threads a row may use: NUMBA_NUM_THREADS where set, else every processor this process may use."""
    return int(os.environ.get("NUMBA_NUM_THREADS") or len(os.sched_getaffinity(0)))
