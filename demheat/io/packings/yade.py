"""Text files of YADE: x y z r (yade-dem.org, yade.export.text, textExt and yade.ymport.textExt)."""

import numpy as np

from demheat.io.packings.found import Found
from demheat.io.packings.text import Lines, mark, marked, read_table, write_rows
from demheat.packing.base import Packing

LAYOUTS = {
    "x_y_z_r": ("x", "y", "z", "r"),
    "x_y_z_r_matId": ("x", "y", "z", "r", "matId"),
    "id_x_y_z_r_matId": ("id", "x", "y", "z", "r", "matId"),
    # Attributes of any number follow: the first row tells how many.
    "x_y_z_r_attrs": ("x", "y", "z", "r"),
}


def write(packing: Packing, stream) -> None:
    """Write a packing; a comment that YADE passes over holds the box."""
    stream.write(f"#format x_y_z_r\n# {mark(packing)}\n")
    write_rows(stream, "%r\t%r\t%r\t%r\n", *packing.centers.T, packing.radii)


def read(lines: Lines, step: None) -> Found:
    """Read spheres; the box is known only where `write` has noted it."""
    layout, own, extra = "x_y_z_r", None, ()
    while (line := lines.take()) is not None and (not line or line.startswith("#")):
        own = own or marked(line)
        if line.startswith("#format"):
            layout = (line.split()[1:] or [""])[0]
            if layout not in LAYOUTS:
                raise lines.broken(repr(line), f"#format and one of {', '.join(LAYOUTS)}")
    names = LAYOUTS[layout]
    if line is not None:
        lines.put_back(line)
        if layout == "x_y_z_r_attrs":
            extra = tuple(f"attribute{k}" for k in range(len(line.split()) - len(names)))
    columns = {name: names.index(name) for name in ("x", "y", "z", "r", "id") if name in names}
    values, numbers = read_table(lines, lines.take_rows(), columns, names, extra=extra)
    spheres = np.column_stack([values[name] for name in "xyzr"])
    size, periodic, domain = own or (None, None, None)
    return Found(spheres, size, periodic, domain=domain, ids=values.get("id"), numbers=numbers)
