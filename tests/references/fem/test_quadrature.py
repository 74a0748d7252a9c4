"""Rules integrate the monomials of their degree, with points inside and positive weights."""

from itertools import product
from math import factorial
from types import SimpleNamespace

import fem_scenes  # noqa: F401, skips without gmsh
import numpy as np
import pytest

from references.fem.elements import wall_weights
from references.fem.quadrature import rule


@pytest.mark.parametrize("degree", [1, 2, 4, 5, 6, 7, 12, 17])
def test_monomials(degree):
    X, weights = rule(degree)
    assert weights.min() > 0
    assert X.min() >= 0 and X.sum(axis=0).max() <= 1 + 1e-15
    for powers in product(range(degree + 1), repeat=3):
        if sum(powers) <= degree:
            known = np.prod([float(factorial(p)) for p in powers]) / factorial(sum(powers) + 3)
            found = weights @ np.prod(X ** np.array(powers)[:, None], axis=0)
            assert found == pytest.approx(known, rel=1e-10)


@pytest.mark.parametrize("weights", [[1 / 3] * 3, [0, 0, 0, 1 / 3, 1 / 3, 1 / 3]])
def test_a_flux_through_a_triangle_goes_to_its_nodes_as_their_shapes_do(weights):
    """Linear: thirds; quadratic: none to the corners, thirds to the middles of edges."""
    corners = np.array([[0.0, 0, 0], [2, 0, 0], [0, 3, 0]])
    middles = (corners + np.roll(corners, -1, axis=0)) / 2
    mesh = SimpleNamespace(points=np.concatenate([corners, middles]))
    found = wall_weights(mesh, np.arange(len(weights))[None])
    assert found[: len(weights)] == pytest.approx(3 * np.array(weights), abs=1e-14)
