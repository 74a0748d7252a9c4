"""The study of fields on a plane: what its rows and claims are made of."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from studies import fig15_16_fields as study
from studies.common import field_errors
from studies.fig15_16_fields import halos
from studies.harness.cells import numbers, picture


def test_the_exact_row_is_rayleighs(monkeypatch):
    monkeypatch.setattr(study, "GRID", 40)
    monkeypatch.setattr(study, "HALOS", (1e-3, 0.103))
    row = study.run("exact", method="exact")
    for key, (value, digits) in study.RAYLEIGH.items():
        assert row[key] == pytest.approx(value, abs=0.51 * 10**-digits)
    assert row["flux_max"] == row["temperature_max"] == row["q_C_error"] == row["relative_flux"] == 0.0
    assert row["relative_within"] == 100.0
    # A halo of next to no width changes nothing; one that passes the wall is cut there.
    near, wide = numbers(row["halo_q_C"])
    assert_allclose(near, row["q_C"], rtol=1e-5)
    assert 1e-4 < abs(wide / row["q_C"] - 1) < 0.01
    assert len(picture(row["slice_flux"])) == study.GRID


def test_a_ball_is_filled_evenly():
    points = halos.ball(4_000)
    radius = np.linalg.norm(points, axis=1)
    # Of points that fill it evenly an eighth lies in each octant, and in the inner ball of half the radius.
    octants = np.bincount((points > 0) @ [1, 2, 4], minlength=8) / 4_000
    assert_allclose([*octants, np.mean(radius < 0.5)], 1 / 8, atol=0.005)
    assert radius.max() < 1 and abs(points.mean(axis=0)).max() < 0.01


def test_errors_in_the_papers_measure():
    from types import SimpleNamespace

    exact = SimpleNamespace(
        temperature_at=lambda points: np.array([20.0, 40.0]),
        flux_at=lambda points: np.array([[0, 3.0, 4.0], [0, 1.0, 0]]),
    )
    flux = np.array([[5.5, 0, 0], [0.0, -0.7, 0]])
    found = field_errors.in_papers_measure(np.array([20.1, 39.9]), flux, exact, np.zeros((2, 3)))
    wanted = {"relative_temperature": 0.5, "relative_flux": 30.0, "relative_within": 50.0}
    assert found == pytest.approx(wanted)


def test_orders_of_exact_second_and_first_order():
    import pandas as pd

    number = np.array([1_000, 8_000, 64_000])
    errors = {"flux_rms_far": 1 / number ** (1 / 3), "temperature_rms": 1 / number ** (2 / 3)}
    (_, flux, at_least), (_, warm, _) = study._orders(pd.DataFrame({"name": "dem", "particles": number} | errors))
    assert_allclose([flux, warm], [1.0, 2.0], rtol=1e-12)
    assert at_least == ">= 1.5"
