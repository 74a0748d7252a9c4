"""Rows in one CSV file, and the one loop that makes them: of sweeps, studies, replays and comparisons.

Rows come from here, from copies of a process or from a cluster; each is kept, the file written whole, before the next
is waited for, so that what is stopped goes on from there. What rows are asked for, and which older ones hold, is for
those to say who ask.
"""

from __future__ import annotations

import csv
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from operator import itemgetter
from pathlib import Path
from typing import NamedTuple, TypeVar

from demheat.runtime.paths import locked, replaced
from demheat.runtime.progress import stage

# Letters of one cell at most: a picture of 200 x 200 numbers has 300 000, above what the csv module reads by default.
csv.field_size_limit(2**24)

Task, Row, Kept = TypeVar("Task"), TypeVar("Row"), TypeVar("Kept")


class RowFile(NamedTuple):
    """A file of rows: what they are, which columns all have, by which one finds a row, which come last; its name."""

    path: Path
    what: str
    needs: tuple[str, ...] = ("case",)
    key: tuple[str, ...] = ("case",)
    last: tuple[str, ...] = ()
    name: str = ""

    def read(self) -> dict[str | tuple, dict[str, str]]:
        """Rows as text by their keys; none of a file that is not there."""
        if not self.path.exists():
            return {}
        try:
            with self.path.open(newline="", encoding="utf-8") as file:
                reader = csv.DictReader(file, strict=True)
                rows, columns = list(reader), reader.fieldnames or ()
            for name in self.needs:
                if name not in columns:
                    raise ValueError(f"no column {name!r}")
            odd = next((k for k, row in enumerate(rows, start=1) if None in row or None in row.values()), None)
            if odd is not None:
                raise ValueError(f"row {odd} has not as many values as there are columns")
            keys = [itemgetter(*self.key)(row) for row in rows]
            if len(set(keys)) < len(keys):
                twice = next(key for key, count in Counter(keys).items() if count > 1)
                raise ValueError(f"two rows of {twice!r}")
        except (OSError, ValueError, csv.Error) as error:
            raise self.error(error) from None
        return dict(zip(keys, rows, strict=True))

    def error(self, why: Exception | str) -> ValueError:
        """The error of a file that holds something else."""
        return ValueError(f"{self.name or self.path}: must hold {self.what}: {why}; mend it or move it away")

    def write(self, rows: Iterable[Mapping]) -> None:
        """Write rows, whole or not at all; a column of some is empty in the others."""
        rows = list(rows)
        seen = list(dict.fromkeys(name for row in rows for name in row))
        columns = [name for name in seen if name not in self.last] + [name for name in self.last if name in seen]
        with replaced(self.path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)

    def put(self, rows: Mapping, *, order: Iterable | None = None) -> None:
        """Put rows, by their keys, in the places of older ones; with an order of keys the others of the file go."""

        def merged(stored):
            found = stored | rows
            return found.values() if order is None else [found[key] for key in order if key in found]

        self.change(merged)

    def change(self, changed: Callable[[dict], Iterable[Mapping]]) -> None:
        """Write what is made of the rows as they are now: of several who do so at a time one waits for the other."""
        with locked(self.path.parent):
            self.write(changed(self.read()))


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
