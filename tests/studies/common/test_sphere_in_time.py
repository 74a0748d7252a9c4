"""The sphere of Haddad et al.: its scene, shells and slice."""

import numpy as np
from numpy.testing import assert_allclose

from references import series
from studies.common import sphere_in_time


def test_means_and_largest_in_shells():
    r = np.array([0.0, 0.1, 0.3, 0.9, 1.0])
    weights, values = np.array([1.0, 3.0, 1.0, 1.0, 1.0]), np.array([4.0, -8.0, 5.0, 1.0, -3.0])
    middle, mean, largest = sphere_in_time.in_shells(r, values, weights, shells=4)
    assert_allclose(middle, [0.125, 0.375, 0.625, 0.875])
    assert_allclose(mean, [-5.0, 5.0, np.nan, -1.0])
    assert_allclose(largest, [8.0, 5.0, np.nan, 3.0])


def test_points_of_the_slice():
    points, inside = sphere_in_time.slice_grid(5)
    # Of 5 x 5 squares the four in the corners have their middle (0.8, 0.8) R off the centre, outside.
    assert inside.sum() == len(points) == 21 and not inside[0, 0]
    assert_allclose(points[:, 2], 0.05)
    picture = np.zeros((5, 5))
    picture[inside] = points[:, 0]
    assert_allclose(picture[2], np.array([0.01, 0.03, 0.05, 0.07, 0.09]))  # columns along x


def test_the_sphere_is_the_papers():
    times = [1.0, 5.0, 10.0, 30.0]
    centre = [field.temperature_at(sphere_in_time.CENTER)[0] for field in series.evolve(sphere_in_time.sphere(), times)]
    # Eq. 19 of Haddad et al., corrected, summed to convergence elsewhere and rounded to 5 digits.
    assert_allclose(centre, [20.31666, 120.77809, 182.17817, 199.95631], atol=5e-6)


def test_order_of_exact_second_order():
    import pandas as pd

    number = np.array([1000, 1000, 8000, 8000])
    # Halving the spacing quarters the mean over packings: (5 + 3) / 2 to (1.5 + 0.5) / 2.
    rows = pd.DataFrame({"particles": number, "error": [5.0, 3.0, 1.5, 0.5]})
    assert_allclose(sphere_in_time.order_of(rows, "error"), 2.0, rtol=1e-12)
