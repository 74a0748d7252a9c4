"""Columns of modes to a buffer and back, beside slices of whole arrays."""

import numpy as np
import pytest

from references.fft.sweep_kernels import TILE, put, take

pytestmark = pytest.mark.twin
# Two whole tiles and a part of one.
COMPONENTS, MX, COLUMNS = 2, 2 * TILE + 3, 11
FIRST, COUNT = 4, 5


def case():
    rng = np.random.default_rng(0)
    modes = rng.random((COMPONENTS, MX, COLUMNS)) + 1j * rng.random((COMPONENTS, MX, COLUMNS))
    return modes, np.full((COMPONENTS, COUNT + 1, MX), 7 + 7j)


def test_take():
    modes, buffer = case()
    expected = buffer.copy()
    expected[:, :COUNT] = modes[:, :, FIRST : FIRST + COUNT].transpose(0, 2, 1)
    take(modes, buffer, FIRST, COUNT)
    assert np.array_equal(buffer, expected)


def test_put():
    modes, buffer = case()
    buffer[:, :COUNT] = np.random.default_rng(1).random((COMPONENTS, COUNT, MX))
    expected = modes.copy()
    expected[:, :, FIRST : FIRST + COUNT] = buffer[:, :COUNT].transpose(0, 2, 1)
    put(modes, buffer, FIRST, COUNT)
    assert np.array_equal(modes, expected)
