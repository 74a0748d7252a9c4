"""The fast multipole method, with one level of cells: cost in proportion to the number of spheres.

Greengard and Rokhlin, J. Comput. Phys. 73 (1987) 325. Spheres in near cells exchange their multipoles one by one. For
the rest the multipoles of all spheres of a cell become those of the cell, cells make each other's local coefficients,
and these become the spheres'. On a regular grid of a periodic cell the second step is a convolution, done by fast
Fourier transforms: no tree is needed. Libraries of the fast multipole method know charges and dipoles, not multipoles
of any degree, and few know periodic cells.
"""

from __future__ import annotations

import math

import numpy as np
from scipy import fft

from references.multipole import cell_kernels, wave_kernels
from references.multipole.axes import axes
from references.multipole.cells import Cells, sorted_into
from references.multipole.far_sums import far_sums, mirror_parities, reflections, transformed
from references.multipole.lane_kernels import LANES
from references.multipole.sums import entries, highest_degree
from references.threads import Team


class FastMultipole:
    """What spheres make at each other, by cells.

    Parameters
    ----------
    spheres : Spheres
    shape : (3,) int array
        Numbers of cells.
    degree : int
        Highest degree of the cells' multipoles.
    negligible : float
    """

    def __init__(self, spheres, shape, degree, negligible):
        self.cells, self.order = sorted_into(shape, spheres, negligible)
        self.degree = degree
        shape = self.cells.shape
        sums = far_sums(shape, self.cells.edge, self.cells.near, 2 * degree)
        self.sums = transformed(sums, shape)
        n, m = entries(degree)
        self.root = np.exp(-0.5 * _log_square(n, m))

    def exchanged(self, spheres, source, threads=1):
        cells, degree = self.cells, self.degree
        order = highest_degree(source.shape[2])
        n, _ = entries(order)
        sent = source[:, self.order] * cells.radii[:, None] ** (n + 1.0)
        made = np.zeros((2, len(cells.receivers), source.shape[2]))
        with Team(threads) as team:
            team.run(cell_kernels.near, -(-made.shape[1] // cell_kernels.BLOCK), order, cells, axes(order), sent, made)
            local = self.between_cells(self.gathered(sent, team), team)
            few = min(order, degree)
            lanes = -(-made.shape[1] // LANES)
            team.run(cell_kernels.spread, lanes, few, degree, cells, axes(degree), local, made)
        made *= cells.radii[cells.receivers, None] ** n.astype(float)
        result = np.empty_like(made)
        result[:, self.order[cells.receivers]] = made
        return result

    def gathered(self, sent, team):
        cells, degree = self.cells, self.degree
        few = min(highest_degree(sent.shape[2]), degree)
        made = np.empty((2, sent.shape[1], len(self.root)))
        lanes = -(-sent.shape[1] // LANES)
        team.run(cell_kernels.gather, lanes, few, degree, cells, axes(degree), sent, made)
        total = np.zeros((2, len(cells.start) - 1, len(self.root)))
        full = np.flatnonzero(np.diff(cells.start))
        total[:, full] = np.add.reduceat(made, cells.start[full], axis=1)
        return total

    def between_cells(self, multipoles, team):
        shape, width = self.cells.shape, len(self.root)
        grid = np.moveaxis(multipoles * self.root, 2, 1).reshape(2, width, *shape)
        waves = fft.rfftn(grid, axes=(2, 3, 4), workers=team.threads)
        n, m = entries(self.degree)
        waves *= ((-1j) ** n)[:, None, None, None]
        half = shape // 2 + 1
        count = int(np.prod(half))
        sent, made = np.empty((2, count, wave_kernels.FIELDS, 2 * width))
        signs = mirror_parities(n, m)
        views = []
        for flip in reflections():
            place = np.ix_(*[flip[a] * np.arange(half[a]) % shape[a] for a in range(3)])
            sign = np.prod(np.where(flip[:, None] < 0, signs, 1), axis=1)
            views.append((place, sign))
        for k, (place, sign) in enumerate(views):
            part = waves[(slice(None), slice(None), *place)] * sign[:, :, None, None, None]
            part = part.reshape(2 * width, count).T
            sent[:, 2 * k], sent[:, 2 * k + 1] = part.real, part.imag
        team.run(wave_kernels.convolve, count, self.degree, self.sums, sent, made)
        for k, (place, sign) in enumerate(views):
            part = (made[:, 2 * k] + 1j * made[:, 2 * k + 1]).T.reshape(2, width, *half)
            waves[(slice(None), slice(None), *place)] = part * sign[:, :, None, None, None]
        waves *= ((-1j) ** n)[:, None, None, None]
        grid = fft.irfftn(waves, tuple(shape), axes=(2, 3, 4), workers=team.threads)
        return np.ascontiguousarray(np.moveaxis(grid.reshape(2, width, -1), 1, 2)) * self.root


def _log_square(n, m):
    from scipy.special import gammaln

    return gammaln(n - m + 1) + gammaln(n + m + 1)
