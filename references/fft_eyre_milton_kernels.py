"""Numba kernels of Eyre and Milton's scheme: the reflection in each voxel and the reflection in Fourier space.

Every kernel works on the planes low <= i < high of the first axis of a field and is called once per thread; sums are
kept per plane, so the bits do not depend on the threads.  Arrays named `work` may be padded along their last axis.
"""

from __future__ import annotations

import numba
import numpy as np

compiled = numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})


@compiled
def _multiply(medium, i, j, vector, result):
    """result = property * vector in a row of voxels; vector and result are (3, nz) rows."""
    nz = medium.phase.shape[2]
    phase, scalar = medium.phase[i, j], medium.scalar
    for axis in range(3):
        for k in range(nz):
            result[axis, k] = scalar[phase[k]] * vector[axis, k]
    row = i * medium.phase.shape[1] + j
    for m in range(medium.start[row], medium.start[row + 1]):
        k, t = medium.place[m], medium.tensor[m]
        x, y, z = vector[0, k], vector[1, k], vector[2, k]
        result[0, k] = t[0] * x + t[5] * y + t[4] * z
        result[1, k] = t[5] * x + t[1] * y + t[3] * z
        result[2, k] = t[4] * x + t[3] * y + t[2] * z


@compiled
def reflect(field, work, medium, sums, low, high):
    """Take the new field from `work`, and leave its reflection Z p there.

    Parameters
    ----------
    field : (3, nx, ny, nz) float array, W/m2
        p = q + c0 g; replaced by the new one.
    work : (3, nx, ny, nz or more) float array, W/m2
    medium : Medium
        Z = (K - c0) / (K + c0).
    sums : (nx, 4) float array
        Out, per plane: sum of the squared change of p, and sums of the components of p + Z p = 2 q.
    low, high : int
    """
    nz = field.shape[3]
    reflected = np.empty((3, nz), field.dtype)
    for i in range(low, high):
        sums[i] = 0.0
        for j in range(field.shape[2]):
            old, new = field[:, i, j], work[:, i, j]
            _multiply(medium, i, j, new, reflected)
            for axis in range(3):
                change, total = 0.0, 0.0
                for k in range(nz):
                    change += (new[axis, k] - old[axis, k]) ** 2
                    total += new[axis, k] + reflected[axis, k]
                for k in range(nz):
                    old[axis, k] = new[axis, k]
                    new[axis, k] = reflected[axis, k]
                sums[i, 0] += change
                sums[i, 1 + axis] += total


@compiled
def gradient(field, work, medium, factor, low, high):
    """work = factor (p - Z p), which is g for factor = 1 / (2 c0)."""
    nz = field.shape[3]
    reflected = np.empty((3, nz), field.dtype)
    for i in range(low, high):
        for j in range(field.shape[2]):
            _multiply(medium, i, j, field[:, i, j], reflected)
            for axis in range(3):
                for k in range(nz):
                    work[axis, i, j, k] = factor * (field[axis, i, j, k] - reflected[axis, k])


@compiled
def conduct(field, work, medium, sums, low, high):
    """field = work = K work; per plane the sums of q_x, q_y, q_z and g.q."""
    nz = field.shape[3]
    flux = np.empty((3, nz), field.dtype)
    for i in range(low, high):
        sums[i] = 0.0
        for j in range(field.shape[2]):
            _multiply(medium, i, j, work[:, i, j], flux)
            for axis in range(3):
                total, energy = 0.0, 0.0
                for k in range(nz):
                    total += flux[axis, k]
                    energy += flux[axis, k] * work[axis, i, j, k]
                for k in range(nz):
                    field[axis, i, j, k] = flux[axis, k]
                    work[axis, i, j, k] = flux[axis, k]
                sums[i, axis] += total
                sums[i, 3] += energy


@compiled
def reflect_modes(modes, wave, free, scale, mean, low, high):
    """modes = scale (1 - 2 Gamma) modes + mean, Gamma = k k / k^2, for complex Fourier coefficients.

    Parameters
    ----------
    modes : (3, mx, my, mz) complex array
        Changed in place.
    wave : tuple of three float arrays
        Wave numbers per axis, 0 at a Nyquist frequency.
    free : tuple of three float arrays
        Per axis: 1 at a Nyquist frequency, where the component along this axis is a gradient by itself, else 0.
    scale : float
    mean : (3,) float array
        Added to the mode of wave number 0.
    low, high : int
    """
    x, y, z = modes[0], modes[1], modes[2]
    for i in range(low, high):
        a = wave[0][i]
        for j in range(modes.shape[2]):
            b = wave[1][j]
            for k in range(modes.shape[3]):
                c = wave[2][k]
                square = a * a + b * b + c * c
                along = 2 * (a * x[i, j, k] + b * y[i, j, k] + c * z[i, j, k]) / (square if square > 0 else square + 1)
                x[i, j, k] = scale * (x[i, j, k] * (1 - 2 * free[0][i]) - a * along)
                y[i, j, k] = scale * (y[i, j, k] * (1 - 2 * free[1][j]) - b * along)
                z[i, j, k] = scale * (z[i, j, k] * (1 - 2 * free[2][k]) - c * along)
    if low == 0:
        for axis in range(3):
            modes[axis, 0, 0, 0] += mean[axis]


