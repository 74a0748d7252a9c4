"""Only here: a picture that comes back from its cell off by more than half a step."""

import numpy as np
from numpy.testing import assert_allclose

from studies.common.pictures import packed, unpacked


def test_a_picture_comes_back_to_half_a_step():
    x, y = np.meshgrid(np.linspace(0, 1, 200), np.linspace(0, 1, 200))
    picture = 100 * x + 30 * np.sin(20 * y) - 400.0 * (x > 0.5)
    text = packed(picture, 0.002)
    assert_allclose(unpacked(text), picture, atol=0.001 * (1 + 1e-9))
    assert len(text) < 100_000 and not set(text) & set(',"\n')
