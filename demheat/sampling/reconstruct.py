"""Temperature and flux of a network between its particles: polynomials fitted to the cells around a point, by phase.

A moving least squares fit (Lancaster and Salkauskas 1981) of the temperatures of a cell, its neighbours and theirs,
reached over facets within one phase only, so that nothing is fitted across an interface; and of what the network knows
at the phase's edges: temperatures on interfaces and held walls, slopes at the others, at walls that exchange heat with
surroundings how both hang together. What is fitted is the difference from the cell's own linear temperature, whose
gradient makes the cell's flux exact for linear fields: where there are too few cells for more, that is what remains.

In a steady state temperatures, or Kirchhoff's transforms of them, are harmonic within a phase: cubics of which that is
so are no more coefficients to find than 16. Where heat is stored quadratics of all kinds are fitted; a jump within a
cell, as at a wall heated at once, overshoots by up to .6 of it until cells have felt it.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from demheat.runtime.process_state import one_blas_thread
from demheat.runtime.progress import stage
from demheat.sampling.polynomials import HARMONICS, QUADRATICS, Polynomials

# Edge points of a fit, and weight of their slopes beside what cells know.
EDGES, SLOPE = 12, 0.3


class Fit(NamedTuple):
    """What is fitted, and to how much."""

    polynomials: Polynomials
    nearest: int  # cells
    ridge: float  # part of the weights that holds a fit to the linear temperature of the cell
    value: float  # weight of values at edges beside those of cells


# Where heat is stored. More of the ridge leaves curvature out; more cells smear the front of a moving source.
STORED = Fit(QUADRATICS, 16, 1e-4, 2.0)
# Steady, see docs/decisions/points.md.
STEADY = Fit(HARMONICS, 24, 1e-5, 6.0)
# A steady fit may add so many times what slopes of the cells around differ by: where heat converges, as to where a good
# conductor touches a wall, few edges can bend it to any slope. Of 4000 points in each of 25 scenes none adds more, but
# for two among pairs of balls by 2000 particles; beside a point of contact some add 4 to 30 times as much.
MOST = 2.0
# Points fitted at once: some 100 MiB of candidates.
CHUNK = 4096


class Reconstruction:
    """Values of a network's temperature and flux density anywhere."""

    def __init__(self, network, edges, temperature, gradient, slope, *, periodic, phase_at, conductivity, steady=True):
        self.network, self.edges, self.fit = network, edges, STEADY if steady else STORED
        self.temperature, self.gradient, self.slope = temperature, gradient, slope - gradient
        self.periodic, self.phase_at = np.asarray(periodic, bool), phase_at
        self.conductivity = np.asarray(conductivity, dtype=float)
        # A fourth coordinate keeps phases apart by more than the box is wide.
        self.apart = 2.0 * np.linalg.norm(network.size)
        lifted = np.column_stack([network.centers, self.apart * network.phase])
        # Temperature and flux at the same points are one fit.
        self._points, self._found = np.empty((0, 3)), ()
        self.tree = cKDTree(lifted, boxsize=np.append(np.where(self.periodic, network.size, 0.0), 0.0))

    def temperature_at(self, points):
        """Temperature, (m, 3) float array, m -> (m,) float array, K; NaN on isolated components."""
        return self._at(points)[0]

    def flux_at(self, points):
        """Flux density, (m, 3) float array, m -> (m, 3) float array, W/m2."""
        return self._at(points)[1]

    def _at(self, points):
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        if not len(points):
            return np.empty(0), np.empty((0, 3))
        if not np.array_equal(points, self._points):
            with stage("points") as done:
                parts = []
                for k in range(0, len(points), CHUNK):
                    done(k / len(points))
                    parts.append(self._fitted(points[k : k + CHUNK]))
            self._points, self._found = points.copy(), [np.concatenate(part) for part in zip(*parts, strict=True)]
        return tuple(values.copy() for values in self._found)

    def _fitted(self, points):
        size = self.network.size
        wrapped = np.where(self.periodic, points % size, points)
        seed = self.tree.query(np.column_stack([wrapped, self.apart * self.phase_at(points)]))[1]
        from_seed = self._nearest_image(wrapped - self.network.centers[seed])
        with one_blas_thread():  # older ones share even small products out, which changes the last bits
            more, steeper = self._beyond_linear(seed, wrapped, from_seed)
        level = self.temperature[seed] + np.einsum("ij,ij->i", self.slope[seed], from_seed)
        slope = self.slope[seed] + steeper + self.gradient
        k = self.conductivity[seed]
        flux = -np.where(k[:, None] > 0, k[:, None] * slope, 0.0)
        return level + more + points @ self.gradient, flux

    def _beyond_linear(self, seed, points, from_seed):
        """What fits add at the points to the linear temperature of their seeds' cells, and to its gradient."""
        around, edges = self._around(seed)
        level, slope = self.temperature[seed][:, None], self.slope[seed]
        cell, offset, away = self._nearest(points, self.network.centers, around, self.fit.nearest + 1)
        # Weights fall to zero, with their slope, at the first cell that is left out: no jump where the choice changes.
        full = np.isfinite(away).sum(axis=1) > self.fit.nearest
        last = np.where(np.isfinite(away), away, 0.0).max(axis=1)
        reach = np.where(full, last, 1.5 * last + 1e-300)[:, None]
        values = self.temperature[cell] - level - _along(slope, offset + from_seed[:, None])
        rows = [(self.fit.polynomials.values(offset / reach[..., None]), _weight(away / reach), values)]
        rows += self._at_edges(seed, points, from_seed, edges, reach) if len(self.edges.values) else []
        found = _least_squares(*(np.concatenate(part, axis=1) for part in zip(*rows, strict=True)), self.fit.ridge)
        more, steeper = found[:, 0], found[:, 1:4] / reach
        wild = self._wild(seed, around, steeper)
        return np.where(wild, 0.0, more), np.where(wild[:, None], 0.0, steeper)

    def _wild(self, seed, around, steeper):
        """Fits among many cells that add more to the slope than they can know."""
        if self.fit is not STEADY:
            return np.zeros(len(seed), bool)
        cell, exists = around
        apart = self.slope[cell] - self.slope[seed][:, None]
        largest = np.where(exists, np.einsum("ijk,ijk->ij", apart, apart), 0.0).max(axis=1)
        many = exists.sum(axis=1) > self.fit.nearest
        return many & (np.einsum("ij,ij->i", steeper, steeper) > MOST**2 * largest)

    def _at_edges(self, seed, points, from_seed, edges, reach):
        """Rows of the fits for what is known at edges, values and slopes, less those of the seed's cell."""
        level, slope = self.temperature[seed][:, None], self.slope[seed]
        edge, offset, away = self._nearest(points, self.edges.places, edges, EDGES)
        weight, scaled, normal = _weight(away / reach), offset / reach[..., None], self.edges.normals[edge]
        values = self.edges.values[edge] - level - _along(slope, offset + from_seed[:, None])
        slopes = reach * (self.edges.slopes[edge] - _along(slope + self.gradient, normal))
        # Of the value in what is known: 1 where that is held, 0 where the flux is, a film's Biot number says between.
        share = 1.0 - 1.0 / (1.0 + self.edges.film[edge] * reach)
        own, value = self.fit.polynomials, self.fit.value
        row = share[..., None] * own.values(scaled) + (1.0 - share)[..., None] * own.along(scaled, normal)
        return [(row, (value * share + SLOPE * (1.0 - share)) * weight, share * values + (1.0 - share) * slopes)]

    def _nearest(self, points, places, chosen, most):
        """The nearest of the candidates of each point: numbers, offsets from it and distances, infinite where none."""
        number, exists = chosen
        offset = self._nearest_image(places[number] - points[:, None])
        away = np.where(exists, np.linalg.norm(offset, axis=2), np.inf)
        kept = np.argsort(away, axis=1, kind="stable")[:, :most]
        number, away = (np.take_along_axis(values, kept, axis=1) for values in (number, away))
        return number, np.take_along_axis(offset, kept[..., None], axis=1), away

    def _nearest_image(self, offset):
        size = self.network.size
        return offset - np.where(self.periodic, size * np.round(offset / size), 0.0)

    def _around(self, seed):
        """Candidates of each seed within its phase: cells up to neighbours' neighbours, edges of it and neighbours."""
        unique, back = np.unique(seed, return_inverse=True)
        row, cell = self._with_linked(np.arange(len(unique)), unique)
        start = self.edges.start
        count = start[cell + 1] - start[cell]
        edges = _padded(np.repeat(row, count), _runs(start[cell], count), len(unique))
        cells = _padded(*self._with_linked(row, cell), len(unique))
        return tuple(part[back] for part in cells), tuple(part[back] for part in edges)

    def _with_linked(self, row, cell):
        """Cells and their neighbours over conducting facets of one phase, once each, and the rows that they are of."""
        indptr, phase, n = self.network.indptr, self.network.phase, len(self.temperature)
        count = np.diff(indptr)[cell]
        link = _runs(indptr[cell], count)
        other = self.network.indices[link].astype(np.int64)
        kept = (phase[other] == np.repeat(phase[cell], count)) & (self.network.conductance[link] > 0)
        keys = np.append(row * np.int64(n) + cell, np.repeat(row, count)[kept] * np.int64(n) + other[kept])
        keys = np.unique(keys)
        return keys // n, keys % n


def _runs(start, count):
    """Numbers start, start + 1, ... of each run, one after the other."""
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    return np.repeat(start - first, count) + np.arange(count.sum())


def _padded(row, value, rows):
    """Values of each row side by side, and which of the places are filled; rows ascend."""
    count = np.bincount(row, minlength=rows)
    place = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    values = np.zeros((rows, max(int(count.max(initial=0)), 1)), dtype=np.int64)
    values[row, place] = value
    return values, np.arange(values.shape[1]) < count[:, None]


def _along(slope, offsets):
    return np.einsum("ij,ikj->ik", slope, offsets)


def _weight(ratio):
    return np.maximum(1.0 - np.minimum(ratio, 1.0) ** 2, 0.0) ** 2


def _least_squares(basis, weight, values, ridge):
    """Coefficients of the fits, (m, polynomials) float array."""
    weighted = basis * weight[..., None]
    values = np.where(weight > 0, values, 0.0)
    matrix = np.swapaxes(weighted, 1, 2) @ basis
    matrix += ridge * weight.sum(axis=1)[:, None, None] * np.eye(basis.shape[2])
    return np.linalg.solve(matrix, np.einsum("mki,mk->mi", weighted, values)[..., None])[..., 0]
