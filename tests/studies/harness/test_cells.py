"""Numbers as cells of a table, and back."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from studies.harness.cells import cell, numbers, picture


def test_cells_keep_six_digits_of_each_number():
    values = np.array([-1.23456789, 1e-7, 200.0, np.nan])
    # Half a unit of the sixth digit.
    assert_allclose(numbers(cell(values)), values, rtol=5e-6)
    assert cell(values[:1], ".3g") == "-1.23" and cell([0.1, 2], ".5f") == "0.10000 2.00000"


def test_cells_keep_digits_behind_the_point():
    values = np.array([[-0.001, 1.2345], [np.nan, 1e4]])
    text = cell(values, decimals=2)
    assert text == "0 1.23 nan 10000"
    assert_array_equal(picture(text), [[0.0, 1.23], [np.nan, 1e4]])


def test_what_cannot_be_read():
    with pytest.raises(ValueError, match="3 numbers: must hold a square"):
        picture("1 2 3")
    # An empty cell of a data frame.
    assert np.isnan(numbers(float("nan"))).all()
