"""Bounds and estimates of the effective conductivity of isotropic composites, as plain functions.

Two-phase functions take (k_matrix, k_inclusion, fraction), fraction that of the inclusions; all arguments broadcast, in
any unit of conductivity. Conductivities from 0 to infinity (inclusive) give the limit. Judge a method with its own
discrete fractions, or a correct method may look wrong.

The form that all bounds share is in `mixing`.
"""

import numpy as np
from numpy.typing import ArrayLike

from references.bounds.mixing import (
    checked_fraction,
    checked_pair,
    checked_phases,
    checked_positive,
    checked_third_order,
    contrast,
    dispersed,
    mixed,
    pure,
)

# Far above the root of a cubic each step takes a third off; 1e-8 at the most, in 46 steps, and then some 6 more.
NEWTON_STEPS = 60
# Lattice sum of r^-5 P_4(cos theta) over the simple cubic lattice of spacing 1, axis along an edge.
CUBIC_SUM_4 = 3.108226680
# Fraction at which spheres of the simple cubic array touch.
CUBIC_TOUCHING = np.pi / 6


def voigt(conductivities: ArrayLike, fractions: ArrayLike) -> float | np.ndarray:
    """Arithmetic mean, the upper bound for any microstructure (Voigt 1889; Wiener 1912).

    Parameters
    ----------
    conductivities : (..., phases) float array, W/(m K)
        Any other unit will do.
    fractions : (..., phases) float array
        Sum to 1 along the last axis.

    Returns
    -------
    (...) float array, W/(m K)
    """
    k, p = checked_phases(conductivities, fractions)
    return (np.where(p > 0, k, 0.0) * p).sum(axis=-1)[()]


def reuss(conductivities: ArrayLike, fractions: ArrayLike) -> float | np.ndarray:
    """Harmonic mean, the lower bound for any microstructure (Reuss 1929; Wiener 1912).

    Parameters
    ----------
    conductivities : (..., phases) float array, W/(m K)
        Any other unit will do.
    fractions : (..., phases) float array
        Sum to 1 along the last axis.

    Returns
    -------
    (...) float array, W/(m K)
    """
    k, p = checked_phases(conductivities, fractions)
    with np.errstate(divide="ignore", invalid="ignore"):
        return (1 / np.where(p > 0, p / k, 0.0).sum(axis=-1))[()]


def maxwell(k_matrix: ArrayLike, k_inclusion: ArrayLike, fraction: ArrayLike) -> float | np.ndarray:
    """Maxwell's estimate for spheres (Treatise, 1873, art. 314): exact to first order in the fraction.

    Parameters
    ----------
    k_matrix, k_inclusion : (...) float arrays, W/(m K)
        Any other unit will do, if the same.
    fraction : (...) float array
        Volume fraction of the inclusions.

    Returns
    -------
    (...) float array, W/(m K)
    """
    k1, k2, p2 = checked_pair(k_matrix, k_inclusion, fraction)
    return mixed(k1, k2, p2, 2 * k1)


def hashin_shtrikman(
    k_matrix: ArrayLike, k_inclusion: ArrayLike, fraction: ArrayLike
) -> tuple[float | np.ndarray, float | np.ndarray]:
    """Bounds for isotropic two-phase composites (Hashin and Shtrikman, J. Appl. Phys. 33 (1962) 3125).

    Parameters
    ----------
    k_matrix, k_inclusion : (...) float arrays, W/(m K)
        Any other unit will do, if the same.
    fraction : (...) float array
        Volume fraction of the inclusions.

    Returns
    -------
    lower, upper : (...) float arrays, W/(m K)
    """
    k1, k2, p2 = checked_pair(k_matrix, k_inclusion, fraction)
    return mixed(k1, k2, p2, 2 * np.minimum(k1, k2)), mixed(k1, k2, p2, 2 * np.maximum(k1, k2))


def bruggeman(k_matrix: ArrayLike, k_inclusion: ArrayLike, fraction: ArrayLike) -> float | np.ndarray:
    """Symmetric effective medium (Bruggeman 1935): sum of p_i (k_i - k)/(k_i + 2 k) = 0, blind to which is the matrix.

    With a perfectly conducting phase it percolates at a third of the volume, with an insulating one at two thirds.

    Parameters
    ----------
    k_matrix, k_inclusion : (...) float arrays, W/(m K)
        Any other unit will do, if the same.
    fraction : (...) float array
        Volume fraction of the inclusions.

    Returns
    -------
    (...) float array, W/(m K)
    """
    k1, k2, p2 = checked_pair(k_matrix, k_inclusion, fraction)
    c1, c2 = 3 * (1 - p2) - 1, 3 * p2 - 1
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        b = c1 * k1 + c2 * k2
        root = np.sqrt(b**2 + 8 * k1 * k2)
        # Two forms of the positive root, each free of cancellation on its side.
        k = np.where(b >= 0, (b + root) / 4, 2 * k1 * k2 / (root - b))
        k = np.where(np.isinf(k2), np.where(c2 < 0, -k1 / c2, np.inf), k)
        k = np.where(np.isinf(k1), np.where(c1 < 0, -k2 / c1, np.inf), k)
    k = np.where(np.isinf(k1) & np.isinf(k2), np.inf, k)
    return pure(k, k1, k2, p2)


