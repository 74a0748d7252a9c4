"""Spheres out of ParaView's PolyData (.vtp), as VTK, ParaView and LIGGGHTS write it."""

from __future__ import annotations

import base64
import binascii
import xml.etree.ElementTree as ET
import zlib

import numpy as np

from demheat.packing.io.found import Found
from demheat.packing.io.text import broken
from demheat.scene.bodies import ROUND_AXES

TYPES = {"Float64": "f8", "Float32": "f4", "UInt8": "u1", "Int8": "i1", "String": "u1"}
HEADERS = {"UInt32": "u4", "UInt64": "u8"}
RADII = ("radius", "radii", "diameter")


def read(path) -> Found:
    """Read points and radii; the box is known only where `write` has noted it."""
    with open(path, "rb") as stream:
        content = stream.read()
    try:
        return _found(_File(content, path))
    except (ET.ParseError, binascii.Error, zlib.error, ValueError, KeyError, IndexError) as error:
        if isinstance(error, ET.ParseError):
            raise broken(path, error.position[0], str(error), "well-formed XML of type PolyData") from None
        raise ValueError(f"{path}: not a whole PolyData file: {error}") from None


def _found(file) -> Found:
    pieces = file.root.findall("PolyData/Piece")
    if file.root.get("type") != "PolyData" or len(pieces) != 1:
        raise ValueError(f"found type {file.root.get('type')} in {len(pieces)} pieces; expected PolyData in one")
    count = int(pieces[0].get("NumberOfPoints", 0))
    named = {array.get("Name", "").lower(): array for array in pieces[0].findall("PointData/DataArray")}
    sizes = [name for name in RADII if name in named]
    points = pieces[0].find("Points/DataArray")
    if not sizes or points is None or count < 1:
        raise ValueError(
            f"found {count} points with the data {', '.join(named) or 'none'}; expected points with one of "
            f"{', '.join(RADII)}"
        )
    radii = file.array(named[sizes[0]], count) / (2 if sizes[0] == "diameter" else 1)
    spheres = np.column_stack((file.array(points, 3 * count).reshape(count, 3), radii))
    field = {array.get("Name", ""): array for array in file.root.find("PolyData").findall("FieldData/*")}
    if not {"size", "periodic", "domain"} <= field.keys():
        return Found(spheres)
    size, periodic = file.array(field["size"], 3), file.array(field["periodic"], 3) != 0
    domain = bytes(file.array(field["domain"]).astype(np.uint8)).rstrip(b"\0").decode()
    return Found(spheres, size, periodic, domain=domain if domain in ROUND_AXES else None)


class _File:
    """The XML of a file and how its arrays are stored."""

    def __init__(self, content, path):
        head, tag, rest = content.partition(b"<AppendedData")
        self.root = ET.fromstring(head + b"</VTKFile>" if tag else head)
        self.encoding = "base64" if b'"base64"' in rest.partition(b">")[0] else "raw"
        self.appended = rest[rest.index(b"_") + 1 :] if tag else b""
        self.order = "<" if self.root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
        self.header = np.dtype(self.order + HEADERS[self.root.get("header_type", "UInt32")])
        self.packed = self.root.get("compressor")
        if self.packed not in (None, "vtkZLibDataCompressor"):
            raise ValueError(f"found the compressor {self.packed}; expected none or vtkZLibDataCompressor")

    def array(self, element, count=None):
        """Values of a DataArray, (count,) float array.

        Parameters
        ----------
        element : xml.etree.ElementTree.Element
        count : int, optional
            How many there must be.
        """
        name, kind, format = element.get("Name"), element.get("type"), element.get("format")
        if kind not in TYPES:
            raise ValueError(f"found the array {name} of type {kind}; expected one of {', '.join(TYPES)}")
        if format == "ascii":
            values = np.array((element.text or "").split(), dtype=float)
        else:
            raw, coded = (element.text or "").strip().encode(), True
            if format == "appended":
                raw, coded = self.appended[int(element.get("offset")) :], self.encoding == "base64"
            values = np.frombuffer(self._bytes(raw, coded), dtype=self.order + TYPES[kind]).astype(float)
        if count is not None and len(values) != count:
            raise ValueError(f"found {len(values)} values of {name}; expected {count}")
        return values

    def _bytes(self, raw, coded):
        """One block: a header of integers (base64 on its own if the data are packed), then the data."""
        if not self.packed:
            width = self.header.itemsize
            head = _decode(raw, width, 0) if coded else raw[:width]
            length = int(np.frombuffer(head, self.header)[0])
            return _whole(_decode(raw, width + length, 0)[width:] if coded else raw[width : width + length], length)
        blocks, head, start = self._packed_header(raw, coded)
        lengths = np.frombuffer(head, self.header)[3 : 3 + blocks].astype(int)
        body = _decode(raw, int(lengths.sum()), start) if coded else raw[start : start + int(lengths.sum())]
        body = _whole(body, int(lengths.sum()))
        ends = np.cumsum(lengths)
        return b"".join(zlib.decompress(body[end - n : end]) for end, n in zip(ends, lengths, strict=True))

    def _packed_header(self, raw, coded):
        """Number of packed blocks, the header that lists their lengths, and where the data start."""
        width = self.header.itemsize
        first = _decode(raw, width, 0) if coded else raw[:width]
        blocks = int(np.frombuffer(first, self.header)[0])
        length = width * (3 + blocks)
        return blocks, _decode(raw, length, 0) if coded else raw[:length], _coded(length) if coded else length


def _coded(length):
    """Length of `length` bytes in base64."""
    return -(-length // 3) * 4


def _decode(raw, length, start):
    """`length` bytes out of base64 that begins at `start`."""
    text = raw[start : start + _coded(length)]
    return base64.b64decode(text + b"=" * (-len(text) % 4))[:length]


def _whole(data, length):
    if len(data) != length:
        raise ValueError(f"found {len(data)} bytes of an array; expected {length}: the file is cut short")
    return data
