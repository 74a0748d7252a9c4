"""Only here: keys of a scene file that are read in another unit, and scenes that come back otherwise than written."""

import numpy as np
import pytest

from demheat import (
    Convection,
    Flux,
    Layer,
    Material,
    MovingCylinder,
    Radiation,
    Scene,
    Sphere,
    UniformSource,
)
from demheat.io import packings, scenes
from demheat.packing import make_packing

RESIN = Material(0.2, 1200.0, 1000.0)
EVERYTHING = """\
size_cm = [10, 20, 30]
matrix = {conductivity_mW_mK = 200, density = "1.2 g/cm3", heat_capacity_kJ_kgK = 1}
initial_C = 20
[materials.steel]
conductivity = 50
[[inclusions]]
shape = "layer"
axis = "z"
start = "10 mm"
stop_m = 0.02
material = "steel"
[[inclusions]]
shape = "sphere"
center = ["5 cm", 0.1, "100 mm"]
radius_um = 1e4
material = {conductivity = 0}
[walls]
z- = "5 degC"
"z+" = {flux_kW_m2 = -1.5}
[[sources]]
kind = "uniform"
power_density_kW_m3 = 2
[[sources]]
kind = "moving-cylinder"
axis = 2
diameter_mm = 5
power_density = "3 W/cm3"
start_mm = [1, 2]
velocity_mm_s = [0, 1]
clip = true
"""


def written(folder, text, name="scene.toml"):
    (folder / name).write_text(text)
    return folder / name


def test_every_key_is_read(tmp_path):
    inclusions = [
        Layer(2, 0.01, 0.02, Material(50.0)),
        Sphere((0.05, 0.1, 0.1), 0.01, Material(0.0)),
    ]
    sources = [UniformSource(2000.0), MovingCylinder(2, 0.005, 3e6, (0.001, 0.002), (0.0, 0.001), True)]
    load = {"walls": {"z-": 5.0, "z+": Flux(-1500.0)}, "initial": 20.0, "sources": sources}
    assert scenes.read(written(tmp_path, EVERYTHING)) == Scene((0.1, 0.2, 0.3), RESIN, inclusions, **load)


def test_resistances_and_walls_that_exchange_heat_have_units(tmp_path):
    text = EVERYTHING.partition("[[inclusions]]")[0].replace("initial_C = 20", "")
    text += """
[[inclusions]]
shape = "sphere"
center = [0.05, 0.1, 0.1]
radius = 0.01
material = "steel"
resistance_mm2K_W = 3
[walls]
"x-" = {coefficient = "2 kW/(m2 K)", temperature_K = 400}
"x+" = {emissivity = 0.5, temperature_K = 300}
"""
    found = scenes.read(written(tmp_path, text))
    assert found.inclusions[0].resistance == 3e-6
    assert dict(found.walls) == {"x-": Convection(2000.0, 400.0), "x+": Radiation(0.5, 300.0)}


def drawn(seed):
    """A scene of random floats; every kind of load and part that a file can hold occurs."""
    rng = np.random.default_rng(seed)
    k = iter(np.exp(rng.normal(size=20)).tolist())
    resists = {"resistance": rng.random()} if seed % 5 else {}
    spheres = [
        Sphere(0.1 + 0.8 * rng.random(3), 0.02 * rng.random(), Material(next(k)), **resists) for _ in range(seed % 3)
    ]
    planes = np.sort(rng.random(2)).tolist()
    layer = [Layer(seed % 3, *planes, Material(next(k), next(k), next(k)), **resists)] * (seed % 2)
    loads = [
        {"gradient": rng.normal(size=3)},
        {"walls": {"z-": rng.normal(), "round": Flux(rng.normal())}, "domain": "cylinder-z"},
        {"walls": {"y-": rng.normal(), "y+": Flux(rng.normal())}, "initial": rng.normal()},
        {"walls": {"x-": Convection(next(k), rng.normal()), "x+": rng.normal()}},
        {"walls": {"x-": Radiation(rng.random(), 300 * rng.random()), "z+": Convection(next(k), next(k))}},
        {"initial": 1.0, "sources": [UniformSource(next(k)), MovingCylinder(1, next(k), next(k), rng.random(2))]},
    ]
    return Scene((1.0, 1.0, 1.0), Material(next(k)), layer or spheres, **loads[seed % 6])


