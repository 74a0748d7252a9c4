"""Only here: factors of the temperature whose integral, mean or inverse is another's."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from demheat import Dependence, Material, Scene, Sphere
from demheat.scene.dependence import Dependences

TABLE = Dependence([(-10.0, 0.5), (0.0, 2.0), (40.0, 0.25), (100.0, 1.0)])
AT = np.array([-200.0, -10.0, -3.0, 0.0, 12.0, 40.0, 77.0, 100.0, 450.0])


def by_quadrature(one, other):
    knots = [t for t, _ in TABLE.points if min(one, other) < t < max(one, other)]
    return quad(TABLE.factor, one, other, points=knots or None, epsabs=1e-12, epsrel=1e-12)[0]


def test_factors_are_linear_between_and_constant_beyond():
    assert_allclose(TABLE.factor(AT), [0.5, 0.5, 1.55, 2.0, 1.475, 0.25, 0.7125, 1.0, 1.0], rtol=1e-14)


def test_the_integral_is_that_of_the_factor_and_is_taken_back():
    assert_allclose(TABLE.integral(AT), [by_quadrature(-10.0, t) for t in AT], atol=1e-9)  # of the quadrature
    assert_allclose(TABLE.inverse(TABLE.integral(AT)), AT, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("one", AT)
def test_means_are_those_of_the_integral(one):
    for other in AT[AT != one]:
        found = TABLE.mean(np.array([one]), np.array([other]))
        assert_allclose(found, by_quadrature(one, other) / (other - one), rtol=1e-11)  # of the quadrature
        assert found == TABLE.mean(np.array([other]), np.array([one]))
    assert_allclose(TABLE.mean(one, one), TABLE.factor(one), rtol=1e-15)


@pytest.mark.parametrize("gap", [1e-3, 1e-9, 1e-13])
def test_means_of_near_temperatures_lose_no_digits(gap):
    # Across a knot: a quarter of the gap below it.
    assert_allclose(TABLE.mean(40.0 - gap / 4, 40.0 + 3 * gap / 4), 0.25, rtol=gap)
    assert_allclose(TABLE.mean(20.0, 20.0 + gap), TABLE.factor(20.0), rtol=gap)


def test_phases_have_their_own():
    depends = Dependences([None, TABLE, Dependence([(0, 1), (1, 3)]), TABLE])
    phase, temperature = np.array([0, 1, 2, 3]), np.full(4, 0.5)
    assert_allclose(depends.factor(phase, temperature), [1.0, TABLE.factor(0.5), 2.0, TABLE.factor(0.5)])
    assert_allclose(depends.inverse(phase, depends.integral(phase, temperature)), temperature)
    assert_allclose(depends.mean(phase, temperature, temperature + 0.25)[[0, 2]], [1.0, 2.25])
    # Of each element of finite elements at many points.
    grid = depends.factor(phase[:, None], np.tile([0.0, 0.5], (4, 1)))
    assert_allclose(grid[2], [1.0, 2.0])


def test_linear_ones_are_cut_where_they_end():
    own = Dependence.linear(-1e-3, 20.0, (0.0, 520.0))
    assert_allclose(own.factor([20.0, 0.0, 520.0, 900.0]), [1.0, 1.02, 0.5, 0.5])


def test_a_periodic_cell_has_no_level():
    own = Material(1.0, dependence=[(0, 1), (1, 2)])
    with pytest.raises(ValueError, match="Material.dependence in phase 1 with Scene.gradient"):
        Scene((1, 1, 1), Material(1.0), [Sphere((0.5,) * 3, 0.2, own)], gradient=(1, 0, 0))
    scene = Scene((1, 1, 1), Material(1.0), [Sphere((0.5,) * 3, 0.2, own)], walls={"x-": 0.0})
    assert scene.varies and not Scene((1, 1, 1), Material(1.0), walls={"x-": 0.0}).varies
