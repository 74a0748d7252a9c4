"""Only here: jumps and short pulses of a load that steps pass over, sources that they outrun."""

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.conduction.integrators.pace import pace_of


def pace(*functions, transits=(), accuracy=1e-3):
    return pace_of(functions, transits, 100.0, accuracy)


@pytest.mark.parametrize("width", [0.11, 30.0])
def test_both_sides_of_every_jump_are_breaks(width):
    found = pace(lambda t: 5.0 if 50.033 <= t < 50.033 + width else -1.0).breaks
    assert len(found) == 4 and np.all(np.diff(found) > 0)
    for (low, high), jump in zip(found.reshape(2, 2), (50.033, 50.033 + width), strict=True):
        # Known to 1e-9 of the run.
        assert low <= jump <= high <= low + 1.01e-7


def test_a_constant_asks_for_nothing():
    found = pace(lambda t: 3.0)
    assert not len(found.breaks) and found.allowed(0.0) == math.inf and found.steps(100.0) == 1


@pytest.mark.parametrize("function", [lambda t: max(0.0, 1 - abs(t - 40) / 0.7), lambda t: math.exp(-((t - 40) ** 2))])
def test_steps_grow_short_where_a_load_changes_fast(function):
    found, now, met = pace(function), 0.0, [0.0]
    while now < 100.0:
        now += found.allowed(now)
        met.append(now)
    assert not len(found.breaks)
    # A fifth of the range, and what a step that ends within one of a thousand parts of the run may take in besides.
    assert max(abs(function(b) - function(a)) for a, b in pairwise(met)) < 0.2 + 0.15
    assert max(map(function, met)) > 0.8
    # Wide steps elsewhere are a twentieth of the run.
    assert max(np.diff(met)) == pytest.approx(5.0) and len(met) < 60


def test_steps_of_a_source_go_with_its_speed_and_the_accuracy():
    source = (20.0, 60.0, 2.0)
    for accuracy, part in ((1e-3, 0.1), (1e-5, 0.01), (0.1, 0.25)):
        found = pace(transits=[source], accuracy=accuracy)
        assert found.breaks.tolist() == [20.0, 60.0]
        assert_allclose([found.allowed(20.0), found.allowed(59.9), found.least(0.0, 30.0)], part * 2.0, rtol=1e-12)
        assert found.allowed(5.0) == 15.0 and found.allowed(60.0) == found.least(0.0, 20.0) == math.inf
    still = pace(transits=[(-math.inf, math.inf, math.inf)])
    assert not len(still.breaks) and still.allowed(0.0) == math.inf


def test_stops_are_times_and_breaks():
    found = pace(transits=[(20.0, 60.0, 2.0)])
    assert found.stops(np.array([10.0, 60.0])) == [(10.0, True), (20.0, False), (60.0, True)]
    assert found.stops([10.0]) == [(10.0, True)]
