"""Temperature and slope at any point, from the multipoles of spheres in a periodic cell.

In a sphere its own regular series converges. Outside, the mean gradient and the periodic multipoles of all spheres are
summed by Ewald's splitting: screened images one by one, the smooth rest by waves, whose amplitudes are worked out once.
Many spheres are summed by cells instead, for the waves go with their number: see `cell_field`.
"""

import math

import numpy as np

from references.multipole import field_kernels as kernels
from references.multipole.cell_field import CellField
from references.multipole.sums import entries, harmonics, splitting, wave_weights
from references.multipole.system import Solved
from references.multipole.translations import Spheres, complex_table, scales

# Nanoseconds, about, of one harmonic of one image and of one wave at one point: they set the splitting.
HARMONIC, WAVE = 4.0, 4.0
# eta radius^2 above this: waves of low degree cancel to more than a digit.
MOST_SCREENED = 6.0
# More spheres than this are summed by cells.
MANY = 100


class Evaluator:
    """The solution at points."""

    def __init__(self, spheres: Spheres, solved: Solved, gradient):
        self.spheres, self.order, self.gradient = spheres, solved.order, np.asarray(gradient, dtype=float)
        self.regular = _regular(spheres, solved)
        self.multipoles = complex_table(solved.source * scales(spheres.radii, solved.order).sent)
        self.cells = CellField(spheres, solved) if len(spheres.radii) > MANY else None
        if not self.cells:
            self.split = _splitting(spheres, solved.order)
            self.amplitudes = _amplitudes(spheres, solved, self.split)

    def __call__(self, points):
        """Temperature and its slope, in perfect conductors the limit of s times it, and which sphere owns the point."""
        points = np.asarray(points, dtype=float)
        offsets, owner = self._owners(points)
        result = np.zeros((len(points), 4))
        inner, outer = np.flatnonzero(owner >= 0), np.flatnonzero(owner < 0)
        part = np.empty((len(inner), 4))
        kernels.inside(offsets[inner], owner[inner], self.regular, self.order, part)
        perfect = np.isinf(self.spheres.contrasts)[owner[inner]]
        part[perfect, 0] = self.regular[owner[inner][perfect], 0].real
        # The mean gradient takes the series, which is that of one cell, to where the point is.
        part[:, 0] += (points[inner] - offsets[inner]) @ self.gradient
        result[inner] = part
        part = self._outside(points[outer])
        part[:, 0] += points[outer] @ self.gradient
        part[:, 1:] += self.gradient
        result[outer] = part
        return result, owner

    def _owners(self, points):
        if self.cells:
            return self.cells.owners(points)
        offsets, owner = points.copy(), np.empty(len(points), dtype=np.int64)
        kernels.owners(offsets, self.spheres, owner)
        return offsets, owner

    def _outside(self, points):
        if self.cells:
            return self.cells.outside(points)
        part = np.zeros((len(points), 4))
        kernels.near(points, self.spheres, self.multipoles, self.order, self.split, part)
        kernels.far(points, self.spheres.size, self.split, self.amplitudes, part)
        return part


def _regular(spheres, solved):
    """Coefficients inside: c + b = c (2l+1)/(l s + l + 1), without the cancellation of the sum at high contrast.

    Where the surface has a resistance rho they are (c + b)/(1 + s rho l), see `references.exact.lattice`. Without the
    value that the mean gradient has at the centre: `Evaluator` adds it.
    """
    n, _ = entries(solved.order)
    root = scales(np.ones(1), solved.order).made
    s, rho = spheres.contrasts[:, None], spheres.resistances[:, None]
    with np.errstate(invalid="ignore"):
        factor = (2 * n + 1) / (n * s + n + 1 + (n + 1) * n * s * rho)
    # Degree 0 is the one temperature of a perfect conductor, the others tell its flux.
    limit = np.where(n > 0, (2 * n + 1) / (np.maximum(n, 1) * (1 + (n + 1) * rho)), 1.0)
    factor = np.where(np.isinf(s), limit, factor)
    return complex_table(solved.local * factor / root * spheres.radii[:, None] ** -n.astype(float))


def _splitting(spheres, order):
    """The splitting that costs least per point."""
    volume, largest = float(np.prod(spheres.size)), float(spheres.radii.max(initial=0.0))
    best, least = None, math.inf
    for factor in (1.0, 2.0, 4.0, 8.0, 16.0, 32.0):
        eta = factor * math.pi / volume ** (2 / 3)
        if factor > 1 and eta * largest**2 > MOST_SCREENED:
            break
        cut = splitting(spheres.size, max(largest, 1e-3 * volume ** (1 / 3)), max(order, 1), eta)
        images = len(spheres.radii) * 4 / 3 * math.pi * cut.reach**3 / volume
        cost = HARMONIC * images * (order + 2) ** 2 + WAVE * len(cut.waves)
        if cost < least:
            best, least = cut, cost
    return best


def _amplitudes(spheres, solved, split):
    """F(K): sum over spheres and degrees of (-i)^l weight exp(-i K.x) Re(sum over m of B_lm R_l^m(K/k))."""
    weights, vectors = wave_weights(split.waves, spheres.size, split.eta, solved.order)
    n, m = entries(solved.order)
    both = np.where(m == 0, 1.0, 2.0)
    table = harmonics(vectors / np.linalg.norm(vectors, axis=1)[:, None], solved.order) * both
    moments = solved.source * spheres.radii[:, None] ** (n + 1.0)
    phase = np.exp(-1j * vectors @ spheres.centers.T)
    total = np.zeros(len(vectors), dtype=complex)
    for degree in range(1, solved.order + 1):
        here = n == degree
        parts = table[:, here].real @ moments[0][:, here].T - table[:, here].imag @ moments[1][:, here].T
        total += (-1j) ** degree * weights[:, degree] * np.sum(phase * parts, axis=1)
    return total
