"""Periodic sums of solid harmonics: against plain summation, other splittings and the sums of Rayleigh's lattice."""

import math

import numpy as np
from numpy.testing import assert_allclose
from scipy.special import lpmv

from references.exact import harmonics
from references.multipole.sums import entries, highest_degree, periodic_irregular

# A cell without any symmetry.
SIZE = (1.0, 1.2, 0.9)


def irregular(points, degree, m):
    """I_L^M in Racah's normalisation, by SciPy's Legendre functions."""
    r = np.linalg.norm(points, axis=-1)
    factor = math.sqrt(math.factorial(degree - m) / math.factorial(degree + m))
    wave = np.exp(1j * m * np.arctan2(points[..., 1], points[..., 0]))
    return factor * lpmv(m, degree, points[..., 2] / r) * wave / r ** (degree + 1)


def test_periodic_sums_against_plain_summation():
    size, degree = np.array(SIZE), 12
    offsets = np.array([[0.3, 0.5, -0.2], [0.0, 0.0, 0.0]])
    sums = periodic_irregular(offsets, degree, size, 0.5)
    cells = np.stack(np.meshgrid(*[np.arange(-9, 10)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) * size
    for row, offset in zip(sums, offsets, strict=True):
        images = (cells + offset)[np.linalg.norm(cells + offset, axis=1) > 0]
        for n, m in ((6, 1), (7, 2), (9, 9), (12, 0)):
            # Left out beyond nine cells: 4 pi/(n - 2)/volume times 8^(2-n), 1e-4 at n = 6; on it harmonics average out.
            assert_allclose(
                row[n * (n + 1) // 2 + m], irregular(images, n, m).sum(), rtol=0, atol=2e-2 * 8.0 ** (3 - n)
            )


def test_periodic_sums_do_not_depend_on_the_splitting():
    size = np.array(SIZE)
    offsets = np.random.default_rng(0).random((20, 3)) * size
    near = np.linalg.norm(offsets - size * np.round(offsets / size), axis=1)
    unit = 0.9 * near.min()
    found = [periodic_irregular(offsets, 20, size, unit, eta=eta) for eta in (3.0, 6.0, 12.0)]
    n, _ = entries(20)
    # Rounding of sums of some 100 terms, in units of the contact.
    assert_allclose(found[1] * unit ** (n + 1.0), found[0] * unit ** (n + 1.0), rtol=0, atol=3e-13)
    assert_allclose(found[2] * unit ** (n + 1.0), found[0] * unit ** (n + 1.0), rtol=0, atol=3e-13)


def test_periodic_sums_of_the_simple_cubic_lattice():
    sums = periodic_irregular(np.zeros((1, 3)), 30, np.ones(3), 1.0)[0]
    expected = harmonics.lattice_sums("sc", 30).total
    for n in range(4, 31, 2):
        here = sums[n * (n + 1) // 2 : n * (n + 1) // 2 + n + 1]
        assert_allclose(here[::4], expected[n, : n // 4 + 1], rtol=0, atol=1e-13)  # rounding of sums of some 100 terms
    # Degree 2 is zero here; `lattice_sums` writes the share of the background in its place.
    assert_allclose(sums[3:6], 0, rtol=0, atol=1e-14)


def test_a_table_knows_its_degree():
    assert [highest_degree(entries(degree).shape[1]) for degree in range(90)] == list(range(90))
