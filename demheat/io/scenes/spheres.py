"""Spheres of a scene from a table of their own: CSV, or a packing as LAMMPS, LIGGGHTS, YADE, OVITO and ASE write it."""

from __future__ import annotations

import csv
import io
from fractions import Fraction

from demheat.io.scenes.source import text_of
from demheat.io.scenes.units import LENGTH, PLAIN, RESISTANCE, factor_of, scaled
from demheat.io.words import as_toml, nearest, nearest_file
from demheat.runtime.limits import free_memory
from demheat.runtime.paths import checked_path
from demheat.scene import Sphere, Union

TABLES = (".csv", ".tsv", ".txt")
COLUMNS = ("x", "y", "z", "radius", "diameter", "material")
KEYS = dict.fromkeys(("file", "unit", "material", "radius_factor", "step", "join"), PLAIN)
KEYS |= {"offset": LENGTH, "resistance": RESISTANCE}
UNITS = tuple(LENGTH.suffixes)
# Bytes of memory that a byte of a table takes as rows of text and spheres; what is always read.
OBJECTS, ALWAYS = 30, 2**24
# Sides of a packing's box and the scene's differ by no more than this part: rounding of text in files.
SAME = 1e-6


def spheres_of(table, materials, default, size) -> list[tuple[Sphere | Union, str]]:
    """Spheres of an entry `file = ...`, each with the place where it stands; with `join` those that overlap as one.

    Coordinates of a packing count from the corner of its own box, which must be that of the scene unless an `offset`
    says where it lies; those of a file without a box count from the corner of the scene.
    """
    table.only(KEYS)
    path = checked_path(table.source.path.parent / table.text("file", ...))
    unit = table.text("unit", "m", among=UNITS)
    offset = table.vector("offset", LENGTH, (0.0, 0.0, 0.0))
    if len(offset) != 3:
        raise table.error(table.keys["offset"], f" = {as_toml(offset)}: must be three lengths")
    shrunk = table.number("radius_factor", PLAIN, 1.0)
    if not 0 < shrunk <= 1:
        raise table.error("radius_factor", f" = {as_toml(shrunk)}: must be a number > 0, at most 1")
    step = table.value("step", int, "an integer")
    factor = factor_of(unit, LENGTH)[0]
    tabular = path.suffix.lower() in TABLES
    if tabular and step is not None:
        raise table.error("step", f" = {step}: a table has one set of spheres; must be left out")
    _check_there(table, path)
    rows = _rows(path, factor) if tabular else _packed(table, path, factor, step, size)
    if tabular and _is_cell(table):
        rows = _within(rows, offset, size)
    join, spheres = (
        table.value("join", bool, "true or false", False),
        _made(table, rows, materials, default, offset, shrunk),
    )
    if not join:
        return spheres
    from demheat.io.scenes.joined import joined  # SciPy

    return joined(spheres, size, periodic=_is_cell(table))


def _is_cell(table):
    """Whether the scene of a table is a periodic cell."""
    return any(key.startswith("gradient") for key in table.source.values)


def _within(rows, offset, size):
    """The same rows; centres outside of a periodic cell, which would come in again elsewhere, are refused."""
    for place, numbers, name in rows:
        center = [c + d for c, d in zip(numbers, offset, strict=False)]
        if any(c < -SAME * side or c > (1 + SAME) * side for c, side in zip(center, size, strict=True)):
            cell = " x ".join(f"{side:.6g}" for side in size)
            raise ValueError(
                f"{place}: x y z = {', '.join(f'{c:.6g}' for c in center)} m: lies outside the periodic cell, 0 to "
                f"{cell} m; must lie in it, is the unit right?"
            )
        yield place, numbers, name


def _check_there(table, path):
    if not path.exists():
        told = f" = {as_toml(table.values['file'])}: there is no such file{nearest_file(path)}"
        raise table.error("file", told)


