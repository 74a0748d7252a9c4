"""The fast multipole method, with one level of cells: cost in proportion to the number of spheres.

Greengard and Rokhlin, J. Comput. Phys. 73 (1987) 325. Spheres in near cells exchange their multipoles one by one. For
the rest the multipoles of all spheres of a cell become those of the cell, cells make each other's local coefficients,
and these become the spheres'. On a regular grid of a periodic cell the second step is a convolution, done by fast
Fourier transforms: no tree is needed. Libraries of the fast multipole method know charges and dipoles, not multipoles
of any degree, and few know periodic cells.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy import fft
from scipy.special import gammaln

from references.multipole import cell_kernels, wave_kernels
from references.multipole.axes import axes
from references.multipole.cells import WIDTH, sorted_into
from references.multipole.far_sums import far_sums, mirror_parities, reflections, transformed
from references.multipole.lane_kernels import LANES
from references.multipole.pieces import in_pieces
from references.multipole.sums import entries, highest_degree
from references.multipole.system import dipoles
from references.multipole.translations import background_share
from references.threads import Team

# Smallest edge of a cell, in largest diameters; and the most cells, of tiny spheres in a large box.
SMALLEST, MOST_CELLS = 1.05, 1e9
# Seconds of an exchange between two spheres over (order + 1)^3, of one between all cells over (degree + 1)^4 and per
# cell, and of one far sum: about, on one processor.
PAIR, CELL, SUM = 2e-9, 7e-10, 1e-5
# Products that a solution takes.
PRODUCTS = 60
# Where the bound of `far_degree` stands above errors found, and how much faster than errors it falls.
ABOVE, FASTER = 60.0, 1.06


class Plan(NamedTuple):
    """How to divide a periodic cell."""

    shape: np.ndarray  # (3,) int array: Numbers of cells
    degree: int  # Highest degree of the cells' multipoles
    precision: float  # Relative error of what spheres make at each other
    # product, setup: s: Estimated cost of one product with all translations and of the far sums
    product: float
    setup: float


def plan(spheres, order, precision) -> Plan:
    """The division of the periodic cell that costs least."""
    edge, best = SMALLEST * 2 * float(spheres.radii.max()), None
    edge = max(edge, (float(np.prod(spheres.size)) / MOST_CELLS) ** (1 / 3))
    while best is None or edge < 1.3 * spheres.size.max():
        shape = np.maximum(1, (spheres.size / edge).astype(np.int64))
        degree, cells = far_degree(spheres.size / shape, precision), int(np.prod(shape))
        pairs = spheres.count * len(spheres.radii) * (2 * WIDTH + 1) ** 3 / cells
        product = PAIR * pairs * (order + 1) ** 3 + CELL * cells * (degree + 1) ** 4
        setup = SUM * np.prod(shape // 2 + 1) * (degree + 1) * (2 * degree + 1)
        if best is None or PRODUCTS * product + setup < PRODUCTS * best.product + best.setup:
            best = Plan(shape, degree, precision, float(product), float(setup))
        edge *= 1.15
    return best


def far_degree(edge, precision) -> int:
    """Highest degree of the multipoles of cells.

    With r half the diagonal of a cell and D the least distance of the middles of cells that are not near, what a
    source makes at any point is known up to (r/(D - r))^(degree + 1) or so of itself: sources and points in the corners
    that face each other. Most are elsewhere: at random, in cubes, errors of b of equal spheres were found to be
    0.43^degree/60 of the largest b, those of the conductivity 30 times less or more.
    """
    half = float(np.linalg.norm(edge)) / 2
    ratio = half / ((WIDTH + 1) * float(np.min(edge)) - half)
    # Of flat cells even near corners may be farther apart than those that count as far.
    if not 0.0 < ratio < 0.9:
        ratio = 0.9
    return max(4, math.ceil(FASTER * math.log(ABOVE * precision) / math.log(ratio)))


class FastMultipole:
    """What spheres make at each other, by cells."""

    def __init__(self, spheres, plan: Plan):
        self.precision = plan.precision
        self.cells, self.order = sorted_into(plan.shape, spheres, plan.precision)
        self.degree = degree = plan.degree
        shape = self.cells.shape
        sums = far_sums(shape, self.cells.edge, self.cells.near, 2 * degree)
        self.sums = transformed(sums, shape)
        n, m = entries(degree)
        # From Racah's harmonics to the kernels' and back.
        self.root = np.exp(-0.5 * (gammaln(n - m + 1) + gammaln(n + m + 1)))

    def exchanged(self, spheres, source, threads=1):
        """c that spheres make at those that count, but for the background: see `translations.received`."""
        cells, degree, order = self.cells, self.degree, highest_degree(source.shape[2])
        n, _ = entries(order)
        sent = self.sent(source)
        made = np.zeros((2, len(cells.receivers), source.shape[2]))
        pairs = cell_kernels.BLOCK * len(cells.near) * len(cells.home) / (len(cells.start) - 1)
        with Team(threads) as team:
            blocks = -(-made.shape[1] // cell_kernels.BLOCK)
            cost = PAIR * pairs * (order + 1) ** 3
            in_pieces(team, cell_kernels.near, blocks, cost, order, cells, axes(order), sent, made)
            local = self.local(sent, team)
            blocks, few = -(-made.shape[1] // LANES), min(order, degree)
            in_pieces(team, cell_kernels.spread, blocks, 1e-3, few, degree, cells, axes(degree), local, made)
        made *= cells.radii[cells.receivers, None] ** n.astype(float)
        slope, level = self.background(spheres, source)
        made[0, :, 0] += cells.places[cells.receivers] @ slope + level
        result = np.empty_like(made)
        result[:, self.order[cells.receivers]] = made
        return result

    def sent(self, source):
        """Multipoles of the spheres, cell by cell, in the order of memory that the kernels are compiled for."""
        n, _ = entries(highest_degree(source.shape[2]))
        return np.ascontiguousarray(source[:, self.order] * self.cells.radii[:, None] ** (n + 1.0))

    def background(self, spheres, source):
        """What the uniform background of the periodic sums makes of dipoles off the middles of their cells.

        A dipole p at y makes -4 pi/(3 volume) p.(x - y) at x in any cell; `translations.received` adds the slope.
        """
        share = background_share(spheres)
        moments = dipoles(spheres, source)[self.order]
        return -share * moments.sum(axis=0), share * float(np.sum(moments * self.cells.places))

    def local(self, sent, team):
        """Local coefficients of all cells, what near cells make left out."""
        cells, degree = self.cells, self.degree
        few = min(highest_degree(sent.shape[2]), degree)
        each = np.empty((2, sent.shape[1], len(self.root)))
        blocks = -(-sent.shape[1] // LANES)
        in_pieces(team, cell_kernels.gather, blocks, 1e-3, few, degree, cells, axes(degree), sent, each)
        total = np.zeros((2, len(cells.start) - 1, len(self.root)))
        full = np.flatnonzero(np.diff(cells.start))
        total[:, full] = np.add.reduceat(each, cells.start[full], axis=1)
        return self._convolved(total, team)

    def _convolved(self, multipoles, team):
        shape, width = tuple(self.cells.shape), len(self.root)
        grid = np.moveaxis(multipoles * self.root, 2, 1).reshape(2, width, *shape)
        n, _ = entries(self.degree)
        # As `far_sums.transformed` has it: i^(l+l') on the sums, (-i)^l here and (-i)^l' there.
        turn = ((-1j) ** n)[:, None, None, None]
        waves = fft.rfftn(grid, axes=(2, 3, 4), workers=team.threads) * turn
        sent, views = self._octants(waves)
        made, cost = np.empty_like(sent), 8 * CELL * (self.degree + 1) ** 4
        in_pieces(team, wave_kernels.convolve, len(sent), cost, self.degree, self.sums, sent, made)
        for k, (place, sign) in enumerate(views):
            part = (made[:, 2 * k] + 1j * made[:, 2 * k + 1]).T
            waves[place] = part.reshape(waves[place].shape) * sign
        grid = fft.irfftn(waves * turn, shape, axes=(2, 3, 4), workers=team.threads)
        return np.ascontiguousarray(np.moveaxis(grid.reshape(2, width, -1), 1, 2)) * self.root

    def _octants(self, waves):
        """Fields of waves that mirror each other side by side; where they stand and their signs."""
        shape = self.cells.shape
        half, signs = shape // 2 + 1, mirror_parities(*entries(self.degree))
        sent, views = np.empty((int(np.prod(half)), wave_kernels.FIELDS, 2 * len(self.root))), []
        for k, flip in enumerate(reflections()):
            place = np.ix_(
                range(2), range(len(self.root)), *[flip[a] * np.arange(half[a]) % shape[a] for a in range(3)]
            )
            sign = np.prod(np.where(flip[:, None] < 0, signs, 1), axis=1)[:, :, None, None, None]
            part = (waves[place] * sign).reshape(-1, len(sent)).T
            sent[:, 2 * k], sent[:, 2 * k + 1] = part.real, part.imag
            views.append((place, sign))
        return sent, views
