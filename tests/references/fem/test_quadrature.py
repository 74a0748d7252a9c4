"""Rules integrate the monomials of their degree, with points inside and positive weights."""

from itertools import product
from math import factorial

import fem_scenes  # noqa: F401, skips without gmsh
import numpy as np
import pytest

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
