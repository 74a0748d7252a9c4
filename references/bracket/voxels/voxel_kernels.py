"""Numba kernels of the energies of trilinear temperatures and of face fluxes on voxels, and of balancing the latter.

Kernels work on the planes low <= i < high of the first axis of a periodic grid, or on columns of modes; see
`references.fft.hexahedron_kernels`. Energies are means over the voxels, so that a unit load's is a conductivity.
"""

from typing import NamedTuple

import numpy as np

from references.fft.hexahedron_kernels import compiled


class Cells(NamedTuple):
    """A property of every voxel: the same all over it, or its products with the fields' shapes along the axes."""

    scalar: np.ndarray  # (nx, ny, nz) float array
    row: np.ndarray  # (nx, ny, nz) int32 array: Row of `table` for voxels in which the property varies, else -1
    # (m, 3, 3, 3) or (m, 3, 3) float array: Of conductivities, for each axis, means of the property times the pairs
    # (00, 01, 11) of linear shapes along the lower and along the higher of the two other axes. Of resistivities, for
    # each axis, those along the axis itself
    table: np.ndarray


@compiled
def conduct(theta, work, cells, load, energy, low, high):
    """Half the slope of the energy of a temperature.

    theta : (nx, ny, nz) float array, K; at the lower corner of each voxel, less the linear part
    work : (nx, ny, nz) float array; out
    cells : Cells; of conductivities
    load : (2, 3) float array; 1 / spacing, and the gradient of the linear part
    energy : (nx,) float array; out: the energy of each plane of voxels, times their number
    low, high : int; planes of `work` to fill
    """
    nx, ny, nz = theta.shape
    inverse, gradient = load[0], load[1]
    slope, flux, out = np.empty((3, 2, 2)), np.empty((3, 2, 2)), np.empty((2, 2, 2))
    for i in range(low, high):
        work[i] = 0.0
    for outer in range(low - 1, high):
        slab, above = outer % nx, (outer + 1) % nx
        total = 0.0
        for j in range(ny):
            jj = (j + 1) % ny
            for k in range(nz):
                kk = (k + 1) % nz
                a, b, c, d = theta[slab, j, k], theta[slab, j, kk], theta[slab, jj, k], theta[slab, jj, kk]
                e, f, g, h = theta[above, j, k], theta[above, j, kk], theta[above, jj, k], theta[above, jj, kk]
                slope[0, 0, 0], slope[0, 0, 1], slope[0, 1, 0], slope[0, 1, 1] = e - a, f - b, g - c, h - d
                slope[1, 0, 0], slope[1, 0, 1], slope[1, 1, 0], slope[1, 1, 1] = c - a, d - b, g - e, h - f
                slope[2, 0, 0], slope[2, 0, 1], slope[2, 1, 0], slope[2, 1, 1] = b - a, d - c, f - e, h - g
                for axis in range(3):
                    for m in range(2):
                        for n in range(2):
                            slope[axis, m, n] = slope[axis, m, n] * inverse[axis] + gradient[axis]
                row = cells.row[slab, j, k]
                if row < 0:
                    _uniform(slope, cells.scalar[slab, j, k], flux)
                else:
                    _varied(slope, cells.table[row], flux)
                for axis in range(3):
                    for m in range(2):
                        for n in range(2):
                            total += slope[axis, m, n] * flux[axis, m, n]
                            flux[axis, m, n] *= inverse[axis]
                for m in range(2):
                    for n in range(2):
                        out[0, m, n] = -flux[0, m, n]
                        out[1, m, n] = flux[0, m, n]
                for m in range(2):
                    for n in range(2):
                        out[m, 0, n] -= flux[1, m, n]
                        out[m, 1, n] += flux[1, m, n]
                        out[m, n, 0] -= flux[2, m, n]
                        out[m, n, 1] += flux[2, m, n]
                if outer >= low:
                    work[slab, j, k] += out[0, 0, 0]
                    work[slab, j, kk] += out[0, 0, 1]
                    work[slab, jj, k] += out[0, 1, 0]
                    work[slab, jj, kk] += out[0, 1, 1]
                if outer + 1 < high:
                    work[above, j, k] += out[1, 0, 0]
                    work[above, j, kk] += out[1, 0, 1]
                    work[above, jj, k] += out[1, 1, 0]
                    work[above, jj, kk] += out[1, 1, 1]
        if outer >= low:
            energy[slab] = total


@compiled
def _uniform(slope, conductivity, flux):
    """Flux on the edges of a voxel of one conductivity: means of products of shapes are (1 + same) / 6 each way."""
    part = conductivity / 36.0
    for axis in range(3):
        s = slope[axis]
        first, second = s[0, 0] + s[0, 1], s[1, 0] + s[1, 1]
        low, high = s[0, 0] + s[1, 0], s[0, 1] + s[1, 1]
        whole = first + second
        flux[axis, 0, 0] = part * (s[0, 0] + first + low + whole)
        flux[axis, 0, 1] = part * (s[0, 1] + first + high + whole)
        flux[axis, 1, 0] = part * (s[1, 0] + second + low + whole)
        flux[axis, 1, 1] = part * (s[1, 1] + second + high + whole)


