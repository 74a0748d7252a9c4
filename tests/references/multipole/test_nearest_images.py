"""Alphas of pairs of spheres: what is known of equal, tiny and touching ones, and that no near pair is passed over."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from references.multipole import truncation
from references.multipole.nearest_images import FAST, alphas, beside
from references.multipole.translations import unmirrored

SIZE = np.array([1.0, 1.2, 0.9])


def spheres(count, seed):
    """Some that may overlap: nothing here asks whether they do."""
    rng = np.random.default_rng(seed)
    return unmirrored(rng.random((count, 3)) * 3 - 1, rng.uniform(0.02, 0.1, count), np.ones(count), SIZE)


def test_alphas_that_are_known():
    # Equal ones; a large one beside next to a point.
    assert_allclose(alphas(np.array(0.3), np.array(0.3), np.array(0.7)), math.acosh(0.7 / 0.6), rtol=1e-14)
    assert_allclose(alphas(np.array(1e-9), np.array(0.5), np.array(0.8)), math.log(0.8 / 0.5), rtol=1e-12)
    assert list(alphas(np.array([0.1, 0.2]), np.array([0.2, 0.1]), np.array([0.3, 0.29]))) == [0.0, 0.0]


def test_limits_of_images_are_images_of_each_other():
    """Both end points lie on the line of centres, each the mirror image of the other in both spheres."""
    large, small, apart = 0.4, 0.15, 0.7
    c = large * math.sinh(float(alphas(np.array(large), np.array(small), np.array(apart))))
    middle = math.sqrt(c**2 + large**2)
    for radius, center in ((large, 0.0), (small, apart)):
        assert_allclose(abs(middle - c - center) * abs(middle + c - center), radius**2, rtol=1e-12)


@pytest.mark.parametrize("count", [1, 2, 40])
def test_no_near_pair_is_passed_over(count):
    for seed in range(4):
        some = spheres(count, seed)
        shifts = SIZE * (np.indices((3, 3, 3)).reshape(3, -1).T - 1)
        one, two = (each.ravel() for each in np.indices((count, count)))
        ways = some.centers[one] - some.centers[two]
        ways -= SIZE * np.round(ways / SIZE)
        apart = np.linalg.norm(ways[:, None] + shifts, axis=2)
        apart[(one == two), 13] = np.inf
        found = alphas(some.radii[one], some.radii[two], apart.min(axis=1))
        share = np.minimum(some.radii[one], some.radii[two]) / np.maximum(some.radii[one], some.radii[two])
        near = beside(some)
        assert near.slowest() == pytest.approx(min(found.min(), FAST), rel=1e-12)
        least = min(found[share < 0.5].min(initial=FAST), FAST)
        assert near.slowest(below=0.5) == pytest.approx(least, rel=1e-12)


def test_nothing_is_near_nothing():
    assert beside(spheres(0, 0)).slowest() == FAST


@pytest.mark.parametrize("ratio", [0.2, 0.9])
def test_the_sum_of_what_rises_first(ratio):
    steps = np.arange(1, 1000)
    expected = np.sum((1 + 2 * steps / 10) ** 2 * ratio**steps)
    assert truncation._rising(ratio, 10) == pytest.approx(expected, rel=1e-12)
