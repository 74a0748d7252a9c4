"""Rows of a comparison in one CSV file, written as soon as each method is done: a killed run loses that method only."""

import hashlib
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from demheat.declared import HOMES
from demheat.runtime.rows import RowFile
from demheat.terminal.commands.answers import Answer
from demheat.terminal.commands.knobs import Asked

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
    file = _file(path)
    rows = file.read()
    try:
        for row in rows.values():
            if tuple(row) != COLUMNS:
                raise ValueError(f"its columns are not {', '.join(COLUMNS)}")
            for name in NUMBERS:
                float(row[name] or "nan")
    except ValueError as error:
        raise file.error(error) from None
    return rows


def add(path: Path, key: tuple[str, ...], row: dict[str, str]) -> None:
    """Put a row into a file as it is now, whole or not at all; rows of another scene or other code are dropped."""

    def changed(rows):
        return ({other: old for other, old in rows.items() if other[-2:] == key[-2:]} | {key: row}).values()

    _file(path).change(changed)


def _file(path):
    return RowFile(path, "rows of a comparison", needs=COLUMNS, key=KEY, last=COLUMNS)


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
