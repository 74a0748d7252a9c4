"""Solid harmonics and their sums over cubic lattices: against SciPy, plain summation and printed numbers."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import lpmv

from references.exact import harmonics

KINDS = ("sc", "bcc", "fcc")


@pytest.mark.parametrize(("degree", "m"), [(0, 0), (1, 0), (3, 1), (7, 4), (12, 12), (25, 8)])
def test_legendre_against_scipy(degree, m):
    z = np.linspace(-1, 1, 9)
    values = list(harmonics.legendre(z, np.ones_like(z), degree, m))[-1] * (1 - z**2) ** (m / 2)
    expected = math.sqrt(math.factorial(degree - m) / math.factorial(degree + m)) * lpmv(m, degree, z)
    # Rounding of some 25 recurrence steps on numbers up to 1.
    assert_allclose(values, expected, atol=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_lattice_sums_do_not_depend_on_the_splitting(kind):
    sums = harmonics.lattice_sums(kind, 20).total
    unit = harmonics.NEAREST[kind]
    cell = 1 / len(harmonics.SITES[kind]) / unit**3
    sites, waves = harmonics._sites(kind, 8.0 * unit) / unit, harmonics._waves(kind, 12) * (2 * np.pi * unit)
    for eta in (0.7, 1.5):
        other = harmonics._ewald(sites, waves, cell, 20, eta * np.pi / cell ** (2 / 3))
        # Rounding: sums of terms up to about 10.
        assert_allclose(other[4::2], sums[4::2], atol=3e-14)


@pytest.mark.parametrize("kind", KINDS)
def test_lattice_sums_against_plain_summation(kind):
    unit = harmonics.NEAREST[kind]
    sums = harmonics.lattice_sums(kind, 40)
    x, y, z = (harmonics._sites(kind, 9.0) / unit).T
    r = np.sqrt(x**2 + y**2 + z**2)
    for degree, m in ((12, 0), (12, 8), (16, 4), (30, 12), (40, 40)):
        values = list(harmonics.legendre(z / r, np.ones_like(z), degree, m))[-1]
        plain = np.sum(values * (((x + 1j * y) / r) ** m).real / r ** (degree + 1))
        # The sites left out, beyond nine edges, add less than about 4 pi 9^-10.
        assert_allclose(sums.total[degree, m // 4], plain, atol=4e-9)


def test_lattice_sums_of_rayleigh():
    # 3.108, 0.5733 and 3.259: McPhedran and McKenzie (1978), Table 1, to the digits quoted since Rayleigh (1892).
    assert_allclose(harmonics.lattice_sums("sc", 8).total[[4, 6, 8], 0], [3.108, 0.5733, 3.259], atol=5e-4)


def test_an_entry_does_not_depend_on_where_its_table_ends():
    few, many = harmonics.lattice_sums("bcc", 8), harmonics.lattice_sums("bcc", 70)
    for name in ("total", "far"):
        assert getattr(few, name).shape == (9, 3)
        assert np.array_equal(getattr(few, name), getattr(many, name)[:9, :3])