@pytest.mark.parametrize("seed", range(12))
def test_what_is_written_is_read_back(tmp_path, seed):
    scene = drawn(seed)
    scenes.write(scene, tmp_path / "scene.toml")
    assert scenes.read(tmp_path / "scene.toml") == scene
    # Equal floats may be two bit patterns, 0 and -0; no other.
    again = scenes.read(tmp_path / "scene.toml")
    assert repr(again) == repr(scene)


def test_what_a_file_cannot_hold_is_refused(tmp_path):
    scene = Scene((1, 1, 1), Material(1.0), walls={"x-": lambda t: t, "x+": 0.0})
    with pytest.raises(ValueError, match=r"Scene.walls\['x-'\]: a file cannot hold a function"):
        scenes.write(scene, tmp_path / "scene.toml")
    with pytest.raises(ValueError, match="Scene.initial: a file cannot hold a function"):
        scenes.write(Scene((1, 1, 1), RESIN, initial=lambda x: x[:, 0]), tmp_path / "scene.toml")
    with pytest.raises(ValueError, match="must be a Scene$"):
        scenes.write(5, tmp_path / "scene.toml")
    with pytest.raises(
        ValueError, match=r"scene = 'mine.toml': must be a Scene; demheat.io.scenes.read\('mine.toml'\)"
    ):
        scenes.write("mine.toml", tmp_path / "scene.toml")
    assert list(tmp_path.iterdir()) == []


ENTRY = """\
size = [1, 1, 1]
gradient = [1, 0, 0]
matrix = "a"
[materials]
a = {{conductivity = 1}}
b = {{conductivity = 2}}
c = {{conductivity = 3}}
[[inclusions]]
material = "b"
file = "{}"
{}
"""
CENTERS = np.array([[0.25, 0.25, 0.25], [0.75, 0.125, 0.5], [0.5, 0.75, 0.75]])
RADII = np.array([0.2, 0.1, 0.05])


def spheres_of(scene):
    return [(*sphere.center, sphere.radius, sphere.material.conductivity) for sphere in scene.inclusions]


@pytest.mark.parametrize(
    ("header", "factor", "more"),
    [
        ("x,y,z,radius", 1, ""),
        ("x_mm,y_mm,z_mm,radius_mm", 1000, ""),
        ("x ; y ;z;radius", 1000, 'unit = "mm"'),
        ("x\ty\tz\tdiameter", 1, ""),
        ("radius,z,y,x,id", 1, ""),
        ("x_cm,y_mm,z,diameter_um", 0, ""),
    ],
)
def test_tables_of_spheres(tmp_path, header, factor, more):
    mark = next(mark for mark in ";\t," if mark in header)
    names = [name.strip() for name in header.split(mark)]
    scale = {"cm": 100, "mm": 1000, "um": 1e6}
    lines = ["# drawn by hand", header]
    for center, radius in zip(CENTERS, RADII, strict=True):
        values = dict(zip("xyz", center, strict=True)) | {"radius": radius, "diameter": 2 * radius, "id": 7}
        row = []
        for name in names:
            plain, _, unit = name.partition("_")
            row.append(repr(float(values[plain] * (factor or scale.get(unit, 1)))))
        lines += [mark.join(row), ""]
    (tmp_path / "t.csv").write_text("\n".join(lines))
    found = spheres_of(scenes.read(written(tmp_path, ENTRY.format("t.csv", more))))
    # Numbers of few binary digits lose none in decimals of millimetres.
    np.testing.assert_allclose(found, np.column_stack([CENTERS, RADII, [2.0] * 3]), rtol=1e-15)


