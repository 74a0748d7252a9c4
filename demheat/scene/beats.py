"""What takes long about shapes says from time to time that it goes on: whoever keeps time can end it there.

A scene knows nothing of budgets: `demheat.runtime.deadline` listens.
"""

from collections.abc import Callable

_listeners: list[Callable[[str], None]] = []


def heard_by(listener: Callable[[str], None]) -> None:
    """Let a function hear of every beat what is being done; it may raise."""
    _listeners.append(listener)


def beat(doing: str) -> None:
    """Say that something goes on: at least every few tenths of a second, where it lasts."""
    for listener in _listeners:
        listener(doing)
