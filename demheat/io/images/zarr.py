"""Arrays of zarr: read a layer of chunks at a time, after their metadata and what each chunk expands to were looked at.

Codecs are plug-ins, one of which runs what a file holds ("pickle"); a few that are of numbers are read, others refused
before a byte is decoded.
"""

import io
import itertools
import json
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from demheat.io.images.ome import as_body, finest
from demheat.io.images.packed import INFLATION, beyond, check_expansion
from demheat.io.images.source import most_of, told_in_one_line
from demheat.runtime.limits import check_free

# Bytes of a file of metadata, and the least version of zarr: before 3 any codec that is installed is run.
LONGEST, LEAST = 2**20, 3
# Of version 2 and 3: what packs a chunk, and what leaves it as long as it is.
PACKERS = ({"zlib", "gzip", "bz2", "lzma", "blosc", "zstd", "lz4"}, {"gzip", "blosc", "zstd"})
OTHERS = ({"shuffle"}, {"bytes", "transpose", "crc32c"})
# Bytes of a checksum, which is what is there beside the numbers.
CHECKSUM = 4
# Bytes at the head of a packed chunk in which its length is told.
HEAD = 32


class Layout(NamedTuple):
    """What metadata tell of an array."""

    version: int  # {2, 3}
    # shape, chunks: tuple of int
    shape: tuple[int, ...]
    chunks: tuple[int, ...]
    dtype: np.dtype  # data type
    codecs: tuple[str, ...]  # tuple of str: In the order in which they pack
    # prefix, mark: Names of files: before the numbers of a chunk, and between them
    prefix: str
    mark: str


class Chunks:
    """An array of zarr; what its decoders happen to raise is one ValueError of the file."""

    def __init__(self, path, array, layout):
        self.path, self.array, self.chunks = path, array, layout.chunks
        self.shape, self.dtype, self.ndim = layout.shape, layout.dtype, len(layout.shape)

    def __getitem__(self, part):
        try:
            with told_in_one_line(self.path, "zarr array"):
                return np.asarray(self.array[part])
        except OSError as error:
            raise ValueError(f"{self.path}: cannot be read: {error.strerror or error}") from None


def read(path):
    """An array in chunks, or the finest of an image in several sizes, and the voxel that this tells."""
    with told_in_one_line(path, "zarr image"):
        group = finest(path)
    if group is None:
        return _array(path), None
    return as_body(path, _array(group.path), group.axes), group.voxel


def _array(path):
    layout = layout_of(path)
    check_chunks(path, layout)
    try:
        import zarr
    except ImportError:
        raise ImportError(f"{path}: zarr arrays need zarr; pip install zarr, or demheat[zarr]") from None
    if int(zarr.__version__.split(".")[0]) < LEAST:
        raise ImportError(
            f"{path}: zarr {zarr.__version__} is installed; must be {LEAST} or later: pip install -U zarr"
        )
    with told_in_one_line(path, "zarr array"):
        return Chunks(path, zarr.open_array(str(path), mode="r", zarr_format=layout.version), layout)


def layout_of(path: Path) -> Layout:
    """What the metadata in a folder tell, or a ValueError; nothing of it is decoded."""
    with told_in_one_line(path, "zarr array"):
        version = 3 if (path / "zarr.json").is_file() else 2
        file = path / ("zarr.json" if version == 3 else ".zarray")
        if not file.is_file() and (path / ".zgroup").is_file():
            raise ValueError(f"{path}: is a group; must be one array, such as one in this folder")
        if not file.is_file():
            raise ValueError(f"{path}: no zarr array: neither .zarray nor zarr.json is in it")
        with file.open(encoding="utf-8") as stream:
            told = json.loads(stream.read(LONGEST))
        if version == 3 and told["node_type"] != "array":
            raise ValueError(f"{path}: is a {told['node_type']}; must be one array, such as one in this folder")
        found = (_of_version_3 if version == 3 else _of_version_2)(told)
        _check_codecs(path, found)
        _check_sizes(path, found)
    return found


