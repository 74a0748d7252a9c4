"""Only here: heat balances and bounds judged with another sign or scale."""

import math

import pytest
from known_fields import CELL, WALLED, exact_flux, exact_temperature, field
from numpy.testing import assert_allclose

from demheat import referee


def test_heat_balance():
    assert referee.heat_balance(field(WALLED, None, None, wall_heat={"y-": -10.0, "y+": 10.5})) == 0.5 / 10.5
    assert referee.heat_balance(field(WALLED, None, None, wall_heat={"y-": 0.0, "y+": 0.0})) == 0.0
    with pytest.raises(ValueError, match="periodic"):
        referee.heat_balance(field(CELL, None, None))


def test_bound_violation():
    reference = field(WALLED, exact_temperature, exact_flux)
    assert referee.bound_violation(reference, 2.0, 4.0) == 0.0
    assert referee.bound_violation(reference, 3.0, 3.0) == 0.0
    assert_allclose(referee.bound_violation(reference, 4.0, 5.0), -0.25, rtol=1e-12)
    assert_allclose(referee.bound_violation(reference, 0.0, 2.0), 0.5, rtol=1e-12)
    assert referee.bound_violation(reference, 0.0, 0.0) == math.inf
    for lower, upper in ((2.0, 1.0), (-1.0, 1.0), (math.nan, 1.0)):
        with pytest.raises(ValueError, match="must be 0 <= lower <= upper"):
            referee.bound_violation(reference, lower, upper)


def test_bound_violation_of_numbers():
    assert referee.bound_violation(2.5, 2.0, 3.0) == 0.0
    assert_allclose(referee.bound_violation(1.0, 2.0, 3.0), -0.5, rtol=1e-12)
    # A failed row must not look as if it lay between the bounds.
    assert math.isnan(referee.bound_violation(math.nan, 2.0, 3.0))
