"""LAMMPS data files, atom style sphere (docs.lammps.org, read_data)."""

import numpy as np

from demheat.io.packings.found import Found
from demheat.io.packings.text import Lines, floats, mark, marked, numerals, read_table, whole, write_rows
from demheat.packing.base import Packing

COLUMNS = ("id", "type", "diameter", "density", "x", "y", "z")
WANTED = {"x": 4, "y": 5, "z": 6, "diameter": 2, "id": 0}
IMAGES = ("ix", "iy", "iz")
# The same columns under the name that old LIGGGHTS gave them.
STYLES = ("sphere", "granular")


def write(packing: Packing, stream) -> None:
    """Write a packing: one type, density 1, ids from 1; the first line says what the format cannot hold."""
    stream.write(f"LAMMPS data file, {mark(packing)}\n\n{packing.number} atoms\n1 atom types\n\n")
    for axis, side in zip("xyz", packing.size, strict=True):
        stream.write(f"{numerals([0.0, side])} {axis}lo {axis}hi\n")
    stream.write("\nAtoms # sphere\n\n")
    ids = np.arange(1, packing.number + 1)
    write_rows(stream, "%d 1 %r 1.0 %r %r %r\n", ids, 2 * packing.radii, *packing.centers.T)


def read(lines: Lines, step: None) -> Found:
    """Read the Atoms section; all other sections are passed over."""
    own = marked(lines.take() or "")
    count, bounds = _header(lines)
    values, numbers = read_table(lines, lines.take_rows(count), WANTED, COLUMNS, extra=IMAGES)
    _check_end(lines, count)
    spheres = np.column_stack([values[name] for name in "xyz"] + [values["diameter"] / 2])
    return Found(
        spheres,
        bounds[:, 1] - bounds[:, 0],
        own[1] if own else None,
        origin=bounds[:, 0],
        domain=own[2] if own else None,
        ids=values["id"],
        numbers=numbers,
    )


def _header(lines):
    """Read up to the first row of the Atoms section; number of atoms and (3, 2) bounds in metres."""
    count, bounds = None, {}
    while (line := lines.take()) is not None:
        text, _, comment = (part.strip() for part in line.partition("#"))
        words = text.split()
        if words[:1] == ["Atoms"]:
            _check_section(lines, comment, count, bounds)
            blank = lines.take()
            if blank is None or blank.partition("#")[0].strip():
                raise lines.broken(repr(blank) if blank is not None else None, "a blank line after Atoms")
            return count, np.array([bounds[axis] for axis in "xyz"])
        if words[1:] == ["atoms"]:
            count = whole(lines, words[0], "the number of atoms", least=1)
        elif len(words) >= 4 and words[2] in ("xlo", "ylo", "zlo"):
            bounds[words[2][0]] = _bounds(lines, words)
        elif words[-3:] == ["xy", "xz", "yz"] and np.any(floats(lines, words, 3, "three tilts before xy xz yz")):
            raise lines.broken(repr(text), "a box without tilt: triclinic boxes are not read")
        elif words[-1:] in (["avec"], ["bvec"], ["cvec"]):
            raise lines.broken(repr(text), "xlo xhi, ylo yhi, zlo zhi: triclinic boxes are not read")
    raise lines.broken(None, "a section Atoms # sphere")


def _bounds(lines, words):
    low, high = floats(lines, words, 2, f"two numbers before {words[2]} {words[2][0]}hi")
    if not low < high:
        raise lines.broken(repr(" ".join(words)), f"{words[2]} < {words[2][0]}hi")
    return low, high


def _check_section(lines, comment, count, bounds):
    """Refuse an Atoms section whose style has no diameters, or that comes before what it needs."""
    if comment and comment not in STYLES:
        raise lines.broken(f"Atoms # {comment}", "Atoms # sphere: other atom styles have no diameters")
    lacking = ["number of atoms"] * (count is None) + [f"{axis}lo {axis}hi" for axis in "xyz" if axis not in bounds]
    if lacking:
        raise lines.broken("the section Atoms", f"{', '.join(lacking)} before it")


def _check_end(lines, count):
    """Refuse a section that holds more atoms than the header says."""
    while (line := lines.take()) is not None:
        text = line.partition("#")[0].strip()
        if text and not text[0].isalpha():
            raise lines.broken(repr(text), f"the end of the section: the header says {count} atoms")
        if text:
            return