def test_surfaces_of_spheres_of_a_file_may_resist(tmp_path):
    (tmp_path / "t.csv").write_text("x,y,z,radius\n.2,.2,.2,.1\n.6,.6,.6,.1\n")
    for more, expected in (("", 0.0), ('resistance = "3 mm2 K/W"', 3e-6), ("resistance_m2K_W = 0.5", 0.5)):
        found = scenes.read(written(tmp_path, ENTRY.format("t.csv", more))).inclusions
        assert [sphere.resistance for sphere in found] == [expected, expected]
    with pytest.raises(ValueError, match=r"scene.toml:11: inclusions\[0\].resistance = -1: must be"):
        scenes.read(written(tmp_path, ENTRY.format("t.csv", "resistance = -1")))


def test_spheres_outside_of_a_periodic_cell_are_refused(tmp_path):
    """They would come in again where nobody put them, as with the wrong unit."""
    (tmp_path / "t.csv").write_text("x,y,z,radius\n.2,.2,.2,.1\n.6,1.4,.6,.1\n")
    with pytest.raises(ValueError, match=r"t.csv:3: x y z = 0.6, 1.4, 0.6 m: lies outside the periodic cell, 0 to 1 x"):
        scenes.read(written(tmp_path, ENTRY.format("t.csv", "")))
    (tmp_path / "t.csv").write_text("x,y,z,radius\n.2,.7,.2,.1\n.6,1.4,.6,.1\n")
    moved = scenes.read(written(tmp_path, ENTRY.format("t.csv", "offset = [0, -0.5, 0]")))
    assert [round(sphere.center[1], 9) for sphere in moved.inclusions] == [0.2, 0.9]
    # On a face is in.
    (tmp_path / "t.csv").write_text("x,y,z,radius\n0,.2,1,.1\n")
    assert len(scenes.read(written(tmp_path, ENTRY.format("t.csv", ""))).inclusions) == 1


def test_materials_of_a_table(tmp_path):
    (tmp_path / "t.csv").write_text("x,y,z,radius,material\n.2,.2,.2,.1,c\n.6,.6,.6,.1,b\n")
    assert [row[4] for row in spheres_of(scenes.read(written(tmp_path, ENTRY.format("t.csv", ""))))] == [3.0, 2.0]


@pytest.mark.parametrize("suffix", ["liggghts", "xyz", "data", "yade", "npz", "vtp", "dump.gz"])
def test_packings_of_others(tmp_path, suffix):
    packing = make_packing(CENTERS, RADII, (1, 1, 1), True, {})
    packings.write(packing, tmp_path / f"p.{suffix}")
    more = "radius_factor = 0.5\noffset = [0, 0.125, 0]"
    if suffix in ("liggghts", "xyz", "dump.gz"):
        more += "\nstep = 0"
    found = spheres_of(scenes.read(written(tmp_path, ENTRY.format(f"p.{suffix}", more))))
    wanted = np.column_stack([CENTERS + [0, 0.125, 0], RADII / 2, [2.0] * 3])
    # A packing is sorted as it is made.
    np.testing.assert_allclose(sorted(found), sorted(map(tuple, wanted)), rtol=1e-15)


# As LIGGGHTS writes it: other columns, ids out of order, a box that does not begin at 0, millimetres.
DUMP = """\
ITEM: TIMESTEP
5000
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS ff ff ff
-500 500
-500 500
0 1000
ITEM: ATOMS id type x y z vx vy vz radius
9 1 250 0 500 0 0 -1e-3 100
4 2 -250 0 500 0 0 0 200
"""
XYZ = """\
2
Lattice="1.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 1.0" Properties=species:S:1:pos:R:3:radius:R:1 pbc="T T T"
Si 0.75 0.5 0.5 0.1
O 0.25 0.5 0.5 0.2
"""


