"""Bounds and estimates of the effective conductivity of isotropic composites, as plain functions.

Two-phase functions take (k_matrix, k_inclusion, fraction), fraction that of the inclusions; all arguments broadcast, in
any unit of conductivity. Conductivities from 0 to infinity (inclusive) give the limit. Judge a method with its own
discrete fractions, or a correct method may look wrong.

All bounds here have one form (Hill; Milton 2002, ch. 26): with <k> = p1 k1 + p2 k2 and the exchanged <k~> = p2 k1 +
p1 k2, k(X) = <k> - p1 p2 (k2 - k1)^2 / (<k~> + X) = (k1 k2 + X <k>) / (<k~> + X), rising with X. X = 2 k1 is Maxwell,
X = 2 min(k1, k2) and 2 max(k1, k2) Hashin and Shtrikman. The last form loses no digits and has its limits.
"""

from __future__ import annotations

import numpy as np

# Fractions worked out by a method sum to 1 within this, by rounding of sums over millions of cells.
SUM_TOLERANCE = 1e-8


def voigt(conductivities, fractions):
    """Arithmetic mean, the upper bound for any microstructure (Voigt 1889; Wiener 1912).

    Parameters
    ----------
    conductivities : (..., phases) float array
    fractions : (..., phases) float array
        Sum to 1 along the last axis.

    Returns
    -------
    (...) float array
    """
    k, p = _phases(conductivities, fractions)
    return (np.where(p > 0, k, 0.0) * p).sum(axis=-1)[()]


def reuss(conductivities, fractions):
    """Harmonic mean, the lower bound for any microstructure; arguments as `voigt`."""
    k, p = _phases(conductivities, fractions)
    with np.errstate(divide="ignore", invalid="ignore"):
        return (1 / np.where(p > 0, p / k, 0.0).sum(axis=-1))[()]


def maxwell(k_matrix, k_inclusion, fraction):
    """Maxwell's estimate for spheres (Treatise, 1873, art. 314): exact to first order in the fraction."""
    k1, k2, p2 = _pair(k_matrix, k_inclusion, fraction)
    return _mixed(k1, k2, p2, 2 * k1)


def hashin_shtrikman(k_matrix, k_inclusion, fraction):
    """Bounds for isotropic two-phase composites (Hashin and Shtrikman, J. Appl. Phys. 33 (1962) 3125).

    Returns
    -------
    lower, upper : (...) float arrays
    """
    k1, k2, p2 = _pair(k_matrix, k_inclusion, fraction)
    return _mixed(k1, k2, p2, 2 * np.minimum(k1, k2)), _mixed(k1, k2, p2, 2 * np.maximum(k1, k2))


def bruggeman(k_matrix, k_inclusion, fraction):
    """Symmetric effective medium (Bruggeman 1935): sum of p_i (k_i - k)/(k_i + 2 k) = 0, blind to which is the matrix.

    With a perfectly conducting phase it percolates at a third of the volume, with an insulating one at two thirds.
    """
    k1, k2, p2 = _pair(k_matrix, k_inclusion, fraction)
    c1, c2 = 3 * (1 - p2) - 1, 3 * p2 - 1
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        b = c1 * k1 + c2 * k2
        root = np.sqrt(b**2 + 8 * k1 * k2)
        # Two forms of the positive root, each free of cancellation on its side.
        k = np.where(b >= 0, (b + root) / 4, 2 * k1 * k2 / (root - b))
        k = np.where(np.isinf(k2), np.where(c2 < 0, -k1 / c2, np.inf), k)
        k = np.where(np.isinf(k1), np.where(c1 < 0, -k2 / c1, np.inf), k)
    k = np.where(np.isinf(k1) & np.isinf(k2), np.inf, k)
    return _pure(k, k1, k2, p2)


def third_order(k_matrix, k_inclusion, fraction, zeta2):
    """Bounds that know the third-order parameter (Beran 1965; in Milton's form, Phys. Rev. Lett. 46 (1981) 542).

    Parameters
    ----------
    k_matrix, k_inclusion, fraction : float arrays
    zeta2 : float array
        Milton's parameter of the inclusion phase, 0 to 1; 0 and 1 give back Hashin and Shtrikman's bounds.

    Returns
    -------
    lower, upper : (...) float arrays
    """
    k1, k2, p2, z2 = _pair(k_matrix, k_inclusion, fraction, zeta2)
    weighted = np.stack([1 - z2, z2], axis=-1)
    stacked = np.stack([k1, k2], axis=-1)
    return _mixed(k1, k2, p2, 2 * reuss(stacked, weighted)), _mixed(k1, k2, p2, 2 * voigt(stacked, weighted))


