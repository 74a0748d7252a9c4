"""Errors between Fields whose difference is known by construction."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Field, Flux, Material, Samples, Scene, referee

WALLED = Scene((1.0, 2.0, 1.0), Material(3.0), walls={"y-": 10.0, "y+": 30.0})
CELL = Scene((1.0, 2.0, 1.0), Material(3.0), gradient=(0.0, 10.0, 0.0))
POINTS = np.array([[0.5, 0.5, 0.5], [0.5, 1.5, 0.5], [0.2, 1.0, 0.5]])
VOLUMES = np.array([1.0, 0.5, 0.5])


def field(scene, temperature, flux, *, conductivity=3.0, **rest):
    """A Field with given temperature and flux functions and samples at POINTS."""

    def sampler():
        return Samples(POINTS, VOLUMES, temperature(POINTS), np.zeros(3, dtype=int), flux(POINTS))

    rest.setdefault("wall_temperature", scene.wall_temperatures)
    mean = np.array([0.0, -10.0 * conductivity, 0.0])
    return Field(scene, mean, np.ones(1), sampler, temperature, flux, **rest)


def exact_temperature(points):
    return 10.0 + 10.0 * points[:, 1]


def exact_flux(points):
    return np.tile([0.0, -30.0, 0.0], (len(points), 1))


def with_errors(scene, temperature_errors, flux_errors=(0.0, 0.0, 0.0)):
    """A Field that is off by the given amounts at POINTS, in the flux along x."""

    def at(points, errors):
        return np.array([errors[np.argmin(np.abs(POINTS - p).sum(axis=1))] for p in points])

    return field(
        scene,
        lambda points: exact_temperature(points) + at(points, temperature_errors),
        lambda points: exact_flux(points) + at(points, flux_errors)[:, None] * [1.0, 0.0, 0.0],
    )


@pytest.fixture
def reference():
    return field(WALLED, exact_temperature, exact_flux)


def test_conductivity_error_is_signed_and_relative(reference):
    # Rounding only, here and below.
    assert_allclose(referee.conductivity_error(field(WALLED, None, None, conductivity=3.3), reference), 0.1, rtol=1e-12)
    assert_allclose(referee.conductivity_error(field(CELL, None, None, conductivity=2.7), 3.0), -0.1, rtol=1e-12)
    for bad in (0.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="must be finite and > 0"):
            referee.conductivity_error(reference, bad)


def test_temperature_error_is_weighted_and_relative_to_the_span(reference):
    found = referee.temperature_error(with_errors(WALLED, (1.0, -3.0, 2.0)), reference)
    assert_allclose(found.rms, math.sqrt((1.0 * 1 + 0.5 * 9 + 0.5 * 4) / 2) / 20, rtol=1e-12)
    assert_allclose(found.max, 3.0 / 20, rtol=1e-12)
    assert_allclose(found.where, POINTS[1], rtol=0)
    at_points = referee.temperature_error(with_errors(WALLED, (1.0, -3.0, 2.0)), reference, POINTS)
    assert_allclose(at_points.rms, math.sqrt(14 / 3) / 20, rtol=1e-12)


def test_level_does_not_count_in_a_periodic_cell():
    reference = field(CELL, exact_temperature, exact_flux)
    # Errors 5, 5, 9 weigh 1, 0.5, 0.5: mean 6, rest -1, -1, 3.
    found = referee.temperature_error(with_errors(CELL, (5.0, 5.0, 9.0)), reference)
    assert_allclose(found.rms, math.sqrt((1 + 0.5 + 4.5) / 2) / 20, rtol=1e-12)
    assert_allclose(found.max, 3.0 / 20, rtol=1e-12)
    walled = field(WALLED, exact_temperature, exact_flux)
    assert_allclose(referee.temperature_error(with_errors(WALLED, (5.0,) * 3), walled).rms, 0.25, rtol=1e-12)


def test_flux_error_is_relative_to_the_mean_flux(reference):
    found = referee.flux_error(with_errors(WALLED, (0.0,) * 3, (3.0, 0.0, -6.0)), reference)
    assert_allclose(found.rms, math.sqrt((9 + 18) / 2) / 30, rtol=1e-12)
    assert_allclose(found.max, 0.2, rtol=1e-12)
    assert_allclose(found.where, POINTS[2], rtol=0)


def test_masks(reference):
    wrong = with_errors(WALLED, (1.0, -3.0, 2.0), (3.0, 0.0, 6.0))
    for mask in (np.array([True, False, True]), lambda points: points[:, 1] < 1.2):
        assert_allclose(referee.temperature_error(wrong, reference, mask=mask).max, 0.1, rtol=1e-12)
        assert_allclose(referee.flux_error(wrong, reference, POINTS, mask=mask).rms, math.sqrt(45 / 2) / 30, rtol=1e-12)
    for bad in (np.array([1, 0, 1]), np.array([True])):
        with pytest.raises(ValueError, match="must be 3 booleans"):
            referee.temperature_error(wrong, reference, mask=bad)
    with pytest.raises(ValueError, match="none left"):
        referee.flux_error(wrong, reference, mask=np.zeros(3, dtype=bool))


def test_what_is_not_finite_shows(reference):
    found = referee.temperature_error(with_errors(WALLED, (1.0, math.nan, 2.0)), reference)
    assert math.isnan(found.rms)
    assert math.isnan(found.max)


def test_span():
    assert referee.span(WALLED) == 20.0
    assert referee.span(Scene((1.0, 2.0, 4.0), Material(1.0), gradient=(1.0, -2.0, 0.5))) == 7.0
    heated = Scene((1.0, 2.0, 1.0), Material(3.0), walls={"y-": 10.0, "y+": Flux(30.0)})
    reference = field(heated, exact_temperature, exact_flux, wall_temperature={"y-": 10.0, "y+": 30.0})
    assert referee.span(heated, reference) == 20.0
    with pytest.raises(ValueError, match="no temperature difference"):
        referee.span(heated)
    with pytest.raises(ValueError, match="no temperature difference"):
        referee.span(Scene((1.0, 2.0, 1.0), Material(3.0), walls={"y-": 10.0, "y+": 10.0}))


def test_no_relative_flux_error_without_flux(reference):
    still = Field(WALLED, np.zeros(3), np.ones(1), reference.sampler, exact_temperature, exact_flux)
    with pytest.raises(ValueError, match="mean_flux = 0"):
        referee.flux_error(reference, still)


def test_heat_balance():
    assert referee.heat_balance(field(WALLED, None, None, wall_heat={"y-": -10.0, "y+": 10.5})) == 0.5 / 10.5
    assert referee.heat_balance(field(WALLED, None, None, wall_heat={"y-": 0.0, "y+": 0.0})) == 0.0
    with pytest.raises(ValueError, match="periodic"):
        referee.heat_balance(field(CELL, None, None))


def test_bound_violation(reference):
    assert referee.bound_violation(reference, 2.0, 4.0) == 0.0
    assert referee.bound_violation(reference, 3.0, 3.0) == 0.0
    assert_allclose(referee.bound_violation(reference, 4.0, 5.0), -0.25, rtol=1e-12)
    assert_allclose(referee.bound_violation(reference, 0.0, 2.0), 0.5, rtol=1e-12)
    assert referee.bound_violation(reference, 0.0, 0.0) == math.inf
    for lower, upper in ((2.0, 1.0), (-1.0, 1.0), (math.nan, 1.0)):
        with pytest.raises(ValueError, match="must be 0 <= lower <= upper"):
            referee.bound_violation(reference, lower, upper)
