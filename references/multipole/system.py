"""The linear system of the multipole method: N spheres in a periodic cell under a mean gradient.

Around sphere i the temperature is sum (c_lm (r/a)^l + b_lm (a/r)^(l+1)) Y_lm, a its radius: c is what the mean
gradient, the other spheres and all images make there, and the interface gives b_lm = -alpha_l c_lm with alpha_l =
l (s - 1) / (l s + l + 1), s the contrast (Rayleigh 1892; Sangani and Acrivos, Proc. R. Soc. A 386 (1983) 263). So
b + alpha T b = -alpha c_gradient, T the translation between spheres, solved by GMRES.

Tables are real, (2, spheres, entries): real and imaginary parts, Racah's normalisation, entry (l, m >= 0) at
l (l + 1)/2 + m. Conductivities are in units of the matrix; lengths in any one unit.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.special import gammaln

from references.exact.lattice import polarisability
from references.multipole.kernels import translate
from references.multipole.sums import entries, periodic_irregular
from references.threads import Team

# Entries of the translation between two spheres that are smaller than this are left out.
NEGLIGIBLE = 1e-14
MOST_ITERATIONS = 400


class Spheres(NamedTuple):
    """Spheres in a periodic cell.

    Attributes
    ----------
    centers : (n, 3) float array, length
    radii : (n,) float array, length
    contrasts : (n,) float array
        Conductivity over that of the matrix.
    size : (3,) float array, length
    """

    centers: np.ndarray
    radii: np.ndarray
    contrasts: np.ndarray
    size: np.ndarray


class Translation(NamedTuple):
    """Periodic sums for all pairs of spheres.

    Attributes
    ----------
    sums : (1 + pairs, entries) complex array
        See `multipole_kernels.translate`.
    top : (1 + pairs,) int array
    """

    sums: np.ndarray
    top: np.ndarray


class Solved(NamedTuple):
    """Multipoles of one order.

    Attributes
    ----------
    order : int
    source, local : (2, n, entries) float arrays
        b and c.
    mean_flux : (3,) float array
        Over the conductivity of the matrix.
    iterations : int
    residual : float
        Relative, recomputed.
    """

    order: int
    source: np.ndarray
    local: np.ndarray
    mean_flux: np.ndarray
    iterations: int
    residual: float


def scales(radii, order):
    """Factors that turn b into multipoles of the kernels' harmonics, and their local coefficients into c.

    Racah's harmonics are sqrt((l-m)! (l+m)!) times the kernels' regular ones and their irregular ones over it.

    Returns
    -------
    tuple of two (n, entries) float arrays
    """
    n, m = entries(order)
    root = np.exp(0.5 * (gammaln(n - m + 1) + gammaln(n + m + 1)))
    a = np.asarray(radii)[:, None]
    return a ** (n + 1.0) / root, a ** n.astype(float) / root


def translation(spheres, degree):
    """Periodic sums up to a degree for all pairs; both ways of a pair share one.

    Returns
    -------
    Translation
    """
    count = len(spheres.radii)
    i, j = np.triu_indices(count, 1)
    offsets = np.vstack([np.zeros((1, 3)), spheres.centers[i] - spheres.centers[j]])
    contact = 2 * float(spheres.radii.max())
    sums = periodic_irregular(offsets, degree, spheres.size, contact)
    n, m = entries(degree)
    sums *= np.exp(0.5 * (gammaln(n - m + 1) + gammaln(n + m + 1)))
    apart = offsets - spheres.size * np.round(offsets / spheres.size)
    apart = np.linalg.norm(apart, axis=1)
    apart[0] = spheres.size.min()
    touch = np.concatenate([[contact], spheres.radii[i] + spheres.radii[j]])
    # Entries of degree L = l + l' are at most about (touch/apart)^L.
    most = math.log(NEGLIGIBLE) / np.log(np.minimum(touch / apart, 1 - 1e-9))
    return Translation(sums, np.minimum(np.ceil(most), degree).astype(np.int64))


def received(spheres, table, order, source, threads=1):
    """c that the spheres and all images make, of multipoles b; (2, n, entries) float array."""
    out_scale, in_scale = scales(spheres.radii, order)
    scaled = source * out_scale
    result = np.zeros_like(scaled)
    count = len(spheres.radii)
    with Team(threads) as team:
        team.run(translate, count, order, table.sums, table.top, scaled[0], scaled[1], result[0], result[1])
    result *= in_scale
    # Two derivatives of the periodic Green function have the trace 4 pi/volume of its background, which no harmonic
    # of degree 2 carries: dipoles p shift every slope by -4 pi/(3 volume) times their sum.
    moments = np.sum(source[:, :, 1:3] * spheres.radii[:, None] ** 2, axis=1, keepdims=True)
    shift = 4 * math.pi / (3 * float(np.prod(spheres.size)))
    result[:, :, 1:3] -= shift * moments * spheres.radii[:, None]
    return result


def uniform(spheres, gradient, order):
    """c of a uniform gradient, without its value at the centres; (2, n, entries) float array.

    g.x = g_z R_10 + 2 Re(-(g_x - i g_y)/sqrt(2) R_11).
    """
    table = np.zeros((2, len(spheres.radii), (order + 1) * (order + 2) // 2))
    table[0, :, 1] = gradient[2] * spheres.radii
    table[0, :, 2] = -gradient[0] / math.sqrt(2) * spheres.radii
    table[1, :, 2] = gradient[1] / math.sqrt(2) * spheres.radii
    return table


def homogeneous(spheres, gradient):
    """The solution of order 0: the matrix alone."""
    applied = uniform(spheres, gradient, 1)
    return Solved(0, np.zeros_like(applied)[:, :, :1], applied[:, :, :1], -np.asarray(gradient), 0, 0.0)


def dipoles(spheres, source):
    """Moments p of the temperatures p.x/r^3 of multipoles b, (n, 3) float array, length^2 K."""
    root = math.sqrt(2)
    return np.stack([-root * source[0, :, 2], root * source[1, :, 2], source[0, :, 1]], axis=1) * (
        spheres.radii[:, None] ** 2
    )


def solve_order(spheres, table, gradient, order, *, tolerance, guess=None, threads=1):
    """Solve for multipoles up to one degree.

    Parameters
    ----------
    spheres : Spheres
    table : Translation
        Up to degree 2 order at least.
    gradient : (3,) float array, K/length
    order : int
    tolerance : float
        Relative residual.
    guess : Solved, optional
        Of a lower order.
    threads : int

    Returns
    -------
    Solved

    Raises
    ------
    RuntimeError
        If GMRES does not reach the tolerance.
    """
    n, _ = entries(order)
    alpha = np.stack([polarisability(s, n) for s in spheres.contrasts])
    applied = uniform(spheres, gradient, order)
    shape = applied.shape

    def system(vector):
        source = vector.reshape(shape)
        return (source + alpha * received(spheres, table, order, source, threads)).ravel()

    load, start = (-alpha * applied).ravel(), np.zeros(shape)
    if guess is not None and guess.order <= order:
        start[:, :, : guess.source.shape[2]] = guess.source
    b, iterations = gmres(system, load, start.ravel(), tolerance)
    source = b.reshape(shape)
    local = received(spheres, table, order, source, threads) + applied
    left, norm = float(np.linalg.norm(source + alpha * local)), float(np.linalg.norm(load))
    residual = left / norm if norm > 0 else left
    # The recomputed residual may exceed GMRES' own by rounding.
    if not residual <= 2 * max(tolerance, 1e-14):
        raise RuntimeError(f"multipole: residual {residual:.2e} > {tolerance:.2e} after {iterations} iterations")
    mean = np.asarray(gradient) - 4 * math.pi / np.prod(spheres.size) * dipoles(spheres, source).sum(axis=0)
    return Solved(order, source, local, -mean, iterations, residual)


def gmres(system, load, start, tolerance):
    """Full GMRES (Saad and Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856), without restarts.

    Parameters
    ----------
    system : callable (n,) float array -> (n,) float array
    load, start : (n,) float arrays
    tolerance : float
        Of the residual over the norm of the load.

    Returns
    -------
    (n,) float array
    iterations : int
    """
    first = load - system(start) if np.any(start) else load.copy()
    size, wanted = float(np.linalg.norm(first)), tolerance * float(np.linalg.norm(load))
    if size <= wanted:
        return start, 0
    basis, columns = np.empty((MOST_ITERATIONS + 1, len(load))), np.zeros((MOST_ITERATIONS + 1, MOST_ITERATIONS))
    basis[0] = first / size
    for k in range(MOST_ITERATIONS):
        vector = system(basis[k])
        # Twice, for orthogonality to rounding; einsum, for BLAS would wake its threads for so little.
        for _ in range(2):
            parts = np.einsum("ij,j->i", basis[: k + 1], vector)
            columns[: k + 1, k] += parts
            vector = vector - np.einsum("i,ij->j", parts, basis[: k + 1])
        norm = columns[k + 1, k] = math.sqrt(np.einsum("i,i", vector, vector))
        target = np.zeros(k + 2)
        target[0] = size
        weights = np.linalg.lstsq(columns[: k + 2, : k + 1], target, rcond=None)[0]
        left = float(np.linalg.norm(target - columns[: k + 2, : k + 1] @ weights))
        if left <= wanted or norm <= 1e-15 * size:
            break
        basis[k + 1] = vector / norm
    return start + np.einsum("i,ij->j", weights, basis[: k + 1]), k + 1
