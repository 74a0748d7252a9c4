"""Packing files: as other programs write them, there and back bit for bit, and broken ones."""

import gzip
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat.network.base import Network
from demheat.packing import io
from demheat.packing.base import ROUND_AXES, Packing, make_packing

FORMATS = {
    "lammps-data": ".data",
    "lammps-dump": ".dump",
    "yade": ".yade",
    "extxyz": ".xyz",
    "npz": ".npz",
    "vtp": ".vtp",
}
TEXTS = [name for name in FORMATS if name not in ("npz", "vtp")]

# As LAMMPS (22 Jul 2025) writes them: write_data, and write_dump atom and custom.
DATA = """LAMMPS data file via write_data, version 22 Jul 2025, timestep = 0, units = si

3 atoms
2 atom types

-0.01 0.01 xlo xhi
0 0.03 ylo yhi
0 0.02 zlo zhi

Pair Coeffs # zero

1
2

Atoms # sphere

3 1 0.003 2500 0.001 0.001 0.01 0 0 0
1 1 0.004 2500 -0.005 0.012 0.004 0 0 0
2 2 0.0051 2500 0.0099 0.02 0.0151 0 0 0

Velocities

1 0.1 0.2 0 0 0 0
2 0.1 0.2 0 0 0 0
3 0.1 0.2 0 0 0 0
"""
BOUNDS = """-1.0000000000000000e-02 1.0000000000000000e-02
0.0000000000000000e+00 2.9999999999999999e-02
0.0000000000000000e+00 2.0000000000000000e-02
"""
DUMP = f"""ITEM: UNITS
si
ITEM: TIME
0
ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
3
ITEM: BOX BOUNDS pp pp ff
{BOUNDS}ITEM: ATOMS radius x y z id
0.0015 0.001 0.001 0.01 3
0.002 -0.005 0.012 0.004 1
0.00255 0.0099 0.02 0.0151 2
"""
SCALED = f"""ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
3
ITEM: BOX BOUNDS pp pp ff
{BOUNDS}ITEM: ATOMS id type diameter xs ys zs ix iy iz
1 1 0.004 0.25 0.4 0.2 0 0 0
2 2 0.0051 0.995 0.666667 0.755 0 0 0
3 1 0.003 0.55 0.0333333 0.5 0 0 0
"""
# As LIGGGHTS writes them: dump custom, type twice, nothing in the box at first.
LIGGGHTS = """ITEM: TIMESTEP
1
ITEM: NUMBER OF ATOMS
0
ITEM: BOX BOUNDS ff ff ff
-0.05 0.05
-0.05 0.05
0 0.15
ITEM: ATOMS id type type x y z ix iy iz vx vy vz fx fy fz omegax omegay omegaz radius{blank}
ITEM: TIMESTEP
800
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS ff ff ff
-0.05 0.05
-0.05 0.05
0 0.15
ITEM: ATOMS id type type x y z ix iy iz vx vy vz fx fy fz omegax omegay omegaz radius{blank}
2 1 1 0.0125 -0.0311 0.1202 0 0 0 0 0 -0.078 0 0 0 0 0 0 0.005{blank}
1 1 1 -0.0202 0.0107 0.0911 0 0 0 0 0 -0.078 0 0 0 0 0 0 0.0025{blank}
ITEM: TIMESTEP
1600
ITEM: NUMBER OF ATOMS
1
ITEM: BOX BOUNDS ff ff ff
-0.05 0.05
-0.05 0.05
0 0.15
ITEM: ATOMS id type type x y z ix iy iz vx vy vz fx fy fz omegax omegay omegaz radius{blank}
1 1 1 -0.0202 0.0107 0.0833 0 0 0 0 0 -0.078 0 0 0 0 0 0 0.0025{blank}
""".format(blank=" ")
# As yade.export.text and textExt write them.
YADE = "#format x_y_z_r\n0.5\t0.25\t0.125\t0.0625\n1\t2\t3\t0.5\n"
YADE_IDS = "#format id_x_y_z_r_matId\n# beads\n7\t1\t2\t3\t0.5\t0\n4\t0.5\t0.25\t0.125\t0.0625\t1\n"
YADE_ATTRS = "#format x_y_z_r_attrs\n#x y z r a b\n0.5\t0.25\t0.125\t0.0625\t1\tred\n1\t2\t3\t0.5\t2\tblue\n"
# As ASE writes them, and with the keys of other writers for OVITO.
ASE = """2
Lattice="2.0 0.0 0.0 0.0 3.0 0.0 0.0 0.0 4.0" Properties=species:S:1:pos:R:3:radius:R:1 note="two words" pbc="T T F"
Si       0.10000000       0.20000000       0.30000000       0.50000000
X        1.00000000       2.00000000       3.00000000       0.25000000
"""
OVITO = """2
Lattice="2 0 0 0 3 0 0 0 4" Origin="-1 0 0.5" Properties=id:I:1:Radius:R:1:pos:R:3
9 0.25 0.5 2 3
5 0.5 -0.5 0.25 1.5
"""
# As VTK (9.7) writes them: XML appended in base64, packed by zlib; and ASCII.
VTK = """<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian" header_type="UInt32"
 compressor="vtkZLibDataCompressor">
  <PolyData>
    <Piece NumberOfPoints="2" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
      <PointData>
        <DataArray type="Float64" Name="radius" format="{format}" {radius}
      </PointData>
      <Points>
        <DataArray type="Float64" Name="Points" NumberOfComponents="3" format="{format}" {points}
      </Points>
    </Piece>
  </PolyData>{appended}
</VTKFile>
"""
VTK_ASCII = VTK.format(
    format="ascii", radius=">\n0.5 0.25\n</DataArray>", points=">\n0.1 0.2 0.3 1 2 3\n</DataArray>", appended=""
)
VTK_BINARY = VTK.format(
    format="binary",
    radius=">\n          AQAAAACAAAAQAAAAEgAAAA==eJxjYACBB/ZgiuGCPQAM5gIv\n        </DataArray>",
    points='>\nAQAAAACAAAAwAAAAIgAAAA==eJybNRMEdtrPAtMn7Y3B4LI9Axh8gNIMDhCKwwEAy/INKg==\n<InformationKey name="x" '
    'location="y" length="1"><Value index="0">3.7</Value></InformationKey></DataArray>',
    appended="",
)
VTK_APPENDED = VTK.format(
    format="appended",
    radius='offset="40"/>',
    points='offset="88"/>',
    appended='<AppendedData encoding="base64">\n   _'
    "AQAAAACAAAAEAAAADAAAAA==eJxLyq9gAAADyQFK"
    "AQAAAACAAAAQAAAAEgAAAA==eJxjYACBB/ZgiuGCPQAM5gIv"
    "AQAAAACAAAAwAAAAIgAAAA==eJybNRMEdtrPAtMn7Y3B4LI9Axh8gNIMDhCKwwEAy/INKg==\n</AppendedData>",
)