def check_chunks(path: Path, layout: Layout) -> None:
    """Raise ValueError if a chunk expands to more than its shape takes; missing ones are of one value."""
    needed = math.prod(layout.chunks) * layout.dtype.itemsize
    packer = next((each for each in layout.codecs if each in PACKERS[layout.version - 2]), None)
    counts = (range(-(-n // chunk)) for n, chunk in zip(layout.shape, layout.chunks, strict=True))
    for place in itertools.product(*counts):
        file = path / (layout.prefix + layout.mark.join(map(str, place)))
        if file.is_file():
            _check_chunk(file, packer, needed + CHECKSUM, layout.codecs[-1:] == ("crc32c",))
        elif file.exists():
            raise ValueError(f"{file}: must be a regular file, no folder, device or pipe")


def _of_version_2(told):
    filters, packer = told.get("filters") or [], told.get("compressor")
    codecs = tuple(str(each["id"]) for each in [*filters, *([packer] if packer else [])])
    shape, chunks = tuple(map(int, told["shape"])), tuple(map(int, told["chunks"]))
    return Layout(2, shape, chunks, np.dtype(str(told["dtype"])), codecs, "", told.get("dimension_separator", "."))


def _of_version_3(told):
    codecs = tuple(str(each if isinstance(each, str) else each["name"]) for each in told["codecs"])
    chunks = tuple(map(int, told["chunk_grid"]["configuration"]["chunk_shape"]))
    keys = told["chunk_key_encoding"]
    usual = {"default": ("c", "/"), "v2": ("", ".")}[keys["name"]]
    mark = keys.get("configuration", {}).get("separator", usual[1])
    prefix = usual[0] and usual[0] + mark
    return Layout(3, tuple(map(int, told["shape"])), chunks, np.dtype(str(told["data_type"])), codecs, prefix, mark)


def _check_codecs(path, layout):
    packers, others = PACKERS[layout.version - 2], OTHERS[layout.version - 2]
    for each in layout.codecs:
        if each not in packers | others:
            known = ", ".join(sorted(packers | others))
            raise ValueError(f"{path}: the codec {each!r} is none of numbers that is read; must be one of {known}")
    packing = tuple(each for each in layout.codecs if each in packers or each == "crc32c")
    last = layout.codecs[len(layout.codecs) - len(packing) :]
    if packing != last or packing[1:] not in ((), ("crc32c",)) or packing == ("crc32c", "crc32c"):
        raise ValueError(f"{path}: codecs {', '.join(layout.codecs)}: must pack once, at the end")


def _check_sizes(path, layout):
    """Raise ValueError unless shape and chunks are of a body of labels, and the chunks no larger than it needs."""
    if layout.dtype.kind not in "iubf":
        raise ValueError(f"{path}: labels of type {layout.dtype}: must be whole numbers")
    if len(layout.shape) != len(layout.chunks) or min((*layout.shape, *layout.chunks), default=0) < 1:
        raise ValueError(f"{path}: shape {layout.shape} in chunks of {layout.chunks}: must be numbers >= 1, one each")
    needed, chunk = (math.prod(each) * layout.dtype.itemsize for each in (layout.shape, layout.chunks))
    check_free(path, needed)
    if chunk > most_of(needed):
        raise ValueError(f"{path}: chunks of {layout.chunks} for an array of {layout.shape}; must be no larger than it")


def _check_chunk(file, packer, most, summed):
    length = file.stat().st_size
    if length > (most if packer is None else most_of(most)):
        raise ValueError(f"{file}: has {length} bytes, of a chunk that takes {most}")
    if packer in ("zlib", "gzip") and length * INFLATION <= most_of(most):
        return
    with file.open("rb") as stream:
        if packer in SAID:
            head = stream.read(HEAD)
            said = SAID[packer](head) if len(head) > CHECKSUM else 0
            if said is None:
                raise ValueError(f"{file}: a chunk of {packer} that does not tell its length; must do")
            if said > most:
                raise beyond(file, most)
        elif packer is not None:
            content = stream.read(length - CHECKSUM if summed else length)
            with told_in_one_line(file, "chunk"):
                check_expansion(file, io.BytesIO(content), packer, most)


def _said_by_zstd(head):
    """Length that a frame of Zstandard tells (RFC 8878, 3.1.1.1), or None."""
    flags = head[4]
    width = (int(flags & 32 > 0), 2, 4, 8)[flags >> 6]
    start = 5 + (not flags & 32) + (0, 1, 2, 4)[flags & 3]
    return _number(head, start, width) + 256 * (width == 2) if width else None


def _number(head, start, width):
    return int.from_bytes(head[start : start + width], "little")


# Packers that tell at the head of a chunk to how many bytes it expands, which is what their decoders go by.
SAID = {
    "blosc": lambda head: _number(head, 4, 4),
    "lz4": lambda head: _number(head, 0, 4),
    "zstd": _said_by_zstd,
}
