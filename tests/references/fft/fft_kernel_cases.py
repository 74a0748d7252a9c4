"""Random voxels for the twins of kernels: nothing compiled has touched them."""

import numpy as np

from references.voxels.paint import Voxels


def random_voxels(shape):
    """Three phases and tensors in a third of the voxels; the conductivity of each as a matrix, (nx, ny, nz, 3, 3)."""
    rng = np.random.default_rng(0)
    phase = rng.integers(0, 3, shape).astype(np.uint16)
    conductivity = np.array([1.0, 7.0, 0.2])
    cut = np.sort(rng.choice(phase.size, phase.size // 3, replace=False))
    root = rng.normal(size=(len(cut), 3, 3))
    tensors = root @ np.swapaxes(root, 1, 2) + 0.1 * np.eye(3)
    full = conductivity[phase][..., None, None] * np.eye(3)
    full.reshape(-1, 3, 3)[cut] = tensors
    spacing, fractions = np.array([0.3, 0.2, 0.5]), np.bincount(phase.ravel()) / phase.size
    return Voxels(spacing, phase, conductivity, cut, entries(tensors), fractions), full


def entries(tensors):
    """Entries xx, yy, zz, yz, xz, xy of symmetric matrices, (m, 3, 3) -> (m, 6)."""
    return tensors[:, [0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]


def padded(values):
    """A copy with two more entries along the last axis, not a number, as the arrays named `work` may have."""
    return np.concatenate([values, np.full((*values.shape[:-1], 2), np.nan)], axis=-1)


def chunks(count):
    """Two ranges that make up range(count), the first as short as can be."""
    return ((0, 1), (1, count))
