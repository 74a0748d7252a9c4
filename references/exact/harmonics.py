"""Solid harmonics, and their sums over cubic lattices, computed to rounding and kept for the process.

Racah's normalisation: R_l^m = sqrt((l-m)!/(l+m)!) r^l P_l^m(cos t) exp(i m p), so that |R_l^m| <= r^l, and the
irregular I_l^m = R_l^m / r^(2l+1). Lengths of this module are in units of the cube's edge.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.special import gamma, gammaincc

SITES = {
    "sc": ((0.0, 0.0, 0.0),),
    "bcc": ((0.0, 0.0, 0.0), (0.5, 0.5, 0.5)),
    "fcc": ((0.0, 0.0, 0.0), (0.0, 0.5, 0.5), (0.5, 0.0, 0.5), (0.5, 0.5, 0.0)),
}
NEAREST = {"sc": 1.0, "bcc": np.sqrt(0.75), "fcc": np.sqrt(0.5)}
# Distance from a site to the farthest corner of its Wigner-Seitz cell.
CIRCUMRADIUS = {"sc": np.sqrt(0.75), "bcc": np.sqrt(5.0) / 4, "fcc": 0.5}
# From this degree on the plain sum over 7.5 nearest distances converges to rounding: 7.5^-20 = 3e-18.
DIRECT_FROM = 22
REACH = 7.5
# Tables are made up to the next multiple of this degree and kept: an entry does not depend on where its table ends.
STEP = 60


class Sums(NamedTuple):
    """Sums of I_L^M over the sites of a cubic array, in units of the nearest distance to the power -(L+1)."""

    # total, far: (order + 1, order // 4 + 1) float arrays: Entry [L, M // 4]; over all sites but the origin, and over
    # those beyond `near`
    total: np.ndarray
    far: np.ndarray
    near: np.ndarray  # (n, 3) float array, edges: The origin first, then the sites close to it


def legendre(z, square, order, m):
    """Values of R_l^m / (x + i y)^m, degree by degree."""
    previous, current = np.zeros_like(z), np.full_like(z, _sectoral(m))
    for degree in range(m, order + 1):
        yield current
        up = (2 * degree + 1) * z * current - np.sqrt(float(degree**2 - m**2)) * square * previous
        previous, current = current, up / np.sqrt(float((degree + 1) ** 2 - m**2))


def _sectoral(m):
    """R_m^m / (x + i y)^m = (-1)^m sqrt((2m)!) / (2^m m!), Condon and Shortley's sign included."""
    k = np.arange(1, m + 1)
    return (-1) ** m * np.sqrt(np.prod((2 * k - 1) / (2 * k)))


def series(tables, points):
    """Sum table[l, m] R_l^m(points) for each of several tables."""
    x, y, z = points.T
    square = np.einsum("ij,ij->i", points, points)
    sums = [np.zeros(len(points), dtype=complex) for _ in tables]
    used = np.any([table != 0 for table in tables], axis=0)
    for m in np.flatnonzero(used.any(axis=0)):
        order = np.flatnonzero(used[:, m])[-1]
        parts = np.zeros((len(tables), len(points)))
        for degree, values in enumerate(legendre(z, square, order, m), start=m):
            for part, table in zip(parts, tables, strict=True):
                if table[degree, m]:
                    part += table[degree, m] * values
        phase = (x + 1j * y) ** int(m)
        for total, part in zip(sums, parts, strict=True):
            total += part * phase
    return sums


