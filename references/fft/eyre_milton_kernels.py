"""Numba kernels of Eyre and Milton's scheme: the reflection in each voxel; `projection_kernels` has the other one.

Every kernel works on the planes low <= i < high of the first axis of a field and is called once per thread or more
often; sums are kept per plane, so the bits do not depend on the threads.  Arrays named `work` may be padded along their
last axis.
"""

from typing import NamedTuple

import numba
import numpy as np

import demheat.runtime.compiled  # noqa: F401 (where compiled kernels are kept)

compiled = numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})


class Sums(NamedTuple):
    """Sums over each plane of voxels."""

    change: np.ndarray  # (nx,) float64 array, W2/m4: Of the squared change of p
    flux: np.ndarray  # (nx, 3) float64 array, W/m2: Of p + Z p = 2 q


@compiled
def mirror(tensor, reference):
    """(K + c0)^-1 (K - c0) of symmetric tensors.

    tensor : (m, 6) float array, W/(m K); K, replaced by the result, which has no unit; order xx, yy, zz, yz, xz, xy
    reference : float, W/(m K); c0
    """
    for m in range(len(tensor)):
        t = tensor[m]
        xx, yy, zz, yz, xz, xy = t[0] + reference, t[1] + reference, t[2] + reference, t[3], t[4], t[5]
        # Cofactors; the matrix is positive definite.
        a, b, c = yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy
        d, e, f = xz * xy - xx * yz, xy * yz - yy * xz, xz * yz - zz * xy
        twice = 2 * reference / (xx * a + xy * f + xz * e)
        t[0], t[1], t[2] = 1 - twice * a, 1 - twice * b, 1 - twice * c
        t[3], t[4], t[5] = -twice * d, -twice * e, -twice * f


# The compiler makes vector instructions of a loop only if it has few arrays to tell apart: hence so many small loops.


@compiled
def _multiply(medium, i, j, x, y, z, result):
    """result = property * vector in a row of voxels: three rows x, y, z and a (3, nz) array."""
    phase, scalar = medium.phase[i, j], medium.scalar
    u, v, w = result[0], result[1], result[2]
    for k in range(len(phase)):
        u[k] = scalar[phase[k]]
    for k in range(len(phase)):
        w[k] = u[k] * z[k]
    for k in range(len(phase)):
        v[k] = u[k] * y[k]
    for k in range(len(phase)):
        u[k] *= x[k]
    row = i * medium.phase.shape[1] + j
    for m in range(medium.start[row], medium.start[row + 1]):
        k, t = medium.place[m], medium.tensor[m]
        u[k] = t[0] * x[k] + t[5] * y[k] + t[4] * z[k]
        v[k] = t[5] * x[k] + t[1] * y[k] + t[3] * z[k]
        w[k] = t[4] * x[k] + t[3] * y[k] + t[2] * z[k]


@compiled
def reflect(field, work, medium, sums, low, high):
    """Take the new field from `work`, and leave its reflection Z p there.

    field : (3, nx, ny, nz) float array, W/m2; p = q + c0 g; replaced by the new one
    work : (3, nx, ny, nz or more) float array, W/m2
    medium : Medium; Z = (K - c0) / (K + c0)
    sums : Sums; out
    low, high : int
    """
    nz = field.shape[3]
    reflected = np.empty((3, nz), field.dtype)
    for i in range(low, high):
        sums.change[i] = 0.0
        sums.flux[i] = 0.0
        for j in range(field.shape[2]):
            _multiply(medium, i, j, work[0, i, j], work[1, i, j], work[2, i, j], reflected)
            for axis in range(3):
                old, new, mirrored = field[axis, i, j], work[axis, i, j], reflected[axis]
                change, total = 0.0, 0.0
                for k in range(nz):
                    change += (new[k] - old[k]) ** 2
                for k in range(nz):
                    total += new[k] + mirrored[k]
                for k in range(nz):
                    old[k] = new[k]
                for k in range(nz):
                    new[k] = mirrored[k]
                sums.change[i] += change
                sums.flux[i, axis] += total


@compiled
def gradient(field, work, medium, factor, low, high):
    """work = factor (p - Z p), which is g for factor = 1 / (2 c0).

    field : (3, nx, ny, nz) float array, W/m2; p
    work : (3, nx, ny, nz or more) float array, K/m; out
    medium : Medium; Z
    factor : float, m K/W
    low, high : int
    """
    nz = field.shape[3]
    reflected = np.empty((3, nz), field.dtype)
    for i in range(low, high):
        for j in range(field.shape[2]):
            _multiply(medium, i, j, field[0, i, j], field[1, i, j], field[2, i, j], reflected)
            for axis in range(3):
                p, g, mirrored = field[axis, i, j], work[axis, i, j], reflected[axis]
                for k in range(nz):
                    g[k] = factor * (p[k] - mirrored[k])


@compiled
def conduct(work, medium, flux, low, high):
    """work = K work.

    work : (3, nx, ny, nz or more) float array; gradient g, K/m; replaced by the flux q along it, W/m2
    medium : Medium; K, W/(m K)
    flux : (nx, 3) float64 array, W/m2; out: sums of q over each plane
    low, high : int
    """
    nz = medium.phase.shape[2]
    row = np.empty((3, nz), work.dtype)
    for i in range(low, high):
        flux[i] = 0.0
        for j in range(work.shape[2]):
            _multiply(medium, i, j, work[0, i, j], work[1, i, j], work[2, i, j], row)
            for axis in range(3):
                q, target = row[axis], work[axis, i, j]
                total = 0.0
                for k in range(nz):
                    total += q[k]
                for k in range(nz):
                    target[k] = q[k]
                flux[i, axis] += total
