"""Kernels of the solvers on voxels against slow twins, and plans that are kept."""

import itertools

import numpy as np
import pytest
from fft_scenes import dispersion
from numpy.testing import assert_allclose

from references.fft import cg_kernels as fft_cg_kernels
from references.fft import eyre_milton_kernels as fft_eyre_milton_kernels
from references.fft import link_kernels as fft_link_kernels
from references.voxels.paint import medium, voxelise


def _random_medium(shape):
    scene = dispersion(gradient=(1.0, 0.0, 0.0))
    grid = voxelise(scene, shape, laminate=True)
    full = np.zeros((*shape, 3, 3))
    full[:] = grid.conductivity[grid.phase][..., None, None] * np.eye(3)
    full.reshape(-1, 3, 3)[grid.cut] = grid.tensor[:, [[0, 5, 4], [5, 1, 3], [4, 3, 2]]]
    return grid, full


def _corner_operator(shape, spacing, walls):
    """Matrices of the gradient in each voxel from the temperatures at its corners, by the definition."""
    nodes = (shape[0] - 1, shape[1] + 1, shape[2] + 1) if walls else shape
    matrix = np.zeros((*shape, 3, *nodes))
    for voxel in np.ndindex(*shape):
        for corner in itertools.product((0, 1), repeat=3):
            node = [v + c for v, c in zip(voxel, corner, strict=True)]
            if walls:
                node[0] -= 1
                if not 0 <= node[0] < nodes[0]:
                    continue
            else:
                node = [n % m for n, m in zip(node, shape, strict=True)]
            for axis in range(3):
                matrix[(*voxel, axis, *node)] += (2 * corner[axis] - 1) / (4 * spacing[axis])
    return matrix


@pytest.mark.parametrize("walls", [False, True])
def test_conduction_through_voxels_against_its_definition(walls):
    shape = (4, 3, 5)
    grid, full = _random_medium(shape)
    matrix = _corner_operator(shape, grid.spacing, walls)
    theta = np.random.default_rng(0).random(matrix.shape[4:])
    load = np.array([0.3, -0.2, 0.5])
    slope = np.tensordot(matrix, theta, 3) + load
    flux = np.einsum("xyzab,xyzb->xyza", full, slope)
    work, sums = np.full((*theta.shape[:2], theta.shape[2] + 2), np.nan), np.zeros((4, 5))
    kernel_medium = medium(grid, grid.conductivity, grid.tensor, float)
    for low, high in ((0, 1), (1, len(theta))):  # In two chunks.
        fft_cg_kernels.conduct_voxels(theta, work, kernel_medium, load, 0.25 / grid.spacing, walls, sums, low, high)
    assert_allclose(work[..., : theta.shape[2]], np.tensordot(flux, matrix, 4), atol=1e-12)
    expected = [np.sum(flux * slope), *flux.sum(axis=(0, 1, 2)), np.sum(flux**2)]
    assert_allclose(sums.sum(axis=0), expected, rtol=1e-12)


@pytest.mark.parametrize("walls", [False, True])
def test_conduction_through_links_against_its_definition(walls):
    shape, spacing = (3, 4, 2), np.array([0.3, 0.2, 0.5])
    rng = np.random.default_rng(1)
    conductivity = [rng.random(tuple(np.array(shape) + np.eye(3, dtype=int)[a])) for a in range(3)]
    for axis, link in enumerate(conductivity):
        ends = np.moveaxis(link, axis, 0)
        ends[-1] = ends[0]
        if walls and axis:
            ends[[0, -1]] = 0
    theta, load = rng.random(shape), np.array([0.3, -0.2, 0.5])
    expected, energy = np.zeros(shape), 0.0
    for axis in range(3):
        for index in np.ndindex(*conductivity[axis].shape):
            above, below = list(index), list(index)
            below[axis] -= 1
            signs, weight = [1.0, 1.0], 0.5 if index[axis] in (0, shape[axis]) else 1.0
            if walls and axis == 0:  # Mirrored in the wall, sign changed.
                signs = [-1.0 if index[0] == shape[0] else 1.0, -1.0 if index[0] == 0 else 1.0]
                above[0], below[0] = min(above[0], shape[0] - 1), max(below[0], 0)
            above[axis] %= shape[axis]
            slope = (signs[0] * theta[tuple(above)] - signs[1] * theta[tuple(below)]) / spacing[axis] + load[axis]
            flux = conductivity[axis][index] * slope
            energy += weight * flux * slope
            if index[axis] < shape[axis]:
                expected[tuple(above)] += flux / spacing[axis]
            if index[axis] > 0:
                expected[tuple(below)] -= flux / spacing[axis]
    work, sums = np.full((*shape[:2], 4), np.nan), np.zeros((3, 5))
    links = fft_link_kernels.Links(*conductivity)
    fft_link_kernels.conduct_links(theta, work, links, load, 1 / spacing, walls, sums, 0, 3)
    assert_allclose(work[..., :2], expected, atol=1e-12)
    assert_allclose(sums[:, 0].sum(), energy, rtol=1e-12)


