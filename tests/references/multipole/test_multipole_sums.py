"""Periodic sums of solid harmonics, translations and the solver behind the multipoles."""

import math
from itertools import product

import numpy as np
from numpy.testing import assert_allclose
from scipy.special import lpmv

from demheat import gallery
from references.exact import harmonics as multipoles
from references.multipole import kernels as multipole_kernels
from references.multipole import solver
from references.multipole import sums as multipole_sums
from references.multipole.system import Spheres, gmres, received, translation

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
    sums = multipole_sums.periodic_irregular(offsets, degree, size, 0.5)
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
    found = [multipole_sums.periodic_irregular(offsets, 20, size, unit, eta=eta) for eta in (3.0, 6.0, 12.0)]
    n, _ = multipole_sums.entries(20)
    # Rounding of sums of some 100 terms, in units of the contact.
    assert_allclose(found[1] * unit ** (n + 1.0), found[0] * unit ** (n + 1.0), rtol=0, atol=3e-13)
    assert_allclose(found[2] * unit ** (n + 1.0), found[0] * unit ** (n + 1.0), rtol=0, atol=3e-13)


def test_periodic_sums_of_the_simple_cubic_lattice():
    sums = multipole_sums.periodic_irregular(np.zeros((1, 3)), 30, np.ones(3), 1.0)[0]
    expected = multipoles.lattice_sums("sc", 30).total
    for n in range(4, 31, 2):
        here = sums[n * (n + 1) // 2 : n * (n + 1) // 2 + n + 1]
        assert_allclose(here[::4], expected[n, : n // 4 + 1], rtol=0, atol=1e-13)  # rounding of sums of some 100 terms
    # Degree 2 is zero here; lattice.py writes the share of the background in its place.
    assert_allclose(sums[3:6], 0, rtol=0, atol=1e-14)


def test_translation_kernel_against_its_slow_twin():
    order, rng = 3, np.random.default_rng(6)
    spheres = Spheres(rng.random((3, 3)) * 3, np.full(3, 0.1), np.ones(3), np.full(3, 3.0))
    table = translation(spheres, 2 * order)
    source = rng.normal(size=(2, 3, 10))
    source[1][:, [0, 1, 3, 6]] = source[:, :, 0] = 0
    found = np.zeros_like(source)
    multipole_kernels.translate(order, table.sums, table.top, *source, *found, 0, 3)
    b = source[0] + 1j * source[1]
    for i, (p, q) in product(range(3), ((0, 0), (1, 1), (2, 0), (3, 2))):
        total = 0
        for j in range(3):
            pair = 0 if i == j else {(0, 1): 1, (0, 2): 2, (1, 2): 3}[min(i, j), max(i, j)]
            for n in range(1, order + 1):
                for m in range(-n, n + 1):
                    # f_l^-m = (-1)^m conj(f_l^m); I_L(-X) = (-1)^L I_L(X).
                    here, big, order_sum = b[j, n * (n + 1) // 2 + abs(m)], n + p, m + q
                    here = here if m >= 0 else (-1) ** m * np.conj(here)
                    wave = table.sums[pair, big * (big + 1) // 2 + abs(order_sum)] * (-1) ** (big if i > j else 0)
                    wave = wave if order_sum >= 0 else (-1) ** order_sum * np.conj(wave)
                    total += (-1) ** p * wave * here
        entry = p * (p + 1) // 2 + q
        assert_allclose(found[0, i, entry] + 1j * found[1, i, entry], np.conj(total), rtol=1e-12)  # rounding


def test_entries_left_out_and_threads_do_not_matter():
    spheres, _ = solver._spheres(gallery.random_dispersion(20, fraction=0.005, seed=1))
    table = translation(spheres, 16)
    assert table.top.min() < 15
    source = np.random.default_rng(0).normal(size=(2, 20, 45))
    found = received(spheres, table, 8, source)
    # Entries bounded by 1e-14 and far below it: rounding.
    assert_allclose(
        found, received(spheres, table._replace(top=np.full_like(table.top, 16)), 8, source), rtol=0, atol=1e-14
    )
    assert np.array_equal(found, received(spheres, table, 8, source, threads=2))


def test_gmres_solves_and_stops():
    rng = np.random.default_rng(0)
    matrix, load = np.eye(30) + 0.3 * rng.normal(size=(30, 30)) / math.sqrt(30), rng.normal(size=30)
    found, iterations = gmres(lambda v: matrix @ v, load, np.zeros(30), 1e-10)
    assert_allclose(matrix @ found, load, rtol=0, atol=1e-10 * np.linalg.norm(load))
    assert 5 < iterations <= 30
    assert gmres(lambda v: matrix @ v, load, found, 1e-9)[1] == 0
