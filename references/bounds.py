"""Bounds and estimates of the effective conductivity of isotropic composites, as plain functions.

Two-phase functions take (k_matrix, k_inclusion, fraction), fraction that of the inclusions; all arguments broadcast, in
any unit of conductivity. Conductivities from 0 to infinity (inclusive) give the limit. Judge a method with its own
discrete fractions, or a correct method may look wrong. `estimate` takes a scene.

All bounds here have one form (Hill; Milton 2002, ch. 26): with <k> = p1 k1 + p2 k2 and the exchanged <k~> = p2 k1 +
p1 k2, k(X) = <k> - p1 p2 (k2 - k1)^2 / (<k~> + X) = (k1 k2 + X <k>) / (<k~> + X), rising with X. X = 2 k1 is Maxwell,
X = 2 min(k1, k2) and 2 max(k1, k2) Hashin and Shtrikman. The last form loses no digits and has its limits.
"""

from __future__ import annotations

import numpy as np

from demheat.method import Errors, Method
from demheat.scene import Sphere

# Fractions worked out by a method sum to 1 within this, by rounding of sums over millions of cells.
SUM_TOLERANCE = 1e-8
# Far above the root of a cubic each step takes a third off; 1e-8 at the most, in 46 steps, and then some 6 more.
NEWTON_STEPS = 60
# Lattice sum of r^-5 P_4(cos theta) over the simple cubic lattice of spacing 1, axis along an edge.
CUBIC_SUM_4 = 3.108226680
# Fraction at which spheres of the simple cubic array touch.
CUBIC_TOUCHING = np.pi / 6


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


def bruggeman_differential(k_matrix, k_inclusion, fraction):
    """Differential effective medium (Bruggeman 1935): (k_i - k)/(k_i - k_m) (k_m/k)^(1/3) = 1 - fraction.

    Spheres are added little by little, each to what the smaller ones before have made, so the matrix always connects:
    meant for very unequal spheres.
    """
    k1, k2, p2 = _pair(k_matrix, k_inclusion, fraction)
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
    return _pure(k, k1, k2, p2)


def rayleigh(k_matrix, k_inclusion, fraction):
    """Simple cubic array to the order that Rayleigh kept (Phil. Mag. 34 (1892) 481): dipoles and octupoles.

    k = k1 + 3 f k1/[1/beta - f - 1.3047 f^(10/3) (k2 - k1)/(k2 + 4 k1/3)], beta = (k2 - k1)/(k2 + 2 k1), from where the
    exact series (McPhedran and McKenzie, Proc. R. Soc. A 359 (1978) 45; `references.exact.lattice`) goes on with
    f^(14/3).
    1.3047 = 16 S^2 (3/(4 pi))^(10/3) with the lattice sum S; 1.65 and 0.523 also stand in print.

    Raises
    ------
    ValueError
        As for all functions here; and for fractions above pi/6, where the spheres would overlap.
    """
    k1, k2, p2 = _pair(k_matrix, k_inclusion, fraction)
    # A fraction worked out from the radius of touching spheres may pass pi/6 in its last digits.
    if np.any(p2 > CUBIC_TOUCHING * (1 + 1e-14)):
        raise ValueError(f"fraction = {fraction!r}: must be <= pi/6, where the spheres of a simple cubic array touch")
    octupole = 16 * CUBIC_SUM_4**2 * (3 / (4 * np.pi)) ** (10 / 3) * p2 ** (10 / 3)
    beta = _contrast(k1, k2, 2.0)
    return _pure(_dispersed(k1, p2, beta, octupole * beta * _contrast(k1, k2, 4 / 3)), k1, k2, p2)


def agari_uno(k_matrix, k_inclusion, fraction, *, c1=1.0, c2=1.0):
    """Empirical log k = f c2 log k2 + (1 - f) log(c1 k1) (Agari and Uno, J. Appl. Polym. Sci. 32 (1986) 5705).

    Parameters
    ----------
    k_matrix, k_inclusion, fraction : float arrays, W/(m K)
        With c2 other than 1 the formula as printed depends on the unit.
    c1 : float
        What the filler does to the matrix itself; near 1.
    c2 : float
        Ease with which the filler forms chains, 0 to 1. With both 1 this is the geometric mean, of Lichtenecker.

    Raises
    ------
    ValueError
        As for all functions here; and for a zero with an infinite conductivity, which have no geometric mean.
    """
    k1, k2, p2 = _pair(k_matrix, k_inclusion, fraction)
    c1, c2 = _positive("c1", c1), _fraction("c2", c2)
    if np.any(((k1 == 0) & np.isinf(k2)) | ((k2 == 0) & np.isinf(k1))):
        raise ValueError(f"k_matrix = {k_matrix!r}, k_inclusion = {k_inclusion!r}: zero and infinity have no mean")
    return ((c1 * k1) ** (1 - p2) * k2 ** (c2 * p2))[()]


