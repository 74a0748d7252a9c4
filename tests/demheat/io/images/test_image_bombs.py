"""Only here: small files that expand beyond what their headers tell of, or run what they hold."""

import bz2
import gzip
import json
import lzma
import pickle
import struct
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest
import tifffile

from demheat import Material
from demheat.io.images import read_image, source

nrrd = pytest.importorskip("nrrd")

MATERIALS = {0: Material(1.0), 1: Material(5.0)}
# What a bomb expands to, and what reading it may take: a quarter of that, which is a piece and the head of a file.
LARGE, LITTLE = 2**24, 2**22
ZEROS = bytes(LARGE)
SHAPE = [2, 2, 2]


@pytest.fixture(autouse=True)
def little_is_free(monkeypatch):
    monkeypatch.setattr(source, "ALWAYS", 2**17)


def refused(path, words):
    """Read, and be told so in one line without the memory."""
    tracemalloc.start()
    try:
        with pytest.raises(ValueError) as caught:
            read_image(path, voxel=1.0, materials=MATERIALS)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    told = str(caught.value)
    assert words in told and told.startswith(str(path)) and "\n" not in told and peak < LITTLE


def nrrd_file(path, encoding, data, sizes="2 2 2", more=""):
    header = f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {sizes}\nencoding: {encoding}\n{more}\n"
    path.write_bytes(header.encode() + data)
    return path


BEYOND = "expand to more than 8 bytes"
NRRDS = {
    "gzip": ("gzip", gzip.compress(ZEROS, 1), BEYOND),
    "gzip in members": ("gz", gzip.compress(bytes(8)) + gzip.compress(ZEROS, 1), BEYOND),
    "short gzip": ("gzip", gzip.compress(bytes(7)), "hold 7 bytes; what its header tells of takes 8"),
    "cut gzip": ("gzip", gzip.compress(bytes(8))[:-9], "no NRRD, or a part of one: Compressed file ended"),
    "text": ("text", b"0 " * 10**6, "8 or more numbers; its header tells of 8"),
    "raw": ("raw", bytes(9), "9 bytes of data, of which its header tells of 8"),
    "short raw": ("raw", bytes(7), "2 x 2 x 2 voxels of uint8 take"),
}


@pytest.mark.parametrize("name", NRRDS)
def test_nrrd(name, tmp_path):
    encoding, data, words = NRRDS[name]
    refused(nrrd_file(tmp_path / "x.nrrd", encoding, data), words)


def test_a_header_without_end(tmp_path):
    path = tmp_path / "x.nrrd"
    path.write_bytes(b"NRRD0004\n" + b"# nothing\n" * 10**6)
    with pytest.raises(ValueError, match="its header"):
        read_image(path, voxel=1.0, materials=MATERIALS)


LABELS = np.random.default_rng(3).integers(0, 2, (3, 4, 5))


@pytest.mark.parametrize(
    ("encoding", "kind", "apart"),
    [("raw", ">i4", False), ("gzip", "<u2", True), ("bzip2", "uint8", False), ("ascii", "uint8", True)],
)
def test_what_pynrrd_writes_is_read(encoding, kind, apart, tmp_path):
    path = tmp_path / ("x.nhdr" if apart else "x.nrrd")
    nrrd.write(str(path), LABELS.astype(kind), {"encoding": encoding})
    image = read_image(path, voxel=1.0, materials=MATERIALS)
    assert np.array_equal(image.labels, LABELS) and np.array_equal(image.labels, nrrd.read(str(path))[0])


@pytest.mark.parametrize(
    "skip, before", [("line skip: 2", b"a\nb\n"), ("byte skip: 5", b"abcde"), ("byte skip: -1", b"a")]
)
def test_what_is_passed_over(skip, before, tmp_path):
    data = before + LABELS.astype(np.uint8).tobytes(order="F")
    path = nrrd_file(tmp_path / "x.nrrd", "raw", data, "3 4 5", skip + "\n")
    assert np.array_equal(read_image(path, voxel=1.0, materials=MATERIALS).labels, LABELS)
    if "byte" in skip:
        refused(nrrd_file(tmp_path / "p.nrrd", "gzip", gzip.compress(data), "3 4 5", skip + "\n"), "must be 0")
    else:
        refused(
            nrrd_file(tmp_path / "p.nrrd", "raw", b"", more="line skip: 3\n"), "line skip = 3: there are fewer lines"
        )