def put(folder, text, suffix):
    path = folder / f"some{suffix}"
    path.write_text(text, encoding="utf-8")
    return path


def awkward(seed, *, domain="box", periodic=(True, False, True), scale=1.0, number=60):
    """Spheres whose numbers are hard on text: all digits, tiny ones, neighbours of round ones."""
    rng = np.random.default_rng(seed)
    size = np.array([0.1, 0.1, 0.1] if domain != "box" else [0.1, 0.3, 1 / 3]) * scale
    inner = 0.3 if domain != "box" else 0.0
    centers = size * rng.uniform(inner, 1 - inner, (number, 3))
    centers[0] = [np.nextafter(size[0] / 2, 0), np.nextafter(size[1] / 2, 1e9), size[2] / 2]
    if domain == "box":
        centers[1] = [0.0, 5e-324, np.nextafter(size[2], 0)]
    radii = 10.0 ** rng.uniform(-9, -1, number) * scale
    radii[:2] = np.nextafter(0.1, 1) * scale, 1 / 3 * scale
    provenance = {"algorithm": "test", "seed": seed, "phi": float(rng.random())}
    return make_packing(centers, radii, size, np.array(periodic), provenance, domain=domain)


def assert_same(one, other):
    """The same bits in the same order."""
    for name in ("centers", "radii", "size", "periodic"):
        a, b = getattr(one, name), getattr(other, name)
        assert a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes(), name
    assert one.domain == other.domain


# --- files of other programs


