"""Only here: a polynomial that is none of those promised, or whose slope is another's."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.sampling.polynomials import HARMONICS, QUADRATICS

X = np.random.default_rng(0).uniform(-1, 1, (50, 3))


def laplacians(own):
    """Of each polynomial, by its coefficients: exact."""
    total = np.zeros((1, own.number))
    here = np.random.default_rng(1).uniform(-1, 1, 3)
    for powers, row in zip(own.powers, own.table, strict=True):
        for axis in range(3):
            p = powers[axis]
            lower = [here[k] ** (powers[k] - 2 * (k == axis)) if p > 1 or k != axis else 0.0 for k in range(3)]
            total += p * (p - 1) * np.prod(lower) * row if p > 1 else 0.0
    return total[0]


def test_harmonics_are_harmonic_and_all_there_are_up_to_third_order():
    assert_allclose(laplacians(HARMONICS), 0.0, atol=1e-14)  # rounding of numbers of order 1
    assert abs(laplacians(QUADRATICS)).max() == 2.0
    assert HARMONICS.number == (3 + 1) ** 2 == np.linalg.matrix_rank(HARMONICS.values(X))
    assert QUADRATICS.number == 10 == np.linalg.matrix_rank(QUADRATICS.values(X))


@pytest.mark.parametrize("own", [HARMONICS, QUADRATICS], ids=["harmonics", "quadratics"])
def test_the_first_four_are_one_and_the_coordinates_and_slopes_are_theirs(own):
    assert_allclose(own.values(X)[:, :4], np.column_stack([np.ones(50), X]), rtol=1e-15)
    normal = np.random.default_rng(2).normal(size=(50, 3))
    # Central differences of a cubic are off by the step squared.
    ahead, behind = (own.values(X + sign * 1e-5 * normal) for sign in (1, -1))
    assert_allclose(own.along(X, normal), (ahead - behind) / 2e-5, atol=1e-8)
