"""Only here: broken packing files whose error names no file, no line, or not what is wrong."""

import numpy as np
import pytest
from packing_files import (
    ASE,
    BOUNDS,
    DATA,
    DUMP,
    FORMATS,
    OVITO,
    VTK_APPENDED,
    VTK_ASCII,
    VTK_BINARY,
    YADE,
    YADE_IDS,
    assert_same,
    awkward,
    put,
)

from demheat.io import packings
from demheat.packing import make_packing


def swapped(text, old, new):
    assert text.count(old) >= 1
    return text.replace(old, new, 1)


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (swapped(DATA, "2500 -0.005 0.012 0.004 0 0 0", "2500 -0.005 0.012"), 18, "found 6 columns.*id type diameter"),
        (swapped(DATA, "3 atoms", "2 atoms"), 19, "found '2 2 0.0051.*the header says 2 atoms"),
        (swapped(DATA, "3 atoms", "4 atoms"), 20, "found 0 columns.*row 4 of 4"),
        (DATA.partition("\n2 2 0.0051")[0] + "\n", 19, "the end of the file; expected row 3 of 3"),
        (swapped(DATA, "2500 -0.005", "2500 -O.005"), 18, "x = '-O.005'; expected a number in column 5"),
        (swapped(DATA, "1 1 0.004", "1 1 0"), 18, r"found radius 0\.0; expected a radius > 0"),
        (swapped(DATA, "2500 -0.005", "2500 nan"), 18, "finite"),
        (swapped(DATA, "2 2 0.0051", "1 2 0.0051"), 19, "id 1 once more"),
        (swapped(DATA, "0.0151 0 0 0", "0.0251 0 0 0"), 19, "between the walls"),
        (swapped(DATA, "# sphere", "# atomic"), 15, "Atoms # atomic; expected Atoms # sphere"),
        (swapped(DATA, "# sphere\n\n", "# sphere\n"), 16, "a blank line after Atoms"),
        (swapped(DATA, "Atoms", "Bonds"), 26, "the end of the file; expected a section Atoms"),
        (swapped(DATA, "3 atoms", "three atoms"), 3, "'three'; expected the number of atoms"),
        (swapped(DATA, "3 atoms", ""), 15, "expected number of atoms before it"),
        (swapped(DATA, "0 0.03 ylo", "0.03 0 ylo"), 7, "expected ylo < yhi"),
        (swapped(DATA, "0 0.03 ylo", "a 0.03 ylo"), 7, "two numbers"),
        (swapped(DATA, "zhi\n", "zhi\n0.1 0 0 xy xz yz\n"), 9, "triclinic"),
        ("", 1, "the end of the file"),
    ],
)
def test_broken_lammps_data(tmp_path, text, line, message):
    path = put(tmp_path, text, ".data")
    with pytest.raises(ValueError, match=f"some.data, line {line}: .*{message}"):
        packings.read(path, periodic=(True, True, False))


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (swapped(DUMP, "ff\n", "ff\nITEM: UNITS\n"), 10, "found 'ITEM: UNITS'; expected xlo xhi"),
        (swapped(DUMP, "ATOMS radius x", "ATOMS mass x"), 13, "mass x y z id; expected radius or diameter"),
        (swapped(DUMP, "ATOMS\n3", "ATOMS\n5"), 17, "the end of the file; expected row 4 of 5"),
        (swapped(DUMP, "ATOMS\n3", "ATOMS\n2"), 16, "expected a line ITEM"),
        (swapped(DUMP, "ATOMS\n3", "ATOMS\nx"), 8, "'x'; expected the integer of ITEM: NUMBER OF ATOMS"),
        (DUMP.partition("ITEM: ATOMS")[0], 13, "expected ITEM: ATOMS"),
        (swapped(DUMP, "ITEM: TIMESTEP\n0\n", ""), 11, "expected ITEM: TIMESTEP before it"),
        (swapped(DUMP, "BOUNDS pp", "BOUNDS xy xz yz pp"), 10, "xlo xhi"),
        (swapped(DUMP, "2.9999999999999999e-02", "0.0"), 11, "ylo < yhi"),
        (swapped(DUMP, "0.002 -0.005", "zwei -0.005"), 15, "radius = 'zwei'; expected a number in column 1"),
        ("", 1, "expected ITEM: TIMESTEP"),
    ],
)
def test_broken_dump(tmp_path, text, line, message):
    with pytest.raises(ValueError, match=f"some.dump, line {line}: .*{message}"):
        packings.read(put(tmp_path, text, ".dump"))


