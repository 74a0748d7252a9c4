"""Arrays of insulated discs: dilute ones, by finite differences, and in towers of layers."""

import numpy as np
from numpy.testing import assert_allclose
from scipy.sparse import diags, identity, kron
from scipy.sparse.linalg import cg

from references.exact.cracks import discs
from references.exact.ellipsoids import penny_cracks


def test_few_discs():
    for radius in (0.02, 0.05):
        lost = 1 - discs(radius).conductivity
        # The next term is of the order of the density, 1e-4.
        assert_allclose(lost, 1 - penny_cracks(radius**3), rtol=2e-4)


def test_layers_far_apart_resist_in_series():
    """What a layer adds to the way does not depend on where the next one is, but for exp(-2 pi height)."""
    more = [height / discs(0.3, height=height).conductivity - height for height in (1.5, 3.0)]
    # Seven digits or so, and exp(-3 pi) = 8e-5.
    assert_allclose(more[0], more[1], rtol=1e-4)


def by_differences(radius, n):
    """An eighth of the cube on a grid; the plane of the disc is insulated inside, at one temperature outside."""
    h = 0.5 / n
    x = (np.arange(n) + 0.5) * h
    line = diags([np.r_[1, 2 * np.ones(n - 2), 1], -np.ones(n - 1), -np.ones(n - 1)], [0, 1, -1])
    one = identity(n)
    matrix = kron(kron(line, one), one) + kron(kron(one, line), one) + kron(kron(one, one), line)
    # Half a step to the held planes.
    bottom, top = np.zeros((n, n, n)), np.zeros((n, n, n))
    bottom[:, :, 0] = 2.0 * (np.hypot(x[:, None], x) > radius)
    top[:, :, -1] = 2.0
    matrix = (matrix + diags((bottom + top).ravel())).tocsr()
    T, failed = cg(matrix, top.ravel(), rtol=1e-10, M=diags(1 / matrix.diagonal()))
    assert failed == 0
    return float(np.sum(top.ravel() * (1 - T)) * h / 0.5**2 * 0.5)


def test_finite_differences():
    """Of first order at the rim, with an error that has no sign where the circle is a staircase: nine radii."""
    radius, n = 0.4, 24
    sure, shifts = 1 - discs(radius).conductivity, (np.arange(9) - 4) / 9 * 0.5 / n
    # A rim between points is seen a part of a step further out; two grids tell how far.
    found = [np.mean([1 - by_differences(radius + s * 24 / size, size) for s in shifts]) for size in (n // 2, n)]
    assert abs(found[1] / sure - 1) < 0.2
    assert_allclose(2 * found[1] - found[0], sure, rtol=0.02)


def test_digits():
    assert 6 < discs(0.25).digits < 13
    # With four times the waves and more functions: 0.95877855.
    assert abs(discs(0.25).conductivity - 0.95877855) < 1e-7
