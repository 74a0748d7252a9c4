"""Tables of spheres: a line of names, then a row for each, with commas, semicolons or tabs between its values."""

import csv
import io
import re
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import partial

from demheat.io.scenes.source import text_of
from demheat.io.scenes.units import LENGTH, factor_of, scaled
from demheat.io.words import nearest
from demheat.runtime.limits import free_memory

COLUMNS = ("x", "y", "z", "radius", "diameter", "material")
UNITS = tuple(LENGTH.suffixes)
# Bytes of memory that a byte of a table takes as rows of text and spheres; what is always read.
OBJECTS, ALWAYS = 30, 2**24
MARKS = "comma, semicolon, tab"
NAMED = "must begin with a line of names: x,y,z,radius, or with units x_mm,y_mm,z_mm,radius_mm"


def read_table(path, unit: str) -> tuple[Iterator[tuple], Callable[[Sequence[float], Sequence[float]], str]]:
    """Rows (place, centre and radius in metres, name of the material or None), and what says in which unit they are."""
    text = text_of(path, max(ALWAYS, int(min(free_memory() / OBJECTS, 2**62))))
    lines = [(k, line) for k, line in enumerate(text.splitlines(), start=1) if line.strip() and line.lstrip()[0] != "#"]
    if not lines:
        raise ValueError(f"{path}:1: is empty; {NAMED}")
    mark = next((mark for mark in ";\t," if mark in lines[0][1]), ",")
    names, *_ = csv.reader([lines[0][1]], delimiter=mark)
    columns = _columns(path, lines[0][0], [name.strip() for name in names], unit)
    if len(lines) == 1:
        raise ValueError(f"{path}:{lines[0][0]}: has names and no rows; must have a row for each sphere")
    reader = csv.reader(io.StringIO("\n".join(line for _, line in lines[1:])), delimiter=mark)
    rows = _parsed(path, [number for number, _ in lines[1:]], reader, columns, (len(names), mark))
    own = [columns[name][1] for name in "xyz"]
    return rows, partial(_read_in, unit if None in own else own[0], own[0] is not None)


def _read_in(unit, named, lengths, size):
    """In which unit numbers were read, and in which they would lie in a box."""
    numbers = [scaled(length, 1 / factor_of(unit, LENGTH)[0]) for length in lengths]
    fits = (each for each in UNITS if all(0 <= n * factor_of(each, LENGTH)[0] <= max(size) for n in numbers))
    wanted = next((each for each in fits if each != unit), None)
    said = (
        f"numbers were read in {unit}, as their columns are named" if named else f'they were read with unit = "{unit}"'
    )
    return said + (f', "{wanted}" would fit' if wanted else "")


def _columns(path, line, names, unit):
    """Where each column stands and its own unit, {name: (number, unit or None, factor)}."""
    known = {name: (name, None) for name in COLUMNS}
    known |= {f"{name}_{own}": (name, own) for name in COLUMNS[:5] for own in UNITS}
    _check_names(path, line, names)
    found = {}
    for k, name in enumerate(names):
        if name not in known:
            # What is no column of ours may stay, unless it looks like a slip.
            if near := nearest(name, known):
                raise ValueError(f"{path}:{line}: no such column, {name!r}{near}")
            continue
        column, own = known[name]
        if column in found:
            raise ValueError(f"{path}:{line}: column {name!r} is {column} once more; must be one of them")
        found[column] = (k, own, factor_of(own or unit, LENGTH)[0])
    both = "radius" in found, "diameter" in found
    lacking = [name for name in "xyz" if name not in found] + ([] if any(both) else ["radius"])
    if lacking:
        raise ValueError(f"{path}:{line}: columns {', '.join(names)!r}: must have {', '.join(lacking)} among them")
    if all(both):
        raise ValueError(f"{path}:{line}: columns radius and diameter; must be one of them")
    return found


def _check_names(path, line, names):
    """Raise ValueError for a first line of numbers, and for one whose names have but blanks between them."""
    if all(re.fullmatch(r"[-+\d.,eE\s]+", name) for name in names):
        raise ValueError(f"{path}:{line}: {', '.join(names)!r}: no names of columns; {NAMED}")
    if len(names) == 1 and len(names[0].split()) > 1:
        raise ValueError(
            f"{path}:{line}: {names[0]!r}: one column; must have one of {MARKS} between names and between values"
        )


def _parsed(path, numbers, reader, columns, layout):
    half = Fraction(1, 2) if "diameter" in columns else 1
    size = "diameter" if "diameter" in columns else "radius"
    width, mark = layout
    for number, row in zip(numbers, reader, strict=False):
        place = f"{path}:{number}"
        if len(row) != width:
            comma = "; a decimal comma is taken for the next value" if mark == "," and len(row) == 2 * width else ""
            raise ValueError(f"{place}: {len(row)} values; must be {width}, as there are names{comma}")
        values = []
        for name in ("x", "y", "z", size):
            k, _, factor = columns[name]
            values.append(_number(place, name, row[k], factor))
        values[3] = values[3] * float(half)
        name = row[columns["material"][0]].strip() if "material" in columns else None
        yield place, values, name


def _number(place, name, text, factor):
    try:
        # Python also takes underscores, and digits of all scripts.
        if "_" in text or not text.isascii():
            raise ValueError
        value = float(text)
    except ValueError:
        point = text.strip().replace(",", ".")
        hint = f", as {point}" if text.count(",") == 1 and re.fullmatch(r"[-+]?\d*\.\d+", point) else ""
        raise ValueError(f"{place}: {name} = {text.strip()!r}: must be a number with a decimal point{hint}") from None
    return scaled(value, factor) if factor != 1 else value