def bruggeman_differential(k_matrix: ArrayLike, k_inclusion: ArrayLike, fraction: ArrayLike) -> float | np.ndarray:
    """Differential effective medium (Bruggeman 1935): (k_i - k)/(k_i - k_m) (k_m/k)^(1/3) = 1 - fraction.

    Spheres are added little by little, each to what the smaller ones before have made, so the matrix always connects:
    meant for very unequal spheres.

    Parameters
    ----------
    k_matrix, k_inclusion : (...) float arrays, W/(m K)
        Any other unit will do, if the same.
    fraction : (...) float array
        Volume fraction of the inclusions.

    Returns
    -------
    (...) float array, W/(m K)
    """
    k1, k2, p2 = checked_pair(k_matrix, k_inclusion, fraction)
    with np.errstate(invalid="ignore", divide="ignore"):
        c = np.where(k1 == k2, 1.0, np.where(np.isinf(k1), 0.0, k2 / k1))
        rigid = np.isinf(c)
        c = np.where(rigid, 1.0, c)
        # With u = (k/k1)^(1/3): u^3 + (c - 1) p1 u = c, convex for u > 0, so Newton from above falls to the root.
        slope = (c - 1) * (1 - p2)
        u = np.maximum(1.0, np.cbrt(c))
        for _ in range(NEWTON_STEPS):
            u = (2 * u**3 + c) / (3 * u**2 + slope)
        k = k1 * np.where(rigid, (1 - p2) ** -3.0, u**3)
    return pure(k, k1, k2, p2)


def rayleigh(k_matrix: ArrayLike, k_inclusion: ArrayLike, fraction: ArrayLike) -> float | np.ndarray:
    """Simple cubic array to the order that Rayleigh kept (Phil. Mag. 34 (1892) 481): dipoles and octupoles.

    k = k1 + 3 f k1/[1/beta - f - 1.3047 f^(10/3) (k2 - k1)/(k2 + 4 k1/3)], beta = (k2 - k1)/(k2 + 2 k1), from where the
    exact series (McPhedran and McKenzie, Proc. R. Soc. A 359 (1978) 45; `references.exact.lattice`) goes on with
    f^(14/3).
    1.3047 = 16 S^2 (3/(4 pi))^(10/3) with the lattice sum S; 1.65 and 0.523 also stand in print.

    Parameters
    ----------
    k_matrix, k_inclusion : (...) float arrays, W/(m K)
        Any other unit will do, if the same.
    fraction : (...) float array
        Volume fraction of the inclusions.

    Returns
    -------
    (...) float array, W/(m K)

    Raises
    ------
    ValueError
        As for all functions here; and for fractions above pi/6, where the spheres would overlap.
    """
    k1, k2, p2 = checked_pair(k_matrix, k_inclusion, fraction)
    # A fraction worked out from the radius of touching spheres may pass pi/6 in its last digits.
    if np.any(p2 > CUBIC_TOUCHING * (1 + 1e-14)):
        raise ValueError(f"fraction = {fraction!r}: must be <= pi/6, where the spheres of a simple cubic array touch")
    octupole = 16 * CUBIC_SUM_4**2 * (3 / (4 * np.pi)) ** (10 / 3) * p2 ** (10 / 3)
    beta = contrast(k1, k2, 2.0)
    return pure(dispersed(k1, p2, beta, octupole * beta * contrast(k1, k2, 4 / 3)), k1, k2, p2)


def agari_uno(
    k_matrix: ArrayLike, k_inclusion: ArrayLike, fraction: ArrayLike, *, c1: float = 1.0, c2: float = 1.0
) -> float | np.ndarray:
    """Empirical log k = f c2 log k2 + (1 - f) log(c1 k1) (Agari and Uno, J. Appl. Polym. Sci. 32 (1986) 5705).

    Parameters
    ----------
    k_matrix, k_inclusion : (...) float arrays, W/(m K)
        With c2 other than 1 the formula as printed depends on the unit.
    fraction : (...) float array
        Volume fraction of the inclusions.
    c1 : float
        What the filler does to the matrix itself; near 1.
    c2 : float
        Ease with which the filler forms chains, 0 to 1. With both 1 this is the geometric mean, of Lichtenecker.

    Returns
    -------
    (...) float array, W/(m K)

    Raises
    ------
    ValueError
        As for all functions here; and for a zero with an infinite conductivity, which have no geometric mean.
    """
    k1, k2, p2 = checked_pair(k_matrix, k_inclusion, fraction)
    c1, c2 = checked_positive("c1", c1), checked_fraction("c2", c2)
    if np.any(((k1 == 0) & np.isinf(k2)) | ((k2 == 0) & np.isinf(k1))):
        raise ValueError(f"k_matrix = {k_matrix!r}, k_inclusion = {k_inclusion!r}: zero and infinity have no mean")
    return ((c1 * k1) ** (1 - p2) * k2 ** (c2 * p2))[()]


