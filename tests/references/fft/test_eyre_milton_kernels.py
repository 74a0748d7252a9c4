"""What Eyre and Milton's scheme does in each voxel, beside products of whole arrays of matrices."""

import numpy as np
import pytest
from fft_kernel_cases import chunks, entries, padded, random_voxels
from numpy.testing import assert_allclose

from references.fft.eyre_milton_kernels import Sums, conduct, gradient, mirror, reflect
from references.voxels.paint import medium

pytestmark = pytest.mark.twin
SHAPE = (4, 3, 5)


def case():
    """A property as kernels read it, a field and new values for it, and what multiplies a field by the property."""
    voxels, full = random_voxels(SHAPE)
    field, work = np.random.default_rng(1).normal(size=(2, 3, *SHAPE))

    def product(vectors):
        return np.einsum("xyzab,bxyz->axyz", full, vectors)

    return medium(voxels, voxels.conductivity, voxels.tensor, float), field, padded(work), product


def test_mirror():
    voxels, full = random_voxels(SHAPE)
    tensor, eye = voxels.tensor.copy(), 0.8 * np.eye(3)
    mirror(tensor, 0.8)
    tensors = full.reshape(-1, 3, 3)[voxels.cut]
    # Rounding of matrices whose condition is below 100.
    assert_allclose(tensor, entries(np.linalg.solve(tensors + eye, tensors - eye)), atol=1e-13)


def test_reflect():
    z, field, work, product = case()
    new = work[..., : SHAPE[2]].copy()
    change, mirrored = new - field, product(new)
    sums = Sums(np.full(SHAPE[0], np.nan), np.full((SHAPE[0], 3), np.nan))
    for low, high in chunks(SHAPE[0]):
        reflect(field, work, z, sums, low, high)
    assert np.array_equal(field, new)
    # Rounding of sums of up to 45 numbers up to 20.
    assert_allclose(work[..., : SHAPE[2]], mirrored, atol=1e-13)
    assert_allclose(sums.change, np.sum(change**2, axis=(0, 2, 3)), rtol=1e-13)
    assert_allclose(sums.flux, np.sum(new + mirrored, axis=(2, 3)).T, atol=1e-12)
    assert np.all(np.isnan(work[..., SHAPE[2] :]))


def test_gradient():
    z, field, work, product = case()
    expected, kept = 0.6 * (field - product(field)), field.copy()
    for low, high in chunks(SHAPE[0]):
        gradient(field, work, z, 0.6, low, high)
    assert_allclose(work[..., : SHAPE[2]], expected, atol=1e-13)  # Rounding, as above.
    assert np.array_equal(field, kept)


def test_conduct():
    k, _, work, product = case()
    expected, flux = product(work[..., : SHAPE[2]]), np.full((SHAPE[0], 3), np.nan)
    for low, high in chunks(SHAPE[0]):
        conduct(work, k, flux, low, high)
    assert_allclose(work[..., : SHAPE[2]], expected, atol=1e-13)  # Rounding, as above.
    assert_allclose(flux, np.sum(expected, axis=(2, 3)).T, atol=1e-12)
