"""Extrapolation finds what has the orders that it is told or shows; a study's limit would be off without a word."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from references.richardson import extrapolate, observed_order

SIZES = 1 / np.array([64, 128, 200, 512])


@pytest.mark.parametrize("order", [1, 2.0, (1, 2), (1, 3), (0.5, 2, 3)])
def test_what_has_these_orders_is_extrapolated_exactly(order):
    powers = np.atleast_1d(order)
    values = 0.3 + 0.7 * np.sum(SIZES[:, None] ** powers, axis=1)
    for n in range(len(powers) + 1, 5):
        # Rounding, amplified some 100 times by three terms.
        assert_allclose(extrapolate(values[:n], SIZES[:n], order), 0.3, rtol=1e-13)
        assert_allclose(extrapolate(values[:n][::-1], 1e3 * SIZES[:n][::-1], order), 0.3, rtol=1e-13)


@pytest.mark.parametrize("order", [0.5, 1.0, 1.7, 4.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_the_order_is_found_in_three_values(order, sign):
    sizes = SIZES[[2, 0, 3]]
    values = 5.0 + 20 * sign * sizes**order
    # Rounding of 5 against differences down to 20 (1/200)^4 = 1e-8.
    assert_allclose(observed_order(values, sizes), order, rtol=1e-6)
    assert_allclose(extrapolate(values, sizes), 5.0, rtol=1e-12)


def test_more_values_than_terms_are_fitted():
    noise = 1e-6 * np.array([1, -2, 1.5, -0.5])
    values = 2.0 + 3 * SIZES + noise
    expected = np.polynomial.Polynomial.fit(SIZES, values, 1).convert().coef[0]
    assert_allclose(extrapolate(values, SIZES, 1), expected, rtol=1e-12)  # Rounding.


def test_too_few_values():
    with pytest.raises(ValueError, match="2 exponents need at least 3"):
        extrapolate([1.0, 2.0], [1.0, 0.5], (1, 2))
    with pytest.raises(ValueError, match="exactly 3"):
        extrapolate([1.0, 2.0], [1.0, 0.5], None)
