"""What a long computation says of itself: its stage, the share done, the time left, the memory that it holds.

On a terminal one line on standard error, which vanishes when the stage ends; to a hook (`on_progress`) reports. A stage
that lasts less than two seconds never speaks, and nothing does where standard error is no terminal and no hook is set.
The environment variable DEMHEAT_PROGRESS=0 silences the terminal.

Neither tqdm nor rich does this: they say nothing of a stage that is silent itself, or begin at once.
"""

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import partial
from typing import NamedTuple

from demheat.runtime.deadline import has_budget, look

# Seconds that a stage may last in silence, between two reports of it, and until somebody else speaks for it.
SILENT, PAUSE, WAIT = 2.0, 0.2, 1.0
# Bytes from which on a computation says what it takes.
LARGE = 2**28
CLEAR = "\r\x1b[K"


class Report(NamedTuple):
    """What a stage says."""

    stage: str  # Such as "cells" or "equations"
    share: float  # Done of it, 0 to 1; NaN if the stage does not know
    elapsed: float  # s
    left: float  # s: Estimated from the share done; NaN while that is 0 or not known
    within: tuple[str, ...] = ()  # The stages that this one is a part of, outermost first


class _Open:
    """A stage that has not ended; `within` are those of its thread that had begun before."""

    def __init__(self, name, within, before):
        self.name, self.within, self.share = name, within, float("nan")
        self.begun = time.monotonic() - before
        self.last = self.begun + SILENT - PAUSE

    def report(self, now):
        elapsed, share = now - self.begun, self.share
        left = elapsed * (1 - share) / share if share > 0 else float("nan")
        return Report(self.name, share, elapsed, left, tuple(each.name for each in self.within))


# Who hears; open stages by thread; the thread whose line the terminal shows; the one that speaks for silent stages.
_hook: list[Callable[[Report], None] | None] = [None]
_open: dict[int, list[_Open]] = {}
_shown: list[int | None] = [None]
_speaker: list[threading.Thread | None] = [None]
_speaking, _work = threading.RLock(), threading.Event()


def on_progress(hook: Callable[[Report], None] | None):
    """Send all reports to a function instead of the terminal, for notebooks and programs; None ends it.

    Parameters
    ----------
    hook : callable or None
        Called with a Report, a few times a second at most and one at a time: in the thread that computes, where what it
        raises ends the computation, or in one that speaks for it, where it must not raise.

    Raises
    ------
    ValueError
        If it is not callable.

    Examples
    --------
    >>> import demheat
    >>> heard: list[tuple[str, float]] = []
    >>> demheat.on_progress(lambda report: heard.append((report.stage, report.share)))
    >>> demheat.on_progress(None)
    """
    if hook is not None and not callable(hook):
        raise ValueError(f"hook = {hook!r}: must be a function of one Report, or None")
    _hook[0] = hook


@contextmanager
def stage(name: str, *, before: float = 0.0) -> Iterator[Callable[[float], None]]:
    """A part of a computation that may be long; stages may lie in stages. Where a budget of time is over it ends."""
    look(name)
    thread = threading.get_ident()
    # Within one of its own name it would only say that again: kernels compiled where all are.
    if not _heard() or any(each.name == name for each in _open.get(thread, ())):
        yield partial(_unheard, name) if has_budget() else _unlimited
        return
    stack = _open.setdefault(thread, [])
    current = _Open(name, tuple(stack), before)
    stack.append(current)
    _wake_speaker()

    def done(share):
        look(name)
        current.share = share
        now = time.monotonic()
        if now - current.last >= PAUSE:
            _say(thread, current, now)

    try:
        yield done
    finally:
        stack.remove(current)
        if not stack:
            _open.pop(thread, None)
            _clear(thread)


def announced(name: str, needed: float):
    """A stage that tells the memory that a large computation will take; of a small one nothing is said."""
    return stage(f"{name}, about {needed / 2**30:.2g} GiB") if needed > LARGE else nullcontext()


def in_parts(name: str):
    """A stage with pauses that do not count, such as those of a generator."""
    spent = [0.0]

    @contextmanager
    def part():
        begun = time.monotonic()
        try:
            with stage(name, before=spent[0]) as done:
                yield done
        finally:
            spent[0] += time.monotonic() - begun

    return part


def _unheard(name, share):
    look(name)


def _unlimited(share):
    pass


def _heard():
    return _hook[0] is not None or _terminal()


def _terminal():
    return sys.stderr is not None and sys.stderr.isatty() and os.environ.get("DEMHEAT_PROGRESS") != "0"


def _say(thread, current, now):
    current.last = now
    report = current.report(now)
    with _speaking:
        if _hook[0] is not None:
            _hook[0](report)
        # One line: that of the thread which spoke first, until its last stage ends.
        elif _terminal() and _shown[0] in (None, thread):
            _shown[0] = thread
            sys.stderr.write(CLEAR + line(report))
            sys.stderr.flush()


def line(report: Report) -> str:
    """A report in words, such as "calibration: equations: 40%, 12 s left"."""
    names, held = ": ".join((*report.within, report.stage)), _held()
    if report.share != report.share:
        return f"{names}: {report.elapsed:.0f} s{held}"
    left = "" if report.left != report.left else f", {_duration(report.left)} left"
    return f"{names}: {report.share:.0%}{left}{held}"


def _held():
    """Memory that the process holds, if it is much and Linux tells it."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            held = int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError):
        return ""
    return f", holds {held / 2**30:.1f} GiB" if held > LARGE else ""


def _duration(seconds):
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"


def _clear(thread):
    with _speaking:
        if _shown[0] == thread:
            _shown[0] = None
            if _terminal():
                sys.stderr.write(CLEAR)
                sys.stderr.flush()


def _wake_speaker():
    if _speaker[0] is None or not _speaker[0].is_alive():
        _speaker[0] = threading.Thread(target=_speak, name="demheat progress", daemon=True)
        _speaker[0].start()
    _work.set()


def _speak():
    """Speak for stages that do not."""
    while True:
        _work.wait()
        time.sleep(PAUSE)
        now = time.monotonic()
        for thread, stack in list(_open.items()):
            # The innermost stage that has lasted long enough; short ones in it are its own matter.
            current = next((each for each in reversed(stack[:]) if now - each.begun >= SILENT), None)
            if current is not None and now - current.last >= WAIT:
                _say(thread, current, now)
        if not _open:
            _work.clear()
            # A stage may have begun between the two.
            if _open:
                _work.set()


def _forget():
    """A forked child has none of its parent's threads, nor their stages."""
    global _speaking, _work
    _speaking, _work = threading.RLock(), threading.Event()
    _open.clear()
    _shown[0] = _speaker[0] = None


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget)
