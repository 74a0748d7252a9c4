"""Only here: radii whose mean, spread or cut is not that of their distribution."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from demheat.packing.radii import Bidisperse, Gaussian, Listed, Lognormal, Uniform

MANY = 200_000


def normal(z):
    return np.exp(-z * z / 2)


def cut_moment(function, cut):
    """Mean of a function of a standard normal number cut at +-cut, by quadrature."""
    top = quad(lambda z: function(z) * normal(z), -cut, cut)[0]
    return top / quad(normal, -cut, cut)[0]


def moments(distribution):
    """Mean and standard deviation by quadrature, and the limits."""
    if isinstance(distribution, Uniform):
        h = distribution.half_width
        return 1.0, h / np.sqrt(3), 1 - h, 1 + h
    s, c = distribution.spread, distribution.cut
    shape = (lambda z: 1 + s * z) if isinstance(distribution, Gaussian) else (lambda z: np.exp(s * z))
    mean = cut_moment(shape, c)
    square = cut_moment(lambda z: shape(z) ** 2, c)
    return 1.0, np.sqrt(square / mean**2 - 1), shape(-c) / mean, shape(c) / mean


@pytest.mark.parametrize(
    "distribution", [Gaussian(), Gaussian(0.1, 4.0), Uniform(), Lognormal(0.5), Lognormal(1.0, 2.0)]
)
def test_moments_and_limits(distribution):
    radii = distribution.draw(MANY, np.random.default_rng(0))
    mean, deviation, low, high = moments(distribution)
    # Sampling: the mean scatters by deviation/sqrt(n), allow 4 of that; the deviation by about as much, or more.
    assert_allclose(radii.mean(), mean, atol=4 * deviation / np.sqrt(MANY))
    assert_allclose(radii.std(), deviation, atol=8 * deviation / np.sqrt(MANY))
    assert radii.min() >= low * (1 - 1e-12) and radii.max() <= high * (1 + 1e-12)  # rounding
    # 2e5 draws fill the range: the ends are met to 1 % of it.
    assert radii.min() < low + 0.01 * (high - low) and radii.max() > high - 0.01 * (high - low)


def test_bidisperse_counts_are_exact():
    radii = Bidisperse(ratio=3.0, fraction=0.1).draw(1000, np.random.default_rng(0))
    assert np.count_nonzero(radii > 1.5 * radii.min()) == 100
    assert_allclose(radii.max() / radii.min(), 3.0, rtol=1e-15)
    assert_allclose(radii.mean(), 1.0, rtol=1e-14)  # rounding
    assert not np.all(np.diff(radii) <= 0)  # shuffled


def test_listed_are_used_once_each():
    values = np.random.default_rng(1).uniform(1, 2, 200)
    radii = Listed(values).draw(200, np.random.default_rng(0))
    assert_allclose(np.sort(radii), np.sort(values) / values.mean(), rtol=1e-14)
    with pytest.raises(ValueError, match="200 radii for 100"):
        Listed(values).draw(100, np.random.default_rng(0))


def test_names_tell_lists_apart():
    assert repr(Listed([1.0, 2.0])) == repr(Listed((1.0, 2.0))) != repr(Listed([1.0, 2.1]))
    assert repr(Gaussian()) == "Gaussian(spread=0.3, cut=2.5)"
