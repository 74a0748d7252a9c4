"""Only here: errors of numbers with another sign, scale or row, by hand."""

import math

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from demheat import referee


def test_value_error_is_signed_and_of_the_kind_of_its_values():
    assert_allclose(referee.value_error(3.3, 3.0), 0.1, rtol=1e-12)
    assert_allclose(referee.value_error(np.array([1.0, 4.0]), 2.0), [-0.5, 1.0], rtol=0)
    assert_allclose(referee.value_error(np.array([21.0, 26.0]), np.array([20.0, 25.0]), scale=10.0), 0.1, rtol=1e-12)
    found = referee.value_error(pd.Series([1.0, np.nan], index=["a", "b"]), pd.Series([2.0, 2.0], index=["a", "b"]))
    assert found["a"] == -0.5 and math.isnan(found["b"])


def test_vector_error():
    found = np.array([[3.0, 4.0, 0.0], [0.0, 0.0, 2.0]])
    assert_allclose(referee.vector_error(found, np.zeros(3), scale=10.0), [0.5, 0.2], rtol=1e-15)
    assert_allclose(referee.vector_error([1.0, 1.0, 1.0], [1.0, 1.0, 3.0]), 2.0, rtol=0)


def test_rms():
    assert_allclose(referee.rms([3.0, -4.0]), math.sqrt(12.5), rtol=1e-15)
    assert_allclose(referee.rms(np.array([[3.0], [-4.0]])), math.sqrt(12.5), rtol=1e-15)
    assert_allclose(referee.rms([3.0, -4.0], np.array([3.0, 1.0])), math.sqrt(43 / 4), rtol=1e-15)
    assert math.isnan(referee.rms([1.0, math.nan]))


def test_worst():
    assert referee.worst([1.0, -3.0, 2.0]) == (1, -3.0)
    assert referee.worst([1.0, math.nan, math.nan])[0] == 1


def test_curve_error_is_of_the_reference_and_signed():
    found = referee.curve_error([10.0, 17.0, 41.0], [10.0, 20.0, 40.0])
    assert found.at == 1
    assert_allclose(found[1:], [-0.15, 3 / 40, 1 / 40], rtol=1e-15)


def test_dispersion_by_hand():
    # (20 - 10)/20 and (40 - 30)/40: the mean of 50 and 25 %.
    assert_allclose(referee.dispersion([[10.0, 40.0], [20.0, 30.0], [15.0, 35.0]]), 0.375, rtol=1e-15)


@pytest.mark.parametrize(("weights", "expected"), [(None, math.sqrt(2 / 3) / 2), ([1.0, 0.0, 3.0], math.sqrt(3) / 5)])
def test_variation(weights, expected):
    values = np.array([1.0, 2.0, 3.0])
    weights = weights if weights is None else np.array(weights)
    assert_allclose(referee.variation(values, weights), expected, rtol=1e-14)
    assert referee.variation(np.full(3, 7.0), weights) == 0.0


def test_columns_find_their_rows_by_name():
    """Of unlike length too: what only one of them has is not-a-number."""
    found, exact = pd.Series([2.0, 3.0], ["a", "b"]), pd.Series([4.0, 1.0, 5.0], ["b", "a", "c"])
    assert referee.value_error(found, exact).fillna(9.0).to_dict() == {"a": 1.0, "b": -0.25, "c": 9.0}
