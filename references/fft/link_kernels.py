"""Numba kernels of the seven-point scheme: conduction through links between neighbouring voxel centres.

See `fft_cg_kernels` for what `low`, `high`, `sums` and `work` are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from references.fft.cg_kernels import compiled


class Links(NamedTuple):
    """Conductivity of the links between neighbouring voxel centres, harmonic mean along each, W/(m K).

    Link i of an axis joins voxels i - 1 and i.  The first and the last pass through the face: the same link twice in
    a periodic cell, mirrored in an isothermal wall, 0 in an insulated one.

    Attributes
    ----------
    x : (nx + 1, ny, nz) float array
    y : (nx, ny + 1, nz) float array
    z : (nx, ny, nz + 1) float array
    """

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray


@compiled
def conduct_links(theta, work, links, gradient, inverse, walls, sums, low, high):
    """Seven-point differences: one temperature per voxel centre, one conductivity per link between neighbours.

    Parameters
    ----------
    theta : (nx, ny, nz) float array, K
        Temperature at the voxel centres less the linear part; the isothermal walls are those across x.
    work : (nx, ny, nz or more) float array
        Out: -div(q), W/m3.
    links : Links
    gradient : (3,) float array, K/m
    inverse : (3,) float array, 1/m
        1 / spacing.
    walls : bool
    sums : (nx, 5) float array
        Out, per plane of voxels: sums of g.q, q_x, q_y, q_z and q.q; each link counts half on either side.
    low, high : int
        Planes of `work` to fill.
    """
    nx, ny, nz = theta.shape
    flux = np.empty((6, nz), theta.dtype)
    for i in range(low, high):
        found = np.zeros(5)
        for j in range(ny):
            _link_fluxes(theta, links, gradient, inverse, walls, i, j, flux, found)
            row = work[i, j]
            for k in range(nz):
                row[k] = (flux[0, k] - flux[1, k]) * inverse[0]
            for k in range(nz):
                row[k] += (flux[2, k] - flux[3, k]) * inverse[1]
            for k in range(nz):
                row[k] += (flux[4, k] - flux[5, k]) * inverse[2]
        for item in range(5):
            sums[i, item] = found[item]


@compiled
def _link_fluxes(theta, links, gradient, inverse, walls, i, j, flux, sums):
    """Fluxes through the six links of each voxel in a row: below and above along x, y, z."""
    nx, ny, nz = theta.shape
    here = theta[i, j]
    # A mirrored neighbour is the voxel itself with its sign changed.
    first, last = walls and i == 0, walls and i == nx - 1
    below = here if first else theta[i - 1, j]
    above = here if last else theta[(i + 1) % nx, j]
    minus, plus = inverse[0] * (-1 if first else 1), inverse[0] * (-1 if last else 1)
    _link_row(below, here, -minus, inverse[0], links.x[i, j], gradient[0], flux[0], sums, 0)
    _link_row(here, above, -inverse[0], plus, links.x[i + 1, j], gradient[0], flux[1], sums, 0)
    _link_row(theta[i, j - 1], here, -inverse[1], inverse[1], links.y[i, j], gradient[1], flux[2], sums, 1)
    _link_row(here, theta[i, (j + 1) % ny], -inverse[1], inverse[1], links.y[i, j + 1], gradient[1], flux[3], sums, 1)
    link, h, g = links.z[i, j], inverse[2], gradient[2]
    # The inner links are those below a voxel and those above its neighbour: they count whole, half and half.
    _link_row(here[: nz - 1], here[1:], -h, h, link[1:nz], g, flux[4, 1:], sums, 2)
    _link_row(here[: nz - 1], here[1:], -h, h, link[1:nz], g, flux[5, : nz - 1], sums, 2)
    _link_row(here[nz - 1 :], here[:1], -h, h, link[:1], g, flux[4, :1], sums, 2)
    _link_row(here[nz - 1 :], here[:1], -h, h, link[nz:], g, flux[5, nz - 1 :], sums, 2)


@compiled
def _link_row(low, high, minus, plus, link, gradient, flux, sums, axis):
    """Flux through a row of links, minus * low + plus * high being the slope; half of each goes to the sums."""
    energy, square, total = 0.0, 0.0, 0.0
    for k in range(len(link)):
        slope = minus * low[k] + plus * high[k] + gradient
        q = link[k] * slope
        flux[k] = q
        energy += q * slope
        square += q * q
        total += q
    sums[0] += 0.5 * energy
    sums[1 + axis] += 0.5 * total
    sums[4] += 0.5 * square


@compiled
def link_state(theta, links, gradient, inverse, walls, flux, low, high):
    """Flux at the centre of every voxel, for `conduct_links`: the mean of the two links along each axis."""
    nx, ny, nz = theta.shape
    row = np.empty((6, nz), theta.dtype)
    found = np.zeros(5)
    for i in range(low, high):
        for j in range(ny):
            _link_fluxes(theta, links, gradient, inverse, walls, i, j, row, found)
            for axis in range(3):
                for k in range(nz):
                    flux[axis, i, j, k] = 0.5 * (row[2 * axis, k] + row[2 * axis + 1, k])
