"""What a long computation says of itself: its stage, the share done, the time left.

Silent unless standard error is a terminal or a hook is set: a stage that lasts less than two seconds never speaks.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

# Seconds that a stage may last in silence, and between two reports of it.
SILENT, PAUSE = 2.0, 0.2


class Report(NamedTuple):
    """What a stage says.

    Attributes
    ----------
    stage : str
        Such as "cells" or "equations".
    share : float
        Done of it, 0 to 1.
    elapsed : float, s
    left : float, s
        Estimated from the share done; NaN while that is 0.
    """

    stage: str
    share: float
    elapsed: float
    left: float


_hook: list[Callable[[Report], None] | None] = [None]


def on_progress(hook: Callable[[Report], None] | None):
    """Send all reports to a function instead of the terminal, for notebooks and programs; None ends it.

    Parameters
    ----------
    hook : callable or None
        Called with a Report, a few times a second at most, in the thread that computes.

    Raises
    ------
    ValueError
        If it is not callable.
    """
    if hook is not None and not callable(hook):
        raise ValueError(f"hook = {hook!r}: must be a function of one Report, or None")
    _hook[0] = hook


@contextmanager
def stage(name: str) -> Iterator[Callable[[float], None]]:
    """A part of a computation that may be long.

    Parameters
    ----------
    name : str

    Yields
    ------
    callable
        To be called with the share done, 0 to 1, as often as one likes.
    """
    begun, last = time.monotonic(), [time.monotonic() + SILENT - PAUSE]
    spoke = []

    def done(share):
        now = time.monotonic()
        if now - last[0] < PAUSE:
            return
        last[0] = now
        elapsed = now - begun
        spoke.append(True)
        _say(Report(name, share, elapsed, elapsed * (1 - share) / share if share > 0 else float("nan")))

    try:
        yield done
    finally:
        if spoke and _hook[0] is None:
            _clear()


def _say(report):
    if _hook[0] is not None:
        _hook[0](report)
    elif sys.stderr is not None and sys.stderr.isatty():
        left = "" if report.left != report.left else f", {report.left:.0f} s left"
        sys.stderr.write(f"\r\x1b[K{report.stage}: {report.share:.0%}{left}")
        sys.stderr.flush()


def _clear():
    if sys.stderr is not None and sys.stderr.isatty():
        sys.stderr.write("\r\x1b[K")
        sys.stderr.flush()
