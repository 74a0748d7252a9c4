"""Cubic arrays of equal spheres by Rayleigh's multipole method, for any contrast; the field is in `lattice_field`.

Rayleigh (1892); McPhedran and McKenzie, Proc. R. Soc. A 359 (1978) 45; Sangani and Acrivos, Proc. R. Soc. A 386 (1983)
263. Outside its sphere the temperature is sum (A_lm R_l^m + B_lm I_l^m), l odd, m = 0, 4, ..., for a mean gradient
along z. The interface gives B_l = -alpha_l r^(2l+1) A_l with alpha_l = l (s - 1) / (l s + l + 1), s the contrast;
where it has a resistance R, with R k_m/a = rho of a sphere of radius a, degree l sees s/(1 + s rho l) for s;
Rayleigh's identity says that A is what the mean gradient and all other spheres make at this one.

Lengths are in units of the cube's edge, conductivities in units of the matrix.
"""

import math
from typing import NamedTuple

import numpy as np

from references.exact.harmonics import CIRCUMRADIUS, NEAREST, SITES, lattice_sums

FIRST_ORDER, HIGHEST_ORDER = 15, 179
# Digits of the conductivity and of the flux at the interface at which the order is no longer raised.
ENOUGH = (12.0, 10.0)
# Rounding of the linear solve leaves no more than this.
MOST_DIGITS = 13.0
# Highest degree of what the far spheres make in one cell: 0.545^59 = 3e-16 even when spheres touch.
FAR_ORDER = 59


class SolvedArray(NamedTuple):
    """One array at one contrast."""

    kind: str  # {"sc", "bcc", "fcc"}
    contrast: float  # Conductivity of the spheres over that of the matrix
    resistance: float  # Of their surfaces, times the conductivity of the matrix over the radius
    radius: float  # edges
    conductivity: float  # Of the array over that of the matrix
    order: int  # Highest degree l
    # Decimal digits of the conductivity, from the change between three quarters of this order and all of it
    digits: float
    # Decimal digits of the flux at the interface, where the series converges most slowly, from its last terms
    field_digits: float
    residual: float  # Relative residual of the linear system, recomputed
    # source, inner: (n, n) float arrays: Entry [l, m]: B_lm / r^(l+1), and A_lm r^l, of the sphere at the origin
    source: np.ndarray
    inner: np.ndarray
    # (n, n) float array: Entry [l, m]: coefficient of R_l^m(x / circumradius of the cell) in what the mean gradient and
    # the spheres beyond the near ones make in the cell at the origin
    far: np.ndarray


class Unknowns(NamedTuple):
    """Which harmonics are there."""

    degree: np.ndarray  # (n,) int arrays
    m: np.ndarray  # (n,) int arrays


def radius(kind, fraction):
    """Radius of the spheres of a cubic array."""
    _check_kind(kind)
    return (3 * fraction / (4 * math.pi * len(SITES[kind]))) ** (1 / 3)


def conductivity(kind, contrast, fraction, *, resistance=0.0, order=None, digits=6) -> float:
    """Effective conductivity of a cubic array over that of its matrix."""
    return solve(kind, contrast, fraction, resistance=resistance, order=order, digits=digits).conductivity


def solve(kind, contrast, fraction, *, resistance=0.0, order=None, digits=6) -> SolvedArray:
    """Solve a cubic array of spheres under a mean unit gradient."""
    _check(kind, contrast, fraction, order)
    if not 0 <= resistance < math.inf:
        raise ValueError(f"resistance = {resistance!r}: must be a finite number >= 0")
    given = kind, float(contrast), fraction, float(resistance)
    found = _solve(*given, order or FIRST_ORDER)
    while order is None and found.order < HIGHEST_ORDER:
        reached = min(found.digits / ENOUGH[0], found.field_digits / ENOUGH[1])
        if reached >= 1:
            break
        # Digits grow in proportion to the order, as long as the spheres do not touch.
        step = math.ceil(found.order / max(reached, 0.4)) // 2 * 2 + 1
        found = _solve(*given, min(max(step, found.order + 4), HIGHEST_ORDER))
    if found.digits < digits:
        raise ValueError(
            f"fraction = {fraction}, contrast = {contrast}: at order {found.order} the {kind} array gives "
            f"{found.digits:.1f} digits, digits = {digits} asked for; the spheres are nearly touching or order is low"
        )
    return found._replace(far=_far(found))


def zeta2(kind, fraction) -> float:
    """Milton's parameter zeta_2 of a cubic array, exactly.

    The third order in s - 1 of Rayleigh's solution against that of Torquato's expansion:
    zeta_2 = 3/(2 phi_1) sum over l >= 3 of l/(2l+1) M_1l^2, M the matrix by which multipoles act on each other.
    """
    _check(kind, 1.0, fraction, None)
    dipole, others = _unknowns(1), _unknowns(HIGHEST_ORDER)
    sums, scale = lattice_sums(kind, HIGHEST_ORDER + 1).total, radius(kind, fraction) / NEAREST[kind]
    (there,) = _translation(dipole, others, sums, scale, scale)
    (back,) = _translation(others, dipole, sums, scale, scale).T
    degree = others.degree
    return float(1.5 / (1 - fraction) * np.sum((degree / (2 * degree + 1) * there * back)[1:]))


def _check_kind(kind):
    if kind not in SITES:
        raise ValueError(f"kind = {kind!r}: must be one of {', '.join(SITES)}")


