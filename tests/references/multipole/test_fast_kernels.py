"""Kernels of the fast multipole method beside slow twins: explicit polynomials, plain loops, sums of single terms.

Tolerances are rounding, of sums of some hundred terms of size 1 unless a comment says more.
"""

import math
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from test_multipole_kernels import coefficients, irregular, of_both_signs, pairs, regular

from references.multipole import cell_kernels, field_kernels, lane_kernels, wave_kernels
from references.multipole.axes import axes
from references.multipole.cells import sorted_into
from references.multipole.lane_kernels import LANES
from references.multipole.translations import scales, unmirrored

pytestmark = pytest.mark.twin
ORDER = 4
WIDTH = len(pairs(ORDER))
SHAPE, SIZE = np.array([2, 3, 2]), np.array([2.0, 2.4, 1.8])


def tables(seed, order=ORDER, count=LANES):
    """Real and imaginary parts of tables of real series, (2, entries, count)."""
    table = np.random.default_rng(seed).normal(size=(2, len(pairs(order)), count))
    table[1, [m == 0 for _, m in pairs(order)]] = 0.0
    return table


def value(table, point, order):
    """Of a series of regular harmonics in Racah's normalisation at a point."""
    total = 0.0
    for entry, (n, m) in enumerate(pairs(order)):
        root = math.sqrt(math.factorial(n - m) * math.factorial(n + m))
        harmonic = root * regular(point, n, m)[0]
        total += (1 if m == 0 else 2) * ((table[0, entry] + 1j * table[1, entry]) * harmonic).real
    return total


def directions(seed, order=ORDER):
    """Unit vectors and their table of turns; the first two along z."""
    vectors = np.random.default_rng(seed).normal(size=(LANES, 3))
    vectors[:2, :2] = 0.0
    vectors /= np.linalg.norm(vectors, axis=1)[:, None]
    turns = np.zeros((4, order + 1, LANES))
    for lane, vector in enumerate(vectors):
        assert lane_kernels.point(lane, *(3.0 * vector), turns) == pytest.approx(3.0, rel=1e-14)
    lane_kernels.multiples(order, turns)
    return vectors, turns


@pytest.mark.parametrize("count", range(10))
def test_add_rows(count):
    rng = np.random.default_rng(0)
    source, table, out = rng.normal(size=(2, 25, LANES)), rng.normal(size=20), np.ones((2, 3, LANES))
    lane_kernels.add_rows(out, 1, 2, source, 0, 3, 2, table, 5, count)
    assert_allclose(out[1, 2], table[5 : 5 + count] @ source[0, 3 : 3 + 2 * count : 2], rtol=0, atol=1e-13)
    assert np.all(out[0] == 1) and np.all(out[1, :2] == 1)


def test_column():
    order = 5
    rows = [lane_kernels.column(m, order) + n for m in range(order + 1) for n in range(m, order + 1)]
    assert rows == list(range(len(pairs(order))))


