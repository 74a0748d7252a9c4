"""Numba kernels that project a vector field on gradients in Fourier space, Gamma = k k / k^2, mode by mode.

Kernels of `modes` are for the Fourier coefficients of a periodic cell, those of `waves` for the sine and cosine
coefficients of a box between isothermal walls.  They work on columns of modes, or on the planes low <= i < high of the
first axis, and are called once per thread or more often; sums are kept per column or plane, so the bits do not depend
on the threads.
"""

from typing import NamedTuple

import numba
import numpy as np

import demheat.runtime.compiled  # noqa: F401 (where compiled kernels are kept)

compiled = numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})


class Waves(NamedTuple):
    """What is known of each wave number; kernels that work on columns want every entry of x twice, see `Transform`."""

    # tuple of three float arrays, 1/m: Wave numbers per axis.  Modes: 0 at a Nyquist frequency.  Waves: those of 0 to n
    # half waves, the last one replaced by 0; those of y and z with a minus
    number: tuple
    # tuple of three float arrays: 1 where the component along this axis is a gradient by itself (a Nyquist frequency,
    # or n half waves), else 0
    free: tuple
    # tuple of three float arrays: How often each wave number counts in a sum of squares over all of them; the product
    # over the axes is a mode's
    multiplicity: tuple


class Parts(NamedTuple):
    """Sums of squares of the compatible part of a field, less its mean, and of the rest; per column or per plane."""

    # inside, outside: (columns or nx + 1,) float64 array: Of the field's unit squared
    inside: np.ndarray
    outside: np.ndarray


@compiled
def reflect_modes(rows, first, count, waves, scale, mean):
    """modes = scale (1 - 2 Gamma) modes + mean for Fourier coefficients.

    Gamma is real, so real and imaginary parts are treated alike.

    rows, first, count : see `sweeps.Transform.columns`; three components, W/m2, changed in place
    waves : Waves; entries of x twice
    scale : float
    mean : (3,) float array, W/m2; added to the mode of wave number 0
    """
    wave, free = waves.number, waves.free
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
def split_modes(rows, first, count, waves, scale, mean, parts):
    """Keep the compatible part of a field, scale Gamma v + mean, and measure both parts.

    rows, first, count : see `sweeps.Transform.columns`; three components of v, changed in place
    waves : Waves; entries of x twice
    scale : float
    mean : (3,) float array; added to the mode of wave number 0, in the unit of v
    parts : Parts; out, per column: sums of |Gamma v|^2 and of |v - Gamma v - mean|^2, scaled
    """
    wave, free = waves.number, waves.free
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
        parts.inside[first + r] = waves.multiplicity[2][k] * inside
        parts.outside[first + r] = waves.multiplicity[2][k] * outside
    if first == 0:
        for axis in range(3):
            rows[axis, 0, 0] += mean[axis]


@compiled
def integrate_modes(modes, potential, waves, low, high):
    """Potential of a compatible field, k.v / (i k^2), for complex Fourier coefficients.

    modes : (3, mx, my, mz) complex array, K/m
    potential : (1, mx, my, mz) complex array, K; out
    waves : Waves; entries of x once
    low, high : int; planes of modes
    """
    wave = waves.number
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
def reflect_waves(modes, waves, scale, mean, low, high):
    """Same as `reflect_modes` for the sine and cosine coefficients of a box with isothermal walls across x.

    The temperature is a sum of sin(a x) cos(b y) cos(c z), so its gradient is (a cos cos cos, -b sin sin cos,
    -c sin cos sin).  Coefficient i of a cosine belongs to wave number i, of a sine to i + 1; a component without the
    wave number counts as 0 there, and the slope of the highest sine is 0 at the voxel centres.

    modes : (3, nx, ny, nz) float array, W/m2; changed in place
    waves : Waves
    scale : float
    mean : (3,) float array, W/m2; its first component is added to the mode of wave number 0; a box knows no other
    low, high : int; wave numbers along x, of 0 to nx
    """
    wave, free = waves.number, waves.free
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
def split_waves(modes, waves, scale, mean, parts, low, high):
    """Same as `split_modes` for sine and cosine coefficients.

    modes, waves, scale, mean, low, high : see `reflect_waves`
    parts : Parts; out, per wave number along x
    """
    wave, free, multiplicity = waves.number, waves.free, waves.multiplicity
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
        parts.inside[i], parts.outside[i] = inside, outside
    if low == 0:
        modes[0, 0, 0, 0] += mean[0]


@compiled
def integrate_waves(modes, potential, waves, low, high):
    """Same as `integrate_modes` for sine and cosine coefficients.

    modes, waves, low, high : see `reflect_waves`
    potential : (1, nx, ny, nz) float array, K; out: plane i holds wave number i + 1
    """
    wave = waves.number
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