def torquato(k_matrix, k_inclusion, fraction, zeta2):
    """Third-order estimate for dispersions (Torquato, J. Appl. Phys. 58 (1985) 3790), arguments as `third_order`.

    Raises
    ------
    ValueError
        As for all functions here; and where zeta2 is so large, over 1/2, that the estimate passes its pole.
    """
    k1, k2, p2, z2 = _pair(k_matrix, k_inclusion, fraction, zeta2)
    with np.errstate(invalid="ignore", divide="ignore"):
        beta = np.where(k1 == k2, 0.0, np.where(np.isinf(k2), 1.0, (k2 - k1) / (k2 + 2 * k1)))
        beta = np.where(np.isinf(k1) & np.isfinite(k2), -0.5, beta)
        third = 2 * (1 - p2) * z2 * beta**2
        above, below = 1 + 2 * p2 * beta - third, 1 - p2 * beta - third
        if np.any((below <= 0) & (p2 < 1)):
            raise ValueError(f"zeta2 = {zeta2!r}: too large for this contrast and fraction, the estimate diverges")
        k = np.where(above == 0, 0.0, k1 * above / below)
    return _pure(k, k1, k2, p2)


def zeta2_hard_spheres(fraction):
    """zeta_2 of equal hard spheres in equilibrium (Miller and Torquato, J. Appl. Phys. 68 (1990) 5486).

    A fit of their simulations, 0 <= fraction <= 0.6. Spheres added one by one at random lie some 7 % lower.
    """
    p = np.asarray(fraction, dtype=float)
    if not np.all((p >= 0) & (p <= 0.6)):
        raise ValueError(f"fraction = {fraction!r}: must lie in 0 to 0.6, where the fit was made")
    return (0.21068 * p - 0.04693 * p**2 + 0.00247 * p**3)[()]


def _phases(conductivities, fractions):
    k, p = np.broadcast_arrays(_conductivity("conductivities", conductivities), _fraction("fractions", fractions))
    if k.ndim == 0 or not np.all(np.abs(p.sum(axis=-1) - 1) <= SUM_TOLERANCE):
        raise ValueError(f"fractions = {fractions!r}: must sum to 1 along the last axis, that of the phases")
    return k, p


def _pair(k_matrix, k_inclusion, fraction, zeta2=None):
    arrays = [
        _conductivity("k_matrix", k_matrix),
        _conductivity("k_inclusion", k_inclusion),
        _fraction("fraction", fraction),
    ]
    if zeta2 is not None:
        arrays.append(_fraction("zeta2", zeta2))
    return np.broadcast_arrays(*arrays)


def _conductivity(name, value):
    array = np.asarray(value, dtype=float)
    if not np.all(array >= 0):
        raise ValueError(f"{name} = {value!r}: must be >= 0, infinity included")
    return array


def _fraction(name, value):
    array = np.asarray(value, dtype=float)
    if not np.all((array >= 0) & (array <= 1)):
        raise ValueError(f"{name} = {value!r}: must lie in 0 to 1")
    return array


def _mixed(k1, k2, p2, x):
    """k(X) of the module docstring, with its limits."""
    p1 = 1 - p2
    with np.errstate(invalid="ignore", divide="ignore"):
        mean, exchanged = p1 * k1 + p2 * k2, p2 * k1 + p1 * k2
        k = (k1 * k2 + x * mean) / (exchanged + x)
        k = np.where(np.isinf(k2), np.where(np.isinf(x), np.inf, (k1 + x * p2) / p1), k)
        k = np.where(np.isinf(k1), np.where(np.isinf(x), np.inf, (k2 + x * p1) / p2), k)
    k = np.where((exchanged + x == 0) | (np.isinf(k1) & np.isinf(k2)), np.maximum(k1, k2), k)
    return _pure(k, k1, k2, p2)


def _pure(k, k1, k2, p2):
    """The value k of a mixture, or that of the phase where there is one alone."""
    return np.where(p2 == 0, k1, np.where(p2 == 1, k2, k))[()]
