"""Images of labels from files: NumPy, TIFF, raw bytes with a MetaImage header, NRRD, zarr.

=========== ====================================================================================================
suffix      what is read
=========== ====================================================================================================
.npy        an (nx, ny, nz) array, mapped into memory
.tif .tiff  a stack of pages of one channel: columns are x, rows y, pages z; mapped if neither packed nor in pieces
.mhd .mha   MetaImage: a header as text, with the raw bytes in a file of their own or behind it, x fastest; mapped
.nrrd .nhdr as pynrrd reads it, x fastest
.zarr       a folder with one (nx, ny, nz) array, read a layer of chunks at a time
=========== ====================================================================================================

What is mapped or in chunks passes slab by slab into the smallest type that holds the labels.
"""

from __future__ import annotations

import logging
import math
import warnings
from collections.abc import Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from demheat.files.source import nearest_file, shown
from demheat.limits import check_free
from demheat.paths import checked_path
from demheat.scene import Image, Material
from demheat.scene.inputs import one_line

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
# What a folder is called that zarr reads.
CHUNKED = ".zarr"
# A header has some twenty lines.
LONGEST = 2**16
# MetaImages tell lengths in millimetres; units of an NRRD.
MILLI = 1e-3
UNITS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "\N{MICRO SIGN}m": 1e-6, "micron": 1e-6, "microns": 1e-6, "nm": 1e-9}


def read_image(path, *, materials: Mapping[int, Material], voxel=None) -> Image:
    """Read an image.

    Parameters
    ----------
    path : path
        Its suffix tells the format.
    materials : mapping of int to Material
        Of each label.
    voxel : (3,) sequence of float, or float, m, optional
        Edges of a voxel; needed unless a MetaImage or an NRRD tells them.

    Returns
    -------
    Image

    Raises
    ------
    ValueError
        If the file is none of these, or broken, or does not fit into memory; or as `Image`. One line with the path.
    ImportError
        If a library that the format needs is not installed.

    Examples
    --------
    >>> import tempfile, numpy as np
    >>> from pathlib import Path
    >>> from demheat import Material, files
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.save(Path(folder, "rock.npy"), np.arange(8).reshape(2, 2, 2) % 2)
    ...     image = files.read_image(
    ...         Path(folder, "rock.npy"), voxel=5e-6, materials={0: Material(0.2), 1: Material(2.0)}
    ...     )
    >>> image.shape, image.fractions.tolist()
    ((2, 2, 2), [0.5, 0.5])
    """
    path = checked_path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        beside = path.with_suffix(".mhd")
        hint = f"; raw bytes need a header, such as {beside.name}" if path.suffix.lower() == ".raw" else ""
        raise ValueError(f"{path}: must end in one of {', '.join(READERS)}{hint}")
    _check_there(path)
    try:
        labels, own = reader(path)
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror or error}") from None
    if voxel is None and own is None:
        raise ValueError(f"{path}: does not tell the edges of a voxel; voxel must be given, in metres")
    try:
        check_free(path, math.prod(labels.shape) * min(labels.dtype.itemsize, 2))
        return Image(labels, own if voxel is None else voxel, materials)
    except ValueError as error:
        told = str(error)
        raise ValueError(told if told.startswith(str(path)) else f"{path}: {told}") from None


def _check_there(path: Path):
    chunked = path.suffix.lower() == CHUNKED
    if path.is_dir() if chunked else path.is_file():
        return
    if path.exists() and chunked:
        raise ValueError(f"{path}: must be a folder, as zarr writes one")
    if path.exists():
        raise ValueError(f"{path}: must be a regular file, no folder, device or pipe")
    raise ValueError(f"{path}: there is no such file{nearest_file(path)}")


def _npy(path):
    try:
        return np.load(path, mmap_mode="r", allow_pickle=False), None
    except (ValueError, EOFError) as error:
        raise ValueError(f"{path}: no array of NumPy, or a part of one: {one_line(error)}") from None


def _tiff(path):
    try:
        import tifffile
    except ImportError:
        raise ImportError(f"{path}: TIFF needs tifffile; pip install tifffile, or demheat[images]") from None
    with _complaints("tifffile") as complaints, _one_line(path, "TIFF"):
        with tifffile.TiffFile(path) as file:
            if len(file.series) != 1:
                raise ValueError(f"{path}: has {len(file.series)} images of unlike shapes; must be one stack of pages")
            (stack,) = file.series
            shape = _paged(path, stack)[::-1]
            plain = stack.dataoffset is not None
            labels = None if plain else _by_pages(path, stack, shape)
            where = {"dtype": np.dtype(stack.dtype).newbyteorder(file.byteorder), "offset": stack.dataoffset}
        if complaints:
            raise ValueError(f"{path}: no TIFF, or a part of one: {complaints[0]}")
        return (_mapped(path, shape, **where) if plain else labels), None