def lewis_nielsen(
    k_matrix: ArrayLike, k_inclusion: ArrayLike, fraction: ArrayLike, *, shape: float = 1.5, packing: float = 0.637
) -> float | np.ndarray:
    """Semi-empirical k = k1 (1 + A B f)/(1 - B psi f) (Nielsen, Ind. Eng. Chem. Fundam. 13 (1974) 17).

    B = (k2 - k1)/(k2 + A k1), psi = 1 + f (1 - packing)/packing^2.

    Parameters
    ----------
    k_matrix, k_inclusion : (...) float arrays, W/(m K)
        Any other unit will do, if the same.
    fraction : (...) float array
        Volume fraction of the inclusions.
    shape : float
        A > 0, 1.5 for spheres; 2 with packing 1 gives back Maxwell.
    packing : float
        Densest packing of the inclusions, 0.637 for randomly packed spheres; no fraction may be larger.

    Returns
    -------
    (...) float array, W/(m K)

    Raises
    ------
    ValueError
        As for all functions here.
    """
    k1, k2, p2 = checked_pair(k_matrix, k_inclusion, fraction)
    shape, packing = checked_positive("shape", shape), checked_positive("packing", packing)
    if np.any(packing > 1) or np.any(p2 > packing):
        raise ValueError(f"packing = {packing}: must be <= 1, and no fraction in {fraction!r} larger")
    b = contrast(k1, k2, shape)
    crowding = 1 + p2 * (1 - packing) / packing**2
    with np.errstate(invalid="ignore", divide="ignore"):
        # psi f = 1 at f = packing only: perfect conductors then touch; rounding must not pass the pole.
        k = np.where(k1 == 0, 0.0, k1 * (1 + shape * b * p2) / np.maximum(1 - b * crowding * p2, 0.0))
    return pure(k, k1, k2, p2)


def third_order(
    k_matrix: ArrayLike, k_inclusion: ArrayLike, fraction: ArrayLike, zeta2: ArrayLike
) -> tuple[float | np.ndarray, float | np.ndarray]:
    """Bounds that know the third-order parameter (Beran 1965; in Milton's form, Phys. Rev. Lett. 46 (1981) 542).

    Parameters
    ----------
    k_matrix, k_inclusion : (...) float arrays, W/(m K)
        Any other unit will do, if the same.
    fraction : (...) float array
        Volume fraction of the inclusions.
    zeta2 : (...) float array
        Milton's parameter of the inclusion phase, 0 to 1; 0 and 1 give back Hashin and Shtrikman's bounds.

    Returns
    -------
    lower, upper : (...) float arrays, W/(m K)
    """
    k1, k2, p2, z2 = checked_third_order(k_matrix, k_inclusion, fraction, zeta2)
    weighted = np.stack([1 - z2, z2], axis=-1)
    stacked = np.stack([k1, k2], axis=-1)
    return mixed(k1, k2, p2, 2 * reuss(stacked, weighted)), mixed(k1, k2, p2, 2 * voigt(stacked, weighted))


def torquato(k_matrix: ArrayLike, k_inclusion: ArrayLike, fraction: ArrayLike, zeta2: ArrayLike) -> float | np.ndarray:
    """Third-order estimate for dispersions (Torquato, J. Appl. Phys. 58 (1985) 3790).

    It rises with zeta2 and meets the upper third-order bound at 1/2, whichever phase conducts better.

    Parameters
    ----------
    k_matrix, k_inclusion : (...) float arrays, W/(m K)
        Any other unit will do, if the same.
    fraction : (...) float array
        Volume fraction of the inclusions.
    zeta2 : (...) float array
        Milton's parameter of the inclusion phase, 0 to 1/2.

    Returns
    -------
    (...) float array, W/(m K)

    Raises
    ------
    ValueError
        As for all functions here; and for zeta2 above 1/2, where the estimate lies above that bound.
    """
    k1, k2, p2, z2 = checked_third_order(k_matrix, k_inclusion, fraction, zeta2)
    if np.any(z2 > 0.5):
        raise ValueError(f"zeta2 = {zeta2!r}: must be <= 1/2, beyond which the estimate passes the upper bound")
    beta = contrast(k1, k2, 2.0)
    third = 2 * (1 - p2) * z2 * beta**2
    return pure(dispersed(k1, p2, beta, third), k1, k2, p2)


def zeta2_hard_spheres(fraction: ArrayLike) -> float | np.ndarray:
    """zeta_2 of equal hard spheres in equilibrium (Miller and Torquato, J. Appl. Phys. 68 (1990) 5486).

    A fit of their simulations. Spheres added one by one at random lie some 7 % lower.

    Parameters
    ----------
    fraction : (...) float array
        Volume fraction of the spheres, 0 to 0.6.

    Returns
    -------
    (...) float array
    """
    p = checked_fraction("fraction", fraction)
    if not np.all((p >= 0) & (p <= 0.6)):
        raise ValueError(f"fraction = {fraction!r}: must lie in 0 to 0.6, where the fit was made")
    return (0.21068 * p - 0.04693 * p**2 + 0.00247 * p**3)[()]
