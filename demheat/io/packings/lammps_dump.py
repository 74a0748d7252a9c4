"""Dumps of LAMMPS and LIGGGHTS as text (docs.lammps.org, dump; cfdem.com, dump custom)."""

import numpy as np

from demheat.io.packings.found import Found
from demheat.io.packings.text import Lines, flags, floats, numerals, read_table, whole, write_rows
from demheat.packing.base import Packing

# Kinds of coordinates, best first: plain, unwrapped, scaled by the box, scaled and unwrapped.
KINDS = ("", "u", "s", "su")


def write(packing: Packing, stream) -> None:
    """Write a packing as one timestep, 0, with ids from 1; the domain is lost."""
    ends = flags(packing.periodic, "pp", "ff")
    stream.write(f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{packing.number}\nITEM: BOX BOUNDS {ends}\n")
    stream.write("".join(f"{numerals([0.0, side])}\n" for side in packing.size))
    stream.write("ITEM: ATOMS id type x y z radius\n")
    ids = np.arange(1, packing.number + 1)
    write_rows(stream, "%d 1 %r %r %r %r\n", ids, *packing.centers.T, packing.radii)


def read(lines: Lines, step: int | None) -> Found:
    """Read one timestep."""
    last, seen = None, []
    while (header := _header(lines)) is not None:
        rows = lines.take_rows(header["NUMBER OF ATOMS"])
        if header["TIMESTEP"] == step:
            return _atoms(lines, header, rows)
        last = header, rows
        seen.append(header["TIMESTEP"])
    if last is None or step is not None:
        some = ", ".join(map(str, seen[:10])) + (", ..." if len(seen) > 10 else "")
        raise lines.broken(None, f"timestep {step}: the file has {some}" if seen else "ITEM: TIMESTEP")
    return _atoms(lines, *last)


def _header(lines):
    """Read the items before the atoms as a dict by their names; None at the end of the file."""
    header = {}
    while (line := lines.take()) is not None:
        if not line.startswith("ITEM:"):
            if line:
                raise lines.broken(repr(line), "a line ITEM: ...")
            continue
        item = line[5:].strip()
        if item.startswith("ATOMS"):
            lacking = [name for name in ("TIMESTEP", "NUMBER OF ATOMS", "BOX BOUNDS") if name not in header]
            if lacking:
                raise lines.broken(repr(line), f"ITEM: {lacking[0]} before it")
            return header | {"columns": item.split()[1:], "line": lines.number}
        if item.startswith("BOX BOUNDS"):
            header["BOX BOUNDS"] = _bounds(lines, item.split()[2:])
        elif item in ("TIMESTEP", "NUMBER OF ATOMS"):
            least = 0 if item == "NUMBER OF ATOMS" else None
            header[item] = whole(lines, lines.take(), f"the integer of ITEM: {item}", least=least)
        else:
            # UNITS, TIME: one line each, not needed.
            lines.take()
    if header:
        raise lines.broken(None, "ITEM: ATOMS")
    return None


def _bounds(lines, words):
    """(3, 2) bounds in metres, and the periodicity or None."""
    if words[:2] == ["abc", "origin"]:
        raise lines.broken("BOX BOUNDS abc origin", "bounds without tilt: triclinic boxes are not read")
    tilted, number, rows = words[:3] == ["xy", "xz", "yz"], lines.number, []
    for axis in "xyz":
        line = lines.take()
        expected = f"{axis}lo {axis}hi, {axis}lo < {axis}hi"
        if line is None:
            raise lines.broken(None, expected)
        row = floats(lines, line.split(), 3 if tilted else 2, expected)
        if not row[0] < row[1]:
            raise lines.broken(repr(line), expected)
        if tilted and row[2]:
            raise lines.broken(repr(line), "a tilt of 0: triclinic boxes are not read")
        rows.append(row[:2])
    ends = words[3:] if tilted else words
    return np.array(rows), _periodic(lines, ends, number) if len(ends) == 3 else None


def _periodic(lines, ends, number):
    """Which axes are periodic: both ends of them are, or neither."""
    wrong = [end for end in ends if not (end == "pp" or (len(end) == 2 and set(end) <= set("fsm")))]
    if wrong:
        raise lines.broken(f"the boundary {wrong[0]!r}", "pp, or two of f, s, m, for each axis", number=number)
    return np.array([end == "pp" for end in ends])


def _atoms(lines, header, rows) -> Found:
    """Read the rows of one timestep."""
    if not rows.count:
        raise lines.broken("no atoms", f"some in timestep {header['TIMESTEP']}", number=header["line"])
    (bounds, periodic), names = header["BOX BOUNDS"], header["columns"]
    low, side = bounds[:, 0], bounds[:, 1] - bounds[:, 0]
    columns, scaled = _columns(lines, names, header["line"])
    values, numbers = read_table(lines, rows, columns, names)
    x = np.column_stack([values[axis] for axis in "xyz"])
    x = np.where(scaled, low + x * side, x)
    radii = values["radius"] if "radius" in values else values["diameter"] / 2
    said = {"step": header["TIMESTEP"]}
    return Found(np.column_stack((x, radii)), side, periodic, low, None, values.get("id"), numbers, said)


def _columns(lines, names, number):
    """Where the wanted columns are, as a dict, and which axes are scaled by the box."""
    columns, scaled = {}, []
    said = f"the columns {' '.join(names)}"
    for axis in "xyz":
        kind = next((kind for kind in KINDS if axis + kind in names), None)
        if kind is None:
            raise lines.broken(said, f"one of {', '.join(axis + kind for kind in KINDS)} among them", number=number)
        columns[axis] = names.index(axis + kind)
        scaled.append("s" in kind)
    sizes = [name for name in ("radius", "diameter") if name in names]
    if not sizes:
        raise lines.broken(said, "radius or diameter among them", number=number)
    columns[sizes[0]] = names.index(sizes[0])
    if "id" in names:
        columns["id"] = names.index("id")
    return columns, np.array(scaled)