def lewis_nielsen(k_matrix, k_inclusion, fraction, *, shape=1.5, packing=0.637):
    """Semi-empirical k = k1 (1 + A B f)/(1 - B psi f) (Nielsen, Ind. Eng. Chem. Fundam. 13 (1974) 17).

    B = (k2 - k1)/(k2 + A k1), psi = 1 + f (1 - packing)/packing^2.

    Parameters
    ----------
    k_matrix, k_inclusion, fraction : float arrays
    shape : float
        A > 0, 1.5 for spheres; 2 with packing 1 gives back Maxwell.
    packing : float
        Densest packing of the inclusions, 0.637 for randomly packed spheres; no fraction may be larger.

    Raises
    ------
    ValueError
        As for all functions here.
    """
    k1, k2, p2 = _pair(k_matrix, k_inclusion, fraction)
    shape, packing = _positive("shape", shape), _positive("packing", packing)
    if np.any(packing > 1) or np.any(p2 > packing):
        raise ValueError(f"packing = {packing}: must be <= 1, and no fraction in {fraction!r} larger")
    b = _contrast(k1, k2, shape)
    crowding = 1 + p2 * (1 - packing) / packing**2
    with np.errstate(invalid="ignore", divide="ignore"):
        # psi f = 1 at f = packing only: perfect conductors then touch; rounding must not pass the pole.
        k = np.where(k1 == 0, 0.0, k1 * (1 + shape * b * p2) / np.maximum(1 - b * crowding * p2, 0.0))
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

    It rises with zeta2 and meets the upper third-order bound at 1/2, whichever phase conducts better.

    Raises
    ------
    ValueError
        As for all functions here; and for zeta2 above 1/2, where the estimate lies above that bound.
    """
    k1, k2, p2, z2 = _pair(k_matrix, k_inclusion, fraction, zeta2)
    if np.any(z2 > 0.5):
        raise ValueError(f"zeta2 = {zeta2!r}: must be <= 1/2, beyond which the estimate passes the upper bound")
    beta = _contrast(k1, k2, 2.0)
    third = 2 * (1 - p2) * z2 * beta**2
    return _pure(_dispersed(k1, p2, beta, third), k1, k2, p2)


def zeta2_hard_spheres(fraction):
    """zeta_2 of equal hard spheres in equilibrium (Miller and Torquato, J. Appl. Phys. 68 (1990) 5486).

    A fit of their simulations, 0 <= fraction <= 0.6. Spheres added one by one at random lie some 7 % lower.
    """
    p = np.asarray(fraction, dtype=float)
    if not np.all((p >= 0) & (p <= 0.6)):
        raise ValueError(f"fraction = {fraction!r}: must lie in 0 to 0.6, where the fit was made")
    return (0.21068 * p - 0.04693 * p**2 + 0.00247 * p**3)[()]


def estimate(scene, *, formula="maxwell"):
    """Effective conductivity of a scene by one of the formulas of isotropic dispersions.

    Parameters
    ----------
    scene : Scene
        Spheres of one material, which no wall cuts.
    formula : {"maxwell", "rayleigh", "bruggeman", "bruggeman_differential"}

    Returns
    -------
    float, W/(m K)

    Raises
    ------
    ValueError
        If there is no such formula.
    NotImplementedError
        For layers, unlike spheres, and spheres that a wall cuts.
    """
    from references.exact.solver import fractions

    if formula not in FORMULAS:
        raise ValueError(f"formula = {formula!r}: must be one of {', '.join(FORMULAS)}")
    if not all(isinstance(inclusion, Sphere) for inclusion in scene.inclusions):
        raise NotImplementedError("bounds: layers; formulas are of spheres in a matrix")
    found = {inclusion.material.conductivity for inclusion in scene.inclusions}
    if len(found) > 1:
        raise NotImplementedError(f"bounds: spheres of {len(found)} conductivities; formulas are of two phases")
    k1 = scene.matrix.conductivity
    return float(FORMULAS[formula](k1, *(found or {k1}), fractions(scene)[1:].sum()))


FORMULAS = {
    "maxwell": maxwell,
    "rayleigh": rayleigh,
    "bruggeman": bruggeman,
    "bruggeman_differential": bruggeman_differential,
}
FORMULA = {
    "role": "beside",
    "call": "estimate",
    "exceptions": {"field": "a formula knows the conductivity alone"},
    "refuses": {"layers": "bounds: layers", "nested": "conductivities", "unlike": "conductivities", "cut": "a wall"},
}
# Errors at 15 % of spheres; at half of the volume all are tens of per cent off but Rayleigh's, of cubic arrays.
METHODS = (
    Method(name="maxwell", title="Maxwell", **FORMULA, errors=Errors(6.6e-4), look=("grey", "", "-.")),
    Method(name="rayleigh", title="Rayleigh", knobs={"formula": "rayleigh"}, **FORMULA, errors=Errors(6.1e-6)),
    Method(name="bruggeman", title="Bruggeman", knobs={"formula": "bruggeman"}, **FORMULA, errors=Errors(8.3e-2)),
    Method(
        name="bruggeman-differential",
        title="Bruggeman, differential",
        knobs={"formula": "bruggeman_differential"},
        **FORMULA,
        errors=Errors(3.6e-2),
    ),
)


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


def _positive(name, value):
    array = np.asarray(value, dtype=float)
    if not np.all((array > 0) & np.isfinite(array)):
        raise ValueError(f"{name} = {value!r}: must be a finite number > 0")
    return array


def _contrast(k1, k2, weight):
    """(k2 - k1)/(k2 + weight k1) with its limits."""
    with np.errstate(invalid="ignore", divide="ignore"):
        value = np.where(np.isinf(k2), 1.0, (k2 - k1) / (k2 + weight * k1))
    return np.where(k1 == k2, 0.0, np.where(np.isinf(k1), -1 / weight, value))


def _dispersed(k1, p2, beta, third):
    """Maxwell's estimate with a term of third order in the contrast, k1 (1 + 2 p2 beta - t)/(1 - p2 beta - t)."""
    # Rounding must not pass the pole.
    above, below = 1 + 2 * p2 * beta - third, np.maximum(1 - p2 * beta - third, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(above == 0, 0.0, k1 * above / below)


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
