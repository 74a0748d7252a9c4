"""Packings as files: what LAMMPS, LIGGGHTS, YADE, OVITO, ASE and ParaView write and read.

Lengths are taken as metres: `packing.scaled(1e-3)` mends a file in millimetres. Floats are written as the shortest text
that reads back to the same bits, so what a format can hold comes back bit for bit. What it cannot hold:

============  =============================  =======================================================================
format        suffixes                       kept
============  =============================  =======================================================================
lammps-data   .data .lmp                     all but provenance; type 1 and density 1 are written
lammps-dump   .dump .lammpstrj .liggghts     all but provenance and domain
yade          .yade                          all but provenance (the box as a comment that YADE passes over)
extxyz        .xyz .extxyz                   all but provenance
npz           .npz                           all
vtp           .vtp                           all but provenance; links as lines beside
============  =============================  =======================================================================

Text may be packed: a further suffix .gz.
"""

import gzip
import io
import os
import zlib
from collections.abc import Sequence
from numbers import Integral

import numpy as np

from demheat.io.packings import arrays, extxyz, lammps_data, lammps_dump, segments, vtp, vtp_read, yade
from demheat.io.packings.found import rank_of, to_packing
from demheat.io.packings.text import Lines, broken
from demheat.packing.base import Packing, check_box, make_packing
from demheat.packing.gate import check_packing
from demheat.runtime.paths import checked_path, replaced
from demheat.scene.bodies import check_name

__all__ = ["ids", "read", "write"]

TEXTS = {"lammps-data": lammps_data, "lammps-dump": lammps_dump, "yade": yade, "extxyz": extxyz}
SUFFIXES = {
    "lammps-data": (".data", ".lmp"),
    "lammps-dump": (".dump", ".lammpstrj", ".liggghts"),
    "yade": (".yade",),
    "extxyz": (".xyz", ".extxyz"),
    "npz": (".npz",),
    "vtp": (".vtp",),
}


def write(packing: Packing, path, *, format: str | None = None, network=None, temperature=None) -> None:
    """Write a packing into a file; an interrupted write leaves no file, and an old one as it was.

    Parameters
    ----------
    packing : Packing
        Sphere i gets the id i + 1 where the format has ids.
    path : path
    format : str, optional
        One of the formats above; by default as the suffix says.
    network : Network, optional
        Of the packing's particles, in the same order; only for vtp. Each pair becomes one line with its conductance,
        W/K; links to periodic images are left out (and counted in the field data `links_cut`), links to walls too.
    temperature : (n,) array_like, K or degrees Celsius, optional
        One per sphere, NaN where there is none; only for vtp. Each line p-q (p before q) then has its heat flow
        H (T_q - T_p), W: what p receives (Haddad et al. 2021, eq. 2).

    Raises
    ------
    ValueError
        If an argument is not as described, or the suffix does not tell the format.

    Examples
    --------
    >>> import tempfile
    >>> from demheat.io import packings
    >>> from demheat.packing.relax import relax
    >>> packing = relax(200, seed=0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     packings.write(packing, f"{folder}/packing.dump")
    ...     again = packings.read(f"{folder}/packing.dump")
    >>> bool((again.centers == packing.centers).all())
    True
    """
    path, name, packed = _format(path, format)
    check_packing(packing)
    # What is read back lies inside to the last bit.
    make_packing(*packing[:5], domain=packing.domain)
    if name != "vtp" and not (network is None and temperature is None):
        raise ValueError(f"network, temperature: the format {name} has no place for them; must be None, or use vtp")
    drawn = segments.segments_of(packing, network, temperature)
    with replaced(path) as part, open(part, "xb") as stream:
        if name == "vtp":
            vtp.write(packing, stream, drawn)
        elif name == "npz":
            arrays.write(packing, stream)
        else:
            _write_text(TEXTS[name], packing, stream, packed)


