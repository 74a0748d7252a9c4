"""Only here: packing files of other programs misread, and bits or an order lost on the way there and back."""

import gzip
import locale
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from packing_files import (
    ASE,
    DATA,
    DUMP,
    FORMATS,
    LIGGGHTS,
    OVITO,
    SCALED,
    TEXTS,
    VTK_APPENDED,
    VTK_ASCII,
    VTK_BINARY,
    YADE,
    YADE_ATTRS,
    YADE_IDS,
    assert_same,
    awkward,
    put,
)

from demheat.io import packings
from demheat.network.base import Network
from demheat.packing.base import Packing, make_packing
from demheat.scene import ROUND_AXES


@pytest.mark.parametrize("name", TEXTS)
def test_a_locale_with_decimal_commas_changes_nothing(tmp_path, monkeypatch, name):
    """As if the user's were German: what formats numbers by the locale is told of a comma."""
    here, there = (tmp_path / f"{k}{FORMATS[name]}" for k in range(2))
    packings.write(awkward(0), here)
    monkeypatch.setattr(locale, "_override_localeconv", {"decimal_point": ",", "thousands_sep": "."})
    assert locale.str(0.5) == "0,5"
    packings.write(awkward(0), there)
    assert there.read_bytes() == here.read_bytes()
    assert_array_equal(packings.read(there, periodic=True).radii, awkward(0).radii)


# --- files of other programs


@pytest.mark.parametrize(("text", "suffix"), [(DATA, ".data"), (DUMP, ".dump"), (SCALED, ".lammpstrj")])
def test_lammps(tmp_path, text, suffix):
    periodic = (True, True, False) if suffix == ".data" else None
    packing = packings.read(put(tmp_path, text, suffix), periodic=periodic)
    # The corner is moved to 0 and rows are in the order of the ids; SCALED holds 6 digits.
    close = {"rtol": 2e-6 if text == SCALED else 1e-14}
    assert_allclose(packing.centers, [[0.005, 0.012, 0.004], [0.0199, 0.02, 0.0151], [0.011, 0.001, 0.01]], **close)
    assert_allclose(packing.radii, [0.002, 0.00255, 0.0015], rtol=1e-15)  # rounding
    assert_allclose(packing.size, [0.02, 0.03, 0.02], rtol=1e-15)  # rounding
    assert packing.periodic.tolist() == [True, True, False] and packing.domain == "box"


def test_liggghts_timesteps(tmp_path):
    path = put(tmp_path, LIGGGHTS, ".liggghts")
    last, middle = packings.read(path), packings.read(path, step=800)
    assert last.number == 1 and last.provenance["step"] == 1600
    assert_allclose(last.centers, [[0.0298, 0.0607, 0.0833]], rtol=1e-14)  # rounding
    # By id, though 2 comes first in the file.
    assert middle.radii.tolist() == [0.0025, 0.005] and middle.periodic.tolist() == [False] * 3
    assert_allclose(middle.centers[1], [0.0625, 0.0189, 0.1202], rtol=1e-14)  # rounding
    with pytest.raises(ValueError, match="timestep 5: the file has 1, 800, 1600"):
        packings.read(path, step=5)
    with pytest.raises(ValueError, match="line 9: found no atoms"):
        packings.read(path, step=1)


def test_unwrapped_coordinates_are_wrapped(tmp_path):
    text = DUMP.replace("radius x y z id", "radius xu yu zu id").replace("0.0015 0.001 ", "0.0015 0.041 ")
    packing = packings.read(put(tmp_path, text, ".dump"))
    assert_allclose(packing.centers[2], [0.011, 0.001, 0.01], rtol=1e-13)  # rounding of two boxes
    with pytest.raises(ValueError, match="line 14: found x y z = .* between the walls"):
        packings.read(put(tmp_path, text, ".dump"), periodic=False)


@pytest.mark.parametrize("text", [YADE, YADE_IDS, YADE_ATTRS, YADE.partition("\n")[2], "# a\n\n" + YADE + "\n# b\n"])
def test_yade(tmp_path, text):
    path = put(tmp_path, text, ".yade")
    packing = packings.read(path, size=(2, 3, 4), periodic=(True, False, False))
    assert packing.centers.tolist() == [[0.5, 0.25, 0.125], [1, 2, 3]]
    assert packing.radii.tolist() == [0.0625, 0.5] and packing.size.tolist() == [2, 3, 4]
    assert packing.provenance["box"] == "given" and packing.periodic.tolist() == [True, False, False]
    guessed = packings.read(path)
    # All numbers are exact in binary: the box runs from .4375 .1875 .0625 to 1.5 2.5 3.5.
    assert guessed.size.tolist() == [1.0625, 2.3125, 3.4375] and not guessed.periodic.any()
    assert guessed.centers.tolist() == [[0.0625, 0.0625, 0.0625], [0.5625, 1.8125, 2.9375]]
    assert guessed.provenance["box"] == "bounding box of the spheres"