def _check(kind, contrast, fraction, order):
    _check_kind(kind)
    if not contrast >= 0:
        raise ValueError(f"contrast = {contrast!r}: must be a number >= 0, infinity included")
    # Touching spheres are the limit; the last digits of a fraction worked out from a radius may pass it.
    touching = 4 / 3 * math.pi * (NEAREST[kind] / 2) ** 3 * len(SITES[kind])
    if not 0 < fraction <= touching * (1 + 1e-14):
        raise ValueError(f"fraction = {fraction!r}: must be > 0 and <= {touching:.6f}, where {kind} spheres touch")
    if order is not None and (order not in range(1, 254, 2)):
        raise ValueError(f"order = {order!r}: must be an odd number from 1 to 253")


def _unknowns(order):
    """`Unknowns` with l = 1, 3, ..., order and m = 0, 4, ..., l."""
    pairs = [(degree, m) for degree in range(1, order + 1, 2) for m in range(0, degree + 1, 4)]
    return Unknowns(*np.array(pairs).T)


def _binomials(size):
    """Pascal's triangle in floats: sums of positive numbers, so every entry is right to some n roundings."""
    table = np.zeros((size + 1, size + 1))
    table[:, 0] = 1.0
    for n in range(1, size + 1):
        table[n, 1:] = table[n - 1, 1:] + table[n - 1, :-1]
    return table


def _translation(receive, send, sums, length, size):
    """Matrix from B_lm / r^(l+1) of other spheres to minus what they make here, (n', n) float array.

    I_l^m(R - x) = sum over l'm' of sqrt(C(l+l'+m+m', l+m) C(l+l'-m-m', l-m)) conj(R_l'^m'(x)) I_(l+l')^(m+m')(R).
    The length to which R_l'^m' refers and the radius r, its size, are in nearest distances.
    """
    p, q, n, m = receive.degree[:, None], receive.m[:, None], send.degree[None], send.m[None]
    choose = np.sqrt(_binomials(2 * int(p.max() + n.max())))
    plus = choose[p + n + q + m, n + m] * choose[p + n - q - m, n - m] * sums[p + n, (q + m) // 4]
    minus = choose[p + n + q - m, n - m] * choose[p + n - q + m, n + m] * sums[p + n, abs(q - m) // 4]
    # The powers meet the binomials in two steps: apart they stay within the range of floats.
    return length ** p.astype(float) * (plus + np.where(m > 0, minus, 0.0)) * size ** (n + 1.0)


def _far(solution):
    """What the mean gradient and the spheres beyond the near ones make in the cell at the origin."""
    kind, order, unit = solution.kind, solution.order, NEAREST[solution.kind]
    here, send = _unknowns(FAR_ORDER), _unknowns(order)
    sums = lattice_sums(kind, order + FAR_ORDER).far
    translation = _translation(here, send, sums, CIRCUMRADIUS[kind] / unit, solution.radius / unit)
    table = np.zeros((FAR_ORDER + 1, FAR_ORDER + 1))
    degree, m = here
    made = translation @ solution.source[send.degree, send.m]
    table[degree, m] = np.where(degree == 1, CIRCUMRADIUS[kind], 0.0) - made
    return table


def polarisability(contrast, degree, resistance=0.0):
    """alpha_l of the module docstring."""
    if math.isinf(contrast):
        # What has one temperature has no source, which is degree 0.
        return np.where(np.asarray(degree) > 0, (1 - resistance * degree) / (1 + resistance * (degree + 1)), 0.0)
    # What the surface adds to the resistance of the sphere itself, for each degree.
    more = contrast * resistance * degree
    return degree * (contrast - 1 - more) / (degree * contrast + degree + 1 + (degree + 1) * more)


def _solve(kind, contrast, fraction, resistance, order):
    r = radius(kind, fraction)
    degree, m = unknowns = _unknowns(order)
    sums, scale = lattice_sums(kind, 2 * order).total, r / NEAREST[kind]
    matrix, alpha = _translation(unknowns, unknowns, sums, scale, scale), polarisability(contrast, degree, resistance)
    system = np.eye(len(degree)) - alpha[:, None] * matrix
    load = np.where(degree == 1, -alpha * r, 0.0)
    b = np.linalg.solve(system, load)
    # What is left at this order is at most three times the change from three quarters of it, if the error falls at
    # least as the inverse of the order, as it does even when spheres touch; it falls geometrically when they do not.
    less = int(np.sum(degree <= 3 * order // 4))
    rough = np.linalg.solve(system[:less, :less], load[:less])
    moment = 4 * math.pi * r**2 * len(SITES[kind])
    ratio = 1 - moment * b[0]
    last = np.abs(degree * b)[degree >= order - 3].max() / r
    source, inner = np.zeros((2, order + 1, order + 1))
    source[degree, m] = b
    inner[degree, m] = np.where(degree == 1, r, 0.0) - matrix @ b
    return SolvedArray(
        kind=kind,
        contrast=contrast,
        resistance=resistance,
        radius=r,
        conductivity=float(ratio),
        order=order,
        digits=_digits(3 * moment * abs(b[0] - rough[0]) / ratio),
        field_digits=_digits(last),
        residual=float(np.linalg.norm(system @ b - load) / max(np.linalg.norm(load), np.finfo(float).tiny)),
        source=source,
        inner=inner,
        far=np.zeros((0, 0)),
    )


def _digits(error):
    return MOST_DIGITS if error == 0 else max(0.0, min(MOST_DIGITS, -math.log10(error)))
