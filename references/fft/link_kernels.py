"""Numba kernels of the seven-point scheme: conduction through links between neighbouring voxel centres.

See `hexahedron_kernels` for what `low`, `high` and `work` are.
"""

from typing import NamedTuple

import numpy as np

from references.fft.hexahedron_kernels import Sums, compiled


class Links(NamedTuple):
    """Conductivity of the links between neighbouring voxel centres, harmonic mean along each, W/(m K).

    Link i of an axis joins voxels i - 1 and i.  The first and the last pass through the face: the same link twice in
    a periodic cell, mirrored in an isothermal wall, 0 in an insulated one.
    """

    x: np.ndarray  # (nx + 1, ny, nz) float array
    y: np.ndarray  # (nx, ny + 1, nz) float array
    z: np.ndarray  # (nx, ny, nz + 1) float array


@compiled
def conduct_links(theta, work, body, gradient, sums, low, high):
    """Seven-point differences: one temperature per voxel centre, one conductivity per link between neighbours.

    theta : (nx, ny, nz) float array, K; temperature at the voxel centres less the linear part; the isothermal walls are
      those across x
    work : (nx, ny, nz or more) float array, W/m3; out: -div(q)
    body : Body; of `Links`
    gradient : (3,) float array, K/m; linear part
    sums : Sums; out; each link counts half on either side
    low, high : int; planes of `work` to fill
    """
    inverse = body.inverse
    nx, ny, nz = theta.shape
    flux = np.empty((6, nz), theta.dtype)
    for i in range(low, high):
        sums.energy[i] = 0.0
        sums.flux[i] = 0.0
        for j in range(ny):
            _link_fluxes(theta, body, gradient, i, j, flux, sums)
            row = work[i, j]
            for k in range(nz):
                row[k] = (flux[0, k] - flux[1, k]) * inverse[0]
            for k in range(nz):
                row[k] += (flux[2, k] - flux[3, k]) * inverse[1]
            for k in range(nz):
                row[k] += (flux[4, k] - flux[5, k]) * inverse[2]


@compiled
def _link_fluxes(theta, body, gradient, i, j, flux, sums):
    """Fluxes through the six links of each voxel in a row: below and above along x, y, z."""
    links, inverse, walls = body.material, body.inverse, body.walls
    nx, ny, nz = theta.shape
    here = theta[i, j]
    # A mirrored neighbour is the voxel itself with its sign changed.
    first, last = walls and i == 0, walls and i == nx - 1
    below = here if first else theta[i - 1, j]
    above = here if last else theta[(i + 1) % nx, j]
    left, right = theta[i, j - 1], theta[i, (j + 1) % ny]
    minus, plus = inverse[0] * (-1 if first else 1), inverse[0] * (-1 if last else 1)
    _link_row(below, here, -minus, inverse[0], links.x[i, j], gradient[0], flux[0], sums, i, 0)
    _link_row(here, above, -inverse[0], plus, links.x[i + 1, j], gradient[0], flux[1], sums, i, 0)
    _link_row(left, here, -inverse[1], inverse[1], links.y[i, j], gradient[1], flux[2], sums, i, 1)
    _link_row(here, right, -inverse[1], inverse[1], links.y[i, j + 1], gradient[1], flux[3], sums, i, 1)
    link, h, g = links.z[i, j], inverse[2], gradient[2]
    # The inner links are those below a voxel and those above its neighbour: they count whole, half and half.
    _link_row(here[: nz - 1], here[1:], -h, h, link[1:nz], g, flux[4, 1:], sums, i, 2)
    _link_row(here[: nz - 1], here[1:], -h, h, link[1:nz], g, flux[5, : nz - 1], sums, i, 2)
    _link_row(here[nz - 1 :], here[:1], -h, h, link[:1], g, flux[4, :1], sums, i, 2)
    _link_row(here[nz - 1 :], here[:1], -h, h, link[nz:], g, flux[5, nz - 1 :], sums, i, 2)


@compiled
def _link_row(low, high, minus, plus, link, gradient, flux, sums, i, axis):
    """Flux through a row of links, minus * low + plus * high being the slope; half of each goes to the sums."""
    energy, total = 0.0, 0.0
    for k in range(len(link)):
        slope = minus * low[k] + plus * high[k] + gradient
        q = link[k] * slope
        flux[k] = q
        energy += q * slope
        total += q
    sums.energy[i] += 0.5 * energy
    sums.flux[i, axis] += 0.5 * total


@compiled
def link_state(theta, body, gradient, flux, low, high):
    """Flux at the centre of every voxel, for `conduct_links`: the mean of the two links along each axis.

    theta, body, gradient : see `conduct_links`
    flux : (3, nx, ny, nz) float array, W/m2; out: along the gradient, that is against Fourier's direction
    low, high : int; planes of voxels to fill
    """
    nx, ny, nz = theta.shape
    row = np.empty((6, nz), theta.dtype)
    unused = Sums(np.zeros(nx), np.zeros((nx, 3)))
    for i in range(low, high):
        for j in range(ny):
            _link_fluxes(theta, body, gradient, i, j, row, unused)
            for axis in range(3):
                for k in range(nz):
                    flux[axis, i, j, k] = 0.5 * (row[2 * axis, k] + row[2 * axis + 1, k])
