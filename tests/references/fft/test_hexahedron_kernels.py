"""Conduction through voxels beside its definition: dense matrices of the gradient and the mean in each voxel."""

import itertools

import numpy as np
import pytest
from fft_kernel_cases import chunks, padded, random_voxels
from numpy.testing import assert_allclose

from references.fft.hexahedron_kernels import Body, Sums, conduct_voxels, voxel_state
from references.voxels.paint import medium

pytestmark = pytest.mark.twin
SHAPE = (4, 3, 5)
LOAD = np.array([0.3, -0.2, 0.5])


def corner_matrices(spacing, walls):
    """Temperatures at the nodes to the gradient and to the mean temperature of each voxel, by its eight corners."""
    nodes = (SHAPE[0] - 1, SHAPE[1] + 1, SHAPE[2] + 1) if walls else SHAPE
    gradient, mean = np.zeros((*SHAPE, 3, *nodes)), np.zeros((*SHAPE, *nodes))
    for voxel in np.ndindex(*SHAPE):
        for corner in itertools.product((0, 1), repeat=3):
            node = [v + c for v, c in zip(voxel, corner, strict=True)]
            if walls:
                node[0] -= 1
                if not 0 <= node[0] < nodes[0]:  # On a wall, where it is 0.
                    continue
            else:
                node = [n % m for n, m in zip(node, SHAPE, strict=True)]
            mean[(*voxel, *node)] += 1 / 8
            for axis in range(3):
                gradient[(*voxel, axis, *node)] += (2 * corner[axis] - 1) / (4 * spacing[axis])
    return gradient, mean


def solved(walls):
    """Voxels as kernels read them, temperatures, and by the definition: gradient, flux, divergence, mean."""
    voxels, full = random_voxels(SHAPE)
    gradient, mean = corner_matrices(voxels.spacing, walls)
    theta = np.random.default_rng(1).random(gradient.shape[4:])
    slope = np.tensordot(gradient, theta, 3) + LOAD
    flux = np.einsum("xyzab,xyzb->xyza", full, slope)
    material = medium(voxels, voxels.conductivity, voxels.tensor, float)
    body = Body(material, 0.25 / voxels.spacing, walls)
    return body, theta, slope, flux, np.tensordot(flux, gradient, 4), np.tensordot(mean, theta, 3)


@pytest.mark.parametrize("walls", [False, True])
def test_conduct_voxels(walls):
    body, theta, slope, flux, expected, _ = solved(walls)
    work, sums = padded(np.full(theta.shape, np.nan)), Sums(np.full(SHAPE[0], np.nan), np.full((SHAPE[0], 3), np.nan))
    for low, high in chunks(len(theta)):
        conduct_voxels(theta, work, body, LOAD, sums, low, high)
    # Rounding of sums of some hundred numbers up to 40.
    assert_allclose(work[..., : theta.shape[2]], expected, atol=1e-12)
    assert_allclose(sums.energy, np.sum(flux * slope, axis=(1, 2, 3)), rtol=1e-13)
    assert_allclose(sums.flux, np.sum(flux, axis=(1, 2)), atol=1e-12)
    assert np.all(np.isnan(work[..., theta.shape[2] :]))


@pytest.mark.parametrize("walls", [False, True])
def test_voxel_state(walls):
    body, theta, _, expected, _, mean = solved(walls)
    center, flux = np.full(SHAPE, np.nan), np.full((3, *SHAPE), np.nan)
    for low, high in chunks(SHAPE[0]):
        voxel_state(theta, body, LOAD, center, flux, low, high)
    # Rounding: a voxel sums eight temperatures below 1, and multiplies slopes up to 10 by conductivities up to 10.
    assert_allclose(center, mean, atol=1e-15)
    assert_allclose(flux, np.moveaxis(expected, 3, 0), atol=1e-13)
