"""Only here: errors of fields without their weights, level or scale, on differences known by construction."""

import math

import numpy as np
import pytest
from known_fields import CELL, POINTS, WALLED, exact_flux, exact_temperature, field, with_errors
from numpy.testing import assert_allclose

from demheat import Field, Flux, Material, Scene, referee


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


def test_units_are_of_one_error(reference):
    wrong = with_errors(WALLED, (1.0, -3.0, 2.0), (3.0, 0.0, -6.0))
    kelvin = referee.temperature_error(wrong, reference, unit="K")
    # Rounding of temperatures of tens of kelvin.
    assert_allclose(kelvin.values, [1.0, -3.0, 2.0], rtol=1e-12)
    for unit, scale in (("%", 20 / 100), ("span", 20)):
        found = referee.temperature_error(wrong, reference, unit=unit)
        assert_allclose([found.rms, found.max], [kelvin.rms / scale, 3 / scale], rtol=1e-12)
    assert_allclose(referee.flux_error(wrong, reference, unit="%").max, 20.0, rtol=1e-12)
    with pytest.raises(ValueError, match="unit = 'C': must be one of span, %, K"):
        referee.temperature_error(wrong, reference, unit="C")
    with pytest.raises(ValueError, match="unit = 'K': must be one of mean, %"):
        referee.flux_error(wrong, reference, unit="K")


def test_values_at_hand_stand_in_for_the_fields_own(reference):
    found = referee.temperature_error(reference, reference, POINTS, values=exact_temperature(POINTS) + 2.0)
    assert_allclose(found.values, 0.1, rtol=1e-12)
    sideways = exact_flux(POINTS) + [0.0, 0.0, 15.0]
    assert_allclose(referee.flux_error(reference, reference, values=sideways).values, 0.5, rtol=1e-12)
    with pytest.raises(ValueError, match=r"values of shape \(2,\): must be one for each of 3 points"):
        referee.temperature_error(reference, reference, POINTS, values=np.zeros(2))


def test_flux_along_the_mean_flux_is_signed(reference):
    off = exact_flux(POINTS) + np.array([[5.0, -3.0, 0.0], [0.0, 6.0, 7.0], [1.0, 0.0, 0.0]])
    found = referee.flux_error(reference, reference, POINTS, values=off, along=True)
    # The mean flux of 30 points down y.
    assert_allclose(found.values, [0.1, -0.2, 0.0], rtol=1e-12)


def test_part_of_an_error(reference):
    found = referee.temperature_error(with_errors(WALLED, (1.0, -3.0, 2.0)), reference, unit="K")
    part = found.part(np.array([True, False, True]))
    assert_allclose([part.rms, part.max], [math.sqrt((1 * 1 + 0.5 * 4) / 1.5), 2.0], rtol=1e-12)
    assert_allclose(part.where, POINTS[2], rtol=0)
    assert referee.temperature_error(reference, reference, POINTS).part(np.array([True, False, False])).weights is None


def heated(time, walls, initial):
    """A reference at a time."""
    scene = Scene((1.0, 2.0, 1.0), Material(3.0, 1.0, 1.0), walls=walls, initial=initial)
    return field(scene, exact_temperature, exact_flux, time=time, wall_temperature={"y-": 10.0, "y+": 30.0})


@pytest.mark.parametrize(
    ("walls", "initial", "expected"),
    [
        ({"y-": 10.0, "y+": 30.0}, 10.0, 20.0),
        ({"y-": 10.0, "y+": 30.0}, 50.0, 40.0),
        ({"y-": 10.0}, 25.0, 15.0),
        ({"y-": lambda time: 10.0 * time}, 0.0, 40.0),
        ({"y+": Flux(1.0)}, 12.0, 20.0),  # walls at 10 and 30 in the reference
    ],
)
def test_span_in_time_counts_the_initial_temperature(walls, initial, expected):
    reference = heated(4.0, walls, initial)
    assert referee.span(reference.scene, reference) == expected


def test_errors_in_time_are_of_that_span():
    reference = heated(4.0, {"y-": 10.0}, 110.0)
    found = referee.temperature_error(with_errors(reference.scene, (1.0, -3.0, 2.0)), reference, unit="%")
    assert_allclose(found.values, [1.0, -3.0, 2.0], rtol=1e-12)
