"""Only here: packing files made to take more memory or time than any packing, and taken."""

import base64
import gzip
import io as streams
import json
import os
import struct
import time
import tracemalloc
import zipfile
import zlib

import numpy as np
import pytest
from packing_files import ASE, DUMP, VTK_ASCII, awkward, put

from demheat.io import packings
from demheat.io.packings import extxyz, npz, source, text
from demheat.runtime import limits

XYZ = "1\nProperties=pos:R:3:radius:R:1:{}\n0 0 0 1\n"
# Bytes that a refusal may take: far below what the files promise or expand to.
LITTLE = 2**24


def refused(path, message, **given):
    """Reading must fail in one line, without memory."""
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match=message) as raised:
            packings.read(path, **given)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < LITTLE and "\n" not in str(raised.value) and len(str(raised.value)) < 600


@pytest.fixture
def small(monkeypatch):
    """Limits of files, small, so that those of the tests may be."""
    for module in (limits, source, text):
        monkeypatch.setattr(module, "ALWAYS", 2**16)


@pytest.mark.parametrize("line", [b"0 0 0 1\n", b" "])
def test_packed_text_that_expands_without_end(tmp_path, small, line):
    path = tmp_path / "a.yade.gz"
    path.write_bytes(gzip.compress(line * 400_000, 9))
    assert path.stat().st_size < 2**16
    refused(path, "a.yade.gz: expands to more than [0-9]+ bytes; no packing does")


@pytest.mark.parametrize("suffix", [".yade.gz", ".npz", ".vtp"])
def test_only_regular_files_are_read(tmp_path, suffix):
    pipe, folder, device = (tmp_path / f"{name}{suffix}" for name in ("pipe", "folder", "device"))
    os.mkfifo(pipe)
    folder.mkdir()
    device.symlink_to("/dev/zero")
    for path in (pipe, folder, device):
        refused(path, "must be a regular file|regular file, no folder")


def test_a_file_larger_than_memory(tmp_path, monkeypatch):
    path = tmp_path / "a.yade"
    with path.open("wb") as file:
        file.truncate(2**33)  # of zeros that take no disk
    monkeypatch.setattr(limits, "free_memory", lambda: 2.0**32)
    refused(path, "a.yade: takes 8 GiB of memory or more, and 4 GiB are free")


def test_rows_that_take_more_than_memory(tmp_path, small, monkeypatch):
    path = put(tmp_path, "#x\n" + "1\n" * 200_000, ".yade")
    monkeypatch.setattr(limits, "free_memory", lambda: 2.0**20)
    refused(path, "are free; must be a smaller file")


@pytest.mark.parametrize(
    ("properties", "message"),
    [
        ("foo:R:100000000", "expected 10000 columns at most"),
        ("foo:R:0", ">= 1"),
        ("foo:R:" + "9" * 6000, "expected Properties"),
    ],
)
def test_widths_of_columns(tmp_path, properties, message):
    refused(put(tmp_path, XYZ.format(properties), ".xyz"), message)


def test_a_line_without_end(tmp_path):
    for before in ("", "1\n", "#format x_y_z_r\n"):
        path = put(tmp_path, before + "1 " * 600_000, ".yade")
        refused(path, "a line of 1000000 characters or more; expected a shorter one")


@pytest.mark.parametrize("count", ["9" * 4000, "10000000000"])
def test_numbers_of_rows_that_no_file_has(tmp_path, count):
    refused(put(tmp_path, DUMP.replace("ATOMS\n3", f"ATOMS\n{count}"), ".dump"), "row 4 of 1|at most 9223")
    refused(put(tmp_path, ASE.replace("2\n", f"{count}\n", 1), ".xyz"), "row 3 of|at most 9223")


