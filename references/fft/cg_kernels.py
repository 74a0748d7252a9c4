"""Numba kernels of the scalar scheme: conduction through voxels or links, and the vector work of conjugate gradients.

Every kernel works on the planes low <= i < high of the first axis and is called once per thread.  An output plane is
summed in one order whatever the chunk, and sums are kept per plane, so the bits do not depend on the threads.
Arrays named `work` may be padded at the end of their last axis.
"""

from __future__ import annotations

import numba
import numpy as np

# Sums may be reordered and fused; NaN and infinity keep their meaning, so a diverging solve is noticed.
compiled = numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})


@compiled
def conduct_voxels(theta, work, medium, gradient, inverse, walls, sums, low, high):
    """Reduced-integration hexahedra: one temperature per corner, one gradient per voxel.

    Parameters
    ----------
    theta : (mx, my, mz) float array, K
        Temperature at the corners less the linear part.  Periodic: m = n.  Walls: mx = n - 1 (those on the two
        isothermal walls are zero and left out), my = ny + 1, mz = nz + 1.
    work : (mx, my, mz or more) float array
        Out: -div(q) at the corners, W/m3, as the sum over the voxels of B^T q.
    medium : Medium
    gradient : (3,) float array, K/m
        Linear part.
    inverse : (3,) float array, 1/m
        1 / (4 spacing).
    walls : bool
    sums : (nx, 5) float array
        Out, per plane of voxels: sums of g.q, q_x, q_y, q_z and q.q.
    low, high : int
        Planes of `work` to fill.
    """
    nx, ny, nz = medium.phase.shape
    mx, my, mz = theta.shape
    shift = 1 if walls else 0
    nothing = np.zeros((my, mz), theta.dtype)
    corner = np.empty((3, nz + 1), theta.dtype)
    slope = np.empty((3, nz), theta.dtype)
    flux = np.zeros((3, nz + 2), theta.dtype)
    for i in range(low, high):
        for j in range(my):
            for k in range(mz):
                work[i, j, k] = 0
    for outer in range(low + shift - 1, high + shift):
        slab, lower, upper = outer % nx, outer - shift, outer + 1 - shift
        below = nothing if walls and lower < 0 else theta[lower % mx]
        above = nothing if walls and upper >= mx else theta[upper % mx]
        # Two threads compute the slab between their chunks, so it is summed aside and both write the same result.
        found = np.zeros(5)
        for j in range(ny):
            jj = (j + 1) % my
            _slopes(below[j], below[jj], above[j], above[jj], corner, slope, gradient, inverse)
            _flux_row(slope, medium, slab, j, flux, found)
            for axis in range(3):
                for k in range(1, nz + 1):
                    flux[axis, k] *= inverse[axis]
                flux[axis, 0] = 0 if walls else flux[axis, nz]
            if low <= lower < high:
                _scatter(work[lower, j], work[lower, jj], flux, -1, mz)
            if low <= upper < high:
                _scatter(work[upper, j], work[upper, jj], flux, 1, mz)
        for item in range(5):
            sums[slab, item] = found[item]


# The compiler makes vector instructions of a loop only if it has few arrays to tell apart: hence so many small loops.


@compiled
def _slopes(a, b, c, d, corner, slope, gradient, inverse):
    """Gradient in a row of voxels from the temperatures along its four edges."""
    mz, nz = len(a), slope.shape[1]
    total, along_x, along_y = corner[0], corner[1], corner[2]
    for k in range(mz):
        total[k] = (a[k] + b[k]) + (c[k] + d[k])
    for k in range(mz):
        along_x[k] = (c[k] + d[k]) - (a[k] + b[k])
    for k in range(mz):
        along_y[k] = (b[k] + d[k]) - (a[k] + c[k])
    if mz == nz:
        for axis in range(3):
            corner[axis, nz] = corner[axis, 0]
    gx, gy, gz = slope[0], slope[1], slope[2]
    for k in range(nz):
        gx[k] = (along_x[k] + along_x[k + 1]) * inverse[0] + gradient[0]
    for k in range(nz):
        gy[k] = (along_y[k] + along_y[k + 1]) * inverse[1] + gradient[1]
    for k in range(nz):
        gz[k] = (total[k + 1] - total[k]) * inverse[2] + gradient[2]


@compiled
def _flux_row(slope, medium, i, j, flux, sums):
    """q = K g in a row of voxels, at entries 1 to nz of `flux`; adds to the sums."""
    phase, scalar = medium.phase[i, j], medium.scalar
    gx, gy, gz = slope[0], slope[1], slope[2]
    qx, qy, qz = flux[0, 1:], flux[1, 1:], flux[2, 1:]
    for k in range(len(phase)):
        qx[k] = scalar[phase[k]]
    for k in range(len(phase)):
        qz[k] = qx[k] * gz[k]
    for k in range(len(phase)):
        qy[k] = qx[k] * gy[k]
    for k in range(len(phase)):
        qx[k] *= gx[k]
    row = i * medium.phase.shape[1] + j
    for m in range(medium.start[row], medium.start[row + 1]):
        k, t = medium.place[m], medium.tensor[m]
        qx[k] = t[0] * gx[k] + t[5] * gy[k] + t[4] * gz[k]
        qy[k] = t[5] * gx[k] + t[1] * gy[k] + t[3] * gz[k]
        qz[k] = t[4] * gx[k] + t[3] * gy[k] + t[2] * gz[k]
    energy, square, flux_x, flux_y, flux_z = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(len(phase)):
        energy += qx[k] * gx[k] + qy[k] * gy[k] + qz[k] * gz[k]
        square += qx[k] * qx[k] + qy[k] * qy[k] + qz[k] * qz[k]
        flux_x += qx[k]
        flux_y += qy[k]
        flux_z += qz[k]
    sums[0] += energy
    sums[1] += flux_x
    sums[2] += flux_y
    sums[3] += flux_z
    sums[4] += square


