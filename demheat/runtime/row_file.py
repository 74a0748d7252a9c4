"""Rows in one CSV file, written whole after each of them: what is stopped goes on from there."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from operator import itemgetter
from pathlib import Path
from typing import NamedTuple

from demheat.runtime.paths import locked, replaced

# Letters of one cell at most: a picture of 200 x 200 numbers has 300 000, above what the csv module reads by default.
csv.field_size_limit(2**24)


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
