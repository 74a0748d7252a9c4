"""The paper's network in its variants: what a row holds, and that C_t scales all of it."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from demheat import Calibrated, dem
from demheat.gallery import sphere_in_cube
from demheat.packing.relax import relax
from studies.common import paper_network, paper_variants
from studies.common.paper_variants import Variant
from studies.harness.store import case_key


@pytest.fixture(scope="module")
def between():
    return relax(3000, size=(0.1, 0.1, 0.1), periodic=False, seed=4)


def test_cases_are_every_packing_under_every_kind_of_walls():
    cases = list(paper_network.cases([1000, 2000]))
    assert len(set(map(case_key, cases))) == len(cases) == 2 * 2 * 3 * 3
    replicated = next(paper_network.cases([8000], held=["periodic"], replicas=2))
    assert replicated["replicas"] == 2 and list(replicated)[-1] == "method"
    # Two calibrations between walls, one in a cell.
    assert len(paper_variants.variants()) == 2 * (2 + 2 + 1)


@pytest.mark.parametrize("held", ["center", "surface"])
def test_one_solve_serves_both_calibrations(between, held):
    """What `solve` finds with a given C_t is the row's value in proportion."""
    scene = sphere_in_cube(10.0)
    fields, row = paper_network.solved({"10": scene}, between, held)
    for way in ("flux", "isothermal"):
        law = Calibrated(wall=held, factor=row[f"ct_{way}"])
        field = dem.solve(scene, law=law, packing=between)
        # The gap that 7.5 contacts ask for, found twice: the solver's tolerance is left.
        k = paper_network.unscaled(fields["10"]) * row[f"ct_{way}"]
        assert_allclose(field.conductivity / scene.matrix.conductivity, k, rtol=1e-6)
    # `solve` calibrates between isothermal walls.
    usual = dem.solve(scene, law=Calibrated(wall=held), packing=between)
    assert_allclose(usual.stats["calibration"], row["ct_isothermal"], rtol=1e-6)
    assert row["ct_flux"] != row["ct_isothermal"]


def test_replicas_have_the_calibration_of_one(tmp_path, monkeypatch):
    monkeypatch.setenv("DEMHEAT_CACHE", str(tmp_path))
    scene = sphere_in_cube(1.0001, periodic=True)
    one = paper_network.packed(scene.size, "lsa", "periodic", 8_000, 0, replicas=2)
    assert one.number == 1000 and one.size[0] == pytest.approx(0.05) and "lsa" in str(one.provenance)
    case = {"packing": "lsa", "held": "periodic", "particles": 8_000, "seed": 0, "replicas": 2}
    fields, row = paper_network.fields_and_row({"k_1": scene}, **case)
    assert fields["k_1"].stats["unknowns"] == row["unknowns"] == 8000
    # A sphere hardly unlike its matrix: 1 + 3 f (s - 1)/(s + 2) = 1 + 1.6e-5 times the matrix's conductivity.
    assert_allclose(fields["k_1"].conductivity / scene.matrix.conductivity, 1.0, atol=3e-5)
    assert fields["k_1"].stats["calibration"] == row["ct_cell"]
    assert_allclose(row["k_1"] * row["ct_cell"], 1.0, atol=3e-5)


def rows(**errors):
    """Rows of three packings whose error at contrast 10 is given for each kind of walls, C_t being .5 and .6."""
    made = []
    for held, percent in errors.items():
        factors = {"ct_cell": 0.5} if held == "periodic" else {"ct_flux": 0.5, "ct_isothermal": 0.6}
        for seed, more in enumerate((-0.1, 0.0, 0.1)):
            k = 2.0 * (1 + (percent + more) / 100)
            here = {"name": "network", "status": "ok", "packing": "lsa", "held": held, "particles": 1000, "seed": seed}
            made.append(here | {"k_10": k} | factors)
    return pd.DataFrame(made)


def test_errors_are_means_with_students_interval_and_the_best_is_named():
    made = paper_variants.variant_errors(rows(center=1.0, periodic=-0.5), {"10": 1.0, "100": 2.0})
    assert set(made) == {
        (Variant("lsa", "center", "flux"), 1000),
        (Variant("lsa", "center", "isothermal"), 1000),
        (Variant("lsa", "periodic", "cell"), 1000),
    }
    found = made[Variant("lsa", "periodic", "cell"), 1000]
    # Student's 97.5 % point of two degrees of freedom is 4.30265.
    assert_allclose(found["10"], (-0.5, 4.30265 * 0.1 / np.sqrt(3), 0.1, 3), rtol=1e-5)
    assert "100" not in found
    first = paper_variants.best_variant(made)
    assert first[0] == Variant("lsa", "periodic", "cell")
    said = paper_variants.told_of(made)
    assert said.startswith("Of 3 variants") and "means over 3 packings" in said
    assert "best is: LSA packing, no walls, C_t in the cell, largest error 0.5 %" in said
    (line,) = [each for each in paper_variants.lines_of(made, {"10": "10"}) if each[""] == "best"]
    assert line["10"] == "-0.50 +- 0.25" and line["packings"] == 3
    said, table = paper_variants.shown(made, {"10": "error"}, "here: errors, %", "; best: least")
    assert said.startswith("The paper's network here: errors, %, means") and said.endswith("(Student's); best: least.")
    assert table.count("best") == 1 and table.count("\n") == 4
