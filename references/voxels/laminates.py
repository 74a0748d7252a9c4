"""Voxels of phases whose conductivity is a tensor: laminates of tensors, and every such voxel with its own.

In a laminate with the normal n the gradient along the layers and the flux n.q across them are the same in all. With
the means <.> over the layers, and t = K n / (n.K n), K = <K - t (n.K n) t> + <t> <t> / <1 / (n.K n)> (Milton, The
Theory of Composites, 2002, chapter 9). On a curved or a second interface it is the mean of the laminates along the
principal directions of n n over the surface inside the voxel, by their shares: of phases that conduct alike all round
that is the formula of `references.voxels.paint`.
"""

import numpy as np

# Axes of the entries of a tensor, as `references.voxels.paint` has them.
ROWS, COLUMNS = np.array([0, 1, 2, 1, 0, 0]), np.array([0, 1, 2, 2, 2, 1])
PLACES = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])


def packed(tensors) -> np.ndarray:
    """Tensors (..., 3, 3) by their entries xx, yy, zz, yz, xz, xy, (..., 6)."""
    return tensors[..., ROWS, COLUMNS]


def unpacked(entries) -> np.ndarray:
    """Tensors (..., 3, 3) of entries xx, yy, zz, yz, xz, xy, (..., 6)."""
    return entries[..., PLACES]


def laminated(rank, fraction, tensors, normals) -> np.ndarray:
    """Conductivities of laminates."""
    count, n = len(normals), normals[rank]
    # The smallest normal number stands for a pore's zero.
    empty = ~tensors.any(axis=(1, 2))
    tensors = np.where(empty[:, None, None], np.finfo(float).tiny * np.eye(3), tensors)
    along = np.einsum("mij,mj->mi", tensors, n)
    across = np.einsum("mi,mi->m", along, n)
    turned = along / across[:, None]
    rest = tensors - turned[:, :, None] * along[:, None, :]
    weighted = fraction[:, None]
    mean = np.stack([np.bincount(rank, c, count) for c in (weighted * rest.reshape(-1, 9)).T], axis=1)
    slope = np.stack([np.bincount(rank, c, count) for c in (weighted * turned).T], axis=1)
    with np.errstate(over="ignore"):
        series = 1.0 / np.bincount(rank, fraction / across, count)
    return mean.reshape(-1, 3, 3) + series[:, None, None] * slope[:, :, None] * slope[:, None, :]


def cut_tensors(part, tensors, moment) -> np.ndarray:
    """Conductivities of cut voxels."""
    voxel, phase, fraction = part
    shares, directions = np.linalg.eigh(unpacked(moment / moment[:, :3].sum(axis=1, keepdims=True)))
    total = np.zeros((len(moment), 3, 3))
    for axis in range(3):
        share = shares[:, axis, None, None]
        total += share * laminated(voxel, fraction, tensors[phase], directions[:, :, axis])
    return packed(total)


def with_own(voxels):
    """The same voxels where every one that a tensor's phase fills has a tensor of its own, as cut ones do."""
    bent = np.any(voxels.tensors != voxels.conductivity[:, None] * [1, 1, 1, 0, 0, 0], axis=1)
    marked = bent[voxels.phase.reshape(-1)]
    marked[voxels.cut] = True
    own = np.flatnonzero(marked)
    tensor = voxels.tensors[voxels.phase.reshape(-1)[own]]
    tensor[np.searchsorted(own, voxels.cut)] = voxels.tensor
    return voxels._replace(cut=own, tensor=tensor)
