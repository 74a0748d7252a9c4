"""Only here: broken scene files whose error has another line, no key, or more than a line."""

# ruff: noqa: E501 (a row of the table is a line)

import random
import re

import pytest

from demheat.io import scenes
from demheat.io.words import nearest_file

# A whole scene, line by line: each broken file below is made of it by one change.
GOOD = """\
size_mm = [10, 10, 10]
matrix = "resin"
[materials.resin]
conductivity = "0.2 W/(m K)"
[materials.silica]
conductivity = 1.4
[[inclusions]]
shape = "sphere"
center_mm = [5, 5, 5]
radius_mm = 3
material = "silica"
[walls]
"y-" = "25 degC"
"y+" = "35 degC"
[solve.fft]
voxels = 32
"""
PERIODIC = {
    '[walls]\n"y-" = "25 degC"\n"y+" = "35 degC"\n': "",
    "[materials.resin]": "gradient = [0, 1, 0]\n[materials.resin]",
}
LAYER = {
    'shape = "sphere"\ncenter_mm = [5, 5, 5]\nradius_mm = 3': 'shape = "layer"\naxis = "y"\nstart_mm = 2\nstop_mm = 4'
}
TABLE = {'shape = "sphere"\ncenter_mm = [5, 5, 5]\nradius_mm = 3': 'file = "beads.csv"'}