@pytest.mark.parametrize(("text", "suffix"), [(DATA, ".data"), (DUMP, ".dump"), (SCALED, ".lammpstrj")])
def test_lammps(tmp_path, text, suffix):
    periodic = (True, True, False) if suffix == ".data" else None
    packing = io.read(put(tmp_path, text, suffix), periodic=periodic)
    # The corner is moved to 0 and rows are in the order of the ids; SCALED holds 6 digits.
    close = {"rtol": 2e-6 if text == SCALED else 1e-14}
    assert_allclose(packing.centers, [[0.005, 0.012, 0.004], [0.0199, 0.02, 0.0151], [0.011, 0.001, 0.01]], **close)
    assert_allclose(packing.radii, [0.002, 0.00255, 0.0015], rtol=1e-15)  # rounding
    assert_allclose(packing.size, [0.02, 0.03, 0.02], rtol=1e-15)  # rounding
    assert packing.periodic.tolist() == [True, True, False] and packing.domain == "box"


def test_lammps_data_header_in_any_order(tmp_path):
    head = "# a comment\n-0 2 zlo zhi # low high\n0 2 xlo xhi\n\n0 0 0 xy xz yz\n0 bonds\n0 2 ylo yhi\n 1 atoms\n"
    text = (
        head + "1 atom types\n\nMasses\n\n1 1.0\n\nVelocities\n\n1 0 0 0 0 0 0\n\nAtoms\n\n1 1 0.5 1 1 1.5 1 # first\n"
    )
    packing = io.read(put(tmp_path, text, ".lmp"), periodic=True)
    assert packing.centers.tolist() == [[1, 1.5, 1]] and packing.radii.tolist() == [0.25]


def test_liggghts_timesteps(tmp_path):
    path = put(tmp_path, LIGGGHTS, ".liggghts")
    last, middle = io.read(path), io.read(path, step=800)
    assert last.number == 1 and last.provenance["step"] == 1600
    assert_allclose(last.centers, [[0.0298, 0.0607, 0.0833]], rtol=1e-14)  # rounding
    # By id, though 2 comes first in the file.
    assert middle.radii.tolist() == [0.0025, 0.005] and middle.periodic.tolist() == [False] * 3
    assert_allclose(middle.centers[1], [0.0625, 0.0189, 0.1202], rtol=1e-14)  # rounding
    with pytest.raises(ValueError, match="timestep 5: the file has 1, 800, 1600"):
        io.read(path, step=5)
    with pytest.raises(ValueError, match="line 9: found no atoms"):
        io.read(path, step=1)


def test_unwrapped_coordinates_are_wrapped(tmp_path):
    text = DUMP.replace("radius x y z id", "radius xu yu zu id").replace("0.0015 0.001 ", "0.0015 0.041 ")
    packing = io.read(put(tmp_path, text, ".dump"))
    assert_allclose(packing.centers[2], [0.011, 0.001, 0.01], rtol=1e-13)  # rounding of two boxes
    with pytest.raises(ValueError, match="line 14: found x y z = .* between the walls"):
        io.read(put(tmp_path, text, ".dump"), periodic=False)


@pytest.mark.parametrize("text", [YADE, YADE_IDS, YADE_ATTRS, YADE.partition("\n")[2], "# a\n\n" + YADE + "\n# b\n"])
def test_yade(tmp_path, text):
    path = put(tmp_path, text, ".yade")
    packing = io.read(path, size=(2, 3, 4), periodic=(True, False, False))
    assert packing.centers.tolist() == [[0.5, 0.25, 0.125], [1, 2, 3]]
    assert packing.radii.tolist() == [0.0625, 0.5] and packing.size.tolist() == [2, 3, 4]
    assert packing.provenance["box"] == "given" and packing.periodic.tolist() == [True, False, False]
    guessed = io.read(path)
    # All numbers are exact in binary: the box runs from .4375 .1875 .0625 to 1.5 2.5 3.5.
    assert guessed.size.tolist() == [1.0625, 2.3125, 3.4375] and not guessed.periodic.any()
    assert guessed.centers.tolist() == [[0.0625, 0.0625, 0.0625], [0.5625, 1.8125, 2.9375]]
    assert guessed.provenance["box"] == "bounding box of the spheres"


def test_extended_xyz(tmp_path):
    packing = io.read(put(tmp_path, ASE, ".xyz"))
    assert packing.centers.tolist() == [[0.1, 0.2, 0.3], [1, 2, 3]] and packing.radii.tolist() == [0.5, 0.25]
    assert packing.size.tolist() == [2, 3, 4] and packing.periodic.tolist() == [True, True, False]
    moved = io.read(put(tmp_path, OVITO, ".extxyz"))
    # Exact in binary; rows by id; a lattice without pbc is periodic, as ASE has it.
    assert moved.centers.tolist() == [[0.5, 0.25, 1.0], [1.5, 2, 2.5]] and moved.radii.tolist() == [0.5, 0.25]
    assert moved.periodic.all()
    both = put(tmp_path, ASE + OVITO + "\n", ".xyz")
    assert_same(io.read(both), moved)
    assert_same(io.read(both, step=0), packing)
    foreign = put(tmp_path, ASE.replace("note=", "domain=surface note="), ".xyz")
    assert io.read(foreign).domain == "box"
    boxless = put(tmp_path, ASE.replace('Lattice="2.0 0.0 0.0 0.0 3.0 0.0 0.0 0.0 4.0" ', ""), ".xyz")
    assert io.read(boxless, size=(2, 3, 4)).centers.tolist() == packing.centers.tolist()


