"""Layers at an angle, against the equations of their gradients, and their limits."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from references.exact.inclined import laminate


def by_equations(tensors, shares, n, resistance):
    """Gradients G + c_i n that carry one flux across; mean flux for each unit G, from a linear system."""
    count, columns = len(tensors), []
    for G in np.eye(3):
        # Unknowns c_i and the flux across, against n.
        matrix, right = np.zeros((count + 1, count + 1)), np.zeros(count + 1)
        for i, k in enumerate(tensors):
            matrix[i, i], matrix[i, count], right[i] = n @ k @ n, -1.0, -n @ k @ G
        matrix[count, :count], matrix[count, count] = shares, resistance
        c = np.linalg.solve(matrix, right)
        columns.append(sum(w * k @ (G + each * n) for w, k, each in zip(shares, tensors, c[:-1], strict=True)))
    return np.column_stack(columns)


@pytest.mark.parametrize("resistance", [0.0, 0.7])
def test_equations_of_the_layers(resistance):
    draw = np.random.default_rng(1)
    tensors = [(a := draw.normal(size=(3, 3))) @ a.T + 0.1 * np.eye(3) for _ in range(3)]
    n = draw.normal(size=3)
    n /= np.linalg.norm(n)
    shares = [0.2, 0.5, 0.3]
    found = laminate(tensors, shares, 7 * n, resistance=resistance)
    assert_allclose(found, by_equations(tensors, shares, n, resistance), rtol=1e-11)
    assert_allclose(found, found.T, rtol=1e-13, atol=1e-13)


def test_means_along_and_across():
    n = np.array([1.0, 1.0, 0.0]) / np.sqrt(2)
    found = laminate([1.0, 9.0], [0.5, 0.5], (1, 1, 0), resistance=0.25)
    assert_allclose(n @ found @ n, 1 / (0.5 + 0.5 / 9 + 0.25), rtol=1e-14)
    assert_allclose(found @ (0, 0, 1), (0, 0, 5), atol=1e-14)
    assert_allclose(found @ (1, -1, 0), (5, -5, 0), atol=1e-13)
    assert_allclose(laminate([3.0, 3.0], [0.1, 0.9], (1, 2, 3)), 3 * np.eye(3), atol=1e-14)


def test_layers_of_no_conductivity():
    found = laminate([0.0, 2.0], [0.25, 0.75], (0, 0, 1))
    assert_allclose(found, np.diag([1.5, 1.5, 0.0]), atol=1e-15)
    # A layer of no thickness is none.
    assert_allclose(laminate([0.0, 2.0], [0.0, 1.0], (0, 0, 1)), 2 * np.eye(3), atol=1e-15)


def test_laminates_of_laminates_are_coated_cylinders():
    """Maxwell's conductivity in the plane: layered twice, the coat's share split so that both directions agree.

    Tartar 1985: f (K - 1)^-1 = (s - 1)^-1 + (1 - f1) along one normal + (f1 - f) along the other, f1 the first share.
    """
    s, f = 6.0, 0.4
    first = (1 + f) / 2
    inner = laminate([1.0, s], [1 - first, first], (1, 0, 0))
    found = laminate([np.eye(3), inner], [1 - f / first, f / first], (0, 1, 0))
    beta = (s - 1) / (s + 1)
    assert_allclose(np.diag(found)[:2], (1 + f * beta) / (1 - f * beta), rtol=1e-13)
