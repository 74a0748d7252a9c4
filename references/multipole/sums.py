"""Irregular solid harmonics summed over the cells of an orthorhombic lattice, by Ewald's splitting.

Ewald, Ann. Phys. 64 (1921) 253; for multipoles McPhedran and McKenzie, Proc. R. Soc. A 359 (1978) 45. Poisson's
formula turns sum_R R_L(X + R) exp(-t |X + R|^2) into a sum over reciprocal vectors K; the part 0 < t < eta of
r^-(2L+1) = int t^(L-1/2) exp(-t r^2) dt / Gamma(L+1/2) integrates to exp(-K^2/(4 eta)) / K^2. Without K = 0 the sums
are those of the periodic Green function -laplace psi = 4 pi (delta - 1/volume), whose mean slope is zero: just what a
mean gradient imposed on the cell asks for. Its uniform background appears only where two derivatives meet: see
`translations.received`.

Harmonics in Racah's normalisation, as in `references.exact.harmonics`; entry (L, M >= 0) of a table stands at
L (L + 1)/2 + M.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.special import gammaincc, gammaln

from references.exact.harmonics import legendre

# What the images and waves left out may add, in units of the largest entry of a translation matrix.
NEGLIGIBLE = 1e-16
# The splitting, in units of volume^(-2/3): pi makes images and waves equally many, but waves cost less.
FEWEST_WAVES, FEWEST_IMAGES = math.pi, 4 * math.pi
# Above this, in units of 1/contact^2, waves of low degree cancel to more than a digit.
CANCEL = 4.0
# Pairs handled at a time, so that intermediate arrays stay in the cache.
CHUNK = 512


class Splitting(NamedTuple):
    """Where Ewald's two sums are cut."""

    eta: float  # length^-2
    reach: float  # length: Images beyond are left out
    # (w, 3) int array: One of each pair K, -K of the reciprocal vectors that count, in units of 2 pi/size
    waves: np.ndarray


def entries(degree):
    """Degrees and orders of a table's entries, two (n,) int arrays."""
    pairs = [(n, m) for n in range(degree + 1) for m in range(n + 1)]
    return np.array(pairs).T


def highest_degree(width) -> int:
    """Highest degree in a table of so many entries."""
    return math.isqrt(2 * width) - 1


def splitting(size, contact, degree, eta=None) -> Splitting:
    """Choose where to split and to cut, for harmonics up to `degree` in units of contact^-(L+1)."""
    volume = float(np.prod(size))
    if eta is None:
        eta = max(FEWEST_WAVES / volume ** (2 / 3), min(FEWEST_IMAGES / volume ** (2 / 3), CANCEL / contact**2))
    n = np.arange(1, degree + 1)[:, None]
    r = math.sqrt(1 / eta) * np.arange(1.0, 60.0, 0.1)
    outside = 4 * math.pi * r**3 / volume * gammaincc(n + 0.5, eta * r**2) * (contact / r) ** (n + 1.0)
    k = math.sqrt(4 * eta) * np.arange(1.0, 60.0, 0.1)
    beyond = volume * k**3 / (2 * math.pi**2) * np.exp(_log_weight(n, k, eta, volume) + (n + 1) * math.log(contact))
    return Splitting(float(eta), _first_small(outside, r), _half_space(size, _first_small(beyond, k)))


def _first_small(terms, where):
    """The first place from which on the terms of all degrees are negligible."""
    large = np.flatnonzero(np.any(terms > NEGLIGIBLE, axis=0))
    # Of tiny spheres in a large cell all may be.
    return float(where[min(large[-1] + 1, len(where) - 1)] if len(large) else where[0])


def _log_weight(degree, k, eta, volume):
    """Logarithm of the weight of R_L^M(K) without its sign, times k^L as |R_L^M(K)| <= k^L."""
    constant = np.log(4 * math.pi**1.5 / volume) - degree * math.log(2.0) - gammaln(degree + 0.5)
    return constant + (degree - 2.0) * np.log(k) - k**2 / (4 * eta)


