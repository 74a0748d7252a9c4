"""Numba kernels of Eyre and Milton's scheme: the reflection in each voxel and the reflection in Fourier space.

Every kernel works on the planes low <= i < high of the first axis of a field, or on columns of modes, and is called
once per thread or more often; sums are kept per plane or column, so the bits do not depend on the threads.  Arrays
named `work` may be padded along their last axis.
"""

from __future__ import annotations

import numba
import numpy as np

compiled = numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})


@compiled
def mirror(tensor, reference):
    """(K + c0)^-1 (K - c0) of symmetric tensors in place, (m, 6) float array in the order xx, yy, zz, yz, xz, xy."""
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
                sums[i, 0] += change
                sums[i, 1 + axis] += total


@compiled
def gradient(field, work, medium, factor, low, high):
    """work = factor (p - Z p), which is g for factor = 1 / (2 c0)."""
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
def conduct(work, medium, sums, low, high):
    """work = K work; per plane the sums of q_x, q_y and q_z."""
    nz = medium.phase.shape[2]
    flux = np.empty((3, nz), work.dtype)
    for i in range(low, high):
        sums[i] = 0.0
        for j in range(work.shape[2]):
            _multiply(medium, i, j, work[0, i, j], work[1, i, j], work[2, i, j], flux)
            for axis in range(3):
                q, target = flux[axis], work[axis, i, j]
                total = 0.0
                for k in range(nz):
                    total += q[k]
                for k in range(nz):
                    target[k] = q[k]
                sums[i, axis] += total


@compiled
def reflect_modes(rows, first, count, wave, free, scale, mean):
    """modes = scale (1 - 2 Gamma) modes + mean, Gamma = k k / k^2, for Fourier coefficients.

    Gamma is real, so real and imaginary parts are treated alike.

    Parameters
    ----------
    rows, first, count : see `fft_sweeps.Transform.columns`
        Three components, changed in place.
    wave : tuple of three float arrays
        Wave numbers per axis, 0 at a Nyquist frequency; those of x twice each, as the rows have them.
    free : tuple of three float arrays
        Per axis: 1 at a Nyquist frequency, where the component along this axis is a gradient by itself, else 0.
    scale : float
    mean : (3,) float array
        Added to the mode of wave number 0.
    """
    mz, a, edge = len(wave[2]), wave[0], free[0]
    share = np.empty_like(a)
    one = share.dtype.type(1)
    two = one + one
    for r in range(count):
        j, k = divmod(first + r, mz)
        b, c = wave[1][j], wave[2][k]
        keep_y, keep_z = scale * (one - two * free[1][j]), scale * (one - two * free[2][k])
        rest = b * b + c * c
        x, y, z = rows[0, r], rows[1, r], rows[2, r]
        for i in range(len(a)):
            square = a[i] * a[i] + rest
            share[i] = two * scale * (a[i] * x[i] + b * y[i] + c * z[i]) / (square if square > 0 else one)
        for i in range(len(a)):
            x[i] = scale * x[i] * (one - two * edge[i]) - a[i] * share[i]
        for i in range(len(a)):
            y[i] = keep_y * y[i] - b * share[i]
        for i in range(len(a)):
            z[i] = keep_z * z[i] - c * share[i]
    if first == 0:
        for axis in range(3):
            rows[axis, 0, 0] += mean[axis]


@compiled
def split_modes(rows, first, count, wave, free, multiplicity, scale, mean, sums):
    """Keep the compatible part of a field, scale Gamma v + mean, and measure both parts.

    Parameters
    ----------
    rows, first, count : see `fft_sweeps.Transform.columns`
        Three components, changed in place.
    wave, free, scale, mean : see `reflect_modes`
    multiplicity : (mz,) float array
        How often each mode of the last axis counts in a sum over all modes.
    sums : (my * mz, 2) float array
        Out, per column: sums of |Gamma v|^2 and of |v - Gamma v - mean|^2, scaled.
    """
    mz, a = len(wave[2]), wave[0]
    one = a.dtype.type(1)
    for r in range(count):
        j, k = divmod(first + r, mz)
        b, c = wave[1][j], wave[2][k]
        x, y, z = rows[0, r], rows[1, r], rows[2, r]
        inside, outside = 0.0, 0.0
        for i in range(len(a)):
            square = a[i] * a[i] + b * b + c * c
            u, v, w = scale * x[i], scale * y[i], scale * z[i]
            along = (a[i] * u + b * v + c * w) / (square if square > 0 else one)
            if i == 0 and first + r == 0:
                u, v, w = u - mean[0], v - mean[1], w - mean[2]
            x[i] = a[i] * along + free[0][i] * u
            y[i] = b * along + free[1][j] * v
            z[i] = c * along + free[2][k] * w
            inside += x[i] ** 2 + y[i] ** 2 + z[i] ** 2
            outside += (u - x[i]) ** 2 + (v - y[i]) ** 2 + (w - z[i]) ** 2
        sums[first + r, 0] = multiplicity[k] * inside
        sums[first + r, 1] = multiplicity[k] * outside
    if first == 0:
        for axis in range(3):
            rows[axis, 0, 0] += mean[axis]


@compiled
def integrate_modes(modes, potential, wave, low, high):
    """Potential of a compatible field, k.v / (i k^2), for complex Fourier coefficients.

    Parameters
    ----------
    modes : (3, mx, my, mz) complex array
    potential : (1, mx, my, mz) complex array
        Out.
    wave : see `reflect_modes`; but those of x once each
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
                along = (a * x[i, j, k] + b * y[i, j, k] + c * z[i, j, k]) / (square if square > 0 else square + 1)
                potential[0, i, j, k] = along * (-1j)


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
def split_waves(modes, wave, free, multiplicity, scale, mean, sums, low, high):
    """Same as `split_modes` for sine and cosine coefficients; see `reflect_waves`.

    Parameters
    ----------
    multiplicity : tuple of three float arrays
        Weight of each wave number per axis in a sum of squares: 1 for the first and the last, else 2.
    sums : (nx + 1, 2) float array
        Out, per wave number along x.
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
        sums[i, 0], sums[i, 1] = inside, outside
    if low == 0:
        modes[0, 0, 0, 0] += mean[0]


@compiled
def integrate_waves(modes, potential, wave, low, high):
    """Same as `integrate_modes` for sine and cosine coefficients; see `reflect_waves`.

    Parameters
    ----------
    potential : (1, nx, ny, nz) float array
        Out: plane i holds wave number i + 1.
    """
    _, ny, nz = modes.shape[1:]
    for i in range(max(low, 1), high):
        for j in range(ny):
            for k in range(nz):
                u, v, w = _wave(modes, i, j, k)
                a, b, c = wave[0][i], wave[1][j], wave[2][k]
                square = a * a + b * b + c * c
                potential[0, i - 1, j, k] = (a * u + b * v + c * w) / (square if square > 0 else square + 1)


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
