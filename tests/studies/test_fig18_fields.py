"""The study of fields among many spheres: errors against its witnesses, what its claims see."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from demheat.scene import Material, Scene, Sphere
from studies import fig18_fields as study
from studies.fig18_fields import errors as fig18_errors
from studies.fig18_fields import rows as fig18_rows
from studies.fig18_fields import tables as fig18_tables
from studies.harness.cells import cell

BOX = Scene(
    (0.1, 0.1, 0.1), Material(0.195),
    [Sphere((0.03, 0.04, 0.045), 0.02, Material(1.5)), Sphere((0.07, 0.065, 0.06), 0.025, Material(0.02))],
    walls={"y-": 25.0, "y+": 35.0},
)  # fmt: skip


def test_distances_and_phases():
    points = np.array([(0.03, 0.04, 0.045), (0.03, 0.04, 0.075), (0.07, 0.065, 0.01)])
    assert_allclose(fig18_rows.distance(BOX, points), [-0.02, 0.01, 0.025], atol=1e-15)
    row = fig18_rows.arrangement_row()
    assert row["number"] == 83
    # 83 spheres that fill a fifth of the cube.
    assert row["radius"] == pytest.approx((0.2 * 3 / (4 * np.pi * 83)) ** (1 / 3))
    scene = fig18_rows.spheres_in("walls")
    points = np.array(list(fig18_rows.POINTS.values())) * scene.size
    gaps = [np.linalg.norm(points - s.center, axis=1) - s.radius for s in scene.inclusions]
    assert_allclose([row[f"gap_{x}"] for x in "ABCD"], np.abs(np.min(np.abs(gaps), axis=0)) / 0.1)
    assert min(row[f"gap_{x}"] for x in "ABCD") >= row["band"]
    assert [row[f"phase_{x}"] == "sphere" for x in "ABCD"] == (np.min(gaps, axis=0) < 0).tolist()


def rows():
    """A witness with a flux of 10 W/m2 down y, and a row that is off by known amounts."""
    flat = np.full((4, 4), 10.0)
    base = {"boundary": "walls", "mean_flux": 10.0, "unknowns": 10, "degree": np.nan, "case": "a"}
    base |= {f"T_{x}": 30.0 for x in "ABCD"} | {f"q_{x}": 10.0 for x in "ABCD"}
    base |= {f"q{axis}_{x}": -10.0 if axis == "y" else 0.0 for axis in "xyz" for x in "ABCD"}
    base |= {
        "slice_temperature": cell(5 * flat, decimals=3),
        "slice_x": cell(0 * flat, decimals=2),
        "slice_z": cell(0 * flat, decimals=2),
    }
    witness = base | {"name": "multipole", "degree": 8, "slice_y": cell(-flat, decimals=2)}
    other = base | {"name": "dem", "particles": study.NUMBERS[-1], "case": "b", "T_B": 30.02, "q_C": 10.3, "qz_C": 1.0}
    bent = -flat
    bent[0, 0] = -14.0
    other |= {"slice_y": cell(bent, decimals=2)}
    gaps = np.full((4, 4), 0.5)
    gaps[:2] = 0.01
    place = {
        "name": "arrangement",
        "slice_gap": cell(gaps, decimals=4),
        "slice_face": cell(gaps, decimals=4),
        "band": 0.02,
        "number": 83,
    }
    return pd.DataFrame([witness, other, place | {f"gap_{x}": 0.03 for x in "ABCD"}])


def test_errors_are_those_put_in():
    found = fig18_errors.with_errors(rows()).set_index("name")
    assert list(found.index) == ["multipole", "dem"]
    exact, dem = found.loc["multipole"], found.loc["dem"]
    assert exact["worst_T"] == exact["worst_q"] == exact["flux_max_band"] == 0.0
    assert_allclose([dem["worst_T"], dem["worst_q"], dem["worst_vector"]], [0.2, 3.0, 10.0])
    # One pixel of the eight in the band is off by 40 % of the mean flux.
    assert_allclose([dem["flux_max_band"], dem["flux_rms_band"], dem["flux_max"]], [40.0, 40 / np.sqrt(8), 0.0])


def network(flux):
    """A row of the paper's network with C_t = 1 whose flux is everywhere so many W/m2 down y."""
    base = rows().iloc[1].to_dict() | {
        "name": "network",
        "packing": "lsa",
        "held": "center",
        "seed": 0,
        "under": "walls",
    }
    base |= {"boundary": np.nan, "particles": 1000, "ct_flux": 0.5, "ct_isothermal": 0.6, "mean_flux": flux}
    base |= {f"q_{x}": flux for x in "ABCD"} | {f"qy_{x}": -flux for x in "ABCD"} | {"qz_C": 0.0}
    return base | {"slice_y": cell(np.full((4, 4), -flux), decimals=2)}


def test_fluxes_of_the_network_are_in_proportion_to_its_calibration():
    df = pd.concat([rows(), pd.DataFrame([network(20.0)])], ignore_index=True)
    found = fig18_errors.network_errors(df).set_index("factor")
    assert list(found.index) == [0.5, 0.6] and found.loc[0.6, "variant"].calibration == "isothermal"
    # 20 W/m2 times C_t, beside the witness's 10.
    assert_allclose(found["worst_q"], [0.0, 20.0], atol=1e-9)
    assert_allclose(found["flux_max"], [0.0, 20.0], atol=1e-9)
    # 30.02 against 30 degrees Celsius, whatever C_t is.
    assert_allclose(found["worst_celsius"], 100 * 0.02 / 30)
    said = fig18_tables.told(df, study.PAPER)
    assert "halos of 11" in said[0] and said[1].count("best") == 1
    assert list(fig18_errors.with_errors(df.iloc[:3])["name"]) == ["multipole", "dem"]


def test_without_multipoles_the_finest_elements_are_the_witness():
    both = rows().replace({"name": {"multipole": "fem"}})
    finer = both.iloc[:1].assign(unknowns=20, case="c")
    assert fig18_errors.witness(pd.concat([both, finer], ignore_index=True), "walls")["case"] == "c"
    assert fig18_errors.witness(rows(), "walls")["name"] == "multipole"
    assert fig18_errors.witness(rows(), "gradient") is None