def test_swap_axes_exchanges_y_and_z():
    table, out, point = tables(1), np.zeros((2, WIDTH, LANES)), np.array([0.4, -0.7, 0.5])
    for n in range(ORDER + 1):
        rows = slice(n * (n + 1) // 2, (n + 1) * (n + 2) // 2)
        part = np.zeros((2, n + 1, LANES))
        lane_kernels.swap_axes(n, axes(ORDER).swap, np.ascontiguousarray(table[:, rows]), part)
        out[:, rows] = part
    assert_allclose(value(out, point, ORDER), value(table, point[[0, 2, 1]], ORDER), rtol=0, atol=1e-13)


def test_turn_rows():
    rng = np.random.default_rng(2)
    source, out, angle = rng.normal(size=(2, 7, LANES)), np.zeros((2, 5, LANES)), rng.random(LANES)
    m = np.arange(4)[:, None]
    lane_kernels.turn_rows(source, 2, np.cos(m * angle), np.sin(m * angle), -1.0, out, 1, 4)
    expected = (source[0, 2:6] + 1j * source[1, 2:6]) * np.exp(-1j * m * angle)
    assert_allclose(out[0, 1:] + 1j * out[1, 1:], expected, rtol=0, atol=1e-14)
    assert np.all(out[:, 0] == 0)


def test_point_and_multiples():
    vectors, turns = directions(3)
    phi, theta = np.arctan2(vectors[:, 1], vectors[:, 0]), np.arccos(np.clip(vectors[:, 2], -1, 1))
    phi[:2] = 0.0  # any will do along z
    m = np.arange(ORDER + 1)[:, None]
    # The arc cosine loses half the digits near the poles.
    assert_allclose(turns[0] + 1j * turns[1], np.exp(1j * m * phi), rtol=0, atol=1e-13)
    assert_allclose(turns[2] + 1j * turns[3], np.exp(1j * m * theta), rtol=0, atol=1e-7)


def test_forth_and_back():
    (vectors, turns), table = directions(4), tables(5)
    work, along, again = np.zeros((2, 2, ORDER + 1, LANES)), np.zeros((2, WIDTH, LANES)), np.zeros((2, WIDTH, LANES))
    lane_kernels.forth(ORDER, ORDER, axes(ORDER), turns, table, work, along)
    rows = [lane_kernels.column(m, ORDER) + n for n, m in pairs(ORDER)]
    # At the direction itself, now z.
    there = value(along[:, rows], np.array([0.0, 0.0, 1.0]), ORDER)
    assert_allclose(there, [value(table[..., k], v, ORDER) for k, v in enumerate(vectors)], rtol=0, atol=1e-12)
    lane_kernels.back(ORDER, ORDER, axes(ORDER), turns, along, work, again)
    assert_allclose(again, table, rtol=0, atol=1e-13)


def some_spheres(count=5, radius=0.2):
    rng = np.random.default_rng(6)
    return unmirrored(rng.random((count, 3)) * SIZE, radius * (1 + rng.random(count)), np.ones(count), SIZE)


def translated(offset, multipoles, order):
    """Local coefficients, by the kernels' harmonics, of multipoles at an offset: plain sums."""
    made = np.zeros(len(pairs(order)), dtype=complex)
    for entry, (p, q) in enumerate(pairs(order)):
        total = 0
        for n in range(1, order + 1):
            for m in range(-n, n + 1):
                harmonic = irregular(offset, n + p, abs(m + q))[0]
                if m + q < 0:
                    harmonic = (-1) ** (m + q) * np.conj(harmonic)
                total += of_both_signs(multipoles, n, m) * harmonic
        made[entry] = np.conj((-1) ** p * total)
    return made


def test_near():
    spheres, order = some_spheres(), 2
    cells, numbers = sorted_into(SHAPE, spheres, 1e-14)
    width = len(pairs(order))
    sent = np.ascontiguousarray(tables(7, order, 5).transpose(0, 2, 1))
    made = np.full((2, 5, width), np.nan)
    cell_kernels.near(order, cells, axes(order), sent, made, 0, 1)
    scale = scales(np.ones(5), order)
    multipoles, centers = (sent[0] + 1j * sent[1]) * scale.sent, spheres.centers[numbers]
    home = np.floor(centers / cells.edge)
    for i in range(5):
        total = np.zeros(width, dtype=complex)
        for j, image in product(range(5), product(range(-2, 3), repeat=3)):
            steps = home[j] + SHAPE * image - home[i]
            if np.all(np.abs(steps) <= 2) and (j != i or any(image)):
                offset = centers[i] - centers[j] - SIZE * image
                total += translated(offset, multipoles[j], order)
        expected = total * scale.made[i]
        found = made[0, i] + 1j * made[1, i]
        assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    whole = made.copy()
    cell_kernels.near(order, cells._replace(negligible=1e-3), axes(order), sent, made, 0, 1)
    assert_allclose(made, whole, rtol=0, atol=1e-2 * np.abs(whole).max())


def test_gather():
    spheres, order, degree = some_spheres(), 2, 5
    cells, _ = sorted_into(SHAPE, spheres, 1e-14)
    sent = np.ascontiguousarray(tables(8, order, 5).transpose(0, 2, 1))
    made = np.zeros((2, 5, len(pairs(degree))))
    cell_kernels.gather(order, degree, cells, axes(degree), sent, made, 0, 1)
    one, two = scales(np.ones(5), order).sent, scales(np.ones(5), degree).sent
    moments, found = (sent[0] + 1j * sent[1]) * one, (made[0] + 1j * made[1]) * two
    for row, place, own in zip(found, cells.places, moments, strict=True):
        for entry, (n, m) in enumerate(pairs(degree)):
            total = 0
            for p in range(1, min(order, n) + 1):
                for q in range(-p, p + 1):
                    if abs(m - q) <= n - p:
                        shift = np.conj(regular(place, n - p, abs(m - q))[0])
                        total += of_both_signs(own, p, q) * (shift if m >= q else (-1) ** (m - q) * np.conj(shift))
            assert_allclose(row[entry], total, rtol=0, atol=1e-13)


def test_spread():
    spheres, order, degree = some_spheres(), 3, 4
    cells, _ = sorted_into(SHAPE, spheres, 1e-14)
    local = np.ascontiguousarray(tables(9, degree, 12).transpose(0, 2, 1))
    made = np.zeros((2, 5, len(pairs(order))))
    cell_kernels.spread(order, degree, cells, axes(degree), local, made, 0, 1)
    small = np.array([0.05, -0.02, 0.07])
    # Of all degrees at the sphere's centre those up to the order: near it the rest goes with the distance^4.
    for i, place in enumerate(cells.places):
        there = local[:, cells.home[i]]
        at = [value(there, place + s * small, degree) for s in (0, 1, -1)]
        own = [value(made[:, i], s * small, order) for s in (0, 1, -1)]
        assert_allclose(own[1] - own[0], at[1] - at[0], rtol=0, atol=20 * np.linalg.norm(small) ** 4)
        assert_allclose(own[1] - own[2], at[1] - at[2], rtol=0, atol=1e-13)  # even degrees cancel: degree 4 with them


def test_convolve():
    degree, rng = 2, np.random.default_rng(10)
    width = len(pairs(degree))
    sums, sent = tables(11, 2 * degree, 3).transpose(0, 2, 1), rng.normal(size=(3, 8, 2 * width))
    made = np.full((3, 8, 2 * width), np.nan)
    for wave in range(3):
        wave_kernels.convolve(degree, np.ascontiguousarray(sums), sent, made, wave, wave + 1)
    zero = [m == 0 for _, m in pairs(degree)]
    for wave, field in product(range(3), range(8)):
        own = sent[wave, field, :width] + 1j * np.where(zero, 0.0, sent[wave, field, width:])
        table = sums[0, wave] + 1j * sums[1, wave]
        for entry, (p, q) in enumerate(pairs(degree)):
            total = sum(
                of_both_signs(own, n, m) * of_both_signs(table, n + p, m + q)
                for n in range(1, degree + 1)
                for m in range(-n, n + 1)
            )
            found = made[wave, field, entry] + 1j * made[wave, field, width + entry]
            assert_allclose(found, np.conj((-1) ** p * total), rtol=0, atol=1e-13)


def points_and_places(cells):
    points = np.random.default_rng(12).random((60, 3)) * SIZE
    steps = np.floor(points / cells.edge).astype(np.int64)
    return points, points - (steps + 0.5) * cells.edge, np.ravel_multi_index(tuple(steps.T), tuple(SHAPE))


def test_owners_by_cells():
    spheres = some_spheres(3, radius=0.3)
    cells, numbers = sorted_into(SHAPE, spheres, 1e-14)
    points, places, home = points_and_places(cells)
    found, owner = places.copy(), np.empty(60, dtype=np.int64)
    field_kernels.owners_by_cells(found, home, cells, owner)
    apart = points[:, None] - spheres.centers[numbers]
    apart -= SIZE * np.round(apart / SIZE)
    inside = np.linalg.norm(apart, axis=2) <= spheres.radii[numbers]
    assert np.array_equal(owner >= 0, inside.any(axis=1)) and 3 < inside.any(axis=1).sum() < 57
    for k in range(60):
        if owner[k] >= 0:
            assert inside[k, owner[k]]
            assert_allclose(found[k], apart[k, owner[k]], rtol=0, atol=1e-14)
        else:
            assert np.array_equal(found[k], places[k])


def test_near_by_cells():
    spheres = some_spheres(3, radius=0.1)
    cells, numbers = sorted_into(SHAPE, spheres, 1e-14)
    points, places, home = points_and_places(cells)
    table, found = coefficients(13), np.ones((4, 4))
    field_kernels.near_by_cells(places[:4], home[:4], cells, table, ORDER, found)
    centers, expected = spheres.centers[numbers], np.ones((4, 4))
    for k, j in product(range(4), range(3)):
        for image in product(range(-2, 3), repeat=3):
            steps = np.floor(centers[j] / cells.edge) + SHAPE * image - np.floor(points[k] / cells.edge)
            if np.all(np.abs(steps) <= 2):
                for n, m in pairs(ORDER)[1:]:
                    there, slope = irregular(points[k] - centers[j] - SIZE * image, n, m)
                    factor = (2 if m else 1) * table[j, n * (n + 1) // 2 + m]
                    expected[k] += (factor * np.array([there, *slope])).real
    assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_near_by_cells_leaves_out_degrees_that_are_negligible():
    spheres = some_spheres(1, radius=0.01)
    cells, _ = sorted_into(SHAPE, spheres, 1e-2)
    places, home, found = cells.places + [0.4, 0.0, 0.0], cells.home, np.zeros((1, 4))
    # At a distance of 0.4 the second degree is 0.05^2 at most, and less at images: nobody looks at the third.
    table = coefficients(13)[:1]
    table[0, [n > 2 for n, _ in pairs(ORDER)]] = np.nan
    field_kernels.near_by_cells(places, home, cells, table, ORDER, found)
    assert np.all(np.isfinite(found)) and np.all(found != 0.0)