# What is changed into what, the line, and words of the message.
BROKEN = [
    # Numbers and units.
    ("radius_mm = 3", "radius_mm = -3", 10, r"inclusions\[0\].radius_mm = -3: must be a finite number > 0 m"),
    ("radius_mm = 3", "radius_mm = true", 10, r"radius_mm = true: must be a number"),
    ("radius_mm = 3", 'radius = "3"', 10, r"radius = '3': must be a number, or text of a number and a unit such as '3 m'"),
    ("radius_mm = 3", 'radius = "3 mmm"', 10, r"unit 'mmm' is not known"),
    ("radius_mm = 3", 'radius = "3 kg"', 10, r"unit 'kg' does not fit; must be one like m"),
    ("radius_mm = 3", "diameter_mm = 6", 10, r"diameter_mm: no such key here; did you mean 'radius_mm', half of it"),
    ("radius_mm = 3", "radius_mm = 3\ngradient_K_mm = [0, 1, 0]", 11, r"a key of the file itself must stand above its"),
    ("conductivity = 1.4", "k = 1.4", 6, r"materials.silica.k: no such key here; did you mean 'conductivity'"),
    ("conductivity = 1.4", 'conductivity = "1,4"', 6, r"= '1,4': must have a decimal point, as 1.4"),
    ("[solve.fft]", '[solve]\nmethod = "fft"\n[solve.fft]', 16, r"solve.method: each method has a table of its own, as"),
    ("radius_mm = 3", "radius_inch = 3", 10, r"radius_inch: no such key here; did you mean 'radius"),
    ("radius_mm = 3", "radius_mm = 1e60", 7, r"inclusions\[0\]: sphere of diameter 2e\+57 is larger than the box"),
    ("center_mm = [5, 5, 5]", "center_mm = [5, 5]", 9, r"center_mm = \[5, 5\]: must be three finite numbers"),
    ('"25 degC"', "{coefficient = 0, temperature = 3}", 13, r"coefficient = 0: must be a finite number > 0"),
    ('"25 degC"', '{coefficient = "3 W/m2", temperature = 3}', 13, r"unit 'W/m2' does not fit; must be one like W/\(m2 K\)"),
    ('"25 degC"', "{temperature = 3}", 13, r"walls.y-: must have one of flux, coefficient, emissivity"),
    ('"25 degC"', "{flux = 3, temperature = 3}", 13, r"temperature: no such key here"),
    ('"25 degC"', '{emissivity = 0.5, temperature = "3 degC"}', 13, r"emissivity: with it all temperatures are in kelvin, and that in line 13 in degC"),
    ('"25 degC"', "{emissivity = 0.5, temperature = 300}", 13, r"emissivity: .* in kelvin, and that in line 13 has no unit; must say so"),
    ('"25 degC"\n"y+" = "35 degC"', '80\n"y+" = {emissivity = 0.5, temperature_K = 300}', 14, r"is in K, and that in line 13 without a unit"),
    ("center_mm = [5, 5, 5]", "center_mm = [\n5,\n false,\n5]", 11, r"center_mm\[1\] = false: must be a number"),
    ("center_mm = [5, 5, 5]", "center_mm = [50, 5, 5]", 7, r"inclusions\[0\]: .*lies outside the box"),
    ("size_mm = [10, 10, 10]", "size_mm = [10, 10, 0]", 1, r"size_mm = \[10, 10, 0\]: all three lengths must be > 0 m"),
    ("size_mm = [10, 10, 10]", "", 1, r"size is missing"),
    ('"0.2 W/(m K)"', '"0.2 W/mK"', 4, r"materials.resin.conductivity.*'W/mK' does not fit; must be one like W/\(m K\)"),
    ('"0.2 W/(m K)"', '"0.2 W/(m K"', 4, r"unit 'W/\(m K' is not finished"),
    ("conductivity = 1.4", "conductivity = 1.4\nconductivity_W_mK = 2", 7, r"conductivity_W_mK: is conductivity once more"),
    ("conductivity = 1.4", "conductivty = 1.4", 6, r"conductivty: no such key here; did you mean 'conductivity'"),
    # Temperatures.
    ('"35 degC"', '"35 degF"', 14, r"walls.y\+ = '35 degF': unit 'degF' is none of a temperature; must be K or degC"),
    ('"35 degC"', "35", 14, r"walls.y\+: is without a unit, and that in line 13 in degC; all temperatures"),
    ('"y+" =', '"q+" =', 14, r"walls.q\+: no such key here"),
    ('"y+" =', "y+ =", 14, r"no TOML: .*; a key with a plus needs quotes"),
    ('"25 degC"\n"y+" = "35 degC"', '1.0\n"y+" = 1.0000000000001', 12, r"walls = .*: rounding leaves little"),
    # Names.
    ('material = "silica"', 'material = "silcia"', 11, r"material = 'silcia': must be the name of one of .*did you mean 'silica'"),
    ('matrix = "resin"', 'matirx = "resin"', 2, r"matirx: no such key here; did you mean 'matrix'"),
    ('matrix = "resin"', 'matrix = "resin"\ndomain = "sphre"', 3, r"domain = 'sphre': must be one of .*did you mean 'sphere'"),
    ('shape = "sphere"', 'shape = "ball"', 8, r"shape = 'ball': must be one of 'sphere', 'layer'"),
    ("radius_mm = 3", "", 7, r"inclusions\[0\]: radius is missing"),
    ("[[inclusions]]", "[inclusions]", 7, r"inclusions = .*: must be an array of tables, \[\[inclusions\]\]"),
    ("[materials.resin]", "[materials]\nresin = 0.2\n[materials.other]", 4, r"materials.resin = 0.2: must be a table"),
    # Methods.
    ("[solve.fft]", "[solve.fftt]", 15, r"solve.fftt: no such method; did you mean 'fft'"),
    ("voxels = 32", "voxels = {a = 1}", 16, r"solve.fft.voxels = {'a': 1}: must be a number, text, a flag or an array"),
    ('matrix = "resin"', 'matrix = "resin"\naccuracy = 2', 3, r"accuracy = 2: must be a number from 1e-9 to below 1"),
    # TOML itself.
    ("radius_mm = 3", "radius_mm = 3\nradius_mm = 4", 11, r"no TOML: cannot overwrite a value"),
    ("[walls]", "[walls", 12, r"no TOML: expected ']'"),
]  # fmt: skip