def _half_space(size, reach):
    """Integer triples n with |2 pi n/size| <= reach, one of each pair n, -n, zero excluded."""
    spans = [np.arange(-int(most), int(most) + 1) for most in reach * np.asarray(size) / (2 * math.pi)]
    waves = np.stack(np.meshgrid(*spans, indexing="ij"), axis=-1).reshape(-1, 3)
    # The middle of the list is zero and the list is symmetric about it.
    waves = waves[len(waves) // 2 + 1 :]
    return waves[np.linalg.norm(2 * math.pi * waves / size, axis=1) <= reach]


def harmonics(points, degree):
    """R_L^M of points on the unit sphere."""
    x, y, z = points.T
    table = np.empty((len(points), (degree + 1) * (degree + 2) // 2), dtype=complex)
    for m in range(degree + 1):
        phase = (x + 1j * y) ** m
        for n, values in enumerate(legendre(z, np.ones_like(z), degree, m), start=m):
            table[:, n * (n + 1) // 2 + m] = values * phase
    return table


def wave_weights(waves, size, eta, degree):
    """Weights of R_L^M(K/k) in the sum over waves, without (-i)^L."""
    vectors = 2 * math.pi * waves / np.asarray(size)
    k = np.linalg.norm(vectors, axis=1)[:, None]
    return np.exp(_log_weight(np.arange(degree + 1)[None], k, eta, float(np.prod(size)))), vectors


def periodic_irregular(offsets, degree, size, contact, *, eta=None):
    """Sum of I_L^M(X + R) over all lattice vectors R; where X = 0, over all but R = 0."""
    cut = splitting(size, contact, degree, eta)
    offsets = offsets - size * np.round(offsets / size)
    vectors, table = wave_table(degree, size, cut)
    result = np.zeros((len(offsets), (degree + 1) * (degree + 2) // 2), dtype=complex)
    for low in range(0, len(offsets), CHUNK):
        part = slice(low, low + CHUNK)
        _add_images(result[part], offsets[part], degree, size, cut)
        add_waves(result[part], offsets[part] @ vectors.T, table)
    result[:, 0] = 0.0
    return result


def _add_images(result, offsets, degree, size, cut):
    apart, square = images(offsets, size, cut.reach)
    owner, image = np.nonzero((square <= cut.reach**2) & (square > 0))
    add_screened(result, owner, apart[owner, image], degree, lambda n, x: gammaincc(n + 0.5, cut.eta * x))


def images(offsets, size, reach):
    """Offsets of the images that may be within reach."""
    spans = [np.arange(-int(n), int(n) + 1) for n in reach / size + 0.5]
    cells = np.stack(np.meshgrid(*spans, indexing="ij"), axis=-1).reshape(-1, 3) * size
    apart = offsets[:, None] + cells
    return apart, np.einsum("ijk,ijk->ij", apart, apart)


def add_screened(result, owner, apart, degree, screen):
    """Add I_L^M of many offsets to the rows of a table, each times a factor of its degree and distance."""
    square = np.einsum("ik,ik->i", apart, apart)
    r = np.sqrt(square)
    x, y, z = (apart / r[:, None]).T
    screened = [screen(n, square) * r ** -(n + 1.0) for n in range(degree + 1)]
    phase = np.ones(len(r), dtype=complex)
    for m in range(degree + 1):
        for n, values in enumerate(legendre(z, np.ones_like(z), degree, m), start=m):
            terms = values * screened[n]
            entry = n * (n + 1) // 2 + m
            result[:, entry].real += np.bincount(owner, terms * phase.real, len(result))
            result[:, entry].imag += np.bincount(owner, terms * phase.imag, len(result))
        phase = phase * (x + 1j * y)


def wave_table(degree, size, cut):
    """Reciprocal vectors and what each adds without its phase."""
    weights, vectors = wave_weights(cut.waves, size, cut.eta, degree)
    table = harmonics(vectors / np.linalg.norm(vectors, axis=1)[:, None], degree)
    n, _ = entries(degree)
    return vectors, table * weights[:, n]


def add_waves(result, angle, table):
    """Add waves: K and -K together give 2 Re((-i)^L exp(i K.X)), a cosine where L is even, a sine where it is odd."""
    n, _ = entries(highest_degree(table.shape[1]))
    for parity, wave in ((0, np.cos(angle)), (1, np.sin(angle))):
        chosen = np.flatnonzero(n % 2 == parity)
        signs = 2.0 * (-1.0) ** (n[chosen] // 2)
        result[:, chosen] += (wave @ table[:, chosen].real + 1j * (wave @ table[:, chosen].imag)) * signs
