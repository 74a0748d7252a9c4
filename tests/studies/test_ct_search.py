"""The search for the paper's packings: what follows for more particles, and when a set fits."""

import pandas as pd
import pytest
from numpy.testing import assert_allclose

from studies.ct_search import means


def fitting(**more):
    """A row that gives all that is printed, but for what is said."""
    finer = (means.SPHERE / means.NUMBER) ** (means.ORDER / 3)
    # The cell's C_t and the walls' share for which .806 and .834 follow at 1e5 and 1e6.
    share = (0.834 - 0.806) / (1e5 ** (-1 / 3) - 1e6 ** (-1 / 3))
    cell = 0.834 + share * 1e6 ** (-1 / 3)
    row = {
        "spread": 0.15,
        "links": 7.5,
        "mean": "arithmetic",
        "status": "ok",
        "method": "dem",
        "case": "a",
        "gap": 0.05,
    }
    row |= {"ct_cell": cell, "ct_block": cell - share * means.NUMBER ** (-1 / 3), "ct_cell_sd": 0.001, "note": ""}
    row |= {"cov_0": 27.0, "cov_4": 5.0, "cov_11": 2.0, "cov_volume_0": 27.0, "cov_volume_4": 5.0, "cov_volume_11": 2.0}
    return row | {"error_0.01": -0.5 * 0.65 * finer, "error_100": 0.1, "under_2": 0.001} | more


def test_what_is_printed_follows_for_more_particles():
    found = means.predicted(pd.DataFrame([fitting()])).iloc[0]
    assert_allclose([found["ct_1e5"], found["ct_1e6"]], [0.806, 0.834], rtol=1e-12)
    assert_allclose([found["sphere"], found["under_2"]], [0.325, 0.1], rtol=1e-12)
    assert found["sphere_low"] < found["sphere"] < found["sphere_high"]
    assert 0 < found["ct_1e6_half"] < found["ct_1e5_half"] < 0.01


@pytest.mark.parametrize(
    ("change", "misfit"),
    [
        ({}, 0.5),
        ({"cov_0": 54.0, "cov_volume_0": 27.0 * 1.2}, 0.8),  # the other weighting fits
        ({"cov_4": 7.5, "cov_volume_4": 7.5}, 2.0),
        ({"under_2": 0.02}, 10.0),
    ],
)
def test_misfits_are_in_tolerances(change, misfit):
    found = means.ranked(pd.DataFrame([fitting(**change)]))
    assert len(found) == len(means.WEIGHTINGS)
    assert found.iloc[0]["worst"] == pytest.approx(misfit)