def read(
    path: str | os.PathLike,
    *,
    format: str | None = None,
    size: Sequence[float] | None = None,
    periodic: bool | Sequence[bool] | None = None,
    domain: str | None = None,
    step: int | None = None,
    order: str = "given",
) -> Packing:
    """Read a packing from a file.

    Parameters
    ----------
    path : path
    format : str, optional
        One of the formats above; by default as the suffix says.
    size : (3,) sequence of float, m, optional
        Box of a file that has none (YADE, VTP or XYZ of others): it is [0, size] in the coordinates of the file.
        Without it the box is the bounding box of the spheres, with walls; provenance["box"] says which it was.
    periodic : bool or three bools, optional
        Goes before what the file says. LAMMPS data of others do not say, and need it.
    domain : str, optional
        As in `Packing`; by default what the file says, else "box".
    step : int, optional
        Timestep of a dump, or number of the frame (from 0) of extended XYZ; by default the last in the file.
    order : {"given", "morton"}
        "given": by rising id, or as in the file where there are no ids, so that sphere i is known to its maker and a
        packing written and read comes back row by row. "morton": as `make_packing` sorts, which keeps neighbours near
        in memory: worth it for large packings of others.

    Returns
    -------
    Packing
        The corner of the box is moved to 0; on periodic axes centres are wrapped into it.

    Raises
    ------
    ValueError
        If an argument is not as described, or the file is broken: then its line (text), what was found there and what
        was expected.

    Examples
    --------
    >>> import tempfile
    >>> from demheat.io import packings
    >>> table = '''ITEM: TIMESTEP
    ... 0
    ... ITEM: NUMBER OF ATOMS
    ... 2
    ... ITEM: BOX BOUNDS pp pp pp
    ... 0 1
    ... 0 1
    ... 0 1
    ... ITEM: ATOMS id x y z radius
    ... 1 0.2 0.5 0.5 0.1
    ... 2 0.7 0.5 0.5 0.2'''
    >>> with tempfile.NamedTemporaryFile("w", suffix=".dump") as file:
    ...     _ = file.write(table)
    ...     file.flush()
    ...     packings.read(file.name).radii
    array([0.1, 0.2])
    """
    path, name, _ = _format(path, format)
    _check_knobs(name, size, periodic, domain, step, order)
    if name in TEXTS:
        found = _read_text(TEXTS[name], path, step)
    else:
        found = (vtp_read if name == "vtp" else arrays).read(path)
    if name != "npz":
        found = found._replace(
            provenance={"algorithm": "read", "file": path.name, "format": name} | (found.provenance or {})
        )
    return to_packing(found, path, size=size, periodic=periodic, domain=domain, order=order)


def ids(path: str | os.PathLike, *, format: str | None = None, step: int | None = None) -> np.ndarray:
    r"""Ids of the spheres of a file in the order in which `read` gives them: rising.

    Parameters
    ----------
    path : path
    format, step
        As those of `read`.

    Returns
    -------
    (n,) int array

    Raises
    ------
    ValueError
        As `read`; or if the file has no ids.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from demheat.io import packings
    >>> lines = ["3", 'Lattice="2 0 0 0 2 0 0 0 2" Properties=id:I:1:pos:R:3:radius:R:1']
    >>> lines += ["7 0.5 0.5 0.5 0.2", "2 1.5 0.5 0.5 0.2", "5 0.5 1.5 0.5 0.2"]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "grains.xyz").write_text("\n".join(lines))
    ...     packings.ids(Path(folder, "grains.xyz")).tolist()
    [2, 5, 7]
    """
    path, name, _ = _format(path, format)
    _check_knobs(name, None, None, None, step, "given")
    found = _read_text(TEXTS[name], path, step) if name in TEXTS else None
    if found is None or found.ids is None:
        raise ValueError(f"path = {str(path)!r}: must be a file whose spheres have ids; those of this one have none")
    return found.ids[rank_of(found, path)].astype(np.int64)


def _format(path, format):
    """Path, name of the format, and whether the text is packed."""
    path = checked_path(path)
    packed = path.suffix.lower() == ".gz"
    suffix = (path.with_suffix("") if packed else path).suffix.lower()
    name = format
    if format is None:
        name = next((name for name, suffixes in SUFFIXES.items() if suffix in suffixes), None)
    if not isinstance(name, str) or name not in SUFFIXES:
        known = "; ".join(f"{name} ({' '.join(suffixes)})" for name, suffixes in SUFFIXES.items())
        said = f"path = {str(path)!r}: the suffix tells no format, and " if format is None else ""
        raise ValueError(f"{said}format = {format!r}: must be one of {known}")
    if packed and name not in TEXTS:
        raise ValueError(
            f"path = {str(path)!r}: only text is packed, one of {', '.join(TEXTS)}; {name} must end plainly"
        )
    return path, name, packed


def _check_knobs(name, size, periodic, domain, step, order):
    check_box((1.0, 1.0, 1.0) if size is None else size, False if periodic is None else periodic)
    if domain is not None:
        check_name("domain", domain)
    if step is not None and name not in ("lammps-dump", "extxyz"):
        raise ValueError(f"step = {step!r}: a file of format {name} has one packing; must be None")
    if step is not None and (not isinstance(step, Integral) or isinstance(step, bool)):
        raise ValueError(f"step = {step!r}: must be an integer")
    if order not in ("given", "morton"):
        raise ValueError(f"order = {order!r}: must be 'given' or 'morton'")


def _write_text(module, packing, stream, packed):
    # Level 1: digits of random numbers shrink hardly more at 6, in three times the time. No name and no time in the
    # archive: equal packings make equal files.
    raw = gzip.GzipFile("", "wb", 1, stream, 0) if packed else stream
    text = io.TextIOWrapper(raw, encoding="utf-8", newline="\n")
    module.write(packing, text)
    text.flush()
    text.detach()
    if packed:
        raw.close()


def _read_text(module, path, step):
    with Lines(path) as lines:
        try:
            return module.read(lines, step)
        except (EOFError, gzip.BadGzipFile, zlib.error) as error:
            raise broken(path, lines.number + 1, f"broken packed data ({error})", "a whole .gz file") from None