@pytest.mark.parametrize(
    "search",
    [
        lambda n: extxyz.PAIR.findall("a" * n),
        lambda n: extxyz.PAIR.findall("a=" + '"' * (n % 2 + 1) + "b" * n),
        lambda n: extxyz.PAIR.findall("a='\"" * (n // 4)),
        lambda n: text.MARK.search("demheat packing: size " + "1" * n),
        lambda n: text.MARK.search("demheat packing: size 1e" + "1" * n),
    ],
)
def test_long_lines_are_searched_once(search):
    """CPU seconds of ten times the length: 100 times as many, and half a minute, where each letter is begun at."""
    begin = time.process_time()
    search(200_000)
    assert time.process_time() - begin < 5.0


@pytest.mark.parametrize("words", ["pp pp p", "pf pp pp", "xx pp pp"])
def test_boundaries_that_are_none(tmp_path, words):
    refused(
        put(tmp_path, DUMP.replace("pp pp ff", words), ".dump"), "line 9: found the boundary .* expected pp, or two"
    )


def members(**changed):
    """Contents of an archive's members, some of them changed."""
    arrays, made = awkward(0)._asdict() | {"provenance": "{}"}, {}
    for name, array in arrays.items():
        stream = streams.BytesIO()
        np.lib.format.write_array(stream, np.asanyarray(array), allow_pickle=False)
        made[name] = stream.getvalue()
    return made | changed


def archive(path, contents, how=zipfile.ZIP_STORED):
    with zipfile.ZipFile(path, "w", how) as file:
        for name, content in contents.items():
            file.writestr(f"{name}.npy", content)
    return path


def header(shape, kind="<f8"):
    text = repr({"descr": kind, "fortran_order": False, "shape": shape}).encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text


@pytest.mark.parametrize(
    "content",
    [
        header((10**12, 3)),
        header((10**400, 3)),
        header((-1, -3)) + bytes(24),
        header((60, 3), "|V4000000000"),
        header((60, 3), "|O") + bytes(2000),
        header((60, 3), "<c16") + bytes(2880),
        header((60, 3), "<M8[s]") + bytes(1440),
        header((60, 3))[:-2] + b"(" * 3000 + b"\n",
        b"",
    ],
)
def test_archives_that_promise_what_they_do_not_hold(tmp_path, content):
    refused(archive(tmp_path / "a.npz", members(centers=content)), "a.npz: not a whole packing archive")


def test_complex_numbers_are_not_cut(tmp_path):
    np.savez(tmp_path / "a.npz", **awkward(0)._asdict() | {"provenance": "{}", "radii": np.full(60, 0.01 + 1j)})
    refused(tmp_path / "a.npz", "complex128.*expected real numbers")


def test_an_archive_that_expands_without_end(tmp_path, small):
    content = header((300_000, 3)) + bytes(7_200_000)
    path = archive(tmp_path / "a.npz", members(centers=content), zipfile.ZIP_DEFLATED)
    refused(path, "centers takes 7200[0-9]+ bytes, more than any packing")


@pytest.mark.parametrize("depth", [200, 100_000])
@pytest.mark.parametrize("ends", ["[]", ('{"a":', "}")])
def test_a_provenance_that_nests_without_end(tmp_path, depth, ends):
    inner = ends[0] * depth + ("1" if ends != "[]" else "") + ends[1] * depth
    path = tmp_path / "a.npz"
    np.savez(path, **awkward(0)._asdict() | {"provenance": '{"a": ' + inner + "}"})
    refused(path, "more than 100 levels|not a whole packing archive")


def test_a_provenance_of_some_levels_is_read():
    deep = {}
    for _ in range(45):
        deep = {"of": [deep]}
    assert npz.parsed(json.dumps(deep)) == deep


def packed_polydata(values, *, blocks=None, lengths=None):
    """VTK_ASCII with packed radii, its header perhaps changed."""
    body = zlib.compress(values, 9)
    head = struct.pack("<4I", blocks or 1, len(values) % 2**32, 0, lengths or len(body))
    radii = (base64.b64encode(head) + base64.b64encode(body)).decode()
    begin, end = VTK_ASCII.index('Name="radius"'), VTK_ASCII.index("</PointData>")
    format_at = VTK_ASCII.index('"ascii"', begin)
    assert format_at < end
    head, tail = VTK_ASCII[:format_at], VTK_ASCII[format_at:]
    tail = tail[tail.index(">") :]
    return head + '"binary"' + ">\n" + radii + "\n" + tail[tail.index("</DataArray>") :]


def test_polydata_packed(tmp_path):
    kind = "<f4" if 'type="Float32" Name="radius"' in VTK_ASCII else "<f8"
    good = packed_polydata(np.array([0.5, 0.25], dtype=kind).tobytes())
    assert packings.read(put(tmp_path, good, ".vtp")).radii.tolist() == [0.5, 0.25]
    refused(put(tmp_path, packed_polydata(bytes(20_000_000)), ".vtp"), "more than [0-9]+ bytes of an array")
    for change in ({"blocks": 2**31}, {"lengths": 2**31}):
        refused(put(tmp_path, packed_polydata(bytes(16), **change), ".vtp"), "not a whole PolyData file")


def test_polydata_whose_xml_expands(tmp_path):
    bomb = '<!DOCTYPE a [<!ENTITY b "bbbbbbbbbb">]>\n' + VTK_ASCII.partition("?>\n")[2]
    refused(put(tmp_path, bomb, ".vtp"), "found a document type")
    many = VTK_ASCII.replace("<PolyData>", "<PolyData>" + "<a/>" * 20_000)
    refused(put(tmp_path, many, ".vtp"), "more than 10000 elements")


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-32", "cp037", "latin-1", "utf-8"])
@pytest.mark.parametrize("said", [False, True])
def test_polydata_in_other_letters(tmp_path, encoding, said):
    """What is looked for in the bytes of a file would not be found, and expat reads it all the same."""
    head, tail = VTK_ASCII.partition("?>\n")[::2]
    head = head.partition(" encoding")[0] + f' encoding="{encoding}"' * said
    text = head + '?>\n<!DOCTYPE a [<!ENTITY b "bbbbbbbbbb">]>\n' + tail
    path = tmp_path / "a.vtp"
    # A declaration in plain letters, and the rest in others, is what 8 bits more allow.
    path.write_bytes(text.encode(encoding))
    if encoding in ("latin-1", "utf-8") and not (said and encoding == "latin-1"):
        refused(path, "found a document type")
    elif encoding == "cp037":
        refused(path, "a.vtp")
    else:
        refused(path, "found XML in .*; expected UTF-8 or ASCII")


@pytest.mark.parametrize("mark", ["", "\N{BYTE ORDER MARK}"])
@pytest.mark.parametrize("encoding", ["UTF-8", "us-ascii"])
def test_polydata_in_usual_letters(tmp_path, mark, encoding):
    head, tail = VTK_ASCII.partition("?>\n")[::2]
    text = f'{mark}{head.partition(" encoding")[0]} encoding="{encoding}"?>\n{tail}'
    assert packings.read(put(tmp_path, text, ".vtp")).number == packings.read(put(tmp_path, VTK_ASCII, ".vtp")).number


def test_polydata_with_more_numbers_than_points(tmp_path):
    begin = VTK_ASCII.index('Name="radius"')
    begin = VTK_ASCII.index(">", begin) + 1
    many = VTK_ASCII[:begin] + "0.5 " * 200_000 + VTK_ASCII[begin:]
    refused(put(tmp_path, many, ".vtp"), "found more than [0-9]+ values of radius")


def test_an_array_of_more_bytes_than_its_shape_takes(tmp_path, small):
    """Zeros behind the numbers of an array would be unpacked for nothing."""
    path = tmp_path / "a.npz"
    packings.write(awkward(0), path)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist() if name != "checksum.npy"}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content + bytes(30_000) * (name == "radii.npy"))
    refused(path, r"radii: found \(60,\) of float64 in [0-9]+ bytes; expected real numbers or text, all there")
