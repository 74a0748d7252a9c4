"""The study of zeta_2: means of cells, differences in standard errors, what its claims see."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from references.bounds import zeta2_hard_spheres
from studies.zeta2 import means as zeta2_means
from studies.zeta2 import rows as zeta2_rows

HERE = {"part": "cells", "placed": "lsa", "gap": 0.0, "ratio": 6.0, "fraction": 0.2, "spheres": 83}


def cells(*values, **where):
    return HERE | {"values": " ".join(map(str, values))} | where


def test_rows_of_one_kind_are_pooled():
    df = pd.DataFrame([cells(0.04, 0.05), cells(0.06, 0.07), cells(0.1, 0.2, placed="rsa")])
    means = zeta2_means.pooled(df).set_index("placed")
    assert means["cells"].tolist() == [4, 2]
    lsa = means.loc["lsa"]
    scatter = np.std([0.04, 0.05, 0.06, 0.07], ddof=1)
    assert_allclose([lsa["zeta2"], lsa["scatter"], lsa["se"]], [0.055, scatter, scatter / 2])
    # Student's t of 3 degrees of freedom, 97.5 %: 3.18245 in the tables.
    assert_allclose(lsa["half"], 3.18245 * scatter / 2, rtol=1e-5)
    assert_allclose(lsa["off_percent"], 100 * (0.055 / zeta2_hard_spheres(0.2) - 1))


def test_differences_are_weighted_by_their_variance():
    upper = [cells(0.099, 0.101), cells(0.18, 0.22, fraction=0.3)]
    lower = [cells(0.089, 0.091, placed="rsa"), cells(0.09, 0.11, fraction=0.3, placed="rsa")]
    means = zeta2_means.pooled(pd.DataFrame(upper + lower))
    found, se = zeta2_means.below(means, {"placed": "rsa"}, {"placed": "lsa"})
    # 10 +- sqrt(2) % and 50 +- sqrt(5^2 + 10^2) %: half of the difference of two values is their standard error.
    weights = np.array([1 / 2, 1 / 125])
    assert_allclose([found, se], [weights @ [10.0, 50.0] / weights.sum(), weights.sum() ** -0.5])
    assert zeta2_means.below(means, {"placed": "rsa"}, {"placed": "none"}) == (None, None)


def test_worst_of_three_places_keeps_its_sign():
    assert zeta2_rows._worst([1.01, 0.97, 1.02], 1.0) == pytest.approx(-3.0)
    row = zeta2_rows.array_row("sc", 0.5, 32)
    assert abs(row["error_percent"]) >= 100 * abs(row["zeta2"] / row["exact"] - 1)
    assert row["per_diameter"] == pytest.approx(32 * 2 * (0.5 * 3 / (4 * np.pi)) ** (1 / 3))
