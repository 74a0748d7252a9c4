"""Rows of a comparison in one CSV file, written as soon as each method is done: a killed run loses that method only."""

from __future__ import annotations

import csv
import hashlib
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from demheat.commands.answers import Answer
from demheat.commands.knobs import Asked
from demheat.declared import HOMES
from demheat.files.whole import replaced

COLUMNS = (
    *("method", "title", "knobs", "status", "conductivity", "lower", "upper", "how"),
    *("wall_s", "cpu_s", "interval_cpu_s", "unknowns", "iterations", "note", "made_of"),
)
NUMBERS = ("conductivity", "lower", "upper", "wall_s", "cpu_s", "interval_cpu_s")


def row_of(each: Asked, found: Answer, made_of: str) -> dict[str, str]:
    """A row, all of it text, floats to the last bit.

    Parameters
    ----------
    each : Asked
    found : Answer
    made_of : str
        See `made_of`.
    """
    values = {
        "method": each.method.name,
        "title": each.method.label,
        "knobs": " ".join(f"{name}={value}" for name, value in each.knobs.items()),
        "status": found.status,
        "conductivity": found.conductivity,
        "lower": found.lower,
        "upper": found.upper,
        "how": found.how,
        **found.cost,
        "note": "; ".join(found.notes),
        "made_of": made_of,
    }
    return {name: _text(values.get(name)) for name in COLUMNS}


def read(path: Path) -> dict[str, dict[str, str]]:
    """Rows of a file by what they are made of; empty if there is none.

    Parameters
    ----------
    path : Path

    Raises
    ------
    ValueError
        If it holds anything else.
    """
    if not path.exists():
        return {}
    try:
        with path.open(newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file, strict=True)
            rows = list(reader)
        if reader.fieldnames != list(COLUMNS) or any(None in row or None in row.values() for row in rows):
            raise ValueError(f"its columns are not {', '.join(COLUMNS)}")
        for row in rows:
            for name in NUMBERS:
                float(row[name] or "nan")
    except (OSError, ValueError, csv.Error) as error:
        raise ValueError(f"{path}: must hold rows of a comparison: {error}; mend it or move it away") from None
    return {row["made_of"]: row for row in rows}


def write(path: Path, rows) -> None:
    """Write rows, whole or not at all.

    Parameters
    ----------
    path : Path
    rows : iterable of dict
    """
    with replaced(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def made_of(scene_text: str, each: Asked, interval: bool) -> str:
    """Digest of all that a row depends on: scene, method, knobs, whether the interval is asked for, and the code.

    Parameters
    ----------
    scene_text : str
        The scene as a file.
    each : Asked
    interval : bool
    """
    parts = (scene_text, each.method.name, repr(sorted(each.knobs.items(), key=str)), str(interval), code())
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]


@cache
def code() -> str:
    """Digest of the sources of all methods and of what they are made of."""
    found = hashlib.sha256()
    for home in HOMES:
        for path in sorted(Path(find_spec(home).origin).parent.rglob("*.py")):
            found.update(path.read_bytes())
    return found.hexdigest()


def _text(value):
    if value is None or value != value:
        return ""
    return repr(value) if isinstance(value, float) else str(value)
