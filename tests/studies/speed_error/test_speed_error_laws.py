"""Laws of error and cost: the fit finds what it is given, and what is shipped is that of the stored rows."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import studies.speed_error as study
from demheat.cheapest import cost_laws as shipped
from references import multipole
from studies.harness.table import read_frame
from studies.speed_error import laws
from studies.speed_error.scenes import STEADY, scene_of

STORED = Path(__file__).parents[3] / "results" / "speed_error.csv"
# Digits of the file.
ROUNDED = 1e-4


def made(name="fft", knob="voxels", values=(16, 32, 64, 128), scenes=tuple(STEADY)[:6]):
    """Rows that follow laws to the last digit."""
    rows = []
    for scene in scenes:
        m = laws.measured(scene)
        for value in values:
            terms = shipped.error_terms(knob, m, value)
            number = 1.02 * value**3
            rows.append(
                {
                    "name": name, "scene": scene, knob: value, "status": "ok", "unknowns": number,
                    "error_percent": 100 * math.exp(terms @ (-3.0, 1.8, 0.5, 0.3, 0.7, -0.2)),
                    "cpu_s": math.exp(shipped.cost_terms(m, number) @ (-14.0, 1.1, 0.4)),
                    "peak_mib": 50 * number / 2**20,
                }
            )  # fmt: skip
    return pd.DataFrame(rows)


def test_the_fit_finds_what_it_is_given():
    law = laws.fitted(made())["fft"]
    # The pull towards no dependence biases exponents a little, the more the less the scenes differ in a measure.
    assert_allclose([law.refinement, law.unknowns], [1.8, 1.1], atol=0.02)
    assert_allclose([law.bulk, law.bytes], [1.02, 50.0], rtol=1e-6)
    assert law.error_within < 1.3 and law.cost_within < 1.1
    assert (law.rows, law.scenes) == (24, 6)


def test_scenes_left_out_are_foretold_where_laws_hold():
    found = laws.left_out(made())
    assert len(found) == 24
    # Exact rows: what is left is the pull's.
    assert laws.within(found["error"]) < 2.0 and laws.within(found["cpu_s"]) < 1.3
    assert_allclose(found["bytes"], 1.0, rtol=1e-6)


def test_errors_of_the_linear_solver_do_not_count():
    rows = made()
    rows.loc[rows["voxels"] == 128, "error_percent"] = 1e-8
    law = laws.fitted(rows)["fft"]
    assert_allclose(law.refinement, 1.8, atol=0.02)
    assert law.rows == 24


def test_what_is_written_is_read(tmp_path):
    found = laws.fitted(made())
    file = tmp_path / "laws.csv"
    file.write_text(laws.written(found))
    assert_allclose(np.array(shipped.laws(file)["fft"][2:]), np.array(found["fft"][2:]), rtol=ROUNDED)


def same_spheres():
    """Whether the polydisperse scene is that of the stored rows: they were drawn before `demheat.powers`."""
    rows = read_frame(study, STORED)
    known = rows.loc[rows["scene"] == "polydisperse", "exact_ratio"].iloc[0]
    scene = scene_of("polydisperse")
    # Other spheres differ by a per cent.
    return abs(multipole.solve(scene, accuracy=1e-4).conductivity / scene.matrix.conductivity / known - 1) < 1e-3


def test_shipped_laws_are_those_of_the_stored_rows():
    """Else: `python -m studies.speed_error.laws`."""
    if not same_spheres():
        pytest.skip("the rows' processor drew other spheres of the same seed: docs/decisions/bits.md")
    now, kept = laws.fitted(laws.stored(STORED)), shipped.laws()
    assert set(now) == set(kept)
    for name, law in now.items():
        assert law[:2] == kept[name][:2]
        # A minimiser's last digits may differ between machines.
        assert_allclose(np.array(law[2:]), np.array(kept[name][2:]), rtol=1e-3, atol=1e-6, err_msg=f"stale: {name}")


def test_known_scenes_are_what_their_names_say():
    assert (
        scene_of("third at infinity").inclusions[0].material.conductivity == 1e6 * scene_of("third").matrix.conductivity
    )
    assert len(scene_of("83 spheres").inclusions) == 83
    from studies.speed_error.cases import LENGTHS

    assert all(scene_of(name).size[0] == length for name, length in LENGTHS.items())
