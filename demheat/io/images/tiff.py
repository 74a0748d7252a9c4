"""Stacks of TIFF: pages of one channel, packed without loss or not at all."""

import io
import logging
import math
import re
from contextlib import contextmanager

import numpy as np

from demheat.io.images.packed import INFLATION, beyond, check_expansion
from demheat.io.images.source import UNITS, mapped, most_of, told_in_one_line
from demheat.runtime.limits import check_free
from demheat.scene.inputs import one_line

# How pages may be packed, by the number that TIFF gives it; who unpacks the last is told how much there must be.
PLAIN, ZLIB, LZMA, PACKBITS, LZW = 1, (8, 32946), 34925, 32773, 5
# Edges of a voxel in the XML of OME: read as text, since nobody checked that it is XML.
OME = re.compile(r'\bPhysical(Size[XYZ](?:Unit)?)="([^"<>]*)"')
KNOWN = {PLAIN, *ZLIB, LZMA, PACKBITS, LZW}


def read(path):
    """A stack of pages."""
    try:
        import tifffile
    except ImportError:
        raise ImportError(f"{path}: TIFF needs tifffile; pip install tifffile, or demheat[images]") from None
    with _complaints("tifffile") as complaints, told_in_one_line(path, "TIFF"):
        with tifffile.TiffFile(path) as file:
            if len(file.series) != 1:
                raise ValueError(f"{path}: has {len(file.series)} images of unlike shapes; must be one stack of pages")
            (stack,) = file.series
            shape = _paged(path, stack)[::-1]
            plain = stack.dataoffset is not None
            if not plain:
                _check_packed(path, file.filehandle, stack)
            labels = None if plain else _by_pages(path, stack, shape)
            voxel = _voxel(file)
            where = {"dtype": np.dtype(stack.dtype).newbyteorder(file.byteorder), "offset": stack.dataoffset}
        if complaints:
            raise ValueError(f"{path}: no TIFF, or a part of one: {complaints[0]}")
        return (mapped(path, shape, **where) if plain else labels), voxel


def _voxel(file):
    """Edges of a voxel in metres as OME or ImageJ tell them; None if any is missing or of no unit that is known."""
    if file.is_ome:
        found = dict(OME.findall(file.ome_metadata or ""))
        told = [(found.get(f"Size{axis}"), found.get(f"Size{axis}Unit", "um")) for axis in "XYZ"]
    elif file.is_imagej:
        own, tags = file.imagej_metadata or {}, file.pages[0].tags
        across = [tags[name].value if name in tags else (0, 1) for name in ("XResolution", "YResolution")]
        told = [(below / above if above else None, own.get("unit")) for above, below in across]
        told.append((own.get("spacing"), own.get("unit")))
    else:
        return None
    edges = [float(length or 0) * UNITS.get(_plain(unit), 0.0) for length, unit in told]
    return tuple(edges) if all(0 < edge < math.inf for edge in edges) else None


def _plain(unit):
    """A unit without ImageJ's escapes."""
    return str(unit).replace("\\u00B5", "\N{MICRO SIGN}").replace("\N{GREEK SMALL LETTER MU}", "\N{MICRO SIGN}").strip()


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


def _check_packed(path, file, stack):
    """Raise ValueError if a strip or a tile is not packed as we know, or would expand beyond what the pages need."""
    for page in filter(None, stack.pages):
        kind, itemsize = page.keyframe.compression, stack.dtype.itemsize
        if kind not in KNOWN:
            name = getattr(kind, "name", kind)
            raise ValueError(f"{path}: pages packed by {name}; must be plain, DEFLATE, LZW, LZMA or PACKBITS")
        most = math.prod(page.keyframe.chunks) * itemsize
        if most > most_of(math.prod(page.keyframe.shape) * itemsize):
            raise ValueError(f"{path}: tiles of {page.keyframe.chunks} for a page of {page.keyframe.shape}")
        for offset, length in zip(page.dataoffsets, page.databytecounts, strict=True):
            if length > most_of(most):
                raise ValueError(f"{path}: {length} bytes of a strip or tile that takes {most}")
            _check_part(path, file, offset, length, kind, most)


def _check_part(path, file, offset, length, kind, most):
    """Raise ValueError if a strip or a tile expands to more than so many bytes; what cannot harm is not looked at."""
    if kind in (PLAIN, LZW) or (kind != LZMA and length * INFLATION <= most_of(most)):
        return
    file.seek(offset)
    data = file.read(length)
    if kind == PACKBITS:
        if _length_of_packbits(data) > most:
            raise beyond(path, most)
    else:
        check_expansion(path, io.BytesIO(data), "lzma" if kind == LZMA else "zlib", most)


def _length_of_packbits(data):
    """Bytes that runs of bytes expand to."""
    at = length = 0
    while at < len(data):
        head = data[at]
        # So many bytes as they are; nothing; or one byte so many times.
        at, more = (at + head + 2, head + 1) if head < 128 else (at + 1, 0) if head == 128 else (at + 2, 257 - head)
        length += more
    return length
