"""Packing files as other programs write them, and packings that are hard to write."""

import numpy as np

from demheat.packing.base import make_packing

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
