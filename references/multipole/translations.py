"""What spheres of a periodic cell make at each other: their multipoles translated, all images included.

Tables are real, (2, spheres, entries): real and imaginary parts, Racah's normalisation, entry (l, m >= 0) at
l (l + 1)/2 + m; b and c as in `system`. Conductivities are in units of the matrix; lengths in any one unit.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.special import gammaln

from references.multipole.pieces import in_pieces
from references.multipole.sums import entries, highest_degree, periodic_irregular
from references.multipole.translation_kernels import translate
from references.threads import Team

# Entries of the translation between two spheres that are smaller than this are left out.
NEGLIGIBLE = 1e-14
# Of a translation between two spheres over (order + 1)^4, about, on one processor.
SECONDS = 2.5e-9


class Spheres(NamedTuple):
    """Spheres in a periodic cell: first those that count, then what are mirror images of them."""

    centers: np.ndarray  # (n, 3) float array, length
    radii: np.ndarray  # (n,) float array, length
    contrasts: np.ndarray  # (n,) float array: Conductivity over that of the matrix
    resistances: np.ndarray  # (n,) float array: Of their surfaces, times the conductivity of the matrix over the radius
    size: np.ndarray  # (3,) float array, length: Of the cell
    original: np.ndarray  # (n,) int array: Sphere that each one mirrors; itself if it counts
    flips: np.ndarray  # (n, 3) bool array: Axes along which it is mirrored

    @property
    def count(self) -> int:
        """Number of those that count."""
        return int(self.original.max(initial=-1)) + 1


def unmirrored(centers, radii, contrasts, size, resistances=None) -> Spheres:
    """Spheres of a cell without mirror images."""
    resistances = np.zeros(len(radii)) if resistances is None else resistances
    flips = np.zeros((len(radii), 3), dtype=bool)
    return Spheres(centers, radii, contrasts, resistances, size, np.arange(len(radii)), flips)


class Translation(NamedTuple):
    """Periodic sums of I_L^M for all pairs of a sphere that counts and any other."""

    # (1 + pairs, entries) complex array, length^-(L+1): Of a sphere's own images, then for i < j of X = x_i - x_j, j
    # running fastest
    sums: np.ndarray
    top: np.ndarray  # (1 + pairs,) int array: Highest degree L = l + l' that counts
    # Relative error of what spheres make at each other: rounding.
    precision = 0.0

    def exchanged(self, spheres, source, threads=1):
        """c that spheres make at those that count, but for the background: see `received`."""
        order, count = highest_degree(source.shape[2]), spheres.count
        scale = scales(spheres.radii, order)
        result = np.zeros((2, count, source.shape[2]))
        with Team(threads) as team:
            cost = SECONDS * len(spheres.radii) * (order + 1) ** 4
            in_pieces(team, translate, count, cost, order, self, source * scale.sent, result)
        return result * scale.made[:count]


class Scales(NamedTuple):
    """Factors from b to multipoles of the kernels' harmonics, and from their local coefficients to c."""

    sent: np.ndarray  # (n, entries) float array, length^(l+1)
    made: np.ndarray  # (n, entries) float array, length^l


def scales(radii, order) -> Scales:
    """Scales of spheres: Racah's harmonics are sqrt((l-m)! (l+m)!) times the kernels' regular ones.

    And the irregular ones are the kernels' over that root.
    """
    n, m = entries(order)
    root = np.exp(0.5 * (gammaln(n - m + 1) + gammaln(n + m + 1)))
    a = np.asarray(radii)[:, None]
    return Scales(a ** (n + 1.0) / root, a ** n.astype(float) / root)


def translation(spheres, degree) -> Translation:
    """Periodic sums for all pairs of spheres; both ways of a pair share one."""
    i, j = np.triu_indices(spheres.count, 1, len(spheres.radii))
    offsets = np.vstack([np.zeros((1, 3)), spheres.centers[i] - spheres.centers[j]])
    contact = 2 * float(spheres.radii.max())
    sums = periodic_irregular(offsets, degree, spheres.size, contact)
    n, m = entries(degree)
    sums *= np.exp(0.5 * (gammaln(n - m + 1) + gammaln(n + m + 1)))
    apart = offsets - spheres.size * np.round(offsets / spheres.size)
    apart = np.linalg.norm(apart, axis=1)
    apart[0] = spheres.size.min()
    touch = np.concatenate([[contact], spheres.radii[i] + spheres.radii[j]])
    # Entries of degree L = l + l' are at most about (touch/apart)^L.
    most = math.log(NEGLIGIBLE) / np.log(np.minimum(touch / apart, 1 - 1e-9))
    return Translation(sums, np.minimum(np.ceil(most), degree).astype(np.int64))


def background_share(spheres) -> float:
    """Slope that the uniform background of the periodic sums takes off per dipole moment, 1/length^3."""
    return 4 * math.pi / (3 * float(np.prod(spheres.size)))


def complex_table(table):
    """(n, entries) complex table of the (2, n, entries) real and imaginary parts."""
    return np.ascontiguousarray(table[0] + 1j * table[1])


def received(spheres, table, source, threads=1):
    """c that all spheres and their periodic images make at those that count."""
    result, count = table.exchanged(spheres, source, threads), spheres.count
    # Two derivatives of the periodic Green function have the trace 4 pi/volume of its background, which no harmonic
    # of degree 2 carries: dipoles p shift every slope by -4 pi/(3 volume) times their sum.
    moments = np.sum(source[:, :, 1:3] * spheres.radii[:, None] ** 2, axis=1, keepdims=True)
    result[:, :, 1:3] -= background_share(spheres) * moments * spheres.radii[:count, None]
    return result