def _sites(kind, reach):
    """All sites within `reach` edges of the origin, the origin excluded, (n, 3) float array."""
    span = np.arange(-int(reach) - 1, int(reach) + 2)
    cells = np.stack(np.meshgrid(span, span, span, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    sites = (cells + np.array(SITES[kind])).reshape(-1, 3)
    distance = np.linalg.norm(sites, axis=1)
    return sites[(distance > 0) & (distance <= reach)]


def _waves(kind, reach):
    """Reciprocal vectors up to `reach` (in units of 2 pi / edge), the origin excluded."""
    span = np.arange(-int(reach), int(reach) + 1)
    waves = np.stack(np.meshgrid(span, span, span, indexing="ij"), axis=-1).reshape(-1, 3).astype(float)
    present = np.abs(np.exp(2j * np.pi * waves @ np.array(SITES[kind]).T).sum(axis=1)) > 0.5
    return waves[present & (np.linalg.norm(waves, axis=1) > 0)]


def _weighted(points, order, weight):
    """Sum weight(L, r) R_L^M(unit vector) over points for even L >= 4, M = 0, 4, ...; (order+1, order//4+1) array.

    The points have cubic symmetry: one of the 16 that agree in |x|, |y| (in either order) and |z| stands for all.
    """
    folded = np.abs(points)
    folded[:, :2].sort(axis=1)
    _, first, count = np.unique(np.round(folded, 9), axis=0, return_index=True, return_counts=True)
    distance = np.linalg.norm(folded[first], axis=1)
    x, y, z = (folded[first] / distance[:, None]).T
    table = np.zeros((order + 1, order // 4 + 1))
    for m in range(0, order + 1, 4):
        phase = ((x + 1j * y) ** m).real
        for degree, values in enumerate(legendre(z, np.ones_like(z), order, m), start=m):
            if degree % 2 == 0 and degree >= 4:
                table[degree, m // 4] = np.sum(count * weight(degree, distance) * values * phase)
    return table


def lattice_sums(kind, order) -> Sums:
    """Lattice sums of a cubic array by Ewald's splitting (low degrees) and plain summation (high degrees).

    Poisson's formula turns sum_R R_L(R) exp(-t R^2) into a sum over reciprocal vectors K; the part 0 < t < eta of
    R^-(2L+1) = int t^(L-1/2) exp(-t R^2) dt / Gamma(L+1/2) then integrates to exp(-K^2/(4 eta)) / K^2. Degree 2 is the
    conditionally convergent one: a mean gradient imposed on the periodic field fixes it to 2 pi/(3 cell volume).
    """
    whole = _whole_sums(kind, math.ceil(order / STEP) * STEP)
    wanted = np.s_[: order + 1, : order // 4 + 1]
    return Sums(whole.total[wanted], whole.far[wanted], whole.near)


@lru_cache(maxsize=8)
def _whole_sums(kind, order):
    unit = NEAREST[kind]
    cell = 1.0 / len(SITES[kind]) / unit**3
    sites = _sites(kind, REACH * unit) / unit
    near = np.linalg.norm(sites, axis=1) < 2.2 * CIRCUMRADIUS[kind] / unit
    total = _weighted(sites, order, lambda degree, r: r ** -(degree + 1.0))
    far = _weighted(sites[~near], order, lambda degree, r: r ** -(degree + 1.0))
    low = min(order, DIRECT_FROM - 2)
    ewald = _ewald(sites, _waves(kind, 8) * (2 * np.pi * unit), cell, low, np.pi / cell ** (2 / 3))
    close = _weighted(sites[near], low, lambda degree, r: r ** -(degree + 1.0))
    total[: low + 1, : low // 4 + 1] = ewald
    far[: low + 1, : low // 4 + 1] = ewald - close
    total[2, 0] = far[2, 0] = 2 * np.pi / (3 * cell)
    return Sums(total, far, np.vstack([np.zeros(3), sites[near] * unit]))


def _ewald(sites, waves, cell, order, eta):
    """Sums over sites and reciprocal vectors; any splitting eta gives the same, near pi / cell^(2/3) both are short."""

    def real(degree, r):
        return gammaincc(degree + 0.5, eta * r**2) * r ** -(degree + 1.0)

    def reciprocal(degree, k):
        factor = (-1) ** (degree // 2) * np.pi**1.5 * 2.0 ** (2 - degree) / (cell * gamma(degree + 0.5))
        return factor * k ** (degree - 2.0) * np.exp(-(k**2) / (4 * eta))

    return _weighted(sites, order, real) + _weighted(waves, order, reciprocal)
