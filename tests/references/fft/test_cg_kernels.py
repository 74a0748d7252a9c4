"""The vector work of conjugate gradients beside whole arrays, and the modes that it divides by."""

import numpy as np
import pytest
from fft_kernel_cases import chunks, padded
from numpy.testing import assert_allclose

from references.fft.cg_kernels import Symbol, Vectors, divide, dot, start, step, turn

pytestmark = pytest.mark.twin
NODES = (4, 3, 5)


def vectors():
    rng = np.random.default_rng(0)
    theta, residual, direction, work = rng.normal(size=(4, *NODES))
    weights = [np.r_[2.0, np.ones(n - 2), 2.0] for n in NODES[1:]]
    return Vectors(theta, residual, direction, padded(work), *weights, partial=np.full(NODES[0], np.nan))


def run(kernel, *arguments):
    """Vectors before and after, called for two chunks of planes."""
    before, after = vectors(), vectors()
    for low, high in chunks(NODES[0]):
        kernel(after, *arguments, low, high)
    assert np.all(np.isnan(after.work[..., NODES[2] :]))
    return unpadded(before), unpadded(after)


def unpadded(vectors):
    return vectors._replace(work=vectors.work[..., : NODES[2]])


def weighted(before, residual):
    return residual * before.weight_y[:, None] * before.weight_z


def check(after, expected):
    for name in ("theta", "residual", "direction", "work"):
        # Rounding of one product and one sum of numbers up to 10.
        assert_allclose(getattr(after, name), getattr(expected, name), atol=1e-14)


def test_start():
    before, after = run(start)
    check(after, before._replace(residual=-before.work, work=weighted(before, -before.work)))


def test_step():
    before, after = run(step, 0.7)
    residual = before.residual - 0.7 * before.work
    theta = before.theta + 0.7 * before.direction
    check(after, before._replace(theta=theta, residual=residual, work=weighted(before, residual)))


def test_turn():
    before, after = run(turn, 0.7)
    check(after, before._replace(direction=before.work + 0.7 * before.direction))


def test_dot():
    before, after = run(dot)
    check(after, before)
    assert_allclose(after.partial, np.sum(before.residual * before.work, axis=(1, 2)), atol=1e-13)  # Rounding.


def test_divide():
    rng = np.random.default_rng(0)
    mx, my, mz = shape = (6, 3, 4)
    sine, cosine = (tuple(rng.random(n) for n in shape) for _ in range(2))
    for axis in range(3):  # Nothing but a constant temperature: the mode without a symbol.
        sine[axis][0], cosine[axis][0] = 0.0, 1.0
    modes = rng.normal(size=shape)
    # Differences along one axis, means along the others.
    symbol = sum(np.einsum("i,j,k->ijk", *(sine[b] if a == b else cosine[b] for b in range(3))) for a in range(3))
    expected = np.divide(0.3 * modes, symbol, out=np.zeros(shape), where=symbol > 0)
    columns = modes.reshape(mx, my * mz).T
    for first, count in ((0, 5), (5, 7)):
        rows = np.full((1, count + 1, mx), 9.0)
        rows[0, :count] = columns[first : first + count]
        divide(rows, first, count, Symbol(sine, cosine), 0.3)
        assert_allclose(
            rows[0, :count], expected.reshape(mx, my * mz).T[first : first + count], rtol=1e-13
        )  # Rounding.
        assert np.all(rows[0, count] == 9.0)
