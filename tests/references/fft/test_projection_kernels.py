"""The projection on gradients beside its definition: a 3 by 3 matrix Gamma for every wave number."""

import numpy as np
import pytest
from fft_kernel_cases import chunks
from numpy.testing import assert_allclose

from references.fft import projection_kernels as kernels
from references.fft.projection_kernels import Parts, Waves

pytestmark = pytest.mark.twin
SHAPE = (4, 3, 6)
MEAN, SCALE = np.array([0.1, 0.2, 0.3]), 0.7


def projector(wave, free):
    """k k / k^2, and 1 for a component that is a gradient by itself; (mx, my, mz, 3, 3)."""
    k, free = (np.stack(np.meshgrid(*a, indexing="ij"), axis=-1) for a in (wave, free))
    square = np.sum(k**2, axis=-1)[..., None, None]
    along = np.divide(k[..., :, None] * k[..., None, :], square, out=np.zeros((*k.shape, 3)), where=square > 0)
    return along + free[..., None] * np.eye(3), k


def potential(k, vectors, factor):
    """Least squares solution of factor k potential = vectors, the smallest one, for every wave number."""
    found = np.empty(k.shape[:3], vectors.dtype)
    for index in np.ndindex(*k.shape[:3]):
        found[index] = np.linalg.lstsq(factor * k[index][:, None], vectors[index], rcond=None)[0][0]
    return found


# Fourier coefficients: the last axis of all N^3 modes is half there, its first and last modes once.


def fourier_case():
    """Modes of a random field, all of them; their projector and wave numbers; and the waves as kernels have them."""
    numbers = [2 * np.pi * n * np.fft.fftfreq(n) for n in SHAPE]
    free = [(2 * np.arange(n) == n).astype(float) for n in SHAPE]
    numbers = [np.where(f, 0.0, k) for f, k in zip(free, numbers, strict=True)]
    gamma, k = projector(numbers, free)
    modes = np.moveaxis(np.fft.fftn(np.random.default_rng(0).random((3, *SHAPE)), axes=(1, 2, 3)), 0, 3)
    multiplicity = (np.ones(4), np.ones(3), np.array([1.0, 2.0, 2.0, 1.0]))
    return modes, gamma, k, Waves((*numbers[:2], numbers[2][:4]), (*free[:2], free[2][:4]), multiplicity)


def by_columns(kernel, modes, waves, *arguments):
    """What the kernel makes of half of all modes, in two chunks of columns."""
    half = np.moveaxis(modes[:, :, :4], 3, 0).reshape(3, 4, 12)
    found, columns = np.empty_like(half), np.ascontiguousarray(half.transpose(0, 2, 1))
    twice = Waves(*((np.repeat(axes[0], 2), *axes[1:]) for axes in waves))
    for first, count in ((0, 5), (5, 7)):
        rows = columns[:, first:].copy().view(float)
        kernel(rows, first, count, twice, *arguments)
        found[..., first : first + count] = rows.view(complex)[:, :count].transpose(0, 2, 1)
    return np.moveaxis(found.reshape(3, 4, 3, 4), 0, 3)


def test_reflect_modes():
    modes, gamma, _, waves = fourier_case()
    expected = SCALE * np.einsum("xyzab,xyzb->xyza", np.eye(3) - 2 * gamma, modes)
    expected[0, 0, 0] += MEAN
    # A real field stays real: that is what the treatment of the Nyquist frequencies is for.
    assert_allclose(np.fft.ifftn(expected, axes=(0, 1, 2)).imag, 0, atol=1e-14)
    found = by_columns(kernels.reflect_modes, modes, waves, SCALE, MEAN)
    assert_allclose(found, expected[:, :, :4], atol=1e-13)  # Rounding of coefficients up to 40.


