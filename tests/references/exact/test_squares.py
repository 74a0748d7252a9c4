"""Closed forms of square patterns, between bounds that are certain."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from references.exact import squares


def upper(conductivity):
    """Least energy of bilinear elements on a square between two isothermal sides, above the true one.

    Cells of a pattern with mirrors: a quarter of it is a box with walls.
    """
    n = len(conductivity)
    number = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    corners = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    # Of a square element, whatever its size.
    block = np.array([[4, -1, -2, -1], [-1, 4, -1, -2], [-2, -1, 4, -1], [-1, -2, -1, 4]]) / 6
    values = conductivity.ravel()[:, None, None] * block
    matrix = coo_matrix(
        (values.ravel(), (np.repeat(corners, 4, axis=1).ravel(), np.tile(corners, 4).ravel())), shape=(number.size,) * 2
    ).tocsr()
    T = np.repeat(np.linspace(0.0, 1.0, n + 1), n + 1)
    free = number[1:-1].ravel()
    T[free] -= spsolve(matrix[free][:, free], (matrix @ T)[free])
    return float(T @ matrix @ T)


def pattern(kind, contrast, n):
    found = np.ones((n, n))
    found[: n // 2, : n // 2] = contrast
    if kind == "checkerboard":
        found[n // 2 :, n // 2 :] = contrast
    return found


@pytest.mark.parametrize("contrast", [0.2, 3.0, 10.0])
def test_square_rods_lie_between_their_bounds(contrast):
    """The dual of the pattern has the inverse conductivities, and the inverse conductivity (Keller 1964)."""
    high = upper(pattern("rods", contrast, 96))
    low = 1 / upper(pattern("rods", 1 / contrast, 96))
    # The bounds are near to each other: corners cost some 96^-1.3 of the contrast's effect.
    assert low <= squares.square_rods(contrast) <= high <= 1.005 * low


@pytest.mark.parametrize("contrast", [3.0, 10.0])
def test_a_checkerboard_lies_between_its_bounds(contrast):
    """Walls halve its cell as they do that of rods; corners are worse."""
    high, low = upper(pattern("checkerboard", contrast, 96)), 1 / upper(pattern("checkerboard", 1 / contrast, 96))
    assert low <= squares.checkerboard(contrast) <= high <= 1.25 * low


def test_limits():
    assert_allclose(squares.square_rods(math.inf) * squares.square_rods(0.0), 1.0, rtol=1e-15)
    assert_allclose(squares.square_rods(1e12), math.sqrt(3), rtol=1e-11)
    assert squares.square_rods(1.0) == squares.checkerboard(1.0) == 1.0
    # The second order of what is isotropic in the plane: f (s - 1) - f (1 - f) (s - 1)^2 / 2.
    for f, form in ((0.25, squares.square_rods), (0.5, squares.checkerboard)):
        d = 1e-4
        bend = (form(1 + d) + form(1 - d) - 2) / d**2
        assert_allclose(bend, -f * (1 - f), rtol=1e-6)