def test_extended_xyz(tmp_path):
    packing = packings.read(put(tmp_path, ASE, ".xyz"))
    assert packing.centers.tolist() == [[0.1, 0.2, 0.3], [1, 2, 3]] and packing.radii.tolist() == [0.5, 0.25]
    assert packing.size.tolist() == [2, 3, 4] and packing.periodic.tolist() == [True, True, False]
    moved = packings.read(put(tmp_path, OVITO, ".extxyz"))
    # Exact in binary; rows by id; a lattice without pbc is periodic, as ASE has it.
    assert moved.centers.tolist() == [[0.5, 0.25, 1.0], [1.5, 2, 2.5]] and moved.radii.tolist() == [0.5, 0.25]
    assert moved.periodic.all()
    both = put(tmp_path, ASE + OVITO + "\n", ".xyz")
    assert_same(packings.read(both), moved)
    assert_same(packings.read(both, step=0), packing)
    foreign = put(tmp_path, ASE.replace("note=", "domain=surface note="), ".xyz")
    assert packings.read(foreign).domain == "box"
    boxless = put(tmp_path, ASE.replace('Lattice="2.0 0.0 0.0 0.0 3.0 0.0 0.0 0.0 4.0" ', ""), ".xyz")
    assert packings.read(boxless, size=(2, 3, 4)).centers.tolist() == packing.centers.tolist()


@pytest.mark.parametrize("text", [VTK_ASCII, VTK_BINARY, VTK_APPENDED], ids=["ascii", "binary", "appended"])
def test_polydata_of_vtk(tmp_path, text):
    packing = packings.read(put(tmp_path, text, ".vtp"), size=(2, 3, 4), periodic=True)
    assert packing.centers.tolist() == [[0.1, 0.2, 0.3], [1, 2, 3]] and packing.radii.tolist() == [0.5, 0.25]
    assert packing.size.tolist() == [2, 3, 4] and packing.periodic.all()
    wide = packings.read(put(tmp_path, text.replace('"radius"', '"Diameter"'), ".vtp"), size=(2, 3, 4))
    assert wide.radii.tolist() == [0.25, 0.125]


# --- there and back


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("seed", [1, 4])
def test_round_trip_keeps_every_bit_and_the_order(tmp_path, name, seed):
    periodic = np.random.default_rng(seed).random(3) < 0.5
    packing = awkward(seed, periodic=periodic, scale=10.0 ** (3 * seed - 6))
    path = tmp_path / f"packing{FORMATS[name]}"
    packings.write(packing, path)
    assert_same(packings.read(path), packing)
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]
    # Rows that no curve has sorted: their order is kept all the same, unless "morton" is asked for.
    shuffle = np.random.default_rng(seed + 100).permutation(packing.number)
    mixed = packing._replace(centers=packing.centers[shuffle], radii=packing.radii[shuffle])
    packings.write(mixed, path)
    assert_same(packings.read(path), mixed)
    assert_same(packings.read(path, order="morton"), packing)


@pytest.mark.parametrize("name", [name for name in FORMATS if name != "lammps-dump"])
@pytest.mark.parametrize("domain", [domain for domain in ROUND_AXES if domain != "box"])
def test_domains_come_back(tmp_path, name, domain):
    packing = awkward(1, domain=domain, periodic=(False, False, False))
    path = tmp_path / f"packing{FORMATS[name]}"
    packings.write(packing, path)
    assert_same(packings.read(path), packing)


def test_a_dump_has_no_domain(tmp_path):
    packing = awkward(1, domain="sphere", periodic=(False, False, False))
    path = tmp_path / "packing.dump"
    packings.write(packing, path)
    assert packings.read(path).domain == "box"
    assert_same(packings.read(path, domain="sphere"), packing)


