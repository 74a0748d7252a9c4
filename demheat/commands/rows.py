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
from demheat.runtime.paths import locked, replaced

# What a row depends on: it is used again only if all of these are the same.
KEY = ("method", "knobs", "with_interval", "scene", "code")
COLUMNS = (
    *("method", "title", "knobs", "status", "conductivity", "lower", "upper", "how"),
    *("wall_s", "cpu_s", "interval_cpu_s", "unknowns", "iterations", "note", *KEY[2:]),
)
NUMBERS = ("conductivity", "lower", "upper", "wall_s", "cpu_s", "interval_cpu_s")


def key_of(each: Asked, scene_text: str, *, interval: bool) -> tuple[str, ...]:
    """What the row of a method depends on, `KEY`."""
    knobs = " ".join(f"{name}={value}" for name, value in sorted(each.knobs.items()))
    scene = hashlib.sha256(scene_text.encode()).hexdigest()[:12]
    return each.method.name, knobs, str(interval), scene, code()


def row_of(each: Asked, found: Answer, key: tuple[str, ...]) -> dict[str, str]:
    """A row, all of it text, floats to the last bit."""
    values = {**found._asdict(), **found.cost, "title": each.method.label, "note": "; ".join(found.notes)}
    values |= dict(zip(KEY, key, strict=True))
    return {name: _text(values.get(name)) for name in COLUMNS}


def read(path: Path) -> dict[tuple, dict[str, str]]:
    """Rows of a file by their keys; empty if there is none."""
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
    return {tuple(row[name] for name in KEY): row for row in rows}


def add(path: Path, key: tuple[str, ...], row: dict[str, str]) -> None:
    """Put a row into a file as it is now, whole or not at all; rows of another scene or other code are dropped.

    Others may do so at the same time: one waits for the other.
    """
    with locked(path.parent):
        rows = {other: old for other, old in read(path).items() if other[-2:] == key[-2:]} | {key: row}
        with replaced(path) as part, part.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows.values())


@cache
def code() -> str:
    """Digest of the sources of all methods and of what they are made of."""
    found = hashlib.sha256()
    for home in HOMES:
        for path in sorted(Path(find_spec(home).origin).parent.rglob("*.py")):
            found.update(path.read_bytes())
    return found.hexdigest()[:12]


def _text(value):
    if value is None or value != value:
        return ""
    return repr(value) if isinstance(value, float) else str(value)
