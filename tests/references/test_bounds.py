"""Bounds and estimates by hand, in limits of 0 and infinity, to their order, and in their order."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from references import bounds
from references.bounds import formulas
from references.exact import lattice

INF = math.inf
FRACTIONS = np.array([0.1, 0.2, 0.3, 0.4, 0.5])
PAIRS = [(1.0, 10.0), (10.0, 1.0), (1.0, 1e4), (33.0, 0.33), (2.0, 2.0)]


def test_silica_in_epoxy_as_printed():
    # To the four digits printed, half a unit of the last.
    found = bounds.torquato(0.195, 1.5, FRACTIONS, bounds.zeta2_hard_spheres(FRACTIONS))
    assert_allclose(found, [0.2392, 0.2922, 0.3558, 0.4327, 0.5261], atol=5e-5)


def test_zeta2_of_hard_spheres():
    # 0.21068 phi - 0.04693 phi^2 + 0.00247 phi^3 by hand at 1/2: 0.10534 - 0.0117325 + 0.00030875.
    assert_allclose(bounds.zeta2_hard_spheres(0.5), 0.09391625, rtol=1e-12)
    assert bounds.zeta2_hard_spheres(0.0) == 0.0
    assert isinstance(bounds.zeta2_hard_spheres(0.5), float)


def test_by_hand():
    # Matrix 1, spheres 4, half and half: beta = 3/6, Maxwell (1 + 1/2)/(1 - 1/4) = 2.
    assert_allclose(bounds.maxwell(1.0, 4.0, 0.5), 2.0, rtol=1e-15)
    assert_allclose(bounds.hashin_shtrikman(1.0, 4.0, 0.5), (2.0, 2.5 - 0.25 * 9 / 10.5), rtol=1e-15)
    assert_allclose(bounds.voigt([1.0, 4.0], [0.5, 0.5]), 2.5, rtol=1e-15)
    assert_allclose(bounds.reuss([1.0, 4.0], [0.5, 0.5]), 1.6, rtol=1e-15)
    # Bruggeman there: 2 k^2 - 2.5 k - 4 = 0.
    assert_allclose(bounds.bruggeman(1.0, 4.0, 0.5), (2.5 + math.sqrt(38.25)) / 4, rtol=1e-15)
    # Differential, backwards: k = 8 of spheres of 27 in 1 needs 1 - f = (27 - 8)/(27 - 1) (1/8)^(1/3) = 19/52.
    assert_allclose(bounds.bruggeman_differential(1.0, 27.0, 33 / 52), 8.0, rtol=1e-14)
    assert_allclose(bounds.agari_uno(1.0, 4.0, 0.5), 2.0, rtol=1e-15)
    assert_allclose(bounds.agari_uno(1.0, 4.0, 0.5, c1=0.25, c2=0.5), math.sqrt(0.5), rtol=1e-15)
    # Lewis and Nielsen: B = 3/5.5, psi = 1 + 0.5 * 0.363/0.405769 = 1.447299, (1 + 0.409091)/(1 - 0.394718).
    assert_allclose(bounds.lewis_nielsen(1.0, 4.0, 0.5), 2.327992, rtol=1e-6)


def test_many_phases_and_broadcasting():
    assert_allclose(bounds.voigt([1.0, 2.0, 4.0], [0.5, 0.25, 0.25]), 2.0, rtol=1e-15)
    assert_allclose(bounds.reuss([1.0, 2.0, 4.0], [0.5, 0.25, 0.25]), 1 / 0.6875, rtol=1e-15)
    fractions = np.stack([1 - FRACTIONS, FRACTIONS], axis=-1)
    assert bounds.voigt([1.0, 2.0], fractions).shape == (5,)
    lower, upper = bounds.hashin_shtrikman(1.0, np.array([2.0, 3.0])[:, None], FRACTIONS)
    assert lower.shape == upper.shape == (2, 5)
    assert_allclose(lower[1, 2], bounds.hashin_shtrikman(1.0, 3.0, 0.3)[0], rtol=1e-15)


def all_of(k1, k2, p, z=0.2):
    """All estimates and bounds in the order in which they must rise."""
    phases = ([k1, k2], [1 - p, p])
    hs, third = bounds.hashin_shtrikman(k1, k2, p), bounds.third_order(k1, k2, p, z)
    return [bounds.reuss(*phases), hs[0], third[0], third[1], hs[1], bounds.voigt(*phases)]


@pytest.mark.parametrize(("k1", "k2"), PAIRS)
@pytest.mark.parametrize("p", [0.0, 0.05, 0.5, 0.9, 1.0])
def test_bounds_are_nested(k1, k2, p):
    values = np.array(all_of(k1, k2, p))
    # Rounding only.
    assert np.all(np.diff(values) >= -1e-14 * values[-1])
    mixed = [bounds.bruggeman(k1, k2, p), bounds.bruggeman_differential(k1, k2, p)]
    for estimate in (bounds.maxwell(k1, k2, p), *mixed, bounds.torquato(k1, k2, p, 0.2)):
        assert values[1] * (1 - 1e-14) <= estimate <= values[4] * (1 + 1e-14)


@pytest.mark.parametrize(("k1", "k2"), PAIRS)
def test_relations(k1, k2):
    # Rounding only, in all of these.
    z, p = 0.2, 0.3
    lower, upper = bounds.hashin_shtrikman(k1, k2, p)
    assert_allclose(bounds.maxwell(k1, k2, p), lower if k1 <= k2 else upper, rtol=1e-14)
    assert_allclose(bounds.third_order(k1, k2, p, 0.0), [bounds.maxwell(k1, k2, p)] * 2, rtol=1e-14)
    assert_allclose(bounds.third_order(k1, k2, p, 1.0), [bounds.maxwell(k2, k1, 1 - p)] * 2, rtol=1e-14)
    assert_allclose(bounds.bruggeman(k1, k2, p), bounds.bruggeman(k2, k1, 1 - p), rtol=1e-14)
    assert_allclose(bounds.third_order(k1, k2, p, z), bounds.third_order(k2, k1, 1 - p, 1 - z), rtol=1e-14)
    k = bounds.bruggeman(k1, k2, p)
    assert_allclose((1 - p) * (k1 - k) / (k1 + 2 * k) + p * (k2 - k) / (k2 + 2 * k), 0, atol=1e-14)
    assert_allclose(bounds.torquato(k1, k2, p, 0.0), bounds.maxwell(k1, k2, p), rtol=1e-14)
    k = bounds.bruggeman_differential(k1, k2, p)
    assert_allclose((k2 - k) * np.cbrt(k1 / k), (1 - p) * (k2 - k1), rtol=1e-13, atol=1e-14)
    assert_allclose(bounds.lewis_nielsen(k1, k2, p, shape=2.0, packing=1.0), bounds.maxwell(k1, k2, p), rtol=1e-14)
    assert_allclose(bounds.agari_uno(k1, k2, p), bounds.agari_uno(k2, k1, 1 - p), rtol=1e-14)


@pytest.mark.parametrize("contrast", [0.0, 10.0, INF])
def test_rayleigh_is_the_cubic_array_to_his_order(contrast):
    assert_allclose(formulas.CUBIC_SUM_4, lattice.lattice_sums("sc", 4).total[4, 0], rtol=1e-8)  # digits given
    errors = [bounds.rayleigh(1.0, contrast, f) - lattice.conductivity("sc", contrast, f) for f in (0.1, 0.05)]
    # What is left out is f^(17/3) in k, 51 times less at half the fraction; with the orders beyond it found 36 (pores)
    # to 75. A wrong octupole term would leave f^(13/3), 20 times.
    assert abs(errors[0] / errors[1]) > 30
    # Found: 1.04 % with perfect conductors, three quarters of the way to touching, where Maxwell is 8 % low.
    assert_allclose(bounds.rayleigh(1.0, contrast, 0.4), lattice.conductivity("sc", contrast, 0.4), rtol=1.5e-2)


def test_limits_of_the_differential_medium():
    # Pores: Archie's law with 3/2; perfect conductors: -3.
    assert_allclose(bounds.bruggeman_differential(1.0, 0.0, FRACTIONS), (1 - FRACTIONS) ** 1.5, rtol=1e-14)
    assert_allclose(bounds.bruggeman_differential(1.0, INF, FRACTIONS), (1 - FRACTIONS) ** -3.0, rtol=1e-14)


def test_lewis_nielsen_ends_at_the_densest_packing():
    assert bounds.lewis_nielsen(1.0, INF, 0.637) > 1e10
    assert np.isfinite(bounds.lewis_nielsen(1.0, INF, 0.63))
    assert_allclose(bounds.lewis_nielsen(1.0, 4.0, 1.0, packing=1.0), 4.0, rtol=1e-15)


def test_third_order_is_third_order():
    # The bounds and the estimate with the right zeta_2 differ from an exact conductivity by (k2 - k1)^4 only.
    f, errors = 0.3, []
    z = lattice.zeta2("sc", f)
    for step in (0.1, 0.05):
        k = lattice.conductivity("sc", 1 + step, f)
        estimates = (*bounds.third_order(1.0, 1 + step, f, z), bounds.torquato(1.0, 1 + step, f, z))
        errors.append(np.array(estimates) - k)
    # Halving the step divides a fourth-order error by 16, less what the fifth order adds: 2 % of a tenth.
    assert np.all(errors[0] / errors[1] > 14)
    assert errors[0][0] < 0 < errors[0][1]


@pytest.mark.parametrize("contrast", [0.0, 0.1, 10.0, INF])
@pytest.mark.parametrize("kind", ["sc", "fcc"])
def test_third_order_holds_the_cubic_arrays(kind, contrast):
    k = lattice.conductivity(kind, contrast, 0.3)
    lower, upper = bounds.third_order(1.0, contrast, 0.3, lattice.zeta2(kind, 0.3))
    assert lower < k < upper or (contrast == 0 and lower == 0 < k < upper)
    # The estimate for dispersions leaves out fourth orders: found 0.5 % with perfect conductors, else below 0.2 %.
    assert_allclose(bounds.torquato(1.0, contrast, 0.3, lattice.zeta2(kind, 0.3)), k, rtol=1e-2)


@pytest.mark.parametrize(("k1", "k2"), [(1.0, INF), (INF, 1.0), (0.0, 1.0), (1.0, 0.0), (0.0, 0.0), (INF, INF)])
@pytest.mark.parametrize("p", [0.0, 0.2, 0.9, 1.0])
def test_limits_are_those_of_large_and_small_numbers(k1, k2, p):
    near = [1e12 if k == INF else 1e-12 if k == 0 else k for k in (k1, k2)]

    def every(a, b):
        some = [bounds.maxwell(a, b, p), bounds.bruggeman(a, b, p), bounds.torquato(a, b, p, 0.2)]
        more = [bounds.bruggeman_differential(a, b, p), bounds.lewis_nielsen(a, b, p, packing=1.0)]
        return [*all_of(a, b, p), *some, *more, bounds.rayleigh(a, b, min(p, 0.5))]

    for limit, value in zip(every(k1, k2), every(*near), strict=True):
        if limit == INF:
            assert value > 1e10
        else:
            # The limit is approached as the inverse of the large number, with factors up to 3000 here.
            assert_allclose(value, limit, rtol=5e-9, atol=1e-9)


def test_percolation_of_bruggeman():
    assert bounds.bruggeman(1.0, INF, 0.34) == INF
    assert_allclose(bounds.bruggeman(1.0, INF, 0.3), 10.0, rtol=1e-14)
    assert bounds.bruggeman(1.0, 0.0, 2 / 3 + 1e-9) == 0.0
    assert_allclose(bounds.bruggeman(1.0, 0.0, 0.6), 0.1, rtol=1e-14)


def test_nothing_beside_infinity_has_no_mean():
    with pytest.raises(ValueError, match="zero and infinity have no mean"):
        bounds.agari_uno(0.0, INF, 0.1)