@pytest.mark.parametrize("text", [VTK_ASCII, VTK_BINARY, VTK_APPENDED], ids=["ascii", "binary", "appended"])
def test_polydata_of_vtk(tmp_path, text):
    packing = io.read(put(tmp_path, text, ".vtp"), size=(2, 3, 4), periodic=True)
    assert packing.centers.tolist() == [[0.1, 0.2, 0.3], [1, 2, 3]] and packing.radii.tolist() == [0.5, 0.25]
    assert packing.size.tolist() == [2, 3, 4] and packing.periodic.all()
    wide = io.read(put(tmp_path, text.replace('"radius"', '"Diameter"'), ".vtp"), size=(2, 3, 4))
    assert wide.radii.tolist() == [0.25, 0.125]


# --- there and back


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("seed", range(5))
def test_round_trip_keeps_every_bit_and_the_order(tmp_path, name, seed):
    periodic = np.random.default_rng(seed).random(3) < 0.5
    packing = awkward(seed, periodic=periodic, scale=10.0 ** (3 * seed - 6))
    path = tmp_path / f"packing{FORMATS[name]}"
    io.write(packing, path)
    assert_same(io.read(path), packing)
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]
    # Rows that no curve has sorted: their order is kept all the same, unless "morton" is asked for.
    shuffle = np.random.default_rng(seed + 100).permutation(packing.number)
    mixed = packing._replace(centers=packing.centers[shuffle], radii=packing.radii[shuffle])
    io.write(mixed, path)
    assert_same(io.read(path), mixed)
    assert_same(io.read(path, order="morton"), packing)


@pytest.mark.parametrize("name", [name for name in FORMATS if name != "lammps-dump"])
@pytest.mark.parametrize("domain", [domain for domain in ROUND_AXES if domain != "box"])
def test_domains_come_back(tmp_path, name, domain):
    packing = awkward(1, domain=domain, periodic=(False, False, False))
    path = tmp_path / f"packing{FORMATS[name]}"
    io.write(packing, path)
    assert_same(io.read(path), packing)


def test_a_dump_has_no_domain(tmp_path):
    packing = awkward(1, domain="sphere", periodic=(False, False, False))
    path = tmp_path / "packing.dump"
    io.write(packing, path)
    assert io.read(path).domain == "box"
    assert_same(io.read(path, domain="sphere"), packing)


