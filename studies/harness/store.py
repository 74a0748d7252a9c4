"""Rows of a study in one CSV file, written row by row so that a killed run loses nothing."""

import math
import tempfile
from contextlib import suppress
from pathlib import Path

from demheat.runtime.rows import RowFile

# What every row ends with, in this order; what a case and a run bring comes before, in order of appearance.
COST = ("wall_s", "cpu_s", "cpu_spread", "repeats", "peak_mib", "base_mib", "peak_by")
# Seconds from the start of a row's process to its end: what a record takes, whatever its costs are.
MADE = "made_s"
# Where values are from, and of which machine, that were made anew without their costs; when they were last made again
# and found the same; which code found another row of their group the same; and which one found other values.
VALUES = (
    *("values_commit", "values_when", "values_machine"),
    *("replayed_commit", "replayed_when", "borne_commit", "moved_commit"),
)
TAIL = (
    *("unknowns", "iterations", "residual"),
    *COST,
    *("status", "note", "commit", "when", "machine", "host", "threads", "versions"),
    *("load", "beside", "noise", "compile_s", "triad_gbs", MADE),
    *VALUES,
)
# Bytes that must be free before a run begins.
ROOM = 2**20


def case_key(case):
    """Name of a case: its parameters in order, as "contrast=10,method=fem,order=2"."""
    return ",".join(f"{name}={value}" for name, value in case.items())


def rows_of(path):
    """The file of a study's rows."""
    return RowFile(Path(path), "rows of a study as CSV", last=TAIL)


def read_rows(path):
    """Rows of a CSV file as {case key: {column: text}}; empty if there is no such file."""
    return rows_of(path).read()


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


def write_rows(path, rows):
    """Write rows, an iterable of dicts, whole or not at all, into a folder that is made if it is not there."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    rows_of(path).write(rows)


def add_rows(path, rows, keys):
    """Add rows to those of a file as it is now: other runs may have added theirs."""
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        rows_of(path).put(rows, order=keys)
    except (OSError, ValueError) as error:
        rescued = Path(tempfile.mkdtemp(prefix="demheat-rows-")) / path.name
        with suppress(ValueError, OSError):
            rows = read_rows(path) | rows
        write_rows(rescued, rows.values())
        raise ValueError(f"{path}: cannot be written: {error}; the rows are in {rescued}") from None