def refused(folder, text, name="scene.toml"):
    """The one line that a file is refused with."""
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ValueError) as caught:
        scenes.read(path)
    told = str(caught.value)
    assert "\n" not in told and len(told) < 500
    return told.replace(f"{folder}/", "")


def changed(changes):
    text = GOOD
    for old, new in changes.items():
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize(("old", "new", "line", "words"), BROKEN, ids=range(len(BROKEN)))
def test_a_broken_file_is_one_line(tmp_path, old, new, line, words):
    told = refused(tmp_path, changed({old: new}))
    assert re.match(rf"scene\.toml:{line}: .*(?:{words})", told), told


def test_what_is_broken_was_whole(tmp_path):
    for k, changes in enumerate(({}, PERIODIC, LAYER)):
        (tmp_path / f"{k}.toml").write_text(changed(changes))
        assert len(scenes.read(tmp_path / f"{k}.toml").inclusions) == 1


LAYERS = [
    ("axis", 'axis = "w"', 9, r"axis = 'w': must be \"x\", \"y\" or \"z\""),
    ("stop_mm", "stop_mm = 1", 11, r"stop_mm = 1: must be a finite number > start"),
    ("stop_mm", "stop_mm = 40", 7, r"inclusions\[0\]: layer from 0.002 to 0.04 must lie in the box"),
    ("stop_mm", "radius_mm = 4", 11, r"radius_mm: no such key here"),
]


@pytest.mark.parametrize(("key", "new", "line", "words"), LAYERS)
def test_a_broken_layer(tmp_path, key, new, line, words):
    text = re.sub(rf"(?m)^{key} = .*$", lambda _: new, changed(LAYER))
    assert re.match(rf"scene\.toml:{line}: .*{words}", told := refused(tmp_path, text)), told


def test_a_broken_load(tmp_path):
    both = changed({'matrix = "resin"': 'matrix = "resin"\ngradient = [0, 1, 0]'})
    assert "both given; a scene needs exactly one load" in refused(tmp_path, both)
    none = changed({'[walls]\n"y-" = "25 degC"\n"y+" = "35 degC"\n': ""})
    assert "neither given; a scene needs exactly one load" in refused(tmp_path, none)
    zero = changed(PERIODIC | {'matrix = "resin"': 'matrix = "resin"'}).replace("[0, 1, 0]", "[0, 0, 0]")
    assert re.match(r"scene\.toml:3: gradient = \[0, 0, 0\]: must not be zero", refused(tmp_path, zero))


def test_two_inclusions_that_overlap_are_both_placed(tmp_path):
    more = '\n[[inclusions]]\nshape = "sphere"\ncenter_mm = [7, 5, 5]\nradius_mm = 2\nmaterial = "silica"\n[walls]'
    told = refused(tmp_path, changed({"\n[walls]": more}))
    assert re.match(
        r"scene\.toml:7: inclusions\[0\]: .*overlap partially.*stands in scene\.toml:12: inclusions\[1\]", told
    )


@pytest.mark.parametrize(
    ("there", "told"),
    [
        ('shape = "mesh"', "must be one of 'sphere', .*'surface mesh'; did you mean 'surface mesh'?"),
        ('shape = "surface_mesh"', "did you mean 'surface mesh'?"),
        ('shape = "STL"', "did you mean 'surface mesh'?"),
        ('shape = "ball"', "did you mean 'sphere'?"),
        ('shape = "gyroid"', "'surface mesh'; level sets are for Python alone, demheat.LevelSet"),
        ('file = "part.stl"', 'is a surface of triangles; must have shape = "surface mesh" beside it'),
        ('file = "part.step"', r"must be exported as triangles \(.stl\), with shape"),
        ("", "shape is missing; must be one of 'sphere', .*'surface mesh', or file, of a table of spheres"),
    ],
)
def test_a_shape_by_another_name_is_told_the_right_one(tmp_path, there, told):
    text = changed({'shape = "sphere"\ncenter_mm = [5, 5, 5]\nradius_mm = 3': there})
    assert re.search(told, refused(tmp_path, text))


