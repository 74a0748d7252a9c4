"""Pictures in cells of a table."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from studies.common.pictures import packed, unpacked


def test_a_picture_comes_back_to_half_a_step():
    x, y = np.meshgrid(np.linspace(0, 1, 200), np.linspace(0, 1, 200))
    picture = 100 * x + 30 * np.sin(20 * y) - 400.0 * (x > 0.5)
    text = packed(picture, 0.002)
    assert_allclose(unpacked(text), picture, atol=0.001 * (1 + 1e-9))
    assert len(text) < 100_000 and not set(text) & set(',"\n')


def test_what_is_no_picture_is_refused():
    for wrong in (np.zeros((2, 3)), np.full((2, 2), np.nan), np.zeros(4)):
        with pytest.raises(ValueError, match="must be square, of finite numbers"):
            packed(wrong, 1.0)
    noise = np.random.default_rng(0).random((400, 400))
    with pytest.raises(ValueError, match="use a larger step"):
        packed(noise, 1e-6)
    for text in ("", "1 2 3", "2:1:AAAA", float("nan")):
        with pytest.raises(ValueError, match="must hold a packed picture"):
            unpacked(text)
