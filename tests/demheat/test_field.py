"""Only here: a conductivity taken across the load, or of walls' nominal temperatures; samples made twice."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Field, Flux, Material, Samples, Scene

BOX = (0.1, 0.2, 0.4)


def field(scene, mean_flux, **rest):
    # No body conducts so: the gate, which has its own tests, lets it pass.
    return Field(scene, np.array(mean_flux), np.ones(1), lambda: None, None, None, slack=(1.0, np.inf), **rest)


def test_periodic_conductivity_is_along_the_gradient():
    scene = Scene(BOX, Material(1.0), gradient=(0.0, 30.0, 40.0))
    # -<q>.g / |g|^2: the part across the gradient does not count.
    assert_allclose(field(scene, [7.0, -60.0, -80.0]).conductivity, 2.0, rtol=1e-15)
    assert_allclose(field(scene, [0.0, -40.0, 30.0]).conductivity, 0.0, atol=1e-15)


@pytest.mark.parametrize(("low", "high"), [(25.0, 35.0), (35.0, 25.0), (25.0, Flux(1000.0)), (Flux(-1000.0), 35.0)])
def test_wall_conductivity_uses_mean_wall_temperatures(low, high):
    scene = Scene(BOX, Material(1.0), walls={"z-": low, "z+": high})
    rise = -10.0 if low == 35.0 else 10.0
    made = field(scene, [1.0, 2.0, -3.0 * rise / 0.4], wall_temperature={"z-": 25.0, "z+": 25.0 + rise})
    assert_allclose(made.conductivity, 3.0, rtol=1e-15)


def test_no_conductivity_without_a_difference_or_an_axis():
    scene = Scene(BOX, Material(1.0), walls={"z-": 25.0, "z+": 25.0})
    with pytest.raises(ValueError, match="same temperature"):
        field(scene, [0.0, 0.0, 0.0], wall_temperature={"z-": 25.0, "z+": 25.0}).conductivity  # noqa: B018
    scene = Scene(BOX, Material(1.0), walls={"z-": 25.0, "y+": 35.0})
    with pytest.raises(ValueError, match="axis of load"):
        field(scene, [0.0, 0.0, 0.0], wall_temperature={"z-": 25.0, "y+": 35.0}).conductivity  # noqa: B018


def test_samples_are_made_once_and_only_when_asked_for():
    calls = []

    def sampler():
        calls.append(1)
        return Samples(*np.zeros((5, 1)))

    scene = Scene(BOX, Material(1.0), gradient=(1, 0, 0))
    made = Field(scene, np.zeros(3), np.ones(1), sampler, None, None, slack=(1.0, np.inf))
    assert not calls
    assert made.samples is made.samples
    assert len(calls) == 1


@pytest.mark.parametrize(
    ("bad", "told"),
    [
        ({3: np.nan}, r"^points\[3\] = \[nan, .*: must be finite coordinates in metres$"),
        ({3: np.inf, 1: np.nan}, r"^points\[1\] = .* in metres; one more row is so$"),
        ({2: 0.2}, r"^points\[2\] = \[0.2, .*: lies outside the box with walls, 0 to \(0.1, 0.2, 0.4\)$"),
        ({2: -0.2, 0: 1.0, 4: 1.0}, r"^points\[0\] = .*\); 2 more rows are so$"),
    ],
)
def test_a_point_that_is_none_is_told_by_its_row(bad, told):
    scene = Scene(BOX, Material(1.0), walls={"z-": 25.0, "z+": 35.0})
    made = Field(scene, np.zeros(3), np.ones(1), lambda: None, lambda points: None, None, slack=(1.0, np.inf))
    points = np.full((5, 3), 0.05)
    points[list(bad), 0] = list(bad.values())
    with pytest.raises(ValueError, match=told):
        made.temperature_at(points)