@compiled
def _scatter(near, far, flux, side, mz):
    """Add B^T q of a row of voxels to the corners of one of its two planes; `side` is -1 below, 1 above in x."""
    qx, qy, qz = flux[0], flux[1], flux[2]
    for k in range(mz):
        near[k] += side * (qx[k] + qx[k + 1]) - (qy[k] + qy[k + 1]) + (qz[k] - qz[k + 1])
    for k in range(mz):
        far[k] += side * (qx[k] + qx[k + 1]) + (qy[k] + qy[k + 1]) + (qz[k] - qz[k + 1])


@compiled
def voxel_state(theta, medium, gradient, inverse, walls, center, flux, low, high):
    """Temperature and flux at the centre of every voxel, for `conduct_voxels`; low and high are planes of voxels.

    Parameters
    ----------
    center : (nx, ny, nz) float array, K
        Out: temperature less the linear part.
    flux : (3, nx, ny, nz) float array, W/m2
        Out: along the gradient, that is against Fourier's direction.
    """
    nx, ny, nz = medium.phase.shape
    mx, my, mz = theta.shape
    shift = 1 if walls else 0
    nothing = np.zeros((my, mz), theta.dtype)
    corner = np.empty((3, nz + 1), theta.dtype)
    slope = np.empty((3, nz), theta.dtype)
    row = np.zeros((3, nz + 2), theta.dtype)
    found = np.zeros(5)
    for i in range(low, high):
        below = nothing if walls and i == 0 else theta[i - shift]
        above = nothing if walls and i == nx - 1 else theta[(i + 1 - shift) % mx]
        for j in range(ny):
            jj = (j + 1) % my
            _slopes(below[j], below[jj], above[j], above[jj], corner, slope, gradient, inverse)
            _flux_row(slope, medium, i, j, row, found)
            for k in range(nz):
                center[i, j, k] = 0.125 * (corner[0, k] + corner[0, k + 1])
                for axis in range(3):
                    flux[axis, i, j, k] = row[axis, k + 1]


@compiled
def divide(rows, first, count, s, c, scale):
    """Divide each mode by sx cy cz + cx sy cz + cx cy sz, the symbol of minus the Laplacian; empty modes become 0.

    Parameters
    ----------
    rows, first, count : see `fft_sweeps.Transform.columns`
        One component, changed in place.
    s, c : tuples of three float arrays
        Per axis, that of x as wide as the rows; c = 1 gives the seven-point Laplacian.
    scale : float
    """
    mz = len(s[2])
    along, across = s[0], c[0]
    for r in range(count):
        j, k = divmod(first + r, mz)
        both, cross = c[1][j] * c[2][k], s[1][j] * c[2][k] + c[1][j] * s[2][k]
        row = rows[0, r]
        for i in range(len(row)):
            symbol = along[i] * both + across[i] * cross
            row[i] *= scale / symbol if symbol > 0 else 0 * scale


@compiled
def start(residual, work, wy, wz, low, high):
    """residual = -work; work = weighted residual, ready for the preconditioner.  Padding is left alone."""
    for i in range(low, high):
        for j in range(residual.shape[1]):
            r, w = residual[i, j], work[i, j]
            for k in range(len(r)):
                r[k] = -w[k]
            for k in range(len(r)):
                w[k] = r[k] * (wy[j] * wz[k])


@compiled
def step(theta, direction, residual, work, alpha, wy, wz, low, high):
    """theta += alpha direction; residual -= alpha work; work = weighted residual."""
    for i in range(low, high):
        for j in range(residual.shape[1]):
            t, p, r, w = theta[i, j], direction[i, j], residual[i, j], work[i, j]
            for k in range(len(r)):
                t[k] += alpha * p[k]
            for k in range(len(r)):
                r[k] -= alpha * w[k]
            for k in range(len(r)):
                w[k] = r[k] * (wy[j] * wz[k])


@compiled
def dot(residual, work, partial, low, high):
    """partial[i] = sum of residual * work over plane i."""
    for i in range(low, high):
        total = 0.0
        for j in range(residual.shape[1]):
            r, w = residual[i, j], work[i, j]
            for k in range(len(r)):
                total += r[k] * w[k]
        partial[i] = total


@compiled
def turn(direction, work, beta, low, high):
    """direction = work + beta direction."""
    for i in range(low, high):
        for j in range(direction.shape[1]):
            p, w = direction[i, j], work[i, j]
            for k in range(len(p)):
                p[k] = w[k] + beta * p[k]