def tiff(path, data, kind, tile=None):
    """One page of 2 x 2 pixels in one strip or tile, packed in some kind."""
    tags = {256: 2, 257: 2, 258: 8, 259: kind, 262: 1, 277: 1}
    begin = 8 + 2 + 12 * (10 if tile else 9) + 4
    tags |= {322: tile, 323: tile, 324: begin, 325: len(data)} if tile else {273: begin, 278: 2, 279: len(data)}
    entries = [struct.pack("<HHII", tag, 4, 1, value) for tag, value in sorted(tags.items())]
    path.write_bytes(b"II*\0" + struct.pack("<IH", 8, len(tags)) + b"".join(entries) + bytes(4) + data)
    return path


PACKBITS = b"\x81\0" * (LARGE // 128 // 16)
TIFFS = {
    "deflate": ((zlib.compress(ZEROS, 1), 8), "expand to more than 4 bytes"),
    "packbits": ((PACKBITS, 32773), "expand to more than 4 bytes"),
    "tile": ((zlib.compress(bytes(4)), 8, 4096), "tiles of (4096, 4096) for a page of (2, 2)"),
    "plain tile": ((bytes(2**18), 1, 16), "262144 bytes of a strip or tile that takes 256"),
    "jpeg": ((bytes(4), 7), "pages packed by JPEG; must be plain, DEFLATE"),
}


@pytest.mark.parametrize("name", TIFFS)
def test_tiff(name, tmp_path):
    made, words = TIFFS[name]
    # Where pages lie in one piece, they are mapped.
    tifffile.TiffFile(tiff(tmp_path / "x.tif", *made)).close()
    refused(tmp_path / "x.tif", words)


@pytest.mark.parametrize("how", [{"compression": "zlib"}, {"compression": "lzma"}, {"tile": (16, 16)}])
def test_honest_pages_are_read(how, tmp_path):
    tifffile.imwrite(
        tmp_path / "x.tif", np.ascontiguousarray(LABELS.T.astype(np.uint16)), photometric="minisblack", **how
    )
    assert np.array_equal(read_image(tmp_path / "x.tif", voxel=1.0, materials=MATERIALS).labels, LABELS)


def test_honest_packbits_are_read(tmp_path):
    # Four as they are; nothing; four times one.
    for data, labels in ((b"\x03\0\1\1\0", [0, 1, 1, 0]), (b"\x80\xfd\1", [1, 1, 1, 1])):
        image = read_image(tiff(tmp_path / "x.tif", data, 32773), voxel=1.0, materials=MATERIALS)
        assert image.labels[:, :, 0].T.ravel().tolist() == labels


class Evil:
    """What unpickles to a file."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return Path.touch, (self.path,)


def zarr2(path, data, chunks=SHAPE, **more):
    path.mkdir()
    told = {"zarr_format": 2, "shape": SHAPE, "chunks": chunks, "dtype": "|u1", "fill_value": 0, "order": "C"}
    (path / ".zarray").write_text(json.dumps(told | {"filters": None, "compressor": None} | more))
    (path / "0.0.0").write_bytes(data)
    return path


def zarr3(path, data, codecs, chunks=SHAPE):
    (path / "c/0/0").mkdir(parents=True)
    told = {"zarr_format": 3, "node_type": "array", "shape": SHAPE, "data_type": "uint8", "fill_value": 0}
    told |= {"chunk_grid": {"name": "regular", "configuration": {"chunk_shape": chunks}}, "attributes": {}}
    told |= {"chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}}, "codecs": codecs}
    (path / "zarr.json").write_text(json.dumps(told))
    (path / "c/0/0/0").write_bytes(data)
    return path


PLAIN = {"name": "bytes"}
FOREIGN = {
    "compressor": lambda path, data: zarr2(path, data, compressor={"id": "pickle"}),
    "filter": lambda path, data: zarr2(path, data, filters=[{"id": "pickle"}]),
    "codec": lambda path, data: zarr3(path, data, [PLAIN, {"name": "pickle"}]),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_codecs_that_run_what_they_read(name, tmp_path):
    """Refused by their names, whether zarr is installed or not."""
    path = FOREIGN[name](tmp_path / "x.zarr", pickle.dumps(Evil(tmp_path / "was here")))
    refused(path, "pickle' is none of numbers that is read; must be one of")
    assert not (tmp_path / "was here").exists()


SAID = struct.pack("<I", LARGE)
OF_ZSTD = b"\x28\xb5\x2f\xfd"
CHUNKS = {
    "zlib": ({"compressor": {"id": "zlib"}}, zlib.compress(ZEROS, 1)),
    "gzip in members": ({"compressor": {"id": "gzip"}}, gzip.compress(bytes(8)) + gzip.compress(ZEROS, 1)),
    "bz2": ({"compressor": {"id": "bz2"}}, bz2.compress(ZEROS, 1)),
    "lzma": ({"compressor": {"id": "lzma"}}, lzma.compress(ZEROS, preset=0)),
    "a filter": ({"filters": [{"id": "bz2"}]}, bz2.compress(ZEROS, 1)),
    "blosc": ({"compressor": {"id": "blosc"}}, b"\2\1\1\1" + SAID + bytes(24)),
    # Lengths in four, two and eight bytes (RFC 8878, 3.1.1.1), the second after a window and a dictionary.
    "zstd": ({"compressor": {"id": "zstd"}}, OF_ZSTD + b"\xa0" + SAID + bytes(24)),
    "zstd, two bytes": ({"compressor": {"id": "zstd"}}, OF_ZSTD + b"\x43\x10\0\0\0\0\0\1" + bytes(24)),
    "zstd, eight bytes": ({"compressor": {"id": "zstd"}}, OF_ZSTD + b"\xe0" + SAID + bytes(28)),
}


@pytest.mark.parametrize("name", CHUNKS)
def test_chunks(name, tmp_path):
    told, data = CHUNKS[name]
    refused(zarr2(tmp_path / "x.zarr", data, **told), "expand to more than 12 bytes")


def test_chunks_of_version_3(tmp_path):
    codecs = [PLAIN, {"name": "gzip", "configuration": {"level": 1}}, {"name": "crc32c"}]
    refused(zarr3(tmp_path / "x.zarr", gzip.compress(ZEROS, 1) + b"1234", codecs), "expand to more than 12 bytes")


CASES = {
    "chunks": (lambda path: zarr2(path, b"", [256, 256, 256]), "chunks of (256, 256, 256) for an array of (2, 2, 2)"),
    "plain": (lambda path: zarr2(path, bytes(2000)), "has 2000 bytes, of a chunk that takes 12"),
    "twice": (lambda path: zarr2(path, b"", filters=[{"id": "zlib"}], compressor={"id": "zlib"}), "must pack once"),
    "not last": (lambda path: zarr2(path, b"", filters=[{"id": "zlib"}, {"id": "shuffle"}]), "must pack once"),
    "shards": (lambda path: zarr3(path, b"", [{"name": "sharding_indexed"}]), "the codec 'sharding_indexed' is none"),
    "objects": (lambda path: zarr2(path, b"", dtype="|O"), "labels of type object: must be whole numbers"),
    "no length": (
        lambda path: zarr2(path, OF_ZSTD + bytes(24), compressor={"id": "zstd"}),
        "a chunk of zstd that does not tell its length",
    ),
    "nothing": (lambda path: zarr2(path, b"", shape=[0, 2, 2]), "must be numbers >= 1"),
    "no JSON": (
        lambda path: (zarr2(path, b"") / ".zarray").write_text("{") and path,
        "no zarr array, or a part of one",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_arrays_that_are_none(name, tmp_path):
    make, words = CASES[name]
    refused(make(tmp_path / "x.zarr"), words)
