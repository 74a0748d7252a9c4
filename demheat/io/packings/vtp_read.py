"""Spheres out of ParaView's PolyData (.vtp), as VTK, ParaView and LIGGGHTS write it."""

import base64
import binascii
import re
import xml.etree.ElementTree as ET
import zlib

import numpy as np

from demheat.io.packings.found import Found
from demheat.io.packings.source import length_of, most_unpacked
from demheat.io.packings.text import broken
from demheat.runtime.limits import ALWAYS, check_free
from demheat.scene.bodies import ROUND_AXES

TYPES = {"Float64": "f8", "Float32": "f4", "UInt8": "u1", "Int8": "i1", "String": "u1"}
HEADERS = {"UInt32": "u4", "UInt64": "u8"}
ENCODING = re.compile(rb"""(?:\xef\xbb\xbf)?\s*<\?xml[^>]*?encoding\s*=\s*["']([\w.:-]*)""")
RADII = ("radius", "radii", "diameter")
# Elements of a file; bytes of the longest field; and memory over the length of a file.
MOST_ELEMENTS, MOST_FIELD, COPIES = 10_000, 10_000, 4


def read(path) -> Found:
    """Read points and radii; the box is known only where `write` has noted it."""
    length = length_of(path)
    check_free(path, COPIES * length)
    with open(path, "rb") as stream:
        content = stream.read(length)
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
        self.root = _parsed(head + b"</VTKFile>" if tag else head)
        self.encoding = "base64" if b'"base64"' in rest.partition(b">")[0] else "raw"
        self.appended = rest[rest.index(b"_") + 1 :] if tag else b""
        self.most = most_unpacked(len(content))
        self.order = "<" if self.root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
        self.header = np.dtype(self.order + HEADERS[self.root.get("header_type", "UInt32")])
        self.packed = self.root.get("compressor")
        if self.packed not in (None, "vtkZLibDataCompressor"):
            raise ValueError(f"found the compressor {self.packed}; expected none or vtkZLibDataCompressor")

    def array(self, element, count=None):
        """Values of a DataArray, (count,) float array."""
        name, kind, format = element.get("Name"), element.get("type"), element.get("format")
        if kind not in TYPES:
            raise ValueError(f"found the array {name} of type {kind}; expected one of {', '.join(TYPES)}")
        if format == "ascii":
            most = MOST_FIELD if count is None else count
            words = (element.text or "").split(maxsplit=most)
            if len(words) > most:
                raise ValueError(f"found more than {most} values of {name}; expected {most} at most")
            values = np.array(words, dtype=float)
        else:
            raw, coded = (element.text or "").strip().encode(), True
            if format == "appended":
                raw, coded = self.appended[int(element.get("offset")) :], self.encoding == "base64"
            dtype = np.dtype(self.order + TYPES[kind])
            most = MOST_FIELD if count is None else min(count * dtype.itemsize, self.most)
            values = np.frombuffer(self._bytes(raw, coded, most), dtype=dtype).astype(float)
        if count is not None and len(values) != count:
            raise ValueError(f"found {len(values)} values of {name}; expected {count}")
        return values

    def _bytes(self, raw, coded, most):
        """One block: a header of integers (base64 on its own if the data are packed), then the data."""
        if not self.packed:
            width = self.header.itemsize
            head = _decode(raw, width, 0) if coded else raw[:width]
            length = int(np.frombuffer(head, self.header)[0])
            return _whole(_decode(raw, width + length, 0)[width:] if coded else raw[width : width + length], length)
        blocks, head, start = self._packed_header(raw, coded)
        lengths = np.frombuffer(head, self.header)[3 : 3 + blocks].tolist()
        total = sum(lengths)
        body = _whole(_decode(raw, total, start) if coded else raw[start : start + total], total)
        return _unpacked(body, lengths, most)

    def _packed_header(self, raw, coded):
        """Number of packed blocks, the header that lists their lengths, and where the data start."""
        width = self.header.itemsize
        first = _decode(raw, width, 0) if coded else raw[:width]
        blocks = int(np.frombuffer(first, self.header)[0])
        length = width * (3 + blocks)
        return blocks, _decode(raw, length, 0) if coded else raw[:length], _coded(length) if coded else length


def _parsed(text):
    """The XML, unless it has a document type, whose entities might expand without end, or very many elements."""
    said = ENCODING.match(text)
    if b"\0" in text or said and said[1].lower() not in (b"utf-8", b"us-ascii", b"ascii"):
        # What is looked for below would be written in other bytes.
        raise ValueError(f"found XML in {said[1].decode() if said else 'UTF-16 or the like'}; expected UTF-8 or ASCII")
    if b"<!DOCTYPE" in text:
        raise ValueError("found a document type; expected none")
    parser, first, count = ET.XMLPullParser(("start",)), None, 0
    for begin in range(0, len(text), ALWAYS >> 8):
        parser.feed(text[begin : begin + (ALWAYS >> 8)])
        for _, root in parser.read_events():
            first, count = root if first is None else first, count + 1
        if count > MOST_ELEMENTS:
            raise ValueError(f"found more than {MOST_ELEMENTS} elements; expected fewer")
    parser.close()
    return first


def _unpacked(body, lengths, most):
    """Packed blocks one behind the other, unpacked: no more than `most` bytes."""
    parts, left, begin = [], most, 0
    for length in lengths:
        unpacker = zlib.decompressobj()
        parts.append(unpacker.decompress(body[begin : begin + length], left + 1))
        left, begin = left - len(parts[-1]), begin + length
        if left < 0:
            raise ValueError(f"found more than {most} bytes of an array; expected {most} at most")
        if not unpacker.eof:
            raise ValueError("found a packed block that does not end; expected whole ones")
    return b"".join(parts)


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
