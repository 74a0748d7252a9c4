"""Temperature and flux in arrays of fibres, of a `references.exact.fibres.SolvedFibres`, across the fibres.

In the cell around a fibre its own and its near neighbours' multipoles are summed as they are, what those beyond and the
mean gradient make is a series in z. For a gradient (g, h) coefficients are A_l (g - i e h) and B_l (g + i e h), e = 1
where l is 1 more than a multiple of the array's turns and -1 elsewhere: h turns the signs of all lattice sums but S_2.

Lengths are in distances of neighbours, conductivities in units of the matrix; the first neighbour lies along x.
"""

import math
from typing import NamedTuple

import numpy as np

from references.exact.fibres import AREA, DIRECT, FOLD, halved_binomials, lattice_sums, sites

# Sites nearer than this are summed as they are; of those beyond, powers of z up to this degree: .54^60 = 1e-16.
BESIDE, HIGHEST = 2.1, 59


class _Parts(NamedTuple):
    """Temperature and its derivative as an analytic function of z in each cell, for one gradient."""

    sources: np.ndarray  # (n,) complex B_l / a^l
    far: np.ndarray  # (HIGHEST + 1,) complex, of powers of z
    inner: np.ndarray  # (n,) complex, of powers of z / a in the fibre, the temperature
    flow: np.ndarray  # (n,) complex, the same times the contrast, whatever that is


def temperature(array, points, gradient) -> np.ndarray:
    """Temperature, 0 in the middle of the fibre at the origin.

    Parameters
    ----------
    array : SolvedFibres
    points : (n, 2) float array
        Relative to the centre of a fibre.
    gradient : (2,) sequence of float
        The mean one.

    Returns
    -------
    (n,) float array

    Examples
    --------
    >>> from references.exact import fibres
    >>> from references.exact.fibres_field import temperature
    >>> temperature(fibres.solve("square", 10.0, 0.3), [[0.5, 0.0]], (1.0, 0.0)).round(9).tolist()  # by symmetry
    [0.5]
    """
    parts, (home, z, inside) = _parts(array, gradient), _cells(array, points)
    found = np.empty(len(z))
    found[inside] = _powers(parts.inner, array.degree, z[inside] / array.radius).real
    found[~inside] = _outside(array, parts, z[~inside])[0].real
    g, h = gradient
    return found + g * home.real + h * home.imag


def flux(array, points, gradient) -> np.ndarray:
    """Flux density, (n, 2) float array; in a fibre of infinite conductivity, too.

    Parameters
    ----------
    array, points, gradient
        As those of `temperature`.

    Examples
    --------
    >>> from references.exact import fibres
    >>> from references.exact.fibres_field import flux
    >>> print(f"{flux(fibres.solve('square', 10.0, 0.3), [[0.0, 0.0]], (1.0, 0.0))[0, 0]:.3f}")
    -2.415
    """
    parts, (_, z, inside) = _parts(array, gradient), _cells(array, points)
    slope = np.empty(len(z), complex)
    degree = array.degree
    slope[inside] = _powers(parts.flow * degree / array.radius, degree - 1, z[inside] / array.radius)
    slope[~inside] = _outside(array, parts, z[~inside])[1]
    # The gradient of the real part of f is (Re f', -Im f').
    return np.column_stack([-slope.real, slope.imag])


def _parts(array, gradient):
    g, h = (float(each) for each in gradient)
    degree, kind, s = array.degree, array.kind, array.contrast
    sign = np.where(degree % FOLD[kind] == 1, 1, -1)
    sources, outer = array.source * (g + 1j * sign * h), array.outer * (g - 1j * sign * h)
    # Without the cancellation of what grows and what falls off, which at high contrasts leaves rounding.
    if math.isinf(s):
        inner, flow = 0 * outer, 2 * outer / (1 + array.resistance * degree)
    else:
        inner = 2 * outer / (s + 1 + s * array.resistance * degree)
        flow = s * inner
    return _Parts(sources, _far(array, sources, g - 1j * h), inner, flow)


def _far(array, sources, gradient):
    """Coefficients of powers of z: the mean gradient, and what fibres beyond the near ones make."""
    powers, degree = np.arange(HIGHEST + 1)[:, None], array.degree[None]
    total = powers + degree
    near = sites(array.kind)
    beside, beyond = near[np.abs(near) < BESIDE], near[np.abs(near) >= BESIDE]
    sums = lattice_sums(array.kind, int(total.max())).astype(complex)
    for n in range(2, len(sums)):
        # Of high degree the near ones leave nothing but rounding: those beyond are summed then.
        sums[n] = sums[n] - np.sum(beside ** float(-n)) if n < DIRECT else np.sum(beyond ** float(-n))
    dipole, sums[:3] = math.pi / AREA[array.kind] * np.conj(sources[0]) * array.radius, 0.0
    choose = np.where(total > 0, halved_binomials(int(total.max()))[total - 1, powers], 0.0)
    scaled = choose * sums[total] * 2.0 ** (total - 1) * array.radius ** degree.astype(float)
    found = -scaled @ sources
    found[0] = 0.0
    found[1] += gradient - dipole
    return found


def _cells(array, points):
    """Sites of the cells that hold points, offsets from them, and which of these lie in the fibre."""
    z = np.asarray(points, dtype=float) @ np.array([1, 1j])
    turn = np.exp(2j * math.pi / FOLD[array.kind])
    row = np.round(z.imag / turn.imag)
    home = np.round((z - row * turn).real) + row * turn
    # Rounding along skew axes may miss the nearest by one.
    around = home[:, None] + np.concatenate([[0], turn ** np.arange(FOLD[array.kind])])
    home = around[np.arange(len(z)), np.abs(z[:, None] - around).argmin(axis=1)]
    return home, z - home, np.abs(z - home) <= array.radius


def _outside(array, parts, z):
    """The analytic function and its derivative at offsets outside of the fibres."""
    near = sites(array.kind)
    value = np.polynomial.polynomial.polyval(z, parts.far)
    slope = np.polynomial.polynomial.polyval(z, np.polynomial.polynomial.polyder(parts.far))
    for site in (0.0, *near[np.abs(near) < BESIDE]):
        t = array.radius / (z - site)
        value = value + _powers(parts.sources, array.degree, t)
        slope = slope - _powers(parts.sources * array.degree, array.degree, t) * t / array.radius
    return value, slope


def _powers(coefficients, degree, t):
    """Sum of coefficients times t^degree."""
    full = np.zeros(int(degree.max()) + 1, complex)
    full[degree] = coefficients
    return np.polynomial.polynomial.polyval(t, full)
