"""Extended XYZ of OVITO and ASE (ovito.org, XYZ file reader; ase.io.extxyz)."""

import re

import numpy as np

from demheat.io.packings.found import Found
from demheat.io.packings.text import Lines, flags, floats, numerals, read_table, whole, write_rows
from demheat.packing.base import Packing
from demheat.scene.bodies import ROUND_AXES

# Names begin where words do: else a long word would be tried from each of its letters.
PAIR = re.compile(r"""(?<![\w-])([\w-]+)\s*=\s*(?:"([^"]*)"|'([^']*)'|([^\s"']+))""")
MOST_COLUMNS = 10_000
TRUE, FALSE = ("T", "TRUE", "1"), ("F", "FALSE", "0")


def write(packing: Packing, stream) -> None:
    """Write a packing: species X, ids from 1; the key `domain` is ours, readers pass over it."""
    lattice = numerals(np.diag(packing.size))
    stream.write(
        f'{packing.number}\nLattice="{lattice}" Origin="0.0 0.0 0.0" Properties=species:S:1:pos:R:3:radius:R:1:id:I:1 '
        f'pbc="{flags(packing.periodic)}" domain={packing.domain}\n'
    )
    ids = np.arange(1, packing.number + 1)
    write_rows(stream, "X %r %r %r %r %d\n", *packing.centers.T, packing.radii, ids)


def read(lines: Lines, step: int | None) -> Found:
    """Read one frame."""
    last, frame = None, 0
    while (line := lines.take()) is not None:
        if not line and frame:
            continue
        count = whole(lines, line, "the number of spheres of a frame", least=1)
        line = lines.take()
        if line is None:
            raise lines.broken(None, "a line with Lattice=... Properties=...")
        last = _header(lines, line), lines.take_rows(count), frame
        if frame == step:
            return _frame(lines, *last)
        frame += 1
    if last is None or step is not None:
        raise lines.broken(None, f"frame {step}: the file has {frame}" if frame else "the number of spheres")
    return _frame(lines, *last)


def _header(lines, line):
    """Read the line before the rows: names of the columns, cell, and domain where it is ours."""
    keys = {key.lower(): a or b or c for key, a, b, c in PAIR.findall(line)}
    # Somebody else's key of that name means something else.
    domain = keys.get("domain") if keys.get("domain") in ROUND_AXES else None
    return _names(lines, keys.get("properties")), _cell(lines, keys), domain


def _frame(lines, header, rows, frame) -> Found:
    """Read the rows of one frame."""
    names, (size, origin, periodic), domain = header
    lower = [name.lower() for name in names]
    columns = {axis: names.index(f"pos{k}") for k, axis in enumerate("xyz")}
    columns["radius"] = lower.index("radius")
    if "id" in lower:
        columns["id"] = lower.index("id")
    values, numbers = read_table(lines, rows, columns, names)
    spheres = np.column_stack([values[name] for name in ("x", "y", "z", "radius")])
    return Found(spheres, size, periodic, origin, domain, values.get("id"), numbers, {"frame": frame})


def _names(lines, properties):
    """Name of each column; those of a property of several columns end in their numbers."""
    expected = "Properties=... with pos:R:3 and radius:R:1"
    fields = (properties or "").split(":")
    if properties is None or len(fields) % 3:
        raise lines.broken(f"Properties={properties}" if properties else "no Properties", expected)
    names = []
    for name, _, width in zip(fields[::3], fields[1::3], fields[2::3], strict=True):
        width = whole(lines, width, expected, least=1)
        if len(names) + width > MOST_COLUMNS:
            raise lines.broken(f"Properties={properties}", f"{MOST_COLUMNS} columns at most")
        names += [name] if width == 1 else [f"{name}{k}" for k in range(width)]
    if "pos2" not in names or "radius" not in [name.lower() for name in names]:
        raise lines.broken(f"Properties={properties}", expected)
    return names


def _cell(lines, keys):
    """Sides, corner and periodicity of the box; no sides and no periodicity without a lattice."""
    if "lattice" not in keys:
        return None, (0.0, 0.0, 0.0), None
    expected = "Lattice of nine numbers, along the axes and > 0: other cells are not read"
    lattice = floats(lines, keys["lattice"].split(), 9, expected).reshape(3, 3)
    size = np.diag(lattice)
    if np.any(size <= 0) or np.any(lattice != np.diag(size)):
        raise lines.broken(f'Lattice="{keys["lattice"]}"', expected)
    origin = floats(lines, keys.get("origin", "0 0 0").split(), 3, "Origin of three numbers")
    words = [word.upper() for word in keys.get("pbc", "T T T").split()]
    if len(words) != 3 or set(words) - {*TRUE, *FALSE}:
        raise lines.broken(f'pbc="{keys["pbc"]}"', 'pbc of three flags, such as "T T F"')
    return size, origin, np.array([word in TRUE for word in words])