def test_split_modes():
    modes, gamma, _, waves = fourier_case()
    inside = SCALE * np.einsum("xyzab,xyzb->xyza", gamma, modes)
    outside = SCALE * modes - inside
    outside[0, 0, 0] -= MEAN
    parts = Parts(np.full(12, np.nan), np.full(12, np.nan))
    found = by_columns(kernels.split_modes, modes, waves, SCALE, MEAN, parts)
    for part, vectors in ((parts.inside, inside), (parts.outside, outside)):
        squares = np.sum(np.abs(vectors) ** 2, axis=(0, 3))
        # Rounding; the modes that are left out are conjugates of others.
        assert_allclose(part.reshape(3, 4), squares[:, :4] * [1, 2, 2, 1], rtol=1e-12)
        assert_allclose(part.sum(), squares.sum(), rtol=1e-12)
    inside[0, 0, 0] += MEAN
    assert_allclose(found, inside[:, :, :4], atol=1e-13)


def test_integrate_modes():
    modes, _, k, waves = fourier_case()
    half = np.ascontiguousarray(np.moveaxis(modes[:, :, :4], 3, 0))
    found = np.full((1, 4, 3, 4), np.nan, complex)
    for low, high in chunks(4):
        kernels.integrate_modes(half, found, waves, low, high)
    assert_allclose(found[0], potential(k, modes, 1j)[:, :, :4], atol=1e-13)  # Rounding.


# Sines and cosines: a component's sines start at wave number 1 and its cosines end at n - 1; what it lacks is 0.

HELD = (np.s_[:4, :3, :6], np.s_[1:, 1:, :6], np.s_[1:, :3, 1:])


def wave_case():
    """Random coefficients as kernels have them and at their wave numbers; projector, wave numbers and waves."""
    modes = np.random.default_rng(0).normal(size=(3, *SHAPE))
    numbers = [
        sign * np.pi * np.arange(n + 1.0) * (np.arange(n + 1) < n) for sign, n in zip((1, -1, -1), SHAPE, strict=True)
    ]
    free = [(np.arange(n + 1) == n).astype(float) for n in SHAPE]
    multiplicity = tuple(np.r_[1.0, np.full(n - 1, 2.0), 1.0] for n in SHAPE)
    gamma, k = projector(numbers, free)
    return modes, spread(modes), gamma, k, Waves(tuple(numbers), tuple(free), multiplicity)


def spread(modes):
    found = np.zeros((*(n + 1 for n in SHAPE), 3))
    for component, held in enumerate(HELD):
        found[(*held, component)] = modes[component]
    return found


def gathered(vectors):
    return np.stack([vectors[(*held, component)] for component, held in enumerate(HELD)])


def test_reflect_waves():
    modes, vectors, gamma, _, waves = wave_case()
    expected = SCALE * np.einsum("xyzab,xyzb->xyza", np.eye(3) - 2 * gamma, vectors)
    expected[0, 0, 0, 0] += MEAN[0]
    for low, high in chunks(SHAPE[0] + 1):
        kernels.reflect_waves(modes, waves, SCALE, MEAN, low, high)
    assert_allclose(modes, gathered(expected), atol=1e-14)  # Rounding of coefficients up to 3.


def test_split_waves():
    modes, vectors, gamma, _, waves = wave_case()
    inside = SCALE * np.einsum("xyzab,xyzb->xyza", gamma, vectors)
    outside = SCALE * vectors - inside
    outside[0, 0, 0, 0] -= MEAN[0]
    parts = Parts(np.full(SHAPE[0] + 1, np.nan), np.full(SHAPE[0] + 1, np.nan))
    for low, high in chunks(SHAPE[0] + 1):
        kernels.split_waves(modes, waves, SCALE, MEAN, parts, low, high)
    weight = np.einsum("i,j,k->ijk", *waves.multiplicity)[..., None]
    assert_allclose(parts.inside, np.sum(weight * inside**2, axis=(1, 2, 3)), rtol=1e-13)  # Rounding.
    assert_allclose(parts.outside, np.sum(weight * outside**2, axis=(1, 2, 3)), rtol=1e-13)
    inside[0, 0, 0, 0] += MEAN[0]
    assert_allclose(modes, gathered(inside), atol=1e-14)


def test_integrate_waves():
    modes, vectors, _, k, waves = wave_case()
    found = np.full((1, *SHAPE), np.nan)
    for low, high in chunks(SHAPE[0] + 1):
        kernels.integrate_waves(modes, found, waves, low, high)
    assert_allclose(found[0], potential(k, vectors, 1.0)[1:, :3, :6], atol=1e-14)  # Rounding.
