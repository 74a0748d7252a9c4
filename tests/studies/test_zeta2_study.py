"""The study of zeta_2: means of cells, differences in standard errors, what its claims see."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from references.bounds import zeta2_hard_spheres
from studies import zeta2 as study
from studies.harness.cells import numbers
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


def test_claims_see_cells_off_the_polynomial_and_additions_that_are_not_below():
    right = zeta2_hard_spheres(0.2)
    many = right * (1 + 0.05 * np.linspace(-1, 1, study.REALISATIONS))
    good = pd.DataFrame([cells(*many), cells(*(0.9 * many), placed="rsa")])
    bad = pd.DataFrame([cells(*(1.1 * many)), cells(*(1.1 * many), placed="rsa")])
    values = []
    for df in (good, bad):
        found = {text.split(":")[-1 if "polynomial" in text else 0]: v for text, v, _ in study._statistics(df)}
        values.append([found[" f <= 0.4, in standard errors"], found[" f >= 0.2, %"]])
        values[-1].append(found["RSA below LSA, both with a gap of 0 D"])
    assert values[0][0] < 1e-3 and values[0][1] < 1e-3 and values[0][2] > 5  # values are text of many digits
    assert values[1][0] > 8 and values[1][1] == pytest.approx(10.0) and values[1][2] == pytest.approx(0.0, abs=1e-9)


def test_claims_see_a_conductivity_outside_the_bounds_and_a_wrong_surface():
    row = {"part": "conductivity", "fraction": 0.2, "zeta2": 0.038, "conductivity": 0.2920, "truncation": 1e-5}
    inside, *_ = [value for _, value, _ in study._bounds(pd.DataFrame([row]))]
    outside, *_ = [value for _, value, _ in study._bounds(pd.DataFrame([row | {"conductivity": 0.31}]))]
    assert inside == 0.0 and outside > 0.01
    surface = pd.DataFrame([{"part": "surface", "error_percent": -2.0, "error_se": 0.5}])
    assert [value for _, value, _ in study._surfaces(surface)] == [2.0, 4.0]


def test_worst_of_three_places_keeps_its_sign():
    assert zeta2_rows._worst([1.01, 0.97, 1.02], 1.0) == pytest.approx(-3.0)
    row = zeta2_rows.array_row("sc", 0.5, 32)
    assert abs(row["error_percent"]) >= 100 * abs(row["zeta2"] / row["exact"] - 1)
    assert row["per_diameter"] == pytest.approx(32 * 2 * (0.5 * 3 / (4 * np.pi)) ** (1 / 3))


def test_moved_arrays_are_the_same_arrays():
    from references import multipole

    scene = zeta2_rows.ARRAYS["bcc"](fraction=0.4)
    moved = zeta2_rows._moved(scene, zeta2_rows.PLACES[1])
    assert moved.inclusions[0].center != scene.inclusions[0].center
    assert_allclose(multipole.zeta2(moved), multipole.zeta2(scene), rtol=1e-9)  # rounding, amplified 20 times


def test_surface_of_a_few_cells():
    row = zeta2_rows.surface_row("rsa", 0.0, 0.1, 6.0, first=0, cells=1)
    assert row["exact"] == pytest.approx(0.6)  # 6 f/D in units of D
    assert abs(row["error_percent"]) < 4 * row["error_se"] < 4.0
    s2 = numbers(row["s2"])
    assert s2[0] == pytest.approx(0.1, rel=0.02)  # seven directions of 10 000 lines: 0.3 %
    assert s2[-1] == pytest.approx(0.01, rel=0.2)
