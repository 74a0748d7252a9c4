"""Transforms in two sweeps: against NumPy's, block by block and column by column, whatever the threads."""

import numpy as np
import pytest
from fft_scenes import SCHEMES, dispersion
from numpy.testing import assert_allclose

from references import fft
from references.fft import sweeps as fft_sweeps
from references.fft.transforms import fourier, trigonometric

SHAPES = [(6, 5, 8), (7, 4, 9), (1, 3, 2), (40, 3, 5)]


@pytest.fixture(params=[1, 2**20], ids=["one by one", "many at a time"])
def blocks(request, monkeypatch):
    """Planes and columns one by one, or as many at a time as there are, the last block smaller."""
    monkeypatch.setattr(fft_sweeps, "BLOCK_BYTES", request.param)
    monkeypatch.setattr(fft_sweeps, "BLOCKS", 3)


def _filled(shape, dtype=np.float64, threads=2, components=2):
    transform = fourier(components, shape, dtype, threads)
    values = np.random.default_rng(0).random((components, *shape)).astype(dtype)
    transform.real[..., : shape[2]] = values
    return transform, values


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("dtype", "rounding"), [(np.float64, 1e-13), (np.float32, 1e-4)])
def test_fourier_there_and_back(blocks, shape, dtype, rounding):
    transform, values = _filled(shape, dtype)
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


def test_kernels_see_every_plane_and_column_once(blocks):
    shape = (7, 4, 9)
    transform, values = _filled(shape)
    columns = np.zeros(transform.modes[0, 0].size, int)
    planes = np.zeros(shape[0], int)

    def halve(rows, first, count, factor):
        columns[first : first + count] += 1
        # The column's coefficients along x: real and imaginary parts in turn.
        expected = modes[:, :, first : first + count].transpose(0, 2, 1)
        assert_allclose(rows[:, :count].view(complex), expected, atol=1e-12)
        rows *= factor

    def count_planes(low, high):
        planes[low:high] += 1
        # Values again, half as large.
        found = transform.real[:, low:high, :, : shape[2]] * transform.scale
        assert_allclose(found, 0.5 * values[:, low:high], atol=1e-14)

    modes = np.fft.rfftn(values, axes=(1, 2, 3)).reshape(2, shape[0], -1)
    transform.planes(forward=True)
    transform.columns(halve, 0.5)
    transform.planes(count_planes, backward=True)
    assert np.all(columns == 1) and np.all(planes == 1)


def test_threads_do_not_change_a_bit(blocks):
    transforms = [_filled((9, 8, 10), threads=threads)[0] for threads in (1, 2, 3)]
    for transform in transforms:
        transform.forward()
    assert np.array_equal(transforms[0].modes, transforms[1].modes)
    assert np.array_equal(transforms[0].modes, transforms[2].modes)


def test_seconds_count_transforms_only():
    transform, _ = _filled((16, 16, 16))
    assert transform.seconds == 0
    transform.planes(lambda low, high: None)
    assert transform.seconds == 0
    transform.forward()
    once = transform.seconds
    transform.backward()
    assert 0 < once < transform.seconds


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("walls", [False, True])
def test_the_cost_of_iterations_is_told(scheme, walls):
    scene = dispersion(walls={"x-": 0.0, "x+": 1.0}) if walls else dispersion(gradient=(1.0, 0.0, 0.0))
    stats = fft.solve(scene, voxels=12, scheme=scheme).stats
    assert 0 < stats["transform_s"] < stats["iteration_s"]