@compiled
def split_modes(modes, potential, wave, free, multiplicity, scale, mean, sums, low, high):
    """Keep the compatible part of a field, scale Gamma v + mean, and its potential; measure both parts.

    Parameters
    ----------
    modes : (3, mx, my, mz) complex array
        Changed in place.
    potential : (mx, my, mz) complex array
        Out.
    wave, free, scale, mean : see `reflect_modes`
    multiplicity : (mz,) float array
        How often each mode of the last axis counts in a sum over all modes.
    sums : (mx, 2) float array
        Out, per plane: sums of |Gamma v|^2 and of |v - Gamma v - mean|^2, scaled.
    low, high : int
    """
    x, y, z = modes[0], modes[1], modes[2]
    for i in range(low, high):
        a = wave[0][i]
        inside, outside = 0.0, 0.0
        for j in range(modes.shape[2]):
            b = wave[1][j]
            for k in range(modes.shape[3]):
                c = wave[2][k]
                square = a * a + b * b + c * c
                u, v, w = scale * x[i, j, k], scale * y[i, j, k], scale * z[i, j, k]
                along = (a * u + b * v + c * w) / (square if square > 0 else square + 1)
                if i == 0 and j == 0 and k == 0:
                    u, v, w = u - mean[0], v - mean[1], w - mean[2]
                x[i, j, k] = a * along + free[0][i] * u
                y[i, j, k] = b * along + free[1][j] * v
                z[i, j, k] = c * along + free[2][k] * w
                potential[i, j, k] = along * (-1j)
                kept = abs(x[i, j, k]) ** 2 + abs(y[i, j, k]) ** 2 + abs(z[i, j, k]) ** 2
                inside += multiplicity[k] * kept
                outside += multiplicity[k] * (
                    abs(u - x[i, j, k]) ** 2 + abs(v - y[i, j, k]) ** 2 + abs(w - z[i, j, k]) ** 2
                )
        sums[i, 0], sums[i, 1] = inside, outside
    if low == 0:
        for axis in range(3):
            modes[axis, 0, 0, 0] += mean[axis]


@compiled
def reflect_waves(modes, wave, free, scale, mean, low, high):
    """Same as `reflect_modes` for the sine and cosine coefficients of a box with isothermal walls across x.

    The temperature is a sum of sin(a x) cos(b y) cos(c z), so its gradient is (a cos cos cos, -b sin sin cos,
    -c sin cos sin).  Coefficient i of a cosine belongs to wave number i, of a sine to i + 1; a component without the
    wave number counts as 0 there, and the slope of the highest sine is 0 at the voxel centres.

    Parameters
    ----------
    modes : (3, nx, ny, nz) float array
        Changed in place.
    wave : tuple of three float arrays
        Wave numbers 0 to n per axis, the last one 0; those of y and z with a minus.
    free, scale, mean : see `reflect_modes`
    low, high : int
        Wave numbers along x, of 0 to nx.
    """
    nx, ny, nz = modes.shape[1:]
    for i in range(low, high):
        for j in range(ny + 1):
            for k in range(nz + 1):
                u, v, w = _wave(modes, i, j, k)
                a, b, c = wave[0][i], wave[1][j], wave[2][k]
                square = a * a + b * b + c * c
                along = 2 * (a * u + b * v + c * w) / (square if square > 0 else square + 1)
                u = scale * (u * (1 - 2 * free[0][i]) - a * along)
                v = scale * (v * (1 - 2 * free[1][j]) - b * along)
                w = scale * (w * (1 - 2 * free[2][k]) - c * along)
                _set_wave(modes, i, j, k, u, v, w)
    if low == 0:
        modes[0, 0, 0, 0] += mean[0]


@compiled
def split_waves(modes, potential, wave, free, multiplicity, scale, mean, sums, low, high):
    """Same as `split_modes` for sine and cosine coefficients; see `reflect_waves`.

    Parameters
    ----------
    multiplicity : tuple of three float arrays
        Weight of each wave number per axis in a sum of squares: 1 for the first and the last, else 2.
    """
    nx, ny, nz = modes.shape[1:]
    for i in range(low, high):
        inside, outside = 0.0, 0.0
        for j in range(ny + 1):
            for k in range(nz + 1):
                u, v, w = _wave(modes, i, j, k)
                u, v, w = scale * u, scale * v, scale * w
                a, b, c = wave[0][i], wave[1][j], wave[2][k]
                square = a * a + b * b + c * c
                along = (a * u + b * v + c * w) / (square if square > 0 else square + 1)
                if i == 0 and j == 0 and k == 0:
                    u -= mean[0]
                weight = multiplicity[0][i] * multiplicity[1][j] * multiplicity[2][k]
                x, y, z = a * along + free[0][i] * u, b * along + free[1][j] * v, c * along + free[2][k] * w
                inside += weight * (x**2 + y**2 + z**2)
                outside += weight * ((u - x) ** 2 + (v - y) ** 2 + (w - z) ** 2)
                _set_wave(modes, i, j, k, x, y, z)
                if i > 0 and j < ny and k < nz:
                    potential[i - 1, j, k] = along
        sums[i, 0], sums[i, 1] = inside, outside
    if low == 0:
        modes[0, 0, 0, 0] += mean[0]


@compiled
def _wave(modes, i, j, k):
    """The three components at one wave number."""
    nx, ny, nz = modes.shape[1:]
    zero = modes.dtype.type(0)
    u = modes[0, i, j, k] if i < nx and j < ny and k < nz else zero
    v = modes[1, i - 1, j - 1, k] if i > 0 and j > 0 and k < nz else zero
    w = modes[2, i - 1, j, k - 1] if i > 0 and j < ny and k > 0 else zero
    return u, v, w


@compiled
def _set_wave(modes, i, j, k, u, v, w):
    nx, ny, nz = modes.shape[1:]
    if i < nx and j < ny and k < nz:
        modes[0, i, j, k] = u
    if i > 0 and j > 0 and k < nz:
        modes[1, i - 1, j - 1, k] = v
    if i > 0 and j < ny and k > 0:
        modes[2, i - 1, j, k - 1] = w
