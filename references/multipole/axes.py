"""Tables for translations along z between harmonics that are turned there and back.

A translation along z keeps m: some order^3/3 products instead of order^4. A direction (theta, phi) is brought to z by a
turn about z, b_m exp(i m phi), an exchange of the axes y and z, a turn about the new z, b_m exp(-i m theta), and the
same exchange again: the exchange is one fixed matrix per degree, its own inverse. White and Head-Gordon, J. Chem. Phys.
105 (1996) 5061; the exchanges instead of Wigner's d matrices go back to Edmonds (1957).

Harmonics are in Racah's normalisation, entry (l, m >= 0) of a table stands at l (l + 1)/2 + m.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.special import gammaln

from references.multipole.sums import harmonics


class Axes(NamedTuple):
    """What the kernels of lanes need."""

    swap: np.ndarray  # (n,) float array: Exchange of y and z, in the order in which `lane_kernels` reads it
    # ((order + 1)^3,) float array: Entry [m, l', l], raveled: from multipoles l to local coefficients l' at the
    # distance 1 along z
    along: np.ndarray
    # (order + 1, order + 1, order + 1) float array: Entry [m, L, l]: from multipoles l to those of degree L >= l about
    # a point 1 below; transposed, from local coefficients L to those of degree l about a point 1 above
    shift: np.ndarray


@lru_cache(maxsize=8)
def axes(order) -> Axes:
    """Tables up to a degree."""
    return Axes(_swap(order), _along(order).ravel(), _shift(order))


def _swap(order):
    """Even m + l: from real parts only, both from those of the same parity and of the other; odd: from imaginary ones.

    For C_l^m has the parity (-1)^(l+m) in z, its real part is even and its imaginary part odd in y.
    """
    points, weights = sphere_points(order)
    here, there = harmonics(points, order), harmonics(points[:, [0, 2, 1]], order)
    flat = []
    for n in range(order + 1):
        rows = slice(n * (n + 1) // 2, (n + 1) * (n + 2) // 2)
        onto = ((2 * n + 1) * weights[:, None] * here[:, rows].conj()).T
        both = np.where(np.arange(n + 1) == 0, 1.0, 2.0)
        real, imaginary = onto @ (both * there[:, rows].real), onto @ (-both * there[:, rows].imag)
        for m in range(n + 1):
            source = real if (n + m) % 2 == 0 else imaginary
            flat += [*source[m, n % 2 :: 2].real, *source[m, (n + 1) % 2 :: 2].imag]
            # The other halves vanish.
    return np.array(flat)


def sphere_points(order):
    """Points on the unit sphere and weights of sum 1 that integrate harmonics up to degree 2 order + 1."""
    z, share = np.polynomial.legendre.leggauss(order + 1)
    turn = 2 * np.pi * (np.arange(2 * order + 2) + 0.5) / (2 * order + 2)
    x, y = np.cos(turn), np.sin(turn)
    flat = np.sqrt(1 - z**2)[:, None]
    points = np.stack([flat * x, flat * y, np.broadcast_to(z[:, None], (len(z), len(turn)))], axis=-1)
    return points.reshape(-1, 3), np.repeat(share / 2 / len(turn), len(turn))


def _along(order):
    m, to, of = np.meshgrid(*[np.arange(order + 1)] * 3, indexing="ij")
    low, high = np.maximum(np.minimum(to, of), m), np.maximum(np.maximum(to, of), m)
    size = gammaln(low + high + 1) - _log_root(low, m) - _log_root(high, m)
    return np.where((to >= m) & (of >= m), (-1.0) ** (to + m) * np.exp(size), 0.0)


def _shift(order):
    m, to, of = np.meshgrid(*[np.arange(order + 1)] * 3, indexing="ij")
    low, high = np.maximum(of, m), np.maximum(np.maximum(to, of), m)
    size = _log_root(high, m) - _log_root(low, m) - gammaln(high - low + 1)
    return np.where((to >= of) & (of >= m), np.exp(size), 0.0)


def _log_root(n, m):
    """Logarithm of sqrt((l-m)! (l+m)!)."""
    return 0.5 * (gammaln(n - m + 1) + gammaln(n + m + 1))
