"""Kernels of the multipole method beside slow twins: explicit polynomials, plain loops and SciPy's special functions.

Tolerances are rounding: of recurrences over some ten degrees here, of sums of some hundred terms there.
"""

import math
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import gamma, gammaincc

from references.multipole import field_kernels as kernels
from references.multipole.sums import Splitting
from references.multipole.translation_kernels import translate
from references.multipole.translations import translation, unmirrored

pytestmark = pytest.mark.twin
SIZE = np.array([1.0, 1.2, 0.9])
ORDER = 4


def pairs(order):
    """Degrees and orders of a table's entries."""
    return [(n, m) for n in range(order + 1) for m in range(n + 1)]


def regular(point, n, m):
    """R_l^m and its gradient: terms (-(x + iy)/2)^p ((x - iy)/2)^q z^s / (p! q! s!) with p + q + s = l, p - q = m."""
    (x, y, z), value, gradient = point, 0, np.zeros(3, dtype=complex)
    plus, minus = -(x + 1j * y) / 2, (x - 1j * y) / 2
    for q in range((n - m) // 2 + 1):
        p, s = q + m, n - m - 2 * q
        below = math.factorial(p) * math.factorial(q) * math.factorial(s)
        value += plus**p * minus**q * z**s / below
        by_plus = p * plus ** (p - 1) * minus**q * z**s / below if p else 0
        by_minus = q * plus**p * minus ** (q - 1) * z**s / below if q else 0
        by_z = s * plus**p * minus**q * z ** (s - 1) / below if s else 0
        gradient += [(by_minus - by_plus) / 2, -1j * (by_plus + by_minus) / 2, by_z]
    return value, gradient


def irregular(point, n, m):
    """I_l^m and its gradient, from those of R_l^m over r^(2l+1)."""
    value, gradient = regular(point, n, m)
    r, factor = np.linalg.norm(point), math.factorial(n - m) * math.factorial(n + m)
    value, gradient = factor * value / r ** (2 * n + 1), factor * gradient / r ** (2 * n + 1)
    return value, gradient - (2 * n + 1) * value * np.asarray(point) / r**2


def of_both_signs(table, n, m):
    """Entry of a table of m >= 0 for either sign of m: f_l^-m = (-1)^m conj(f_l^m)."""
    entry = table[n * (n + 1) // 2 + abs(m)]
    return entry if m >= 0 else (-1) ** m * np.conj(entry)


def three_spheres():
    """Spheres in a cell, two of them across its faces."""
    centers = np.array([[0.05, 0.4, 0.3], [0.55, 1.15, 0.2], [0.5, 0.45, 0.75]])
    return unmirrored(centers, np.array([0.25, 0.2, 0.15]), np.ones(3), SIZE)


def coefficients(seed):
    """Tables of a real series, three spheres."""
    table = np.random.default_rng(seed).normal(size=(3, 2, len(pairs(ORDER))))
    table[:, 1, [m == 0 for _, m in pairs(ORDER)]] = 0.0
    return table[:, 0] + 1j * table[:, 1]


def nearest(points, center):
    """Offsets from the nearest periodic image of a centre."""
    images = center + np.array(list(product((-2, -1, 0, 1, 2), repeat=3))) * SIZE
    apart = points[:, None] - images
    return apart[np.arange(len(points)), np.argmin(np.linalg.norm(apart, axis=2), axis=1)]


@pytest.mark.parametrize("point", [(0.3, -0.4, 0.7), (0.0, 0.0, 1.3), (-2.0, 0.1, 0.0)])
def test_regular_and_irregular(point):
    found = np.zeros((2, len(pairs(9))), dtype=complex)
    kernels.regular(found[0], *point, 9)
    kernels.irregular(found[1], *point, 9)
    for table, slow in zip(found, (regular, irregular), strict=True):
        expected = [slow(point, n, m)[0] for n, m in pairs(9)]
        assert_allclose(table, expected, rtol=1e-12)


def test_translate():
    order, rng = 3, np.random.default_rng(6)
    spheres = unmirrored(rng.random((3, 3)) * 3, np.full(3, 0.1), np.ones(3), np.full(3, 3.0))
    table = translation(spheres, 2 * order)
    # Two spheres receive, each in a call of its own.
    sent, made = rng.normal(size=(2, 3, 10)), np.full((2, 2, 10), np.nan)
    sent[1][:, [0, 1, 3, 6]] = sent[:, :, 0] = 0
    for i in range(2):
        translate(order, table, sent, made, i, i + 1)
    for i, (p, q) in product(range(2), pairs(order)):
        total = 0
        for j, n in product(range(3), range(1, order + 1)):
            pair = 0 if i == j else {(0, 1): 1, (0, 2): 2, (1, 2): 3}[min(i, j), max(i, j)]
            # I_L(-X) = (-1)^L I_L(X).
            flip = (-1) ** (n + p) if i > j else 1
            for m in range(-n, n + 1):
                multipole = of_both_signs(sent[0, j] + 1j * sent[1, j], n, m)
                total += (-1) ** p * flip * multipole * of_both_signs(table.sums[pair], n + p, m + q)
        entry = p * (p + 1) // 2 + q
        assert_allclose(made[0, i, entry] + 1j * made[1, i, entry], np.conj(total), rtol=1e-12, atol=1e-13)


def test_owners():
    spheres = three_spheres()
    points = 3 * np.random.default_rng(7).random((400, 3)) - 1
    offsets, owner = points.copy(), np.empty(400, dtype=np.int64)
    kernels.owners(offsets, spheres, owner)
    expected = np.full(400, -1)
    for k, (center, radius) in enumerate(zip(spheres.centers, spheres.radii, strict=True)):
        apart = nearest(points, center)
        here = np.linalg.norm(apart, axis=1) <= radius
        expected[here] = k
        assert_allclose(offsets[here], apart[here], rtol=0, atol=1e-15 * 3)
    assert np.array_equal(owner, expected)
    assert np.array_equal(offsets[expected < 0], points[expected < 0])
    assert np.bincount(expected + 1).min() > 3


def test_inside():
    table, rng = coefficients(8), np.random.default_rng(9)
    offsets, owner, found = rng.normal(size=(5, 3)), rng.integers(0, 3, 5), np.full((5, 4), np.nan)
    kernels.inside(offsets, owner, table, ORDER, found)
    for offset, k, row in zip(offsets, owner, found, strict=True):
        value, gradient = 0, np.zeros(3)
        for n, m in product(range(ORDER + 1), range(-ORDER, ORDER + 1)):
            if abs(m) <= n:
                own, slope = regular(offset, n, abs(m))
                sign = (-1) ** m if m < 0 else 1
                factor = of_both_signs(table[k], n, m)
                value += factor * sign * (np.conj(own) if m < 0 else own)
                gradient = gradient + factor * sign * (np.conj(slope) if m < 0 else slope)
        assert_allclose(row, [value.real, *gradient.real], rtol=0, atol=1e-13 * np.abs(row).max())


@pytest.mark.parametrize("square", [0.04, 0.9, 7.0])
def test_screens(square):
    eta, found = 2.3, np.full((2, 8), np.nan)
    kernels.screens(square, eta, found)
    a, x = np.arange(8) + 0.5, eta * square
    assert_allclose(found[0], gammaincc(a, x), rtol=1e-13)
    assert_allclose(found[1], -2 * eta * x ** (a - 1) * math.exp(-x) / gamma(a), rtol=1e-13)


def test_near():
    spheres, table = three_spheres(), coefficients(10)
    split = Splitting(3.0, 1.4, np.zeros((0, 3), dtype=np.int64))
    points = np.array([[0.9, 0.05, 0.6], [0.4, 0.8, 0.45]])
    found = np.ones((2, 4))
    kernels.near(points, spheres, table, ORDER, split, found)
    expected = np.ones((2, 4))
    for row, point in zip(expected, points, strict=True):
        for center, multipoles in zip(spheres.centers, table, strict=True):
            apart = point - center + np.array(list(product(range(-3, 4), repeat=3))) * SIZE
            for offset in apart[np.linalg.norm(apart, axis=1) <= split.reach]:
                x = split.eta * offset @ offset
                for n, m in pairs(ORDER)[1:]:
                    value, slope = irregular(offset, n, m)
                    terms = (2 if m else 1) * (multipoles[n * (n + 1) // 2 + m] * np.array([value, *slope])).real
                    row += gammaincc(n + 0.5, x) * terms
                    fall = -2 * split.eta * x ** (n - 0.5) * math.exp(-x) / gamma(n + 0.5)
                    row[1:] += fall * terms[0] * offset
    assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


def test_far():
    rng = np.random.default_rng(11)
    waves, points = rng.integers(-3, 4, size=(12, 3)), rng.random((6, 3))
    amplitudes, found = rng.normal(size=12) + 1j * rng.normal(size=12), np.ones((6, 4))
    kernels.far(points, SIZE, Splitting(1.0, 1.0, waves), amplitudes, found)
    vectors = 2 * math.pi * waves / SIZE
    terms = 2 * amplitudes * np.exp(1j * points @ vectors.T)
    expected = np.column_stack([1 + terms.real.sum(axis=1), 1 + (1j * terms @ vectors).real])
    assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(expected).max())