@compiled
def _varied(slope, table, flux):
    for axis in range(3):
        for m in range(2):
            for n in range(2):
                total = 0.0
                for mm in range(2):
                    for nn in range(2):
                        total += table[axis, m + mm, n + nn] * slope[axis, mm, nn]
                flux[axis, m, n] = total


@compiled
def resist(flux, work, cells, low, high):
    """Half the slope of the energy of a flux.

    flux : (3, nx, ny, nz) float array; normal flux through the lower face of each voxel across each axis
    work : (3, nx, ny, nz) float array; out
    cells : Cells; of resistivities
    low, high : int; planes of `work` to fill
    """
    _, nx, ny, nz = flux.shape
    for i in range(low, high):
        ii, before = (i + 1) % nx, (i - 1) % nx
        for j in range(ny):
            jj = (j + 1) % ny
            for k in range(nz):
                kk = (k + 1) % nz
                same, cross, _ = _pairs(cells, i, j, k, 0)
                work[0, i, j, k] = same * flux[0, i, j, k] + cross * flux[0, ii, j, k]
                same, cross, _ = _pairs(cells, i, j, k, 1)
                work[1, i, j, k] = same * flux[1, i, j, k] + cross * flux[1, i, jj, k]
                same, cross, _ = _pairs(cells, i, j, k, 2)
                work[2, i, j, k] = same * flux[2, i, j, k] + cross * flux[2, i, j, kk]
                _, cross, same = _pairs(cells, before, j, k, 0)
                work[0, i, j, k] += same * flux[0, i, j, k] + cross * flux[0, before, j, k]
                _, cross, same = _pairs(cells, i, j - 1, k, 1)
                work[1, i, j, k] += same * flux[1, i, j, k] + cross * flux[1, i, j - 1, k]
                _, cross, same = _pairs(cells, i, j, k - 1, 2)
                work[2, i, j, k] += same * flux[2, i, j, k] + cross * flux[2, i, j, k - 1]


@compiled
def _pairs(cells, i, j, k, axis):
    row = cells.row[i, j, k]
    if row < 0:
        scalar = cells.scalar[i, j, k]
        return scalar / 3.0, scalar / 6.0, scalar / 3.0
    table = cells.table[row, axis]
    return table[0], table[1], table[2]


class Modes(NamedTuple):
    """Fourier modes of face fluxes."""

    # tuple of three (n, 2) float arrays: Real and imaginary part of (exp(i angle) - 1) / spacing, what the divergence
    # multiplies a mode by
    turn: tuple
    # tuple of three (n,) float arrays: What a mode's part of the energy of a unit resistivity is multiplied by: (2 +
    # cos angle) / 3; or 1
    mass: tuple
    held: np.ndarray  # (3,) float array: Direction along which the mean flux stays; 0 if it is to pass


@compiled
def balance(rows, first, count, modes, scale):
    """Of each mode the balanced flux for which the energy of a unit resistivity has the given slope, but for gradients.

    rows, first, count : see `references.fft.sweeps.Transform.columns`; three components, changed in place
    modes : Modes
    scale : float
    """
    turn, mass = modes.turn, modes.mass
    mz = len(mass[2])
    for r in range(count):
        j, k = divmod(first + r, mz)
        yr, yi, zr, zi = turn[1][j, 0], turn[1][j, 1], turn[2][k, 0], turn[2][k, 1]
        my, mm = 1.0 / mass[1][j], 1.0 / mass[2][k]
        across = (yr * yr + yi * yi) * my + (zr * zr + zi * zi) * mm
        for i in range(len(mass[0])):
            xr, xi, mx = turn[0][i, 0], turn[0][i, 1], 1.0 / mass[0][i]
            ar, ai = rows[0, r, 2 * i] * mx, rows[0, r, 2 * i + 1] * mx
            br, bi = rows[1, r, 2 * i] * my, rows[1, r, 2 * i + 1] * my
            cr, ci = rows[2, r, 2 * i] * mm, rows[2, r, 2 * i + 1] * mm
            whole = (xr * xr + xi * xi) * mx + across
            if whole > 0:
                sr = (xr * ar - xi * ai + yr * br - yi * bi + zr * cr - zi * ci) / whole
                si = (xr * ai + xi * ar + yr * bi + yi * br + zr * ci + zi * cr) / whole
                ar, ai = ar - (xr * sr + xi * si) * mx, ai - (xr * si - xi * sr) * mx
                br, bi = br - (yr * sr + yi * si) * my, bi - (yr * si - yi * sr) * my
                cr, ci = cr - (zr * sr + zi * si) * mm, ci - (zr * si - zi * sr) * mm
            else:
                along = modes.held[0] * ar + modes.held[1] * br + modes.held[2] * cr
                ar, br, cr = ar - along * modes.held[0], br - along * modes.held[1], cr - along * modes.held[2]
            rows[0, r, 2 * i], rows[0, r, 2 * i + 1] = scale * ar, scale * ai
            rows[1, r, 2 * i], rows[1, r, 2 * i + 1] = scale * br, scale * bi
            rows[2, r, 2 * i], rows[2, r, 2 * i + 1] = scale * cr, scale * ci
