"""Rows of a study in one CSV file, written row by row so that a killed run loses nothing."""

from __future__ import annotations

import csv
import math
import tempfile
from contextlib import contextmanager
from pathlib import Path

from demheat.runtime import paths
from demheat.runtime.paths import locked

# What every row ends with, in this order; what a case and a run bring comes before, in order of appearance.
COST = ("wall_s", "cpu_s", "cpu_spread", "repeats", "peak_mib", "base_mib", "peak_by")
# Seconds from the start of a row's process to its end: what a record takes, whatever its costs are.
MADE = "made_s"
# Where values are from that were made anew without their costs; when they were last made again and found the same; and
# which code found another row of their group the same.
VALUES = ("values_commit", "values_when", "replayed_commit", "replayed_when", "borne_commit")
TAIL = (
    *("unknowns", "iterations", "residual"),
    *COST,
    *("status", "note", "commit", "when", "machine", "host", "threads", "versions"),
    *("load", "beside", "noise", "compile_s", "triad_gbs", MADE),
    *VALUES,
)
# Bytes that must be free before a run begins.
ROOM = 2**20
# Letters of one cell at most: a picture of 200 x 200 numbers has 300 000, above what the csv module reads by default.
csv.field_size_limit(2**24)


def case_key(case):
    """Name of a case: its parameters in order, as "contrast=10,method=fem,order=2"."""
    return ",".join(f"{name}={value}" for name, value in case.items())


def read_rows(path):
    """Rows of a CSV file as {case key: {column: text}}; empty if there is no such file."""
    path = Path(path)
    if not path.exists():
        return {}
    try:
        with path.open(newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file, strict=True)
            rows, columns = list(reader), reader.fieldnames or ()
        if "case" not in columns:
            raise ValueError("no column 'case'")
        odd = next((k for k, row in enumerate(rows, start=1) if None in row or None in row.values()), None)
        if odd is not None:
            raise ValueError(f"row {odd} has not as many values as there are columns")
    except (OSError, ValueError, csv.Error) as error:
        raise ValueError(f"{path}: must hold rows of a study as CSV: {error}; mend it or move it away") from None
    return {row["case"]: row for row in rows}


def number_of(row, name):
    """A cell of a row as a number; not-a-number if it is none or not there."""
    try:
        return float(row.get(name))
    except (TypeError, ValueError):
        return math.nan


def check_writable(folder):
    """Raise ValueError unless rows can be written into a folder, which is made if need be: before an hour's solve."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(bytes(ROOM))
    except OSError as error:
        raise ValueError(f"{folder}: must be a folder that can be written, with some room: {error}") from None


def add_rows(path, rows, keys):
    """Add rows to those of a file as it is now: other runs may have added theirs."""
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with locked(path.parent):
            rows = read_rows(path) | rows
            write_rows(path, (rows[key] for key in keys if key in rows))
    except (OSError, ValueError) as error:
        rescued = Path(tempfile.mkdtemp(prefix="demheat-rows-")) / path.name
        write_rows(rescued, rows.values())
        raise ValueError(f"{path}: cannot be written: {error}; the rows are in {rescued}") from None


def write_rows(path, rows):
    """Write rows, an iterable of dicts, whole or not at all."""
    rows = list(rows)
    seen = list(dict.fromkeys(name for row in rows for name in row))
    columns = [name for name in seen if name not in TAIL] + [name for name in TAIL if name in seen]
    with replaced(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


@contextmanager
def replaced(path):
    """As `demheat.runtime.paths.replaced`, in a folder that is made if it is not there."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with paths.replaced(path) as temporary:
        yield temporary
