"""LIGGGHTS, LAMMPS and Yade on beds of grains, where they are; what is written for them and read of them anywhere."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from studies.peers import beds, given
from studies.peers.programs import lammps, liggghts, yade

PROGRAMS = {"liggghts": liggghts, "lammps": lammps, "yade": yade}


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_short_chain(name):
    program = PROGRAMS[name]
    if program.missing():
        pytest.skip(program.missing())
    scene = beds.BEDS[program.CASES[0]["scene"]]
    found = program.solve(scene, n=4)
    # What is left of the slowest part is 1e-10 of 1 K where it starts; in the mean of both ends less.
    assert_allclose(found.conductivity, beds.known(program.CASES[0]["scene"]), rtol=1e-9)
    assert found.cost["cpu_s"] >= 0 and found.unknowns == 4


@pytest.mark.parametrize("name", PROGRAMS)
def test_cases_are_beds(name):
    scenes = {case["scene"] for case in PROGRAMS[name].CASES}
    assert scenes <= set(beds.BEDS) and len(scenes) >= 4


@pytest.mark.parametrize("name", PROGRAMS)
def test_bodies_are_refused(name):
    with pytest.raises(NotImplementedError, match="no body"):
        PROGRAMS[name].solve(given.scene("sphere 10"), n=4)


def test_what_liggghts_reads(tmp_path):
    bed = beds.BEDS["unlike chain, root of area"].drawn(5)
    kinds = liggghts._write(tmp_path, bed, 0.125, 7)
    # Three solids, of which two are at the ends as well.
    assert kinds == 5
    data, script = (tmp_path / "bed.data").read_text(), (tmp_path / "in.bed").read_text()
    rows = np.loadtxt(data.split("Atoms\n\n")[1].splitlines())
    assert_allclose(rows[:, 2] / 2, bed.radii, rtol=0)
    assert_allclose(rows[:, 4:], bed.centers, rtol=0)
    assert "group hot id 1\n" in script and "group cold id 5\n" in script and "timestep 0.125\n" in script


def test_what_liggghts_writes(tmp_path):
    dump = "ITEM: TIMESTEP\n0\nITEM: ATOMS id\n9 9 9\nITEM: TIMESTEP\n7\nITEM: ATOMS id\n1 1.0 -2.5\n2 0.0 2.5\n"
    (tmp_path / "grains.dump").write_text(dump)
    assert_allclose(liggghts._last(tmp_path / "grains.dump"), [[1, 1, -2.5], [2, 0, 2.5]])


def test_materials_of_lammps():
    given_pairs = list(lammps._contacts("Hertz radius", np.array([4.0, 16.0]), False))
    # The harmonic mean of 4 and 16.
    assert [line.split()[-1] for line in given_pairs] == ["4.0", "6.4", "16.0"]
    assert len(list(lammps._contacts("Hertz radius", np.array([4.0, 16.0]), True))) == 2


@pytest.mark.skipif(yade.missing() is not None, reason=str(yade.missing()))
def test_the_rod_of_yade():
    found, documented, _ = yade.own()
    # Its grains are 167 volumes along the rod, its steps a thousandth of the time.
    assert_allclose(found, documented, rtol=1e-4)
