"""Means in slices, by hand."""

import numpy as np
from numpy.testing import assert_allclose

from studies.common.slices import slice_means


def test_means_over_slices():
    x = np.array([0.0, 0.01, 0.3, 0.99, 1.0])
    middle, mean = slice_means(x, np.array([1.0, 3.0, 5.0, 7.0, 9.0]), bins=4)
    assert_allclose(middle, [0.125, 0.375, 0.625, 0.875], rtol=1e-15)
    # The third slice is empty.
    assert_allclose(mean, [2.0, 5.0, np.nan, 8.0], rtol=1e-15)