def test_a_foreign_dump(tmp_path):
    (tmp_path / "d.liggghts").write_text(DUMP)
    scene = scenes.read(written(tmp_path, ENTRY.format("d.liggghts", 'unit = "mm"')))
    assert spheres_of(scene) == [(0.25, 0.5, 0.5, 0.2, 2.0), (0.75, 0.5, 0.5, 0.1, 2.0)]
    (tmp_path / "d.liggghts").write_text(DUMP.replace("9 1 250", "9 1 abc"))
    with pytest.raises(
        ValueError, match=r"scene.toml:10: inclusions\[0\].file = .*d.liggghts, line 10: found x = 'abc'"
    ):
        scenes.read(tmp_path / "scene.toml")


def test_a_foreign_extended_xyz(tmp_path):
    (tmp_path / "d.xyz").write_text(XYZ)
    scene = scenes.read(written(tmp_path, ENTRY.format("d.xyz", "")))
    assert sorted(spheres_of(scene)) == [(0.25, 0.5, 0.5, 0.2, 2.0), (0.75, 0.5, 0.5, 0.1, 2.0)]


def test_the_box_of_a_packing_is_that_of_the_scene(tmp_path):
    """Else a unit was forgotten, or an offset must say where it lies."""
    (tmp_path / "d.liggghts").write_text(DUMP)
    words = r"scene.toml:10: .*has a box of 1000 x 1000 x 1000 m; must be 1 x 1 x 1 m, as size is, by its unit"
    with pytest.raises(ValueError, match=words):
        scenes.read(written(tmp_path, ENTRY.format("d.liggghts", "")))
    entry = ENTRY.replace("size = [1, 1, 1]", "size = [2, 2, 2]")
    scene = scenes.read(written(tmp_path, entry.format("d.liggghts", 'unit = "mm"\noffset = [1, 0, 0.5]')))
    assert spheres_of(scene) == [(1.25, 0.5, 1.0, 0.2, 2.0), (1.75, 0.5, 1.0, 0.1, 2.0)]


def test_a_packing_without_a_box_counts_from_the_corner_of_the_scene(tmp_path):
    """Not from that of the box around its spheres, nor are those that cross a face of a periodic cell refused."""
    (tmp_path / "d.yade").write_text("0.25 0.5 0.5 0.1\n0.95 0.5 0.5 0.1\n")
    scene = scenes.read(written(tmp_path, ENTRY.format("d.yade", "")))
    assert spheres_of(scene) == [(0.25, 0.5, 0.5, 0.1, 2.0), (0.95, 0.5, 0.5, 0.1, 2.0)]
    walled = ENTRY.replace("gradient = [1, 0, 0]", 'walls = {{x- = 0, "x+" = 1}}')
    (tmp_path / "d.yade").write_text("250 500 500 100\n1950 500 500 100\n")
    with pytest.raises(ValueError, match=r"scene.toml:10: .*d.yade, line 2: found x y z = .*between the walls"):
        scenes.read(written(tmp_path, walled.format("d.yade", 'unit = "mm"')))


def test_methods_and_accuracy_of_a_file(tmp_path):
    more = (
        "accuracy = 1e-4\n" + ENTRY.format("t.csv", "") + "[solve.fem-p1]\nsize_mm = 50\n[solve.dem]\nparticles = 500\n"
    )
    (tmp_path / "t.csv").write_text("x,y,z,radius\n.2,.2,.2,.1\n")
    found = scenes.read_file(written(tmp_path, more))
    assert found.methods == {"fem-p1": {"size": 0.05}, "dem": {"particles": 500}}
    assert found.accuracy == 1e-4


def test_thousands_of_spheres_are_read_in_a_moment(tmp_path):
    """A table of any length: each of its spheres has its line."""
    n = 15
    grid = (np.indices((n, n, n)).reshape(3, -1).T + 0.5) / n
    rows = "\n".join(f"{x},{y},{z},{0.4 / n}" for x, y, z in grid.tolist())
    (tmp_path / "t.csv").write_text(f"x,y,z,radius\n{rows}\n")
    assert len(scenes.read(written(tmp_path, ENTRY.format("t.csv", ""))).inclusions) == n**3
