"""Square and hexagonal arrays of parallel circular fibres by Rayleigh's multipole method, for any contrast.

Rayleigh, Phil. Mag. 34 (1892) 481; Perrins, McKenzie and McPhedran, Proc. R. Soc. A 369 (1979) 207. Across the fibres
the temperature outside of one is the real part of sum (A_l z^l + B_l z^-l), z = x + iy from its centre, for a mean
gradient along x. In the square array l is odd, in the hexagonal one no multiple of 3 besides. The interface gives
B_l = -alpha_l a^2l A_l with alpha_l = (s - 1)/(s + 1), s the contrast, a the radius.

Where the interface has a resistance R, r = R k_m / a, degree l sees s/(1 + s r l) for s: inside is C_l z^l; the flux
across is s l C_l a^(l-1) = l (A_l a^(l-1) - B_l a^(-l-1)), the jump A_l a^l + B_l a^-l - C_l a^l = r a s l C_l a^(l-1).
So (A_l - B_l a^-2l) (1 + s r l) = s (A_l + B_l a^-2l).

Rayleigh's identity says that A_l is what the mean gradient and all other fibres make at this one,
A_l = delta_l1 - sum over l' of C(l+l'-1, l) S_(l+l') B_l', S_n the sum of w^-n over all sites w but the origin; S_2 is
pi over the area of the cell where the mean gradient is that of the cell. Then k/k_m = 1 - 2 pi B_1 / area.

Lengths are in units of the distance of neighbours, conductivities in units of the matrix.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.special import gamma

# Area of the cell of one fibre; turns about a site that leave the array as it is.
AREA = {"square": 1.0, "hexagonal": math.sqrt(3) / 2}
FOLD = {"square": 4, "hexagonal": 6}
FIRST_ORDER, HIGHEST_ORDER = 16, 1024
# Digits of the conductivity at which the order is no longer raised; rounding leaves no more.
ENOUGH = 13.0
# From this degree on a lattice sum is that of the sites nearer than `NEAR`: 6^-32 = 1e-25.
DIRECT, NEAR = 32, 6


class SolvedFibres(NamedTuple):
    """One array at one contrast."""

    kind: str  # {"square", "hexagonal"}
    # contrast, resistance: As they were given; an infinite resistance is a contrast of 0
    contrast: float
    resistance: float
    radius: float  # distances of neighbours
    conductivity: float  # Across the fibres, over that of the matrix
    order: int  # Highest degree l
    # Decimal digits of the conductivity, from the change between three quarters of this order and all of it
    digits: float
    degree: np.ndarray  # (n,) int array
    source: np.ndarray  # (n,) float array, distances of neighbours: B_l / a^l, for a mean unit gradient along x
    outer: np.ndarray  # (n,) float array, distances of neighbours: A_l a^l


def touching(kind) -> float:
    """Volume fraction at which fibres touch."""
    _check_kind(kind)
    return math.pi / (4 * AREA[kind])


def along(contrast, fraction) -> float:
    """Conductivity along fibres of any arrangement, over that of the matrix: the mean, whatever the interface resists.

    Parameters
    ----------
    contrast : float
        Conductivity of the fibres over that of the matrix, finite.
    fraction : float
        Volume fraction of the fibres.

    Examples
    --------
    >>> from references.exact import fibres
    >>> print(f"{fibres.along(10.0, 0.3):.6f}")
    3.700000
    """
    _check_contrast(contrast, most="a finite number >= 0", fits=math.isfinite)
    if not 0 <= fraction <= 1:
        raise ValueError(f"fraction = {fraction!r}: must be from 0 to 1")
    return float(1 + fraction * (contrast - 1))


def conductivity(kind, contrast, fraction, *, resistance=0.0, order=None, digits=6) -> float:
    """Effective conductivity across an array of fibres over that of its matrix.

    Parameters
    ----------
    kind, contrast, fraction, resistance, order, digits
        As those of `solve`.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        As for `solve`.

    Examples
    --------
    >>> from references.exact import fibres
    >>> print(f"{fibres.conductivity('square', 10.0, 0.3):.6f}")
    1.652036
    """
    return solve(kind, contrast, fraction, resistance=resistance, order=order, digits=digits).conductivity


def solve(kind, contrast, fraction, *, resistance=0.0, order=None, digits=6) -> SolvedFibres:
    """Solve an array of fibres under a mean unit gradient across them.

    Parameters
    ----------
    kind : {"square", "hexagonal"}
    contrast : float
        Conductivity of the fibres over that of the matrix, 0 (pores) to infinity (inclusive).
    fraction : float
        Volume fraction of the fibres, less than that of touching ones.
    resistance : float
        Of their surfaces, times the conductivity of the matrix over the radius; infinite, the fibres are pores.
    order : int, optional
        Highest degree; by default raised until the conductivity has converged.
    digits : float, optional
        Fewest digits of the conductivity to accept.

    Returns
    -------
    SolvedFibres

    Raises
    ------
    ValueError
        If an argument is out of range, or fibres come so close that `digits` are not reached.

    Examples
    --------
    >>> from references.exact import fibres
    >>> found = fibres.solve("hexagonal", 10.0, 0.3)
    >>> print(f"{found.conductivity:.4f} {found.digits > 6}")
    1.6506 True
    """
    _check(kind, contrast, fraction, resistance, order)
    if math.isinf(resistance):
        contrast, resistance = 0.0, 0.0
    found = _solve(kind, contrast, fraction, resistance, order or FIRST_ORDER)
    while order is None and found.digits < ENOUGH and found.order < HIGHEST_ORDER:
        found = _solve(kind, contrast, fraction, resistance, 2 * found.order)
    if found.digits < digits:
        raise ValueError(
            f"fraction = {fraction}, contrast = {contrast}: at order {found.order} the {kind} array gives "
            f"{found.digits:.1f} digits, digits = {digits} asked for; the fibres are nearly touching or order is low"
        )
    return found


def lattice_sums(kind, highest) -> np.ndarray:
    """Sums of w^-n over all sites w = x + iy but the origin, n = 0 to highest, a (highest + 1,) float array.

    The first that is there is a value of the gamma function, the next follow by the equation of Weierstrass's
    function, those of high degree are a few sites. But for S_2, pi over the area, only multiples of 4 (of 6 in the
    hexagonal array) do not vanish.
    """
    _check_kind(kind)
    sums, fold = np.zeros(max(highest, DIRECT) + 1), FOLD[kind]
    if kind == "square":
        sums[4] = gamma(1 / 4) ** 8 / (960 * math.pi**2)
    else:
        sums[6] = gamma(1 / 3) ** 18 / (8960 * math.pi**6)
    for n in range(2 * fold, DIRECT, fold):
        # (2k - 1) S_2k are the coefficients of the function: each is a sum of products of those before it.
        k, m = n // 2, np.arange(2, n // 2 - 1)
        products = (2 * m - 1) * sums[2 * m] * (2 * (k - m) - 1) * sums[2 * (k - m)]
        sums[n] = 3 * products.sum() / ((2 * k + 1) * (k - 3)) / (2 * k - 1)
    near = sites(kind)
    for n in range(-(-DIRECT // fold) * fold, highest + 1, fold):
        sums[n] = (near**-n).real.sum()
    sums[2] = math.pi / AREA[kind]
    return sums[: highest + 1]


def sites(kind):
    """Sites up to `NEAR` from the origin, without it, a complex array."""
    steps = np.arange(-2 * NEAR, 2 * NEAR + 1)
    turn = np.exp(2j * math.pi / FOLD[kind])
    w = (steps[:, None] + turn * steps).ravel()
    return w[(np.abs(w) <= NEAR) & (np.abs(w) > 0.5)]


def _solve(kind, contrast, fraction, resistance, order):
    degree = np.arange(1, order + 1, 2)
    degree = degree if kind == "square" else degree[degree % 3 > 0]
    radius = math.sqrt(fraction * AREA[kind] / math.pi)
    system = _system(kind, degree, radius)
    alpha = _polarisability(contrast, degree, resistance)
    matrix, load = np.eye(len(degree)) - alpha[:, None] * system, np.where(degree == 1, -alpha * radius, 0.0)
    source = np.linalg.solve(matrix, load)
    less = int(np.sum(degree <= 3 * order // 4))
    rough = np.linalg.solve(matrix[:less, :less], load[:less])
    moment = 2 * math.pi * radius / AREA[kind]
    ratio = 1 - moment * source[0]
    # What is left is at most three times the change, if it falls at least as the inverse of the order; far from
    # touching it falls geometrically.
    change = 3 * moment * abs(source[0] - rough[0]) / abs(ratio)
    digits = ENOUGH if change == 0 else max(0.0, min(ENOUGH, -math.log10(change)))
    return SolvedFibres(
        kind=kind,
        contrast=float(contrast),
        resistance=float(resistance),
        radius=radius,
        conductivity=float(ratio),
        order=order,
        digits=digits,
        degree=degree,
        source=source,
        outer=np.where(degree == 1, radius, 0.0) - system @ source,
    )


def _system(kind, degree, radius):
    """What fibres with B_l' = a^l' make at another one, minus A_l a^l: C(l+l'-1, l) S_(l+l') a^(l+l')."""
    here, there = degree[:, None], degree[None]
    total = here + there
    top = int(total.max())
    # Powers of 2 a, at most 1, stay within the range of floats, as those binomials do.
    choose = halved_binomials(top)[total - 1, here]
    return 0.5 * choose * lattice_sums(kind, top)[total] * (2 * radius) ** total.astype(float)


def halved_binomials(most):
    """C(n, k) / 2^n up to n = most, a (most + 1, most + 1) float array."""
    halved = np.zeros((most + 1, most + 1))
    halved[0, 0] = 1.0
    for n in range(1, most + 1):
        halved[n, 0] = halved[n - 1, 0] / 2
        halved[n, 1:] = (halved[n - 1, 1:] + halved[n - 1, :-1]) / 2
    return halved


def _polarisability(contrast, degree, resistance):
    """alpha_l of the module docstring, (n,) float array."""
    if math.isinf(contrast):
        return (1 - resistance * degree) / (1 + resistance * degree)
    more = contrast * resistance * degree
    return (contrast - 1 - more) / (contrast + 1 + more)


def _check_kind(kind):
    if kind not in AREA:
        raise ValueError(f"kind = {kind!r}: must be one of {', '.join(AREA)}")


def _check_contrast(contrast, *, most="a number >= 0, infinity included", fits=lambda value: True):
    if not (contrast >= 0 and fits(contrast)):
        raise ValueError(f"contrast = {contrast!r}: must be {most}")


def _check(kind, contrast, fraction, resistance, order):
    _check_kind(kind)
    _check_contrast(contrast)
    if not 0 < fraction < touching(kind):
        raise ValueError(f"fraction = {fraction!r}: must be > 0 and < {touching(kind):.6f}, where {kind} fibres touch")
    if not resistance >= 0:
        raise ValueError(f"resistance = {resistance!r}: must be a number >= 0, infinity included")
    if order is not None and order not in range(1, HIGHEST_ORDER + 1):
        raise ValueError(f"order = {order!r}: must be a whole number from 1 to {HIGHEST_ORDER}")