@pytest.mark.parametrize("name", TEXTS)
def test_packed_text(tmp_path, name):
    packing, path = awkward(3, number=200), tmp_path / f"packing{FORMATS[name]}.gz"
    io.write(packing, path)
    assert_same(io.read(path), packing)
    first = path.read_bytes()
    # No time in the header (RFC 1952, bytes 4 to 7): equal packings make equal files.
    assert first[4:8] == bytes(4)
    path.write_bytes(first[: len(first) // 2])
    with pytest.raises(ValueError, match=r"line \d+: found .*packed data"):
        io.read(path)
    plain = path.with_suffix("")
    plain.write_bytes(gzip.decompress(first))
    assert_same(io.read(plain), packing)


def test_provenance_in_npz_only(tmp_path):
    packing = awkward(2)
    packing.provenance["number"] = np.int64(7)
    io.write(packing, tmp_path / "a.npz")
    assert io.read(tmp_path / "a.npz").provenance == packing.provenance
    io.write(packing, tmp_path / "a.xyz")
    assert io.read(tmp_path / "a.xyz").provenance == {
        "algorithm": "read",
        "file": "a.xyz",
        "format": "extxyz",
        "frame": 0,
    }
    packing.provenance["what"] = object()
    with pytest.raises(ValueError, match="provenance"):
        io.write(packing, tmp_path / "b.npz")
    assert not (tmp_path / "b.npz").exists()


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "a.data"
    io.write(awkward(0), path)
    before = path.read_bytes()

    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(io.lammps_data, "write_rows", stop)
    with pytest.raises(KeyboardInterrupt):
        io.write(awkward(1), path)
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_written_text_is_what_the_programs_expect(tmp_path):
    packing = make_packing([[0.5, 0.25, 1.0]], [0.1], (1, 1, 2), (True, False, True), {})
    shown = {}
    for name in TEXTS:
        io.write(packing, tmp_path / "a", format=name)
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
    io.write(packing, tmp_path / "a.vtp", network=network, temperature=temperature)
    arrays = raw_arrays(tmp_path / "a.vtp")
    assert arrays["Lines", "connectivity"].tolist() == [0, 1, 1, 2] and arrays["Lines", "offsets"].tolist() == [2, 4]
    assert arrays["CellData", "conductance"].tolist() == [2.0, 3.0]
    # 2 W/K times (310 - 300) K arrive at particle 0.
    assert_array_equal(arrays["CellData", "heat_flow"], [20.0, np.nan])
    assert_array_equal(arrays["PointData", "temperature"], temperature)
    assert arrays["FieldData", "links_cut"].tolist() == [1] and len(arrays["Verts", "connectivity"]) == 0
    assert_same(io.read(tmp_path / "a.vtp"), packing)
    io.write(packing, tmp_path / "b.vtp", network=network)
    assert ("CellData", "heat_flow") not in raw_arrays(tmp_path / "b.vtp")
    io.write(packing, tmp_path / "c.vtp", temperature=temperature)
    arrays = raw_arrays(tmp_path / "c.vtp")
    assert arrays["Verts", "offsets"].tolist() == [1, 2, 3]
    assert arrays["Verts", "connectivity"].tolist() == [0, 1, 2] and ("CellData", "conductance") not in arrays


def test_vtk_reads_what_is_written(tmp_path):
    vtk = pytest.importorskip("vtk")
    numbers = pytest.importorskip("vtk.util.numpy_support").vtk_to_numpy
    packing, network = chain()
    io.write(packing, tmp_path / "a.vtp", network=network, temperature=[1.0, 2.0, 4.0])
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(tmp_path / "a.vtp"))
    reader.Update()
    data = reader.GetOutput()
    assert_array_equal(numbers(data.GetPoints().GetData()), packing.centers)
    assert_array_equal(numbers(data.GetPointData().GetArray("radius")), packing.radii)
    assert numbers(data.GetLines().GetConnectivityArray()).tolist() == [0, 1, 1, 2]
    assert numbers(data.GetCellData().GetArray("heat_flow")).tolist() == [2.0, 6.0]
    assert data.GetFieldData().GetAbstractArray("domain").GetValue(0) == "box"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"network": 3}, "network = int: must be a Network"),
        ({"network": "moved"}, "must be packing.centers"),
        ({"temperature": [1.0, 2.0]}, "temperature of shape"),
        ({"temperature": [1.0, 2.0, np.inf]}, "temperature"),
        ({"temperature": [1.0, 2.0, 3.0], "path": "a.data"}, "lammps-data has no place"),
        ({"network": "own", "path": "a.npz"}, "npz has no place"),
        ({"packing": "own"}, "packing = str"),
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
        io.write(**given)
    assert list(tmp_path.iterdir()) == []


