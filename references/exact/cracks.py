"""Square arrays of insulated discs, by Galerkin's method with the jump of the temperature across the disc as unknown.

A disc of radius a at right angles to the load in the middle of a box L x L x H, periodic or between isothermal walls
and insulated sides, which is the same by its mirrors. With w(x, y) the jump, w_k its Fourier coefficients over the
square, the gradient at the disc is 1 - sum of D(k) w_k exp(ikx), D = k/2 coth(k H / 2), 1/H for k = 0, and it vanishes:
a symmetric equation for w. Then k_eff/k = 1 - w_0/H. Functions r^m cos(m t) (1 - r^2/a^2)^(j + 1/2), m = 0, 4, ...,
have the root that w has at the rim; by Sonine's integral they transform to J_(m+j+3/2)(ka) / (ka)^(j+3/2).

An insulated disc alone takes 8/3 a^3 of volume off the mean gradient (Sneddon, Mixed Boundary Value Problems, 1966):
w = 4/pi sqrt(a^2 - r^2). Lengths are in units of the side L.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.special import gamma, gammaln, spherical_jn

# Waves up to this many over the side; beyond it their sum is an integral, which closed forms give.
WAVES = 192
# Functions: j and m/4 below each; the coarser ones tell what is left.
RADIAL, ANGULAR = (3, 5), (2, 3)
# Lines on which a disc would touch its images are not reached.
LARGEST = 0.45


class SolvedDiscs(NamedTuple):
    """One array."""

    conductivity: float  # Across the discs, over that of what they lie in
    digits: float  # Decimal digits, from the change with fewer functions and fewer waves


def discs(radius, *, height=1.0) -> SolvedDiscs:
    """Conductivity across a square array of insulated discs.

    Parameters
    ----------
    radius : float, sides
        Of the discs, up to 0.45.
    height : float, sides
        Distance of one layer of discs to the next, at least 0.1.

    Returns
    -------
    SolvedDiscs

    Raises
    ------
    ValueError
        If an argument is not as described.

    Examples
    --------
    >>> from references.exact.cracks import discs
    >>> print(f"{discs(0.25).conductivity:.6f}")
    0.958779
    """
    if not 0 < radius <= LARGEST:
        raise ValueError(f"radius = {radius!r}: must be > 0 and <= {LARGEST} sides of the square")
    if not 0.1 <= height < math.inf:
        raise ValueError(f"height = {height!r}: must be a finite number >= 0.1 sides of the square")
    found = _solve(radius, height, RADIAL[1], ANGULAR[1], WAVES)
    fewer = _solve(radius, height, RADIAL[0], ANGULAR[0], WAVES)
    shorter = _solve(radius, height, RADIAL[1], ANGULAR[1], WAVES // 2)
    change = max(abs(found - fewer), abs(found - shorter))
    return SolvedDiscs(found, 13.0 if change == 0 else min(13.0, -math.log10(change)))


def _solve(a, H, radial, angular, waves):
    m, j = (each.ravel() for each in np.meshgrid(4 * np.arange(angular), np.arange(radial), indexing="ij"))
    nu = j + 0.5
    k, turn, weight = _waves(waves)
    D = np.divide(k, 2 * np.tanh(k * H / 2), out=np.full_like(k, 1 / H), where=k > 0)
    # Coefficients of each function over the square, of unit area; signs of the transform are one for all of an m.
    t = k * a
    shapes = np.array([_transform(order, n, t) for order, n in zip(m, nu, strict=True)]) * np.cos(m[:, None] * turn)
    shapes *= 2 * math.pi * a**2
    matrix = (shapes * (D * weight)) @ shapes.T
    # Waves beyond: k/2 over all directions, an integral from the last one on.
    last = 2 * math.pi * waves * a
    for row in range(len(m)):
        for column in range(len(m)):
            if m[row] == m[column]:
                tail = _beyond(int(m[row]), nu[row], nu[column], last)
                # Of cos^2 over all directions a half, of 1 all.
                share = 1.0 if m[row] == 0 else 0.5
                matrix[row, column] += (2 * math.pi * a**2) ** 2 * share * tail / (4 * math.pi * a**3)
    load = shapes[:, 0]
    # Scaled to a unit diagonal, since the functions are of very different size.
    size = 1 / np.sqrt(np.diag(matrix))
    jump = size * np.linalg.solve(size[:, None] * matrix * size, size * load)
    return float(1 - load @ jump / H)


def _waves(waves):
    """Lengths and directions of wave vectors in an eighth of the plane, 0 first, and how often each is there."""
    p, q = (each.ravel() for each in np.meshgrid(np.arange(waves + 1), np.arange(waves + 1), indexing="ij"))
    here = (q <= p) & (p**2 + q**2 <= waves**2)
    p, q = p[here], q[here]
    weight = np.where(p == 0, 1.0, np.where((q == 0) | (q == p), 4.0, 8.0))
    return 2 * math.pi * np.hypot(p, q), np.arctan2(q, p), weight


def _transform(m, nu, t):
    """2^nu Gamma(nu + 1) J_(m+nu+1)(t) / t^(nu+1), its value at 0 included."""
    scale = 2**nu * gamma(nu + 1)
    at_0 = 0.5 / (nu + 1) if m == 0 else 0.0
    return np.divide(scale * _bessel(m + nu + 1, t), t ** (nu + 1), out=np.full_like(t, at_0), where=t > 0)


def _bessel(order, t):
    """J of half a whole number, by the spherical ones."""
    return np.sqrt(2 * t / math.pi) * spherical_jn(round(order - 0.5), t)


def _beyond(m, one, other, last):
    """Integral over t from `last` on of t^2 times two transforms: that from 0 on, closed, less a quadrature."""
    scale = 2 ** (one + other) * gamma(one + 1) * gamma(other + 1)
    p, q, power = m + one + 1, m + other + 1, one + other
    log = gammaln(power) + gammaln((p + q - power + 1) / 2)
    log -= gammaln((q - p + power + 1) / 2) + gammaln((p + q + power + 1) / 2) + gammaln((p - q + power + 1) / 2)
    whole = math.exp(log) / 2**power
    nodes, weights = np.polynomial.legendre.leggauss(16)
    # Panels of a wave of the product.
    edges = np.linspace(0, last, 2 + math.ceil(last / math.pi))
    half = 0.5 * np.diff(edges)[:, None]
    t = (edges[:-1, None] + half * (1 + nodes)).ravel()
    values = _bessel(p, t) * _bessel(q, t) * t**-power
    return scale * (whole - float(values @ (half * weights).ravel()))