def test_tilted_dump(tmp_path):
    rows = [row + " 0.0" for row in BOUNDS.splitlines()]
    text = DUMP.replace("BOUNDS pp", "BOUNDS xy xz yz pp").replace(BOUNDS, "\n".join(rows) + "\n")
    assert_same(packings.read(put(tmp_path, text, ".dump")), packings.read(put(tmp_path, DUMP, ".lammpstrj")))
    with pytest.raises(ValueError, match="line 12: .*triclinic"):
        packings.read(put(tmp_path, text.replace("e-02 0.0\nITEM: ATOMS", "e-02 0.1\nITEM: ATOMS"), ".dump"))


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("#format x_y_z\n1 2 3\n", 1, "expected #format and one of x_y_z_r, x_y"),
        ("1 2 3 .5\n1 2 3\n", 2, "found 3 columns, '1 2 3'; expected row 2, 4 columns: x y z r"),
        ("# x\n\n1 2 3 .5\n\n# y\n1 2 three .5\n", 6, "z = 'three'; expected a number in column 3"),
        ("1 2 3 .5\n1 2 3 0 # no\n", 2, r"radius 0\.0"),
        (YADE_IDS.replace("\n4\t", "\n7\t"), 4, "id 7 once more"),
    ],
)
def test_broken_yade(tmp_path, text, line, message):
    with pytest.raises(ValueError, match=f"some.yade, line {line}: .*{message}"):
        packings.read(put(tmp_path, text, ".yade"))


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (swapped(ASE, "2\n", "two\n"), 1, "the number of spheres of a frame"),
        (swapped(ASE, "2\n", "3\n"), 5, "the end of the file; expected row 3 of 3"),
        (swapped(ASE, "2\n", "1\n"), 4, "the number of spheres of a frame"),
        (swapped(ASE, ":radius:R:1", ""), 2, "expected Properties=... with pos:R:3 and radius:R:1"),
        (swapped(ASE, "2.0 0.0 0.0 0.0 3", "2.0 0.1 0.0 0.0 3"), 2, "along the axes"),
        (swapped(ASE, "2.0 0.0 ", "2.0 "), 2, "nine numbers"),
        (swapped(ASE, "T T F", "T F"), 2, "pbc"),
        (swapped(OVITO, "-1 0 0.5", "-1 0"), 2, "Origin"),
        (swapped(ASE, "3.00000000 ", "5.00000000 "), 4, "between the walls"),
        ("", 1, "the end of the file"),
    ],
)
def test_broken_xyz(tmp_path, text, line, message):
    with pytest.raises(ValueError, match=f"some.xyz, line {line}: .*{message}"):
        packings.read(put(tmp_path, text, ".xyz"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (swapped(VTK_ASCII, "</Points>", "</Point>"), "line 15: .*expected well-formed XML"),
        (swapped(VTK_ASCII, '"radius"', '"mass"'), "found 2 points with the data mass"),
        (swapped(VTK_ASCII, "0.5 0.25", "0.5"), "found 1 values of radius; expected 2"),
        (swapped(VTK_ASCII, "0.5 0.25", "0.5 -1"), "sphere 2: found radius -1"),
        (swapped(VTK_ASCII, 'type="PolyData"', 'type="ImageData"'), "ImageData"),
        (swapped(VTK_ASCII, "vtkZLib", "vtkLZ4"), "compressor vtkLZ4"),
        (swapped(VTK_BINARY, "eJxjYACBB", "eJxjYACB!"), "not a whole PolyData file"),
        (VTK_APPENDED[:-80], "not a whole PolyData file"),
    ],
)
def test_broken_polydata(tmp_path, text, message):
    with pytest.raises(ValueError, match=f"some.vtp.*{message}"):
        packings.read(put(tmp_path, text, ".vtp"))