# Tables of spheres: text, line, words.
TABLES = [
    ("", 1, r"is empty; must begin with a line of names"),
    ("x,y,z,radius\n", 1, r"has names and no rows"),
    ("x,y,radius\n1,2,3\n", 1, r"columns 'x, y, radius': must have z among them"),
    ("x,y,z,raduis\n1,2,3,4\n", 1, r"no such column, 'raduis'; did you mean 'radius'"),
    ("x,y,z,radius,diameter\n1,2,3,4,8\n", 1, r"columns radius and diameter; must be one of them"),
    ("x,y,z,radius,radius_mm\n1,2,3,4,4\n", 1, r"'radius_mm' is radius once more"),
    ("x,y,z,radius\n.005,.005,.005,-1\n", 2, r"radius = -1.0: must be a finite number > 0"),
    ("x,y,z,radius\n.005,.005,.005,.001\n\n# c\n.005,.005,.005\n", 5, r"3 values; must be 4"),
    ("x,y,z,radius\n.005,.005,five,.001\n", 2, r"z = 'five': must be a number with a decimal point"),
    ("x;y;z;radius\n0,005;.005;.005;.001\n", 2, r"x = '0,005': must be a number with a decimal point, as 0.005"),
    ("x,y,z,radius,material\n.005,.005,.005,.001,silcia\n", 2, r"material = 'silcia'.*did you mean 'silica'"),
    ("x_mm,y_mm,z_mm,radius_mm\n5,5,5,2\n5,5,8,2\n", 2, r"overlap partially.*beads.csv:3"),
    ("300,500,500,150\n", 1, r"'300, 500, 500, 150': no names of columns; must begin with a line of names: x,y,z,"),
    ("x y z radius\n1 2 3 4\n", 1, r"'x y z radius': one column; must have one of comma, semicolon, tab between"),
    ("x,y,z,radius\n0,005,0,005,0,005,0,001\n", 2, r"8 values; must be 4.*a decimal comma is taken for the next"),
    ("x,y,z,radius\n5,5,5,2\n", 2, r"5, 5, 5 m: lies outside the box.*read with unit = \"m\", \"mm\" would fit"),
    ("x_m,y_m,z_m,radius\n5,5,5,2\n", 2, r"numbers were read in m, as their columns are named, \"mm\" would fit"),
    ("x,y,z,radius\n.005,.005,.005,2\n", 2, r"radius = 2 m: must be at most .* as the box; .*\"mm\" would fit"),
    (b"x,y,z,radius\n\xff,1,1,1\n", 2, r"byte 0xff is no UTF-8"),
]


@pytest.mark.parametrize(("table", "line", "words"), TABLES, ids=range(len(TABLES)))
def test_a_broken_table_is_one_line(tmp_path, table, line, words):
    (tmp_path / "beads.csv").write_bytes(table if isinstance(table, bytes) else table.encode())
    told = refused(tmp_path, changed(TABLE))
    assert re.search(rf"beads\.csv:{line}: .*(?:{words})", told), told


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ("scene.tmol", "; did you mean 'scene.toml'?"),
        ("scne.toml", "; did you mean 'scene.toml'?"),
        ("beads.tsv", "; did you mean 'beads.csv'?"),
        # Endings alike, a letter alike, a part alike: none of these was meant.
        ("no.toml", ""),
        ("a.toml", ""),
        ("pores.toml", ""),
        ("sc.toml", ""),
    ],
)
def test_files_are_suggested_by_their_names_not_their_endings(tmp_path, asked, told):
    for name in ("scene.toml", "beads.csv", "b.toml"):
        (tmp_path / name).touch()
    assert nearest_file(tmp_path / asked) == told and nearest_file(tmp_path / "none" / asked) == ""


