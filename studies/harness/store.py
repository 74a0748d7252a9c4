"""Rows of a study in one CSV file, written row by row so that a killed run loses nothing."""

from __future__ import annotations

import csv
import os
import tempfile
from contextlib import contextmanager
from pathlib import Path

# What every row ends with, in this order; what a case and a run bring comes before, in order of appearance.
COST = ("wall_s", "cpu_s", "peak_mib", "base_mib", "peak_by")
TAIL = (
    *("unknowns", "iterations", "residual"),
    *COST,
    *("status", "note", "code", "commit", "when", "machine", "threads", "versions", "load", "triad_gbs"),
)


def case_key(case):
    """Name of a case: its parameters in order, as "contrast=10,method=fem,order=2"."""
    return ",".join(f"{name}={value}" for name, value in case.items())


def read_rows(path):
    """Rows of a CSV file as {case key: {column: text}}; empty if there is no such file."""
    path = Path(path)
    if not path.exists():
        return {}
    with path.open(newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


def write_rows(path, rows):
    """Write rows, an iterable of dicts, whole or not at all.

    Parameters
    ----------
    path : path
    rows : iterable of dict
        One for each case.
    """
    rows = list(rows)
    seen = list(dict.fromkeys(name for row in rows for name in row))
    columns = [name for name in seen if name not in TAIL] + [name for name in TAIL if name in seen]
    with replaced(path) as temporary, temporary.open("w", newline="") as file:
        writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


@contextmanager
def replaced(path):
    """Path of a temporary file that takes the place of `path` at the end, unless an exception comes first."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    # The suffix stays last: drawing libraries tell the format by it.
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}.", suffix=path.suffix)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def printed(study):
    """Numbers that the paper prints for a study, {quantity: value}, from studies/paper/STUDY.csv."""
    with (Path(__file__).parents[1] / "paper" / f"{study}.csv").open(newline="") as file:
        return {row["quantity"]: float(row["value"]) for row in csv.DictReader(file)}