@pytest.mark.parametrize("name", ["npz", "vtp"])
def test_cut_binary_files(tmp_path, name):
    path = tmp_path / f"a{FORMATS[name]}"
    packings.write(awkward(0), path)
    whole = path.read_bytes()
    for part in (0, 10, len(whole) // 2, len(whole) - 2000):
        path.write_bytes(whole[:part])
        with pytest.raises(ValueError, match=rf"a\{FORMATS[name]}.*not a whole|a\{FORMATS[name]}, line"):
            packings.read(path)
    if name == "vtp":
        # Inside the bytes of the radii, 80 before those of the points.
        path.write_bytes(whole[: whole.index(b'encoding="raw"') + 200])
        with pytest.raises(ValueError, match=r"found \d+ bytes of an array; expected \d+: the file is cut short"):
            packings.read(path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"centers": None}, "found the arrays radii.*expected centers"),
        ({"radii": np.ones(3)}, "found centers .*radii"),
        ({"centers": np.empty((0, 3)), "radii": np.empty(0)}, r"found centers \(0, 3\) .*; expected .* n > 0"),
        ({"provenance": "{"}, "not a whole"),
        ({"provenance": np.array([{}], dtype=object)}, "pickle"),
    ],
)
def test_broken_npz(tmp_path, change, message):
    arrays = awkward(0)._asdict() | {"provenance": "{}"} | change
    np.savez(tmp_path / "a.npz", **{name: value for name, value in arrays.items() if value is not None})
    with pytest.raises(ValueError, match=f"a.npz.*{message}"):
        packings.read(tmp_path / "a.npz")


@pytest.mark.parametrize(
    ("text", "suffix", "given", "message"),
    [
        (DATA, ".data", {}, "periodic: .*does not say which axes"),
        (DATA, ".data", {"periodic": True, "size": (1, 1, 1)}, "size = .*its own box"),
        (DATA, ".data", {"periodic": "ppf"}, "periodic = 'ppf'"),
        (DATA, ".data", {"step": 1}, "step = 1: .*one packing"),
        (DUMP, ".dump", {"domain": "sphere"}, "some.dump: domain = 'sphere'"),
        (YADE, ".yade", {"periodic": True}, "size: .*has no box"),
        (YADE, ".yade", {"size": (1, 1, 1)}, "line 3: .*between the walls"),
        (ASE, ".xyz", {"step": 1}, "line 5: .*frame 1: the file has 1"),
        (YADE, ".txt", {}, r"the suffix tells no format, .*lammps-data \(.data .lmp\).*yade \(.yade\)"),
        (YADE, ".yade", {"format": "xyz"}, "format = 'xyz': must be one of lammps-data"),
        (VTK_ASCII, ".vtp.gz", {}, "only text is packed"),
    ],
)
def test_bad_arguments_of_read(tmp_path, text, suffix, given, message):
    with pytest.raises(ValueError, match=message):
        packings.read(put(tmp_path, text, suffix), **given)


def test_arguments_are_judged_before_the_file(tmp_path):
    with pytest.raises(ValueError, match="order"):
        packings.read(tmp_path / "absent.data", order="id")
    with pytest.raises(FileNotFoundError):
        packings.read(tmp_path / "absent.npz")
    with pytest.raises(FileNotFoundError):
        packings.read(tmp_path / "absent.data")
    with pytest.raises(FileNotFoundError):
        packings.write(awkward(0), tmp_path / "absent" / "a.data")


def test_a_packing_outside_of_its_box_is_not_written(tmp_path):
    """Not even of a periodic one, whose images lie inside: readers of others would take the places as they are."""
    good = make_packing([[0.2] * 3, [0.7] * 3], [0.1, 0.1], (1, 1, 1), True, {})
    with pytest.raises(ValueError, match=r"packing.centers\[0\] = .*must be finite, in the box"):
        packings.write(good._replace(centers=good.centers + 5.0), tmp_path / "a.yade")
    assert not list(tmp_path.iterdir())
