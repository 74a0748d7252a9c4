"""The study of halos: what its rows and claims are made of."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from demheat.field import Field, Samples
from studies import fig10_halo
from studies.fig10_halo import rows as halo_rows
from studies.fig10_halo import statistics, tables
from studies.fig10_halo.statistics import RATIOS, STATISTICS, long
from studies.harness.cells import numbers

LENGTH = halo_rows.LENGTH


def test_statistics_of_a_few_numbers():
    number, cov, cov_volume, least, mean, most = statistics._of(np.array([1.0, 2.0, 3.0]), np.array([1.0, 0.0, 3.0]))
    assert (number, least, most) == (3, 1.0, 3.0)
    assert_allclose([cov, mean], [100 * np.sqrt(2 / 3) / 2, 2.5], rtol=1e-14)
    assert_allclose(cov_volume, 100 * np.sqrt((1.5**2 + 3 * 0.5**2) / 4) / 2.5, rtol=1e-14)
    assert np.isnan(statistics._of(np.empty(0), np.empty(0))[1:]).all()


@pytest.mark.parametrize("walls", ["held", "periodic"])
def test_the_bulk_is_what_no_halo_reaches_a_wall_from(walls):
    """Flux 2 beyond 4 mean radii from the walls, 1 at 2 to 4, 0 nearer: of 3300 W/m2, down the gradient."""
    radius = LENGTH / 20
    points = np.random.default_rng(0).random((4000, 3)) * LENGTH
    depth = np.minimum(points, LENGTH - points).min(axis=1)
    flux = np.zeros((4000, 3))
    flux[:, 1] = -3300.0 * ((depth > 2 * radius).astype(float) + (depth > 4 * radius))
    samples = Samples(points, np.ones(4000), np.zeros(4000), np.zeros(4000, int), flux)
    scene, stats = halo_rows.scene_of(walls), {"mean_radius": radius, "law": "calibrated"}
    # Without a conductivity of its own: nothing is to be judged of it.
    field = Field(scene, np.zeros(3), np.ones(1), lambda: samples, None, None, stats={})
    object.__setattr__(field, "stats", stats)
    row = statistics.by_radius(field, {ratio: flux for ratio in (0.0, 4.0, 5.5)})
    found = {name: numbers(cell) for name, cell in row.items()}
    here = [RATIOS.index(ratio) for ratio in (0.0, 4.0, 5.5, 7.0)]
    assert found["number"][here].tolist() == [4000, 4000, 4000, 0]
    assert_allclose(found["least"][here], [0, 0, 0, np.nan])
    if walls == "periodic":
        assert_allclose(found["bulk_least"][here], [0, 0, 0, np.nan])
    else:
        # Of a box of 20 radii a halo of 5.5 leaves 9, less than its own width.
        assert_allclose(found["bulk_least"][here], [1, 2, np.nan, np.nan])
        assert found["bulk_number"][here].tolist() == [(depth > d * radius).sum() for d in (2, 4)] + [0, 0]
    shares = [np.mean(flux[:, 1] == -3300.0 * k) for k in (0, 1, 2)]
    assert_allclose(found["density_0"][[0, 26, 53]], shares, rtol=1e-11)  # printed with 12 digits
    assert_allclose(found["density_0"].sum(), 1.0, rtol=1e-11)


def test_the_flux_by_depth_below_a_wall():
    """Flux 1 within 3 mean radii of the walls across y, 2 beyond; none beside insulated faces."""
    radius = LENGTH / 40
    points = np.random.default_rng(1).random((20_000, 3)) * LENGTH
    away = np.minimum(points, LENGTH - points) / radius
    flux = np.zeros((20_000, 3))
    flux[:, 1] = -3300.0 * np.where(away[:, 1] < 3, 1.0, 2.0) * (away[:, [0, 2]].min(axis=1) > 4)
    samples = Samples(points, np.ones(20_000), np.zeros(20_000), np.zeros(20_000, int), flux)
    field = Field(
        halo_rows.scene_of("held"), np.zeros(3), np.ones(1), lambda: samples, None, None, stats={"mean_radius": radius}
    )
    row = {name: numbers(cell) for name, cell in statistics.near_wall(field, {4.0: flux}).items()}
    assert_allclose(row["near_4"], [1.0] * 3 + [2.0] * 13)
    assert list(row) == ["near_4"]


def test_all_four_weightings_are_held_against_what_is_printed():
    row = {"law": "calibrated", "split": "half", "walls": "held", "seed": 0, "status": "ok", "particles": 500_000}
    cells = {"cov": 54.0, "cov_volume": 27.0, "bulk_cov": 13.5, "bulk_cov_volume": 2.7}
    row |= {f"{part}{name}": "1" + " nan" * 10 for part in ("", "bulk_") for name in STATISTICS}
    # Without halo so much, with a halo of 4 as printed, of 11 half as much.
    row |= {name: f"{value} 9 9 9 5 9 9 9 1 9 9" for name, value in cells.items()}
    found = tables.factors(long(pd.DataFrame([row])))
    assert_allclose(found[0.0], [2.0, 1.0, 0.5, 0.1])
    assert_allclose(found[4.0], 1.0)
    assert_allclose(found[11.0], 0.5)
    (_, value, limit), *_ = fig10_halo._paper(long(pd.DataFrame([row])))
    assert value == 2.0 > limit
