"""Arrays of NumPy, and raw bytes with a MetaImage header: mapped, nothing is unpacked."""

import math

import numpy as np

from demheat.io.images.source import check_there, mapped, told_in_one_line
from demheat.io.words import as_toml

# Types of a MetaImage.
ELEMENTS = {
    "MET_CHAR": "i1",
    "MET_UCHAR": "u1",
    "MET_SHORT": "i2",
    "MET_USHORT": "u2",
    "MET_INT": "i4",
    "MET_UINT": "u4",
    "MET_LONG_LONG": "i8",
    "MET_ULONG_LONG": "u8",
    "MET_FLOAT": "f4",
    "MET_DOUBLE": "f8",
}
# A header has some twenty lines.
LONGEST = 2**16
# They tell lengths in millimetres.
MILLI = 1e-3


def read_npy(path):
    """An array of NumPy."""
    # A changed header is parsed as Python: what it raises is not known.
    with told_in_one_line(path, "array of NumPy"):
        return np.lib.format.open_memmap(path, mode="r"), None


def read_meta(path):
    """Read a MetaImage: https://itk.org/Wiki/MetaIO/Documentation."""
    header, offset = _header(path)
    shape = _numbers(path, header, "DimSize", int)
    if len(shape) != 3 or min(shape) < 1:
        raise ValueError(f"{path}: DimSize = {header['dimsize']}: must be three whole numbers >= 1")
    kind = header.get("elementtype", "")
    if kind.upper() not in ELEMENTS:
        raise ValueError(f"{path}: ElementType = {kind or 'missing'}: must be one of {', '.join(ELEMENTS)}")
    if header.get("compresseddata", "false").lower() == "true" or header.get("elementnumberofchannels", "1") != "1":
        raise ValueError(f"{path}: packed data or several channels: must be plain bytes of one channel")
    large = header.get("binarydatabyteordermsb", header.get("elementbyteordermsb", "false")).lower() == "true"
    name = header.get("elementdatafile", "")
    if name.upper() != "LOCAL":
        if not name or "%" in name or name.upper() == "LIST":
            raise ValueError(f"{path}: ElementDataFile = {name or 'missing'}: must be one file, or LOCAL")
        data, offset = path.parent / name, _skipped(path, header)
        check_there(data)
    else:
        data = path
    spacing = "ElementSpacing" if "elementspacing" in header else "ElementSize"
    voxel = tuple(MILLI * h for h in _numbers(path, header, spacing, float)) if spacing.lower() in header else None
    if offset < 0:
        offset = data.stat().st_size - math.prod(shape) * np.dtype(ELEMENTS[kind.upper()]).itemsize
    return mapped(data, shape, dtype=(">" if large else "<") + ELEMENTS[kind.upper()], offset=offset), voxel


def _skipped(path, header):
    """Bytes before the data of a file of their own; -1 counts from its end."""
    (skip,) = _numbers(path, {"headersize": "0"} | header, "HeaderSize", int)
    if skip < -1:
        raise ValueError(f"{path}: HeaderSize = {skip}: must be a whole number >= -1")
    return skip


def _header(path):
    """Keys in small letters and their texts, and where the header ends."""
    with open(path, "rb") as file:
        start, found = file.read(LONGEST), {}
    offset = 0
    for number, line in enumerate(start.split(b"\n"), start=1):
        offset += len(line) + 1
        text = line.decode("latin-1").strip()
        key, equal, value = text.partition("=")
        if text and (not equal or not key.strip().isalnum()):
            raise ValueError(
                f"{path}:{number}: no line of a MetaImage: {as_toml(text)}; must be like DimSize = 64 64 64"
            )
        if text:
            found[key.strip().lower()] = value.strip()
        if key.strip().lower() == "elementdatafile":
            break
    return found, offset


def _numbers(path, header, key, kind):
    text = header.get(key.lower())
    try:
        return tuple(kind(word) for word in text.split())
    except (AttributeError, ValueError):
        raise ValueError(f"{path}: {key} = {text or 'missing'}: must be numbers with blanks between") from None