def test_the_reflection_in_fourier_space_against_its_definition():
    shape, rng = (4, 3, 6), np.random.default_rng(0)
    field, mean = rng.random((3, *shape)), np.array([0.1, 0.2, 0.3])
    numbers = [2 * np.pi * n * np.fft.fftfreq(n) for n in shape]
    modes = np.fft.fftn(field, axes=(1, 2, 3))
    for index in np.ndindex(*shape):
        nyquist = [2 * i == n for i, n in zip(index, shape, strict=True)]
        k = np.array([0.0 if f else x[i] for f, x, i in zip(nyquist, numbers, index, strict=True)])
        gamma = np.diag(np.array(nyquist, float)) + (np.outer(k, k) / (k @ k) if k.any() else 0)
        modes[(slice(None), *index)] = (np.eye(3) - 2 * gamma) @ modes[(slice(None), *index)]
    expected = np.fft.ifftn(modes, axes=(1, 2, 3)) + mean[:, None, None, None]
    # A real field stays real: that is what the treatment of the Nyquist frequencies is for.
    assert_allclose(expected.imag, 0, atol=1e-14)
    half = np.fft.rfftn(field, axes=(1, 2, 3))
    wave = tuple(np.where(2 * np.arange(n) == n, 0, x) for n, x in zip(shape, numbers, strict=True))
    free = tuple((2 * np.arange(n) == n).astype(float) for n in shape)
    wave, free = (*wave[:2], np.abs(wave[2][:4])), (*free[:2], free[2][:4])
    columns = np.ascontiguousarray(half.reshape(3, 4, 12).transpose(0, 2, 1))
    wave, free = ((np.repeat(v[0], 2), *v[1:]) for v in (wave, free))
    for first, count in ((0, 5), (5, 7)):  # In two chunks.
        rows = columns[:, first:].copy().view(float)
        fft_eyre_milton_kernels.reflect_modes(rows, first, count, wave, free, 1 / 72, mean)
        half.reshape(3, 4, 12)[..., first : first + count] = rows.view(complex)[:, :count].transpose(0, 2, 1)
    assert_allclose(np.fft.irfftn(half * 72, s=shape, axes=(1, 2, 3)), expected.real, atol=1e-13)


def test_plans_are_kept(tmp_path, monkeypatch):
    from references.fft import transforms as fft_transforms

    monkeypatch.setenv("DEMHEAT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(fft_transforms, "MEASURED_FROM", 1)
    fft_transforms.fourier(1, (6, 10, 14), np.float64, 1)
    kept = tmp_path / "cache" / "fftw-wisdom-float64.txt"
    assert b"fftw_wisdom" in kept.read_bytes()
    fft_transforms.pyfftw.forget_wisdom()
    fft_transforms._loaded.clear()
    # With the kept wisdom alone the plan is there; without it FFTW would have to measure.
    monkeypatch.setattr(fft_transforms, "_save_wisdom", lambda dtype: pytest.fail("measured again"))
    fft_transforms.fourier(1, (6, 10, 14), np.float64, 1)