# --- broken files and arguments


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
        (swapped(DATA, "1 1 0.004", "1 1 -0.004"), 18, r"found radius -0\.002"),
        (swapped(DATA, "2500 -0.005", "2500 nan"), 18, "finite"),
        (swapped(DATA, "2500 -0.005", "2500 1e999"), 18, "finite"),
        (swapped(DATA, "2 2 0.0051", "1 2 0.0051"), 19, "id 1 once more"),
        (swapped(DATA, "2 2 0.0051", "1.5 2 0.0051"), 19, "id 1.5; expected an integer"),
        (swapped(DATA, "0.0151 0 0 0", "0.0251 0 0 0"), 19, "between the walls"),
        (swapped(DATA, "0.001 0.01 ", "0.001 -0.01 "), 17, "between the walls"),
        (swapped(DATA, "# sphere", "# atomic"), 15, "Atoms # atomic; expected Atoms # sphere"),
        (swapped(DATA, "# sphere\n\n", "# sphere\n"), 16, "a blank line after Atoms"),
        (swapped(DATA, "Atoms", "Bonds"), 26, "the end of the file; expected a section Atoms"),
        (swapped(DATA, "3 atoms", "three atoms"), 3, "'three'; expected the number of atoms"),
        (swapped(DATA, "3 atoms", "0 atoms"), 3, ">= 1"),
        (swapped(DATA, "3 atoms", ""), 15, "expected number of atoms before it"),
        (swapped(DATA, "0 0.03 ylo yhi", ""), 15, "expected ylo yhi before it"),
        (swapped(DATA, "0 0.03 ylo", "0.03 0 ylo"), 7, "expected ylo < yhi"),
        (swapped(DATA, "0 0.03 ylo", "a 0.03 ylo"), 7, "two numbers"),
        (swapped(DATA, "0 0.03 ylo", "0 inf ylo"), 7, "two numbers"),
        (swapped(DATA, "zhi\n", "zhi\n0.1 0 0 xy xz yz\n"), 9, "triclinic"),
        (swapped(DATA, "zhi\n", "zhi\n1 0 0 avec\n"), 9, "triclinic"),
        ("", 1, "the end of the file"),
    ],
)
def test_broken_lammps_data(tmp_path, text, line, message):
    path = put(tmp_path, text, ".data")
    with pytest.raises(ValueError, match=f"some.data, line {line}: .*{message}"):
        io.read(path, periodic=(True, True, False))


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (swapped(DUMP, "ff\n", "ff\nITEM: UNITS\n"), 10, "found 'ITEM: UNITS'; expected xlo xhi"),
        (swapped(DUMP, "ATOMS radius x", "ATOMS mass x"), 13, "mass x y z id; expected radius or diameter"),
        (swapped(DUMP, "radius x y", "radius x v"), 13, "expected one of y, yu, ys, ysu"),
        (swapped(DUMP, "ATOMS\n3", "ATOMS\n5"), 17, "the end of the file; expected row 4 of 5"),
        (swapped(DUMP, "ATOMS\n3", "ATOMS\n2"), 16, "expected a line ITEM"),
        (swapped(DUMP, "ATOMS\n3", "ATOMS\nx"), 8, "'x'; expected the integer of ITEM: NUMBER OF ATOMS"),
        (swapped(DUMP, "ATOMS\n3", "ATOMS\n-3"), 8, ">= 0"),
        (DUMP.partition("0.00255")[0] + "0.00255 0.00", 16, "found 2 columns.*row 3 of 3, 5 columns"),
        (DUMP.partition("ITEM: ATOMS")[0], 13, "expected ITEM: ATOMS"),
        (swapped(DUMP, "ITEM: TIMESTEP\n0\n", ""), 11, "expected ITEM: TIMESTEP before it"),
        (swapped(DUMP, "BOUNDS pp", "BOUNDS xy xz yz pp"), 10, "xlo xhi"),
        (swapped(DUMP, "BOUNDS pp", "BOUNDS abc origin pp"), 9, "triclinic"),
        (swapped(DUMP, "2.9999999999999999e-02", "0.0"), 11, "ylo < yhi"),
        (swapped(DUMP, "0.002 -0.005", "zwei -0.005"), 15, "radius = 'zwei'; expected a number in column 1"),
        (swapped(DUMP, "0.002 -0.005", "0 -0.005"), 15, "a radius > 0"),
        (DUMP.partition("ITEM: BOX")[0], 9, "the end of the file"),
        (DUMP.partition("0.0000")[0], 11, "the end of the file; expected ylo yhi"),
        ("", 1, "expected ITEM: TIMESTEP"),
        (DATA, 1, "found 'LAMMPS data file via.*expected a line ITEM"),
    ],
)
def test_broken_dump(tmp_path, text, line, message):
    with pytest.raises(ValueError, match=f"some.dump, line {line}: .*{message}"):
        io.read(put(tmp_path, text, ".dump"))


