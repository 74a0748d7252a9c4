"""Numba kernels of conduction through voxels: hexahedra with one integration point, one temperature per corner.

Every kernel works on the planes low <= i < high of the first axis and is called once per thread.  An output plane is
summed in one order whatever the chunk, and sums are kept per plane, so the bits do not depend on the threads.
Arrays named `work` may be padded at the end of their last axis.
"""

from typing import NamedTuple

import numba
import numpy as np

import demheat.runtime.compiled  # noqa: F401 (where compiled kernels are kept)

# Sums may be reordered and fused; NaN and infinity keep their meaning, so a diverging solve is noticed.
compiled = numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})


class Body(NamedTuple):
    """What conducts, and the load's kind."""

    material: NamedTuple  # Medium or Links, W/(m K)
    inverse: np.ndarray  # (3,) float array, 1/m: 1 / (4 spacing) for voxels, 1 / spacing for links
    walls: bool  # Two isothermal walls across the first axis and four insulated ones; else a periodic cell


class Sums(NamedTuple):
    """Sums over each plane of voxels of products of the gradient g and the flux q along it."""

    energy: np.ndarray  # (nx,) float64 array, W K/m3: Of g.q
    flux: np.ndarray  # (nx, 3) float64 array, W/m2: Of q


@compiled
def conduct_voxels(theta, work, body, gradient, sums, low, high):
    """Reduced-integration hexahedra: one temperature per corner, one gradient per voxel.

    theta : (mx, my, mz) float array, K; temperature at the corners less the linear part, see `cg_kernels.Vectors`
    work : (mx, my, mz or more) float array, W/m3; out: -div(q) at the corners, as the sum over the voxels of B^T q
    body : Body; of a `Medium`
    gradient : (3,) float array, K/m; linear part
    sums : Sums; out
    low, high : int; planes of `work` to fill
    """
    medium, inverse, walls = body.material, body.inverse, body.walls
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
        energy, along_x, along_y, along_z = 0.0, 0.0, 0.0, 0.0
        for j in range(ny):
            jj = (j + 1) % my
            _slopes(below[j], below[jj], above[j], above[jj], corner, slope, gradient, inverse)
            found, x, y, z = _flux_row(slope, medium, slab, j, flux)
            energy, along_x, along_y, along_z = energy + found, along_x + x, along_y + y, along_z + z
            for axis in range(3):
                for k in range(1, nz + 1):
                    flux[axis, k] *= inverse[axis]
                flux[axis, 0] = 0 if walls else flux[axis, nz]
            if low <= lower < high:
                _scatter(work[lower, j], work[lower, jj], flux, -1, mz)
            if low <= upper < high:
                _scatter(work[upper, j], work[upper, jj], flux, 1, mz)
        sums.energy[slab] = energy
        sums.flux[slab, 0], sums.flux[slab, 1], sums.flux[slab, 2] = along_x, along_y, along_z


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
def _flux_row(slope, medium, i, j, flux):
    """q = K g in a row of voxels, at entries 1 to nz of `flux`; returns the sums of g.q, q_x, q_y and q_z."""
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
    energy, flux_x, flux_y, flux_z = 0.0, 0.0, 0.0, 0.0
    for k in range(len(phase)):
        energy += qx[k] * gx[k] + qy[k] * gy[k] + qz[k] * gz[k]
        flux_x += qx[k]
        flux_y += qy[k]
        flux_z += qz[k]
    return energy, flux_x, flux_y, flux_z


@compiled
def _scatter(near, far, flux, side, mz):
    """Add B^T q of a row of voxels to the corners of one of its two planes; `side` is -1 below, 1 above in x."""
    qx, qy, qz = flux[0], flux[1], flux[2]
    for k in range(mz):
        near[k] += side * (qx[k] + qx[k + 1]) - (qy[k] + qy[k + 1]) + (qz[k] - qz[k + 1])
    for k in range(mz):
        far[k] += side * (qx[k] + qx[k + 1]) + (qy[k] + qy[k + 1]) + (qz[k] - qz[k + 1])


@compiled
def voxel_state(theta, body, gradient, center, flux, low, high):
    """Temperature and flux at the centre of every voxel, for `conduct_voxels`.

    theta, body, gradient : see `conduct_voxels`
    center : (nx, ny, nz) float array, K; out: temperature less the linear part
    flux : (3, nx, ny, nz) float array, W/m2; out: along the gradient, that is against Fourier's direction
    low, high : int; planes of voxels to fill
    """
    medium, inverse, walls = body.material, body.inverse, body.walls
    nx, ny, nz = medium.phase.shape
    mx, my, mz = theta.shape
    shift = 1 if walls else 0
    nothing = np.zeros((my, mz), theta.dtype)
    corner = np.empty((3, nz + 1), theta.dtype)
    slope = np.empty((3, nz), theta.dtype)
    row = np.zeros((3, nz + 2), theta.dtype)
    for i in range(low, high):
        below = nothing if walls and i == 0 else theta[i - shift]
        above = nothing if walls and i == nx - 1 else theta[(i + 1 - shift) % mx]
        for j in range(ny):
            jj = (j + 1) % my
            _slopes(below[j], below[jj], above[j], above[jj], corner, slope, gradient, inverse)
            _flux_row(slope, medium, i, j, row)
            for k in range(nz):
                center[i, j, k] = 0.125 * (corner[0, k] + corner[0, k + 1])
                for axis in range(3):
                    flux[axis, i, j, k] = row[axis, k + 1]
