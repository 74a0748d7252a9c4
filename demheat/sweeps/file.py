"""Rows of a sweep in a CSV file, written whole after each row: a sweep that is stopped goes on from there."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

from demheat.runtime.paths import checked_path
from demheat.runtime.rows import RowFile
from demheat.sweeps.cases import key_of
from demheat.sweeps.rows import CASE, TAIL


class Kept:
    """Rows of a file as text, by their cases."""

    def __init__(self, path: Path):
        name = f"out = {str(path)!r}"
        self.file = RowFile(path, "rows of a sweep as CSV", needs=(CASE, *TAIL), last=TAIL, name=name)
        self.rows = self.file.read()

    def has(self, case: Mapping) -> bool:
        """Whether a case stands there without an error."""
        row = self.rows.get(key_of(case))
        return row is not None and not row["error"]

    def row(self, case: Mapping) -> dict:
        """The row of a case: its values as they were given, the others as the text says, without empty ones."""
        found = self.rows[key_of(case)]
        values = {name: _parsed(text) for name, text in found.items() if name != CASE and text != ""}
        ends = {name: values.pop(name, None) for name in TAIL}
        others = {name: value for name, value in values.items() if name not in case}
        return {**case, **others, **ends, "error": found["error"]}

    def add(self, case: Mapping, row: Mapping) -> None:
        """Put a row in the place of an older one of its case, beside what others have written meanwhile."""
        texts = {name: "" if value is None else str(value) for name, value in row.items()}
        new = {key_of(case): {CASE: key_of(case), **texts}}
        self.rows |= new
        self.file.put(new)


def opened(path) -> Kept:
    """Rows of a file that may not be there yet, or a ValueError: before any case is computed."""
    try:
        path = checked_path(path)
    except ValueError as error:
        raise ValueError(f"out: {error}") from None
    try:
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise ValueError(f"out = {str(path)!r}: must be a file in a folder that can be written: {error}") from None
    if path.is_dir() or not path.name:
        raise ValueError(f"out = {str(path)!r}: must be a file, and is a folder")
    return Kept(path)


def _parsed(text):
    """A cell as what it stood for: a flag, a number or text."""
    if text in ("True", "False"):
        return text == "True"
    for kind in (int, float):
        try:
            return kind(text) if "_" not in text else text
        except ValueError:
            pass
    return text
