"""The study of the sphere's centre: what its rows are made of."""

import pandas as pd
import pytest
from numpy.testing import assert_allclose

from studies import fig07_sphere
from studies.fig07_sphere import rows as fig07_rows
from studies.fig07_sphere import tables as fig07_tables
from studies.harness.cells import numbers


@pytest.fixture(scope="module")
def usual():
    return fig07_sphere.run("dem", law="calibrated", particles=500, seed=99)


def test_laws_of_contacts_heat_the_centre_too_early(usual):
    # Wall temperatures act in centres, a radius inside of a sphere of some five: found 8.7 K; exact is 182.
    assert 3.0 < usual["error_10s"] < 17.0
    assert 0.6 < usual["calibration"] < 0.9


def test_one_march_serves_both_calibrations(usual):
    """What `evolve` calibrates between isothermal walls is one of the two, at the same times."""
    row = fig07_sphere.run("dem", "network", packing="relaxed", held="center", particles=500, seed=99)
    assert_allclose(row["ct_isothermal"], usual["calibration"], rtol=1e-6)
    # Two marches of accuracy 1e-5 of 180 K.
    assert_allclose(numbers(row["errors_isothermal"]), numbers(usual["errors"]), atol=0.01)
    assert row["error_10s_flux"] != row["error_10s_isothermal"]


def test_temperatures_at_the_surface_heat_it_later():
    """The centre of a sphere of 3000 particles is nearer to the exact one where the wall's own surface is held."""
    found = {
        held: fig07_rows.network_row("relaxed", held, 3_000, 0, times=(10.0,))["error_10s_isothermal"]
        for held in ("center", "surface")
    }
    assert found["center"] > 2.0 and abs(found["surface"]) < 0.5 * found["center"]


def test_of_a_stall_is_said_whether_it_is_temporal():
    size, accuracy = next(iter(fig07_sphere.TIGHTER.items()))
    here = {"method": "fem", "order": 2, "size": size, "status": "ok"}
    df = pd.DataFrame([here | {"error_10s": 0.1}, here | {"error_10s": 0.01, "accuracy": accuracy}])
    (said,) = fig07_tables.told(df)
    assert said.endswith("most of it is temporal.") and "+0.1000 K" in said
    df.loc[1, "error_10s"] = 0.09
    assert fig07_tables.told(df)[0].endswith("little of it is temporal.")
    assert fig07_tables.told(df.iloc[:1].assign(accuracy=None)) == []