# Entries of spheres from files.
ENTRIES = [
    ("", 8, r"scene.toml:8: inclusions\[0\].file = 'beads.csv': there is no such file; did you mean 'beeds.csv'"),
    ('\nunit = "inch"', 9, r"unit = 'inch': must be one of 'm', 'cm'"),
    ("\nradius_factor = 2", 9, r"radius_factor = 2: must be a number > 0, at most 1"),
    ("\noffset_mm = [1, 2]", 9, r"offset_mm = .*: must be three lengths"),
    ("\nstep = 5", 9, r"step = 5: a table has one set of spheres"),
]


@pytest.mark.parametrize(("more", "line", "words"), ENTRIES)
def test_a_broken_entry_of_a_file(tmp_path, more, line, words):
    (tmp_path / "beeds.csv").write_text("x,y,z,radius\n1,1,1,1\n")
    told = refused(tmp_path, changed({**TABLE, 'material = "silica"': f'material = "silica"{more}'}))
    assert re.search(words, told), told


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"\xff\xfes\0i\0z\0e\0", r"scene\.toml:1: zero bytes, as in a binary file or UTF-16"),
        (b"size = [1, 1, 1]\nmatrix = '\xe9'\n", r"scene\.toml:2: byte 0xe9 is no UTF-8"),
        (b"", r"scene\.toml:1: size is missing"),
        (b"a = " + b"[" * 5000, r"scene\.toml(:1)?: no TOML"),
    ],
)
def test_what_is_no_scene(tmp_path, text, words):
    told = refused(tmp_path, text)
    assert re.match(words, told), told


def test_a_byte_order_mark_and_other_line_ends_do_no_harm(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert scenes.read(path).inclusions[0].radius == 0.003
    told = refused(tmp_path, GOOD.replace("radius_mm = 3", "radius_mm = -3").replace("\n", "\r\n"))
    assert told.startswith("scene.toml:10: ")


def test_what_is_no_file(tmp_path):
    for path, words in (
        (tmp_path / "none.toml", "there is no such file"),
        (tmp_path, "must be a regular file"),
        ("/dev/zero", "must be a regular file"),
        ("a\0b", "none has a zero byte"),
        (5, "must be the name of a file"),
    ):
        with pytest.raises(ValueError, match=words) as caught:
            scenes.read(path)
        assert "\n" not in str(caught.value)


def test_a_huge_file_is_not_read(tmp_path):
    path = tmp_path / "scene.toml"
    with path.open("wb") as file:
        file.truncate(2**40)
    with pytest.raises(ValueError, match=r"has 1099511627776 bytes, at most 16777216 are read"):
        scenes.read(path)


WORDS = ("nan", "-1", "true", '"x"', "[]", "{}", "1e400", "a.b", "= =", "#", "[x]", "\\", '"""', "0")


def spoilt(text, draw):
    """A text with one slip: a line lost, twice or moved, a letter lost, a word put in."""
    lines = text.split("\n")
    k, m, at = draw.randrange(len(lines)), draw.randrange(len(lines)), draw.randrange(len(text))
    kind = draw.randrange(5)
    if kind == 0:
        return "\n".join(lines[:k] + lines[k + 1 :])
    if kind == 1:
        return "\n".join(lines[:m] + [lines[k]] + lines[m:])
    if kind == 2:
        return "\n".join([*lines[:k], lines[k].split("=")[0] + "= " + draw.choice(WORDS), *lines[k + 1 :]])
    if kind == 3:
        return text[:at] + text[at + 1 :]
    return text[:at] + draw.choice(WORDS) + text[at:]


def test_slips_at_random_are_one_line_or_a_scene(tmp_path):
    draw, path = random.Random(16), tmp_path / "scene.toml"
    told = {True: 0, False: 0}
    for _ in range(250):
        text = spoilt(GOOD, draw)
        path.write_text(text)
        try:
            scenes.read(path)
            told[True] += 1
        except ValueError as error:
            told[False] += 1
            assert str(error).startswith(f"{path}:") and "\n" not in str(error) and len(str(error)) < 600, text
    # Both happen: a lost blank, or a lost table of a method, does no harm.
    assert min(told.values()) > 20
