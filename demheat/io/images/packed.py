"""Packed bytes, unpacked in pieces and no further than what they are for needs."""

import bz2
import gzip
import lzma
import zlib
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

# Bytes that are unpacked at once.
PIECE = 2**18
# How many times its length what zlib has packed may expand to: 258 bytes out of two bits.
INFLATION = 1032


def unpacked(path: Path, stream, kind: str, needed: int) -> np.ndarray:
    """Unpack so many bytes, not one more or less."""
    content, end = np.empty(needed, np.uint8), 0
    for piece in _bounded(path, stream, kind, needed):
        content[end : end + len(piece)] = np.frombuffer(piece, np.uint8)
        end += len(piece)
    if end < needed:
        raise ValueError(f"{path}: its packed data hold {end} bytes; what its header tells of takes {needed}")
    return content


def check_expansion(path: Path, stream, kind: str, most: int) -> None:
    """Raise ValueError if a stream unpacks to more bytes; nothing is kept."""
    for _ in _bounded(path, stream, kind, most):
        pass


def beyond(path: Path, most: int) -> ValueError:
    """The error to raise for what would unpack to more bytes."""
    return ValueError(f"{path}: packed data that expand to more than {most} bytes, which is all that its header tells")


def _bounded(path, stream, kind, most) -> Iterator[bytes]:
    left = most
    for piece in PIECES[kind](stream):
        left -= len(piece)
        if left < 0:
            raise beyond(path, most)
        yield piece


def _inflated(stream):
    unpacker = zlib.decompressobj()
    while not unpacker.eof:
        data = unpacker.unconsumed_tail or stream.read(PIECE)
        piece = unpacker.decompress(data, PIECE)
        if not data and not piece:
            raise EOFError("packed data that end early")
        yield piece


def _of_file(kind, stream):
    with kind(stream) as file:
        while piece := file.read(PIECE):
            yield piece


PIECES = {
    "gzip": partial(_of_file, lambda stream: gzip.GzipFile(fileobj=stream)),
    "zlib": _inflated,
    "bz2": partial(_of_file, bz2.BZ2File),
    "lzma": partial(_of_file, lzma.LZMAFile),
}
