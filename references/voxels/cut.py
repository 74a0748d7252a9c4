"""Voxels that surfaces cut: how much they hold of each phase, and what that conducts as a laminate."""

import numpy as np

from references.voxels import kernels
from references.voxels.slopes import MOST


def phase_parts(n_phases, rank, cuts, parent, background):
    """Fraction of each phase in each cut voxel, as (voxel, phase, fraction) columns.

    A voxel starts as its background; each surface in it moves its fraction from the phase it was painted on.
    """
    voxels = np.concatenate([np.arange(len(background)), rank, rank])
    phases = np.concatenate([background, cuts.phase, parent[cuts.phase]])
    moved = np.concatenate([np.ones(len(background)), cuts.fraction, -cuts.fraction])
    key, inverse = np.unique(voxels * n_phases + phases, return_inverse=True)
    total = np.bincount(inverse, moved)
    # Touching inclusions leave nothing of their background but rounding and quadrature error.
    total[total < kernels.FULL] = 0.0
    voxel = key // n_phases
    return voxel, key % n_phases, total / np.bincount(voxel, total)[voxel]


def laminate_tensors(part, conductivities, moment, slopes=None):
    """Tensors (number of cut voxels, 6): arithmetic mean in the tangent plane, harmonic mean along the normal.

    Where films let slopes of phases in the tangent plane differ, it is what they conduct there together, over the
    square of the slope that the corners see; both given as `slopes`, of phases and of cut voxels.
    """
    voxel, phase, fraction = part
    # A pore blocks the normal direction; the smallest normal number stands for its zero conductivity.
    resistance = fraction / np.maximum(conductivities[phase], np.finfo(float).tiny)
    arithmetic = np.bincount(voxel, fraction * conductivities[phase])
    if slopes is not None:
        own, seen = slopes
        most = np.zeros(len(moment))
        np.maximum.at(most, voxel, conductivities[phase])
        together = np.bincount(voxel, fraction * conductivities[phase] * own[phase] ** 2)
        arithmetic = np.minimum(together / seen**2, MOST * most)
    with np.errstate(over="ignore"):
        harmonic = 1.0 / np.bincount(voxel, resistance)
    direction = moment / moment[:, :3].sum(axis=1, keepdims=True)
    tensors = -(arithmetic - harmonic)[:, None] * direction
    tensors[:, :3] += arithmetic[:, None]
    return tensors
