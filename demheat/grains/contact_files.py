"""Contacts out of text dumps of LIGGGHTS and LAMMPS: `dump local` of `compute pair/gran/local` or `pair/local`."""

from collections.abc import Mapping, Sequence

import numpy as np

from demheat.grains.pairs import Contacts
from demheat.io.packings.text import Lines, broken, read_table, whole
from demheat.runtime.paths import checked_path

FORCE = ("fx", "fy", "fz")
KNOWN = ("id1", "id2", "radius", "area", *FORCE)


def read_contacts(
    path,
    *,
    columns: Mapping[str, int | str] | None = None,
    ids: Sequence[int] | None = None,
    step: int | None = None,
) -> Contacts:
    r"""Read which grains touch, and how large the contacts are or with which forces they press.

    Parameters
    ----------
    path : path
        Packed if it ends in .gz.
    columns : mapping of str to int or str, optional
        Where "id1" and "id2" stand, and of "radius" (m), "area" (m2) or "fx", "fy", "fz" (N, on the grain id1) those
        that are there: the column's name in the file, or its number from 1, as in {"id1": 1, "id2": 2, "area": 7}. By
        default the columns of these names.
    ids : (n,) sequence of int, optional
        Ids of the grains in the order of the packing, as `demheat.io.packings.ids` reads them; by default 1 to n.
    step : int, optional
        Timestep; the last in the file by default.

    Returns
    -------
    Contacts
        With radii, those of circles of that area; with forces; or with neither.

    Raises
    ------
    ValueError
        If an argument is not as described, or the file is broken: then its line, what was found and what expected.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from demheat import grains
    >>> dump = "ITEM: TIMESTEP\n9\nITEM: NUMBER OF ENTRIES\n1\nITEM: ENTRIES c_p[1] c_p[2] c_p[3]\n1 2 0.25\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "pairs.dump").write_text(dump)
    ...     found = grains.read_contacts(Path(folder, "pairs.dump"), columns={"id1": 1, "id2": 2, "radius": "c_p[3]"})
    >>> print(found.first, found.second, found.radius)
    [0] [1] [0.25]
    """
    path = checked_path(path)
    strange = [name for name in columns or {} if name not in KNOWN]
    if strange:
        raise ValueError(f"columns[{strange[0]!r}]: must be one of {', '.join(KNOWN)}")
    with Lines(path) as lines:
        names, number, rows = _step(lines, step)
        places = _places(lines, names, number, columns)
        # A dump without contacts is one, too.
        values, numbers = (
            read_table(lines, rows, places, names) if rows.count else (dict.fromkeys(places, np.zeros(0)), ())
        )
    first, second = (_grains(path, values[name], numbers, name, ids) for name in ("id1", "id2"))
    radius, force = values.get("radius"), None
    if radius is None and "area" in values:
        radius = np.sqrt(np.maximum(values["area"], 0.0) / np.pi)
    if all(name in values for name in FORCE):
        force = np.column_stack([values[name] for name in FORCE])
    return Contacts(first, second, radius, force)


def _step(lines, step):
    """Names of the columns, the line that says them, and the rows of one timestep."""
    last, seen, said = None, [], {}
    while (line := lines.take()) is not None:
        item = line.removeprefix("ITEM:").strip()
        if item in ("TIMESTEP", "NUMBER OF ENTRIES"):
            said[item] = whole(lines, lines.take(), f"the integer of ITEM: {item}", least=0)
        elif item.startswith("ENTRIES"):
            if len(said) < 2:
                raise lines.broken(repr(line), "ITEM: TIMESTEP and ITEM: NUMBER OF ENTRIES before it")
            last = item.split()[1:], lines.number, lines.take_rows(said["NUMBER OF ENTRIES"])
            if said["TIMESTEP"] == step:
                return last
            seen, said = [*seen, said["TIMESTEP"]], {}
        elif item.startswith("BOX BOUNDS"):
            for _ in range(3):
                lines.take()
        elif line.startswith("ITEM:"):
            # TIME, UNITS: one line each, not needed.
            lines.take()
        elif line:
            raise lines.broken(repr(line), "a line ITEM: ...")
    if last is None or step is not None:
        raise lines.broken(None, f"timestep {step}: the file has {seen[:10]}" if seen else "ITEM: ENTRIES")
    return last


def _places(lines, names, number, columns):
    """Number of each wanted column, from 0."""
    columns = {name: name for name in KNOWN if name in names} if columns is None else columns
    said = f"the columns {' '.join(names)}"
    places = {}
    for wanted, column in columns.items():
        if isinstance(column, int) and not isinstance(column, bool) and 1 <= column <= len(names):
            places[wanted] = column - 1
        elif column in names:
            places[wanted] = names.index(column)
        else:
            raise lines.broken(
                f"{len(names)} columns, {' '.join(names)}", f"column {column!r} of {wanted!r}", number=number
            )
    lacking = [name for name in ("id1", "id2") if name not in places]
    if lacking:
        raise lines.broken(said, f"{lacking[0]} among them, or columns={{{lacking[0]!r}: ...}}", number=number)
    return places


def _grains(path, found, numbers, name, ids):
    """Numbers of grains, from 0, by their ids."""
    if ids is None:
        return found.astype(np.int64) - 1
    ids = np.asarray(ids)
    order = np.argsort(ids, kind="stable")
    at = np.minimum(np.searchsorted(ids[order], found), len(ids) - 1)
    wrong = ids[order][at] != found
    if wrong.any():
        k = int(np.argmax(wrong))
        raise broken(path, numbers[k], f"{name} = {found[k]:g}", "the id of a grain of the packing")
    return order[at]