def test_tilted_dump(tmp_path):
    rows = [row + " 0.0" for row in BOUNDS.splitlines()]
    text = DUMP.replace("BOUNDS pp", "BOUNDS xy xz yz pp").replace(BOUNDS, "\n".join(rows) + "\n")
    assert_same(io.read(put(tmp_path, text, ".dump")), io.read(put(tmp_path, DUMP, ".lammpstrj")))
    with pytest.raises(ValueError, match="line 12: .*triclinic"):
        io.read(put(tmp_path, text.replace("e-02 0.0\nITEM: ATOMS", "e-02 0.1\nITEM: ATOMS"), ".dump"))


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("#format x_y_z\n1 2 3\n", 1, "expected #format and one of x_y_z_r, x_y"),
        ("1 2 3 .5\n1 2 3\n", 2, "found 3 columns, '1 2 3'; expected row 2, 4 columns: x y z r"),
        ("1 2 3 .5 1\n", 1, "found 5 columns"),
        ("# x\n\n1 2 3 .5\n\n# y\n1 2 three .5\n", 6, "z = 'three'; expected a number in column 3"),
        ("1 2 3 .5\n1 2 3 0 # no\n", 2, r"radius 0\.0"),
        ("#format x_y_z_r_matId\n1 2 3 .5\n", 2, "5 columns: x y z r matId"),
        ("# nothing\n", 2, "the end of the file"),
        (YADE_IDS.replace("\n4\t", "\n7\t"), 4, "id 7 once more"),
        (DATA, 1, "found .* columns, 'LAMMPS data"),
    ],
)
def test_broken_yade(tmp_path, text, line, message):
    with pytest.raises(ValueError, match=f"some.yade, line {line}: .*{message}"):
        io.read(put(tmp_path, text, ".yade"))


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (swapped(ASE, "2\n", "two\n"), 1, "the number of spheres of a frame"),
        (swapped(ASE, "2\n", "0\n"), 1, ">= 1"),
        (swapped(ASE, "2\n", "3\n"), 5, "the end of the file; expected row 3 of 3"),
        (swapped(ASE, "2\n", "1\n"), 4, "the number of spheres of a frame"),
        (swapped(ASE, ":radius:R:1", ""), 2, "expected Properties=... with pos:R:3 and radius:R:1"),
        (swapped(ASE, "radius:R:1", "radius:R"), 2, "expected Properties"),
        (swapped(ASE, "Properties", "Property"), 2, "found no Properties"),
        (swapped(ASE, "2.0 0.0 0.0 0.0 3", "2.0 0.1 0.0 0.0 3"), 2, "along the axes"),
        (swapped(ASE, "3.0 0.0", "-3.0 0.0"), 2, "along the axes"),
        (swapped(ASE, "2.0 0.0 ", "2.0 "), 2, "nine numbers"),
        (swapped(ASE, "T T F", "T F"), 2, "pbc"),
        (swapped(OVITO, "-1 0 0.5", "-1 0"), 2, "Origin"),
        (swapped(ASE, "0.30000000       0.5", "0.30000000"), 3, "found 4 columns"),
        (swapped(ASE, "0.30000000  ", "0.3000000O  "), 3, "z = '0.3000000O'; expected a number in column 4"),
        (swapped(ASE, "0.25000000", "-.25000000"), 4, "radius -0.25"),
        (swapped(ASE, "3.00000000 ", "5.00000000 "), 4, "between the walls"),
        ("2\n", 2, "the end of the file"),
        ("", 1, "the end of the file"),
    ],
)
def test_broken_xyz(tmp_path, text, line, message):
    with pytest.raises(ValueError, match=f"some.xyz, line {line}: .*{message}"):
        io.read(put(tmp_path, text, ".xyz"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (swapped(VTK_ASCII, "</Points>", "</Point>"), "line 15: .*expected well-formed XML"),
        (swapped(VTK_ASCII, '"radius"', '"mass"'), "found 2 points with the data mass"),
        (swapped(VTK_ASCII, "0.5 0.25", "0.5"), "found 1 values of radius; expected 2"),
        (swapped(VTK_ASCII, "0.5 0.25", "0.5 x"), "could not convert"),
        (swapped(VTK_ASCII, "0.5 0.25", "0.5 -1"), "sphere 2: found radius -1"),
        (swapped(VTK_ASCII, 'type="PolyData"', 'type="ImageData"'), "ImageData"),
        (swapped(VTK_ASCII, "vtkZLib", "vtkLZ4"), "compressor vtkLZ4"),
        (swapped(VTK_BINARY, "eJxjYACBB", "eJxjYACB!"), "not a whole PolyData file"),
        (VTK_APPENDED[:-80], "not a whole PolyData file"),
        ("points", "line 1: "),
    ],
)
def test_broken_polydata(tmp_path, text, message):
    with pytest.raises(ValueError, match=f"some.vtp.*{message}"):
        io.read(put(tmp_path, text, ".vtp"))


