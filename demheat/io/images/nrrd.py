"""NRRD: its header as pynrrd reads it, the data beside or behind it in no more bytes than the header tells of."""

import io
import math
import warnings

import numpy as np

from demheat.io.images.packed import unpacked
from demheat.io.images.source import UNITS, check_there, mapped, told_in_one_line
from demheat.runtime.limits import check_free

# Bytes of a header, and of a line that is passed over at once.
LONGEST = 2**20
NEEDED = ("type", "dimension", "sizes", "encoding")
PACKED = {"gzip": "gzip", "gz": "gzip", "bzip2": "bz2", "bz2": "bz2"}
TEXT = ("ascii", "text", "txt")


def read(path):
    """An image, and the edges of a voxel where they are told."""
    try:
        import nrrd
    except ImportError:
        raise ImportError(f"{path}: NRRD needs pynrrd; pip install pynrrd, or demheat[images]") from None
    with told_in_one_line(path, "NRRD"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with open(path, "rb") as file:
            start = io.BytesIO(file.read(LONGEST))
        header = nrrd.read_header(start)
        lacking = [name for name in NEEDED if name not in header]
        if lacking or start.tell() >= LONGEST:
            what = f"says nothing of {', '.join(lacking)}" if lacking else f"has {LONGEST} bytes or more"
            raise ValueError(f"{path}: no NRRD, or a part of one: its header {what}")
        # An array of one number, to have the type that the header means.
        alone = {name: header[name] for name in ("type", "endian") if name in header}
        alone |= {"endian": "little"} if header["encoding"].lower() in TEXT else {}
        alone |= {"dimension": 1, "sizes": np.array([1]), "encoding": "raw"}
        kind = nrrd.read_data(alone, io.BytesIO(bytes(8))).dtype
        return _data(path, header, start.tell(), kind), _spacings(header)


def _data(path, header, offset, kind):
    """The array that a header tells of; behind the header, or in a file of its own."""
    sizes = tuple(map(int, header["sizes"]))
    count = math.prod(sizes)
    if len(sizes) != header["dimension"] or min(sizes, default=0) < 1:
        raise ValueError(f"{path}: sizes {sizes} of {header['dimension']} dimensions: must be one each, all >= 1")
    check_free(path, count * kind.itemsize)
    name = header.get("datafile", header.get("data file"))
    data, offset = (path.parent / name, 0) if name else (path, offset)
    check_there(data)
    lines = header.get("lineskip", header.get("line skip", 0))
    skip = header.get("byteskip", header.get("byte skip", 0))
    with open(data, "rb") as file:
        file.seek(offset)
        _pass_over(path, file, lines)
        return _array(path, data, file, sizes, kind, header["encoding"].lower(), skip)


def _array(path, data, file, sizes, kind, encoding, skip):
    """The array from where a file stands."""
    count = math.prod(sizes)
    if encoding in PACKED:
        if skip:
            raise ValueError(f"{path}: byte skip = {skip} in packed data: must be 0")
        return unpacked(data, file, PACKED[encoding], count * kind.itemsize).view(kind).reshape(sizes, order="F")
    if skip < (-1 if encoding == "raw" else 0):
        raise ValueError(f"{path}: byte skip = {skip}: must be a number of bytes, or -1 before raw data")
    there, needed = data.stat().st_size, count * kind.itemsize
    offset = there - needed if skip == -1 else file.tell() + skip
    if encoding == "raw":
        if offset + needed < there:
            raise ValueError(f"{path}: {there - offset} bytes of data, of which its header tells of {needed}")
        return mapped(data, sizes, dtype=kind, offset=offset)
    if encoding not in TEXT:
        raise ValueError(f"{path}: encoding = {encoding}: must be one of raw, {', '.join([*PACKED, *TEXT])}")
    file.seek(offset)
    # One more than there must be.
    labels = np.fromfile(file, kind, count=count + 1, sep=" ")
    if len(labels) != count:
        raise ValueError(f"{path}: {min(len(labels), count)} or more numbers; its header tells of {count}")
    return labels.reshape(sizes, order="F")


def _pass_over(path, file, lines):
    """Read lines of any length."""
    for _ in range(lines):
        while not (line := file.readline(LONGEST)).endswith(b"\n"):
            if not line:
                raise ValueError(f"{path}: line skip = {lines}: there are fewer lines")


def _spacings(header):
    """Edges of a voxel in metres, or None where lengths or their unit are not told."""
    units = header.get("space units", header.get("units"))
    if units is None or len(units) < 3 or any(unit not in UNITS for unit in units[:3]):
        return None
    if "space directions" in header:
        lengths = np.linalg.norm(np.asarray(header["space directions"], float), axis=1)
    elif "spacings" in header:
        lengths = np.asarray(header["spacings"], float)
    else:
        return None
    return tuple(float(h) * UNITS[unit] for h, unit in zip(lengths, units, strict=False))