def _made(table, rows, materials, default, offset, shrunk):
    """Spheres of rows (place, centre and radius in metres, name of the material)."""
    found, resistance = [], table.number("resistance", RESISTANCE, 0.0)
    for place, numbers, name in rows:
        material = default if name is None else materials.get(name)
        if material is None and name is None:
            raise table.error("file", f": spheres of {place.partition(':')[0]} have no material; must be given here")
        if material is None:
            raise ValueError(f"{place}: material = {name!r}: must be one of [materials]{nearest(name, materials)}")
        center = tuple(c + d for c, d in zip(numbers, offset, strict=False))
        try:
            found.append((Sphere(center, numbers[3] * shrunk, material, resistance=resistance), place))
        except ValueError as error:
            if str(error).startswith("Sphere.resistance"):
                raise table.blamed(error) from None
            raise ValueError(f"{place}: {str(error).removeprefix('Sphere.')}") from None
    return found


def _packed(table, path, factor, step, size):
    """Rows of a packing; its reader says what is wrong with it."""
    from demheat.io.packings import read

    told = f" = {as_toml(table.values['file'])}"
    try:
        packing = read(path, step=step)
        if "box" in packing.provenance:
            # It has none: not that around its spheres, but that of the scene.
            sides = tuple(scaled(side, 1 / factor) for side in size)
            packing = read(path, step=step, size=sides, periodic=_is_cell(table))
    except OSError as error:
        raise table.error("file", f"{told}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise table.error("file", f"{told}: {error}") from None
    own = [scaled(side, factor) for side in packing.size.tolist()]
    if table.keys["offset"] is None and any(abs(a - b) > SAME * b for a, b in zip(own, size, strict=True)):
        box, wanted = (" x ".join(f"{side:.6g}" for side in sides) for sides in (own, size))
        valid = f"must be {wanted} m, as size is, by its unit, or have an offset"
        raise table.error("file", f"{told}: has a box of {box} m; {valid}")
    return _placed(path, packing, factor)


def _placed(path, packing, factor):
    for k, (center, radius) in enumerate(zip(packing.centers.tolist(), packing.radii.tolist(), strict=True)):
        yield f"{path}, sphere {k + 1}", [scaled(value, factor) for value in (*center, radius)], None


def _rows(path, factor):
    """Rows of a table with a line of names."""
    text = text_of(path, max(ALWAYS, int(min(free_memory() / OBJECTS, 2**62))))
    lines = [(k, line) for k, line in enumerate(text.splitlines(), start=1) if line.strip() and line.lstrip()[0] != "#"]
    if not lines:
        raise ValueError(f"{path}:1: is empty; must begin with a line of names: x,y,z,radius")
    mark = next((mark for mark in ";\t," if mark in lines[0][1]), ",")
    names, *_ = csv.reader([lines[0][1]], delimiter=mark)
    columns = _columns(path, lines[0][0], [name.strip() for name in names], factor)
    if len(lines) == 1:
        raise ValueError(f"{path}:{lines[0][0]}: has names and no rows; must have a row for each sphere")
    reader = csv.reader(io.StringIO("\n".join(line for _, line in lines[1:])), delimiter=mark)
    return _parsed(path, [number for number, _ in lines[1:]], reader, columns, len(names))


def _columns(path, line, names, factor):
    """Where each column stands and its unit, {name: (number, factor)}."""
    known = {name: (name, factor) for name in COLUMNS}
    known |= {f"{name}_{unit}": (name, factor_of(unit, LENGTH)[0]) for name in COLUMNS[:5] for unit in UNITS}
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
        found[column] = (k, own)
    both = "radius" in found, "diameter" in found
    lacking = [name for name in "xyz" if name not in found] + ([] if any(both) else ["radius"])
    if lacking:
        raise ValueError(f"{path}:{line}: columns {', '.join(names)!r}: must have {', '.join(lacking)} among them")
    if all(both):
        raise ValueError(f"{path}:{line}: columns radius and diameter; must be one of them")
    return found


def _parsed(path, numbers, reader, columns, width):
    half = Fraction(1, 2) if "diameter" in columns else 1
    size = "diameter" if "diameter" in columns else "radius"
    for number, row in zip(numbers, reader, strict=False):
        place = f"{path}:{number}"
        if len(row) != width:
            raise ValueError(f"{place}: {len(row)} values; must be {width}, as there are names")
        values = []
        for name in ("x", "y", "z", size):
            k, factor = columns[name]
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
        raise ValueError(f"{place}: {name} = {text.strip()!r}: must be a number with a decimal point") from None
    return scaled(value, factor) if factor != 1 else value