@pytest.mark.parametrize("name", TEXTS)
def test_packed_text(tmp_path, name):
    packing, path = awkward(3, number=200), tmp_path / f"packing{FORMATS[name]}.gz"
    packings.write(packing, path)
    assert_same(packings.read(path), packing)
    first = path.read_bytes()
    # No time in the header (RFC 1952, bytes 4 to 7): equal packings make equal files.
    assert first[4:8] == bytes(4)
    path.write_bytes(first[: len(first) // 2])
    with pytest.raises(ValueError, match=r"line \d+: found .*packed data"):
        packings.read(path)
    plain = path.with_suffix("")
    plain.write_bytes(gzip.decompress(first))
    assert_same(packings.read(plain), packing)


def test_provenance_in_npz_only(tmp_path):
    packing = awkward(2)
    packing.provenance["number"] = np.int64(7)
    packings.write(packing, tmp_path / "a.npz")
    assert packings.read(tmp_path / "a.npz").provenance == packing.provenance
    packings.write(packing, tmp_path / "a.xyz")
    assert packings.read(tmp_path / "a.xyz").provenance == {
        "algorithm": "read",
        "file": "a.xyz",
        "format": "extxyz",
        "frame": 0,
    }
    packing.provenance["what"] = object()
    with pytest.raises(ValueError, match="provenance"):
        packings.write(packing, tmp_path / "b.npz")
    assert not (tmp_path / "b.npz").exists()


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "a.data"
    packings.write(awkward(0), path)
    before = path.read_bytes()

    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(packings.lammps_data, "write_rows", stop)
    with pytest.raises(KeyboardInterrupt):
        packings.write(awkward(1), path)
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_written_text_is_what_the_programs_expect(tmp_path):
    packing = make_packing([[0.5, 0.25, 1.0]], [0.1], (1, 1, 2), (True, False, True), {})
    shown = {}
    for name in TEXTS:
        packings.write(packing, tmp_path / "a", format=name)
        shown[name] = (tmp_path / "a").read_text().splitlines()
    assert shown["lammps-data"][2:] == (
        ["1 atoms", "1 atom types", "", "0.0 1.0 xlo xhi", "0.0 1.0 ylo yhi", "0.0 2.0 zlo zhi", ""]
        + ["Atoms # sphere", "", "1 1 0.2 1.0 0.5 0.25 1.0"]
    )
    assert shown["lammps-dump"] == (
        [
            "ITEM: TIMESTEP",
            "0",
            "ITEM: NUMBER OF ATOMS",
            "1",
            "ITEM: BOX BOUNDS pp ff pp",
            "0.0 1.0",
            "0.0 1.0",
            "0.0 2.0",
        ]
        + ["ITEM: ATOMS id type x y z radius", "1 1 0.5 0.25 1.0 0.1"]
    )
    # ymport.textExt takes the first line as the layout, skips "#" and stumbles over blank lines.
    assert shown["yade"][0] == "#format x_y_z_r" and shown["yade"][1].startswith("# ")
    assert shown["yade"][2:] == ["0.5\t0.25\t1.0\t0.1"]
    assert shown["extxyz"][0] == "1" and shown["extxyz"][2] == "X 0.5 0.25 1.0 0.1 1"
    assert 'Lattice="1.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 2.0"' in shown["extxyz"][1]
    assert "Properties=species:S:1:pos:R:3:radius:R:1:id:I:1" in shown["extxyz"][1]
    assert 'pbc="T F T"' in shown["extxyz"][1]


# --- links for ParaView


def chain():
    """Three spheres in a row in a periodic box: links 0-1, 1-2 inside, 2-0 through the face."""
    packing = make_packing([[0.5, 0.5, 0.5], [1.5, 0.5, 0.5], [2.5, 0.5, 0.5]], [0.5] * 3, (3, 1, 1), True, {})
    none = np.zeros(0)
    # Codes 13, 22 and 4: no shift, one box up and one box down along x.
    network = Network(
        packing.centers,
        packing.size,
        np.array([0, 2, 4, 6]),
        np.array([1, 2, 0, 2, 1, 0], dtype=np.uint32),
        np.array([13, 4, 13, 13, 13, 22], dtype=np.uint8),
        np.array([2.0, 7.0, 2.0, 3.0, 3.0, 7.0]),
        *[none] * 5,
        np.ones(3),
        np.zeros(3, dtype=int),
    )
    return packing, network


def raw_arrays(path):
    """The appended arrays of a file by name, by the VTK specification: 8 bytes of length, then the data."""
    head, _, rest = path.read_bytes().partition(b'<AppendedData encoding="raw">\n_')
    kinds, found = {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8", "UInt8": "u1"}, {}
    for section in ET.fromstring(head + b"</VTKFile>").iter():
        for element in section.findall("DataArray"):
            start = int(element.get("offset"))
            length = int.from_bytes(rest[start : start + 8], "little")
            values = np.frombuffer(rest[start + 8 : start + 8 + length], kinds[element.get("type")])
            found[section.tag, element.get("Name")] = values
    return found


def test_links(tmp_path):
    packing, network = chain()
    temperature = [300.0, 310.0, np.nan]
    packings.write(packing, tmp_path / "a.vtp", network=network, temperature=temperature)
    arrays = raw_arrays(tmp_path / "a.vtp")
    assert arrays["Lines", "connectivity"].tolist() == [0, 1, 1, 2] and arrays["Lines", "offsets"].tolist() == [2, 4]
    assert arrays["CellData", "conductance"].tolist() == [2.0, 3.0]
    # 2 W/K times (310 - 300) K arrive at particle 0.
    assert_array_equal(arrays["CellData", "heat_flow"], [20.0, np.nan])
    assert_array_equal(arrays["PointData", "temperature"], temperature)
    assert arrays["FieldData", "links_cut"].tolist() == [1] and len(arrays["Verts", "connectivity"]) == 0
    assert_same(packings.read(tmp_path / "a.vtp"), packing)
    packings.write(packing, tmp_path / "b.vtp", network=network)
    assert ("CellData", "heat_flow") not in raw_arrays(tmp_path / "b.vtp")
    packings.write(packing, tmp_path / "c.vtp", temperature=temperature)
    arrays = raw_arrays(tmp_path / "c.vtp")
    assert arrays["Verts", "offsets"].tolist() == [1, 2, 3]
    assert arrays["Verts", "connectivity"].tolist() == [0, 1, 2] and ("CellData", "conductance") not in arrays


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"network": 3}, "network = int: must be a Network"),
        ({"network": "moved"}, "must be packing.centers"),
        ({"temperature": [1.0, 2.0]}, "temperature of shape"),
        ({"temperature": [1.0, 2.0, np.inf]}, "temperature"),
        ({"temperature": [1.0, 2.0, 3.0], "path": "a.data"}, "lammps-data has no place"),
        ({"network": "own", "path": "a.npz"}, "npz has no place"),
        ({"packing": "own"}, "packing = 'own': must be a Packing"),
        ({"packing": "nan"}, "centers"),
    ],
)
def test_bad_arguments_of_write(tmp_path, change, message):
    packing, network = chain()
    moved = network._replace(centers=network.centers[::-1])
    given = {"packing": packing, "path": "a.vtp"} | change
    given["path"] = tmp_path / given["path"]
    if "network" in given:
        given["network"] = {"moved": moved, "own": network}.get(given["network"], given["network"])
    if given["packing"] == "nan":
        given["packing"] = packing._replace(centers=packing.centers * np.nan)
    with pytest.raises(ValueError, match=message):
        packings.write(**given)
    assert list(tmp_path.iterdir()) == []


def test_the_suffix_is_only_a_default(tmp_path):
    path = put(tmp_path, YADE, ".txt")
    assert packings.read(path, format="yade").number == 2
    assert isinstance(packings.read(put(tmp_path, DUMP, ".DUMP")), Packing)


def test_lammps_data_header_in_any_order(tmp_path):
    head = "# a comment\n-0 2 zlo zhi # low high\n0 2 xlo xhi\n\n0 0 0 xy xz yz\n0 bonds\n0 2 ylo yhi\n 1 atoms\n"
    text = (
        head + "1 atom types\n\nMasses\n\n1 1.0\n\nVelocities\n\n1 0 0 0 0 0 0\n\nAtoms\n\n1 1 0.5 1 1 1.5 1 # first\n"
    )
    packing = packings.read(put(tmp_path, text, ".lmp"), periodic=True)
    assert packing.centers.tolist() == [[1, 1.5, 1]] and packing.radii.tolist() == [0.25]


def test_comments_in_any_encoding(tmp_path):
    path = tmp_path / "a.yade"
    path.write_bytes("# Körner\r\n1 2 3 .5\r\n".encode("latin-1"))
    assert packings.read(path).radii.tolist() == [0.5]
