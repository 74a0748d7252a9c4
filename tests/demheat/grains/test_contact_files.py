"""Only here: contacts of dumps misread, and tables of pairs half written."""

import csv

import numpy as np
import pytest
from beds import crystal, random_bed
from numpy.testing import assert_allclose

from demheat import grains
from demheat.grains import Gap, read_contacts
from demheat.io import packings

# As `dump local` of LIGGGHTS writes `compute pair/gran/local id force contactArea`: ids, periodic flag, force, area.
DUMP = """ITEM: TIMESTEP
100
ITEM: NUMBER OF ENTRIES
0
ITEM: BOX BOUNDS pp pp ff
-4 4
-4 4
0 10
ITEM: ENTRIES c_pairs[1] c_pairs[2] c_pairs[3] c_pairs[4] c_pairs[5] c_pairs[6] c_pairs[7]
ITEM: TIMESTEP
200
ITEM: NUMBER OF ENTRIES
2
ITEM: BOX BOUNDS pp pp ff
-4 4
-4 4
0 10
ITEM: ENTRIES c_pairs[1] c_pairs[2] c_pairs[3] c_pairs[4] c_pairs[5] c_pairs[6] c_pairs[7]
12 7 0 -1.5 0 0 3.14e-8
7 30 1 0 0 2.5 1.2e-8
"""
COLUMNS = {"id1": 1, "id2": 2, "fx": 4, "fy": 5, "fz": 6, "area": "c_pairs[7]"}
IDS = np.array([7, 9, 12, 30])


@pytest.fixture
def dump(tmp_path):
    path = tmp_path / "contacts.local"
    path.write_text(DUMP)
    return path


def test_a_dump_of_contacts(dump):
    found = read_contacts(dump, columns=COLUMNS, ids=IDS)
    assert found.first.tolist() == [2, 0] and found.second.tolist() == [0, 3]
    assert_allclose(found.radius, np.sqrt(np.array([3.14e-8, 1.2e-8]) / np.pi))
    assert_allclose(found.force, [[-1.5, 0, 0], [0, 0, 2.5]])
    # Without ids they are counted from 1; without other columns there are pairs alone.
    plain = read_contacts(dump, columns={"id1": 1, "id2": 2})
    assert plain.first.tolist() == [11, 6] and plain.radius is None and plain.force is None
    assert len(read_contacts(dump, columns=COLUMNS, step=100).first) == 0


@pytest.mark.parametrize(
    ("change", "knobs", "message"),
    [
        (("7 30 1", "7 31 1"), {}, "line 20: found id2 = 31; expected the id of a grain"),
        (("12 7 0", "12 7 x"), {"columns": COLUMNS | {"area": 3}}, "line 19: found area = 'x'"),
        (("12 7 0", "12 7"), {}, "line 19: found 6 columns"),
        (("ITEM: TIMESTEP\n200\n", ""), {}, "expected ITEM: TIMESTEP and"),
        ((" c_pairs[7]", ""), {}, "column 'c_pairs\\[7\\]' of 'area'"),
        (("", ""), {"columns": None}, "expected id1 among them"),
        (("", ""), {"columns": {"id1": 1, "id2": 99}}, "expected column 99 of 'id2'"),
        (("", ""), {"columns": {"first": 1}}, "columns\\['first'\\]: must be one of id1"),
        (("", ""), {"step": 300}, "timestep 300: the file has \\[100, 200\\]"),
        ((DUMP, "nonsense\n"), {}, "expected a line ITEM"),
    ],
)
def test_a_broken_dump_is_said_by_its_line(dump, change, knobs, message):
    dump.write_text(DUMP.replace(*change) if change[0] else DUMP)
    with pytest.raises(ValueError, match=message):
        read_contacts(dump, **{"columns": COLUMNS, "ids": IDS, **knobs})


def test_ids_of_a_packing(tmp_path):
    text = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n"
    path = tmp_path / "bed.liggghts"
    path.write_text(text + "ITEM: ATOMS id x y z radius\n41 .5 .5 .5 .1\n7 .2 .2 .2 .05\n")
    assert packings.ids(path).tolist() == [7, 41]
    # In the order of the packing.
    assert packings.read(path).radii.tolist() == [0.05, 0.1]
    path.write_text(text + "ITEM: ATOMS x y z radius\n.5 .5 .5 .1\n.2 .2 .2 .05\n")
    with pytest.raises(ValueError, match="must be a file whose spheres have ids"):
        packings.ids(path)


def test_pairs_are_written(tmp_path):
    field = grains.solve(random_bed(), 2.0, walls={"z-": 1.0, "z+": 3.0}, gap=Gap(conductivity=0.03))
    ids = 10 * np.arange(field.packing.number) + 3
    field.write(tmp_path / "flows.csv", ids=ids)
    with open(tmp_path / "flows.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    between = [row for row in rows if row["second"] not in ("z-", "z+")]
    assert len(between) == len(field.heat) and len(rows) == len(field.heat) + len(field.at_walls.grain)
    # Floats are written so that they read back to the same bits.
    assert [float(row["heat_W"]) for row in between] == field.heat.tolist()
    assert [int(row["first"]) for row in between] == ids[field.pairs.first].tolist()
    entered = sum(float(row["heat_W"]) for row in rows if row["second"] == "z+")
    assert_allclose(entered, field.wall_heat["z+"], rtol=1e-12)
    whole = [float(row["contact_W_K"]) + float(row["medium_W_K"]) for row in rows[: len(between)]]
    assert_allclose(whole, field.pairs.conductance, rtol=1e-12)
    held = grains.solve(random_bed(), 2.0, walls={"z-": 1.0, "z+": 3.0}, gap=Gap(conductivity=0.03), layer=1e-3)
    held.write(tmp_path / "flows.csv")
    assert ",z-,nan,0.0," in (tmp_path / "flows.csv").read_text()
    field.write(tmp_path / "flows.npz")
    with np.load(tmp_path / "flows.npz") as arrays:
        assert np.array_equal(arrays["heat"], field.heat) and np.array_equal(arrays["temperature"], field.temperature)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["flows.csv", "flows.npz"]


def test_an_interrupted_write_leaves_the_old_table(tmp_path, monkeypatch):
    field = grains.solve(crystal("sc"), 2.0, gradient=(0, 0, 1), gap=Gap(conductivity=0.03))
    (tmp_path / "flows.csv").write_text("old")

    def rows(*_):
        yield 1, 2
        raise KeyboardInterrupt

    monkeypatch.setattr(grains.GrainField, "_rows", rows)
    with pytest.raises(KeyboardInterrupt):
        field.write(tmp_path / "flows.csv")
    assert [each.name for each in tmp_path.iterdir()] == ["flows.csv"]
    assert (tmp_path / "flows.csv").read_text() == "old"


def test_where_nothing_can_be_written(tmp_path):
    field = grains.solve(crystal("sc"), 2.0, gradient=(0, 0, 1), gap=Gap(conductivity=0.03))
    for path, message in (
        (tmp_path / "x.txt", "must be .csv or .npz"),
        (tmp_path / "no" / "x.csv", "there is no folder"),
    ):
        with pytest.raises(ValueError, match=message):
            field.write(path)
    with pytest.raises(ValueError, match="ids of shape \\(3,\\): must be 27 whole numbers"):
        field.write(tmp_path / "x.csv", ids=[1, 2, 3])