@pytest.mark.parametrize("name", ["npz", "vtp"])
def test_cut_binary_files(tmp_path, name):
    path = tmp_path / f"a{FORMATS[name]}"
    io.write(awkward(0), path)
    whole = path.read_bytes()
    for part in (0, 10, len(whole) // 2, len(whole) - 2000):
        path.write_bytes(whole[:part])
        with pytest.raises(ValueError, match=rf"a\{FORMATS[name]}.*not a whole|a\{FORMATS[name]}, line"):
            io.read(path)
    if name == "vtp":
        # Inside the bytes of the radii, 80 before those of the points.
        path.write_bytes(whole[: whole.index(b'encoding="raw"') + 200])
        with pytest.raises(ValueError, match=r"found \d+ bytes of an array; expected \d+: the file is cut short"):
            io.read(path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"centers": None}, "found the arrays radii.*expected centers"),
        ({"radii": np.ones(3)}, "found centers .*radii"),
        ({"radii": -np.ones(60)}, "radius -1"),
        ({"size": np.zeros(3)}, "size"),
        ({"provenance": "{"}, "not a whole"),
        ({"provenance": np.array([{}], dtype=object)}, "pickle"),
        ({"domain": "cone"}, "domain"),
    ],
)
def test_broken_npz(tmp_path, change, message):
    arrays = awkward(0)._asdict() | {"provenance": "{}"} | change
    np.savez(tmp_path / "a.npz", **{name: value for name, value in arrays.items() if value is not None})
    with pytest.raises(ValueError, match=f"a.npz.*{message}"):
        io.read(tmp_path / "a.npz")


@pytest.mark.parametrize(
    ("text", "suffix", "given", "message"),
    [
        (DATA, ".data", {}, "periodic: .*does not say which axes"),
        (DATA, ".data", {"periodic": True, "size": (1, 1, 1)}, "size = .*its own box"),
        (DATA, ".data", {"periodic": "ppf"}, "periodic = 'ppf'"),
        (DATA, ".data", {"step": 1}, "step = 1: .*one packing"),
        (DUMP, ".dump", {"step": 1.5}, "step = 1.5: must be an integer"),
        (DUMP, ".dump", {"step": True}, "step = True: must be an integer"),
        (DUMP, ".dump", {"order": "id"}, "order = 'id': must be 'given' or 'morton'"),
        (DUMP, ".dump", {"domain": "cone"}, "domain = 'cone': must be one of box"),
        (DUMP, ".dump", {"domain": "sphere"}, "some.dump: domain = 'sphere'"),
        (YADE, ".yade", {"periodic": True}, "size: .*has no box"),
        (YADE, ".yade", {"size": (1, 1, 1)}, "line 3: .*between the walls"),
        (YADE, ".yade", {"size": (1, 1)}, "size = "),
        (ASE, ".xyz", {"step": 1}, "line 5: .*frame 1: the file has 1"),
        (YADE, ".txt", {}, r"the suffix tells no format, .*lammps-data \(.data .lmp\).*yade \(.yade\)"),
        (YADE, "", {}, "the suffix tells no format"),
        (YADE, ".yade", {"format": "xyz"}, "format = 'xyz': must be one of lammps-data"),
        (VTK_ASCII, ".vtp.gz", {}, "only text is packed"),
    ],
)
def test_bad_arguments_of_read(tmp_path, text, suffix, given, message):
    with pytest.raises(ValueError, match=message):
        io.read(put(tmp_path, text, suffix), **given)


def test_arguments_are_judged_before_the_file(tmp_path):
    with pytest.raises(ValueError, match="order"):
        io.read(tmp_path / "absent.data", order="id")
    with pytest.raises(FileNotFoundError):
        io.read(tmp_path / "absent.npz")
    with pytest.raises(FileNotFoundError):
        io.read(tmp_path / "absent.data")
    with pytest.raises(FileNotFoundError):
        io.write(awkward(0), tmp_path / "absent" / "a.data")


def test_comments_in_any_encoding(tmp_path):
    path = tmp_path / "a.yade"
    path.write_bytes("# Körner\r\n1 2 3 .5\r\n".encode("latin-1"))
    assert io.read(path).radii.tolist() == [0.5]


def test_the_suffix_is_only_a_default(tmp_path):
    path = put(tmp_path, YADE, ".txt")
    assert io.read(path, format="yade").number == 2
    assert isinstance(io.read(put(tmp_path, DUMP, ".DUMP")), Packing)


def test_no_writer_of_vtk_is_loaded():
    code = (
        "import sys, demheat.packing.io; print([n for n in ('vtk', 'meshio', 'pyevtk', 'pandas') if n in sys.modules])"
    )
    root = Path(__file__).parents[2]
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
