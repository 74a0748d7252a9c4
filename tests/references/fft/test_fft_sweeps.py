"""Transforms in two sweeps: block by block and column by column, whatever the threads."""

import numpy as np
import pytest
from fft_scenes import SCHEMES, dispersion, filled
from numpy.testing import assert_allclose

from references import fft


def test_kernels_see_every_plane_and_column_once(blocks):
    shape = (7, 4, 9)
    transform, values = filled(shape)
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
    transforms = [filled((9, 8, 10), threads=threads)[0] for threads in (1, 2, 3)]
    for transform in transforms:
        transform.forward()
    assert np.array_equal(transforms[0].modes, transforms[1].modes)
    assert np.array_equal(transforms[0].modes, transforms[2].modes)


def test_seconds_count_transforms_only():
    transform, _ = filled((16, 16, 16))
    assert transform.seconds == 0
    transform.planes(lambda low, high: None)
    assert transform.seconds == 0
    transform.forward()
    once = transform.seconds
    transform.backward()
    assert 0 < once < transform.seconds


@pytest.mark.filterwarnings("ignore:gaps beside inclusions")  # how long it takes is asked, not how right it is
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("walls", [False, True])
def test_the_cost_of_iterations_is_told(scheme, walls):
    scene = dispersion(walls={"x-": 0.0, "x+": 1.0}) if walls else dispersion(gradient=(1.0, 0.0, 0.0))
    stats = fft.solve(scene, voxels=12, scheme=scheme).stats
    assert 0 < stats["transform_s"] < stats["iteration_s"]