@contextmanager
def _complaints(library):
    """What a library logs as an error, and goes on: pages that are not there would be left out."""
    found = []
    logger = logging.getLogger(library)
    handler = logging.Handler(logging.ERROR)
    handler.emit = lambda record: found.append(one_line(record.getMessage()))
    before = logger.propagate
    logger.addHandler(handler)
    logger.propagate = False
    try:
        yield found
    finally:
        logger.removeHandler(handler)
        logger.propagate = before


@contextmanager
def _one_line(path, kind):
    """What libraries and their decoders happen to raise, as one ValueError of the file."""
    try:
        yield
    except OSError:
        raise
    except Exception as error:  # noqa: BLE001
        if isinstance(error, ValueError) and str(error).startswith(str(path)):
            raise
        raise ValueError(f"{path}: no {kind}, or a part of one: {one_line(error)}") from None


def _paged(path, stack):
    """Pages, rows and columns of a stack of one channel."""
    shape = tuple(n for n, axis in zip(stack.shape, stack.axes, strict=True) if axis != "S" or n > 1)
    if "S" in stack.axes and len(shape) == len(stack.shape):
        raise ValueError(f"{path}: has {stack.shape[stack.axes.index('S')]} channels of colour; must be one of labels")
    if not 2 <= len(shape) <= 3:
        raise ValueError(f"{path}: pages of axes {stack.axes}, {stack.shape}; must be one stack of one channel")
    return shape if len(shape) == 3 else (1, *shape)


def _by_pages(path, stack, shape):
    """Pages read one after the other."""
    check_free(path, math.prod(shape) * stack.dtype.itemsize)
    labels = np.empty(shape, stack.dtype)
    for number in range(shape[2]):
        page = stack.pages[number].asarray() if len(stack.pages) == shape[2] else None
        if page is None:
            # Several pages in one: of no use but as a whole.
            return stack.asarray().reshape(shape[::-1]).T
        labels[:, :, number] = page.reshape(shape[1], shape[0]).T
    return labels


def _meta(path):
    """A MetaImage: https://itk.org/Wiki/MetaIO/Documentation."""
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
        _check_there(data)
    else:
        data = path
    spacing = "ElementSpacing" if "elementspacing" in header else "ElementSize"
    voxel = tuple(MILLI * h for h in _numbers(path, header, spacing, float)) if spacing.lower() in header else None
    if offset < 0:
        offset = data.stat().st_size - math.prod(shape) * np.dtype(ELEMENTS[kind.upper()]).itemsize
    return _mapped(data, shape, dtype=(">" if large else "<") + ELEMENTS[kind.upper()], offset=offset), voxel


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
            raise ValueError(f"{path}:{number}: no line of a MetaImage: {shown(text)}; must be like DimSize = 64 64 64")
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


def _mapped(path, shape, *, dtype, offset):
    """Raw bytes, x fastest, as an array; they must all be there."""
    needed, there = offset + math.prod(shape) * np.dtype(dtype).itemsize, path.stat().st_size
    if needed > there or offset < 0:
        sides = " x ".join(map(str, shape))
        raise ValueError(
            f"{path}: has {there} bytes; {sides} voxels of {np.dtype(dtype)} take {needed} with what is before them"
        )
    return np.memmap(path, dtype=dtype, mode="r", offset=offset, shape=tuple(shape), order="F")


def _nrrd(path):
    try:
        import nrrd
    except ImportError:
        raise ImportError(f"{path}: NRRD needs pynrrd; pip install pynrrd, or demheat[images]") from None
    with _one_line(path, "NRRD"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        header = nrrd.read_header(str(path))
        check_free(path, math.prod(int(n) for n in header["sizes"]))
        labels, _ = nrrd.read(str(path))
    return labels, _spacings(header)


class _Chunks:
    """An array of zarr; what its decoders happen to raise is one ValueError of the file."""

    def __init__(self, path, array):
        self.path, self.array, self.chunks = path, array, tuple(array.chunks)
        self.shape, self.dtype, self.ndim = tuple(array.shape), np.dtype(array.dtype), array.ndim

    def __getitem__(self, part):
        try:
            with _one_line(self.path, "zarr array"):
                return np.asarray(self.array[part])
        except OSError as error:
            raise ValueError(f"{self.path}: cannot be read: {error.strerror or error}") from None


def _zarr(path):
    try:
        import zarr
    except ImportError:
        raise ImportError(f"{path}: zarr arrays need zarr; pip install zarr, or demheat[zarr]") from None
    with _one_line(path, "zarr array"):
        array = zarr.open(str(path), mode="r")
        if not hasattr(array, "chunks"):
            raise ValueError(f"{path}: is a group; must be one array, such as one in this folder")
        return _Chunks(path, array), None


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


READERS = {
    ".npy": _npy,
    ".tif": _tiff,
    ".tiff": _tiff,
    ".mhd": _meta,
    ".mha": _meta,
    ".nrrd": _nrrd,
    ".nhdr": _nrrd,
    CHUNKED: _zarr,
}
