"""Values of arrays of fibres by duality, series, asymptotics and sums: other methods are held against these."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from references.exact import fibres

KINDS = ("square", "hexagonal")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("fraction", [0.05, 0.77])
@pytest.mark.parametrize("contrast", [2.0, math.inf])
def test_duality(kind, fraction, contrast):
    """Keller, J. Math. Phys. 5 (1964) 548: k(s) k(1/s) = 1 of what is isotropic in the plane."""
    other = 0.0 if math.isinf(contrast) else 1 / contrast
    pair = [fibres.solve(kind, s, fraction) for s in (contrast, other)]
    # 13 digits each.
    assert_allclose(pair[0].conductivity * pair[1].conductivity, 1.0, rtol=5e-13)


def test_the_first_terms_of_the_series():
    """Rayleigh's own formulas; the next terms are of f^8 (square) and f^12."""
    f = 0.1
    square = 1 + 2 * f / (1 - f - 3 * 3.1512120021538976**2 * (f / math.pi) ** 4)
    assert_allclose(fibres.conductivity("square", math.inf, f), square, atol=20 * f**9)
    area = math.sqrt(3) / 2
    hexagonal = 1 + 2 * f / (1 - f - 5 * 5.8630316934**2 * (f * area / math.pi) ** 6)
    assert_allclose(fibres.conductivity("hexagonal", math.inf, f), hexagonal, atol=20 * f**13 + 1e-12)


def test_printed_values():
    """The square array of perfect conductors as the task's table and the usual ones print it."""
    for fraction, printed, half in ((0.1, 1.2222, 5e-5), (0.7, 7.433, 5e-4), (0.76, 15.44, 5e-3), (0.78, 35.93, 5e-3)):
        assert abs(fibres.conductivity("square", math.inf, fraction) - printed) <= half


@pytest.mark.parametrize(("kind", "neighbours"), [("square", 1.0), ("hexagonal", math.sqrt(3))])
def test_perfect_conductors_that_nearly_touch(kind, neighbours):
    """Keller, J. Appl. Phys. 34 (1963) 991: a gap g between radii a conducts pi sqrt(a/g), and then a constant."""
    found = []
    for gap in (4e-3, 1e-3, 2.5e-4):
        a = (1 - gap) / 2
        f = math.pi * a**2 / fibres.AREA[kind]
        found.append(fibres.conductivity(kind, math.inf, f) - neighbours * math.pi * math.sqrt(a / gap))
    # What is left tends to a constant, while the term itself doubles twice from 35.
    assert abs(found[2] - found[1]) < abs(found[1] - found[0]) < 0.1


@pytest.mark.parametrize("kind", KINDS)
def test_lattice_sums_by_summing(kind):
    steps, sums = np.arange(-300, 301), fibres.lattice_sums(kind, 60)
    w = (steps[:, None] + np.exp(2j * math.pi / fibres.FOLD[kind]) * steps).ravel()
    w = w[(np.abs(w) < 250) & (np.abs(w) > 0.5)]
    for n in range(3, 61):
        # Beyond 250 the rings cancel but for their rim, some 250^(1-n); n roundings of each site.
        assert abs((w**-n).sum() - sums[n]) < 250.0 ** (1 - n) + 1e-14 * n


@pytest.mark.parametrize("kind", KINDS)
def test_a_resistance_is_neutral_at_one_value_only_for_the_dipole(kind):
    """At r = (s - 1)/s degree 1 is not seen; no other degree is excited then. Without bound fibres are pores."""
    assert_allclose(fibres.conductivity(kind, 5.0, 0.6, resistance=0.8), 1.0, rtol=1e-13)
    assert_allclose(fibres.conductivity(kind, math.inf, 0.6, resistance=1.0), 1.0, rtol=1e-13)
    pores = fibres.conductivity(kind, 0.0, 0.6)
    assert fibres.conductivity(kind, 5.0, 0.6, resistance=math.inf) == pores
    # The distance to the limit is of the order of 1/r.
    assert_allclose(fibres.conductivity(kind, 5.0, 0.6, resistance=1e9), pores, rtol=1e-8)


def test_digits_are_honest_when_fibres_nearly_touch():
    rough = fibres.solve("square", math.inf, 0.784, order=64, digits=0)
    better = fibres.solve("square", math.inf, 0.784)
    assert abs(rough.conductivity / better.conductivity - 1) <= 10.0**-rough.digits
    assert rough.digits < 6 < 12 < better.digits


def test_along_fibres_is_the_mean():
    assert fibres.along(11.0, 0.25) == 3.5
    assert_allclose(fibres.touching("square"), math.pi / 4)
    assert_allclose(fibres.touching("hexagonal"), math.pi / (2 * math.sqrt(3)))
