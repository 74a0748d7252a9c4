"""The one loop of rows: of sweeps, studies, replays and comparisons, made here, in copies, or on a cluster.

What rows are asked for, and which older ones hold, is for those to say who ask.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TypeVar

from demheat.runtime.progress import stage

Task, Row, Kept = TypeVar("Task"), TypeVar("Row"), TypeVar("Kept")


def each_kept(
    tasks: Sequence[Task],
    made: Iterable[tuple[int, Row]],
    keep: Callable[[Task, Row], Kept],
    *,
    what: str,
    named: Callable[[Task], str] = lambda task: "",
) -> Iterator[Kept]:
    """What `keep` makes of each task and its row, as they come: before the next is waited for.

    `made` yields numbers of tasks and their rows, in any order; with `named` progress names tasks that come in theirs.
    """
    made, begun = iter(made), time.perf_counter()
    for count, task in enumerate(tasks):
        label = f"{what} {count + 1}/{len(tasks)}{named(task)}"
        with stage(label, before=time.perf_counter() - begun) as done:
            done(count / len(tasks))
            number, row = next(made)
        yield keep(tasks[number], row)
