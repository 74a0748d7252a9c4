"""A time budget: computations look at the clock as their stages begin and go on, and end in words when it is over.

Nothing is killed. Between two looks is a block of compiled loops, an iteration or a set-up; how long that may be is in
`docs/decisions/threads.md`.
"""

import time
from contextlib import AbstractContextManager, contextmanager, nullcontext
from contextvars import ContextVar
from typing import NamedTuple

from demheat.scene.beats import heard_by
from demheat.scene.inputs import finite


class _Deadline(NamedTuple):
    """When the seconds of a budget are over, by `time.monotonic`."""

    seconds: float
    end: float


# What a message, and the note of a row, says of a time that did not suffice.
OVER = "are over, in"
# Of what computes in this thread; threads that are started begin without.
_now: ContextVar[_Deadline | None] = ContextVar("deadline", default=None)


def budget(seconds: float | None, *, begun: float | None = None) -> AbstractContextManager[None]:
    """Let what is computed within take so many seconds, by any method; of budgets in budgets the first to end counts.

    Parameters
    ----------
    seconds : float, s, or None
        None changes nothing.
    begun : float, s, optional
        When they began, by `time.monotonic`, where several parts share them. Default: now.

    Returns
    -------
    context manager

    Raises
    ------
    ValueError
        If it is anything else, or not positive.
    TimeoutError
        Where they are over: at the next look, mostly within half a second, later while large equations are set up
        (found: 3 s of 7e5 unknowns) and in a first call, which compiles.

    Examples
    --------
    >>> import demheat
    >>> from demheat import gallery
    >>> from references import fft
    >>> with demheat.budget(60.0):
    ...     field = fft.solve(gallery.sphere_in_cube(5.0), voxels=32)
    >>> try:
    ...     with demheat.budget(1e-9):
    ...         demheat.solve(gallery.sphere_in_cube(5.0))
    ... except TimeoutError as error:
    ...     print(error)
    seconds = 1e-09 are over, in ...
    """
    if seconds is None:
        return nullcontext()
    seconds = finite("seconds", seconds, "a finite number > 0, or None", lambda v: v > 0)
    return _until(seconds, time.monotonic() if begun is None else begun)


@contextmanager
def _until(seconds, begun):
    outer, own = _now.get(), _Deadline(seconds, begun + seconds)
    before = _now.set(own if outer is None or own.end < outer.end else outer)
    try:
        yield
    finally:
        _now.reset(before)


def look(doing: str) -> None:
    """Raise TimeoutError if a budget is over."""
    deadline = _now.get()
    if deadline is not None and time.monotonic() >= deadline.end:
        raise TimeoutError(f"seconds = {deadline.seconds:g} {OVER} {doing}")


heard_by(look)


def has_budget() -> bool:
    """Whether there is a budget."""
    return _now.get() is not None
