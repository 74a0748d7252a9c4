"""Transforms against NumPy's and their definition, and plans that are kept."""

import numpy as np
import pytest
from fft_scenes import filled
from numpy.testing import assert_allclose

from references.fft import transforms
from references.fft.transforms import trigonometric

SHAPES = [(6, 5, 8), (7, 4, 9), (1, 3, 2), (40, 3, 5)]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("dtype", "rounding"), [(np.float64, 1e-13), (np.float32, 1e-4)])
def test_fourier_there_and_back(blocks, shape, dtype, rounding):
    transform, values = filled(shape, dtype)
    transform.forward()
    # Rounding of sums of up to 600 numbers below 1.
    assert_allclose(transform.modes, np.fft.rfftn(values, axes=(1, 2, 3)), atol=rounding)
    transform.backward()
    assert_allclose(transform.real[..., : shape[2]] * transform.scale, values, atol=rounding)


def test_sines_and_cosines_by_their_definition(blocks):
    kinds, shape = [("sin2", "cos2", "cos2"), ("cos2", "sin2", "cos2")], (5, 4, 6)
    transform = trigonometric(kinds, shape, np.float64, 2)
    values = np.random.default_rng(0).random((2, *shape))
    transform.real[:] = values
    transform.forward()
    for kind, value, modes in zip(kinds, values, transform.modes, strict=True):
        for axis, (name, n) in enumerate(zip(kind, shape, strict=True)):
            place, wave = np.arange(n) + 0.5, np.arange(n)[:, None]
            matrix = 2 * (
                np.sin((wave + 1) * np.pi * place / n) if name == "sin2" else np.cos(wave * np.pi * place / n)
            )
            value = np.moveaxis(np.tensordot(matrix, value, (1, axis)), 0, axis)
        assert_allclose(modes, value, atol=1e-12)  # Rounding.
    transform.backward()
    assert_allclose(transform.real * transform.scale, values, atol=1e-14)


def test_the_last_block_may_lie_where_others_do_not():
    """Four planes of 91 squared are whole vectors, the blocks of five before them are not: 90 voxels had failed."""
    shape = (89, 91, 91)
    transform = trigonometric([("sin1", "cos1", "cos1")], shape, np.float64, 1)
    values = np.random.default_rng(0).random((1, *shape))
    transform.real[:] = values
    transform.forward()
    transform.backward()
    assert_allclose(transform.real * transform.scale, values, atol=1e-13)  # Rounding.


def test_plans_are_kept(tmp_path, monkeypatch):
    monkeypatch.setenv("DEMHEAT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(transforms, "MEASURED_FROM", 1)
    transforms.fourier(1, (6, 10, 14), np.float64, 1)
    kept = tmp_path / "cache" / "fftw-wisdom-float64.txt"
    assert b"fftw_wisdom" in kept.read_bytes()
    transforms.pyfftw.forget_wisdom()
    transforms._loaded.clear()
    # With the kept wisdom alone the plan is there; without it FFTW would have to measure.
    monkeypatch.setattr(transforms, "_save_wisdom", lambda dtype: pytest.fail("measured again"))
    transforms.fourier(1, (6, 10, 14), np.float64, 1)
