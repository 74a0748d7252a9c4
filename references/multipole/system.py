"""The linear system of the multipole method: N spheres in a periodic cell under a mean gradient.

Around sphere i the temperature is sum (c_lm (r/a)^l + b_lm (a/r)^(l+1)) Y_lm, a its radius: c is what the mean
gradient, the other spheres and all images make there, and the interface gives b_lm = -alpha_l c_lm with alpha_l =
l (s - 1) / (l s + l + 1), s the contrast (Rayleigh 1892; Sangani and Acrivos, Proc. R. Soc. A 386 (1983) 263). So
b + alpha T b = -alpha c_gradient, T the translation between spheres, solved by GMRES. Of spheres that are mirror images
of others only the others' b are unknown.

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
from references.multipole.sums import entries, highest_degree, periodic_irregular
from references.threads import Team

# Entries of the translation between two spheres that are smaller than this are left out.
NEGLIGIBLE = 1e-14
MOST_ITERATIONS = 400


class Spheres(NamedTuple):
    """Spheres in a periodic cell: first those that count, then what are mirror images of them.

    Attributes
    ----------
    centers : (n, 3) float array, length
    radii : (n,) float array, length
    contrasts : (n,) float array
        Conductivity over that of the matrix.
    size : (3,) float array, length
        Of the cell.
    original : (n,) int array
        Sphere that each one mirrors; itself if it counts.
    flips : (n, 3) bool array
        Axes along which it is mirrored.
    """

    centers: np.ndarray
    radii: np.ndarray
    contrasts: np.ndarray
    size: np.ndarray
    original: np.ndarray
    flips: np.ndarray

    @property
    def count(self) -> int:
        """Number of those that count."""
        return int(self.original.max(initial=-1)) + 1


def unmirrored(centers, radii, contrasts, size) -> Spheres:
    """Spheres of a cell without mirror images; arguments as the attributes of `Spheres`."""
    return Spheres(centers, radii, contrasts, size, np.arange(len(radii)), np.zeros((len(radii), 3), dtype=bool))


class Translation(NamedTuple):
    """Periodic sums of I_L^M for all pairs of a sphere that counts and any other.

    Attributes
    ----------
    sums : (1 + pairs, entries) complex array, length^-(L+1)
        Of a sphere's own images, then for i < j of X = x_i - x_j, j running fastest.
    top : (1 + pairs,) int array
        Highest degree L = l + l' that counts.
    """

    sums: np.ndarray
    top: np.ndarray


class Solved(NamedTuple):
    """Multipoles of one order.

    Attributes
    ----------
    order : int
    source, local : (2, n, entries) float arrays, K
        b and c of all spheres.
    mean_flux : (3,) float array, K/length
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


class Scales(NamedTuple):
    """Factors from b to multipoles of the kernels' harmonics, and from their local coefficients to c.

    Attributes
    ----------
    sent : (n, entries) float array, length^(l+1)
    made : (n, entries) float array, length^l
    """

    sent: np.ndarray
    made: np.ndarray


def scales(radii, order) -> Scales:
    """Scales of spheres: Racah's harmonics are sqrt((l-m)! (l+m)!) times the kernels' regular ones.

    And the irregular ones are the kernels' over that root.

    Parameters
    ----------
    radii : (n,) float array, length
    order : int
        Highest degree.

    Returns
    -------
    Scales
    """
    n, m = entries(order)
    root = np.exp(0.5 * (gammaln(n - m + 1) + gammaln(n + m + 1)))
    a = np.asarray(radii)[:, None]
    return Scales(a ** (n + 1.0) / root, a ** n.astype(float) / root)


def translation(spheres, degree) -> Translation:
    """Periodic sums for all pairs of spheres; both ways of a pair share one.

    Parameters
    ----------
    spheres : Spheres
    degree : int
        Highest L.

    Returns
    -------
    Translation
    """
    i, j = np.triu_indices(spheres.count, 1, len(spheres.radii))
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


def received(spheres, table, source, threads=1):
    """c that all spheres and their periodic images make at those that count.

    Parameters
    ----------
    spheres : Spheres
    table : Translation
        Up to twice the order of the multipoles at least.
    source : (2, n, entries) float array, K
        b of all spheres.
    threads : int

    Returns
    -------
    (2, count, entries) float array, K
    """
    order, count = highest_degree(source.shape[2]), spheres.count
    scale = scales(spheres.radii, order)
    result = np.zeros((2, count, source.shape[2]))
    with Team(threads) as team:
        team.run(translate, count, order, table, source * scale.sent, result)
    result *= scale.made[:count]
    # Two derivatives of the periodic Green function have the trace 4 pi/volume of its background, which no harmonic
    # of degree 2 carries: dipoles p shift every slope by -4 pi/(3 volume) times their sum.
    moments = np.sum(source[:, :, 1:3] * spheres.radii[:, None] ** 2, axis=1, keepdims=True)
    shift = 4 * math.pi / (3 * float(np.prod(spheres.size)))
    result[:, :, 1:3] -= shift * moments * spheres.radii[:count, None]
    return result


def mirror_signs(spheres, gradient, order):
    """Signs by which the b, or the c, of all spheres follow from those of the spheres that they mirror.

    Mirrored along x the azimuth p turns into pi - p, along y into -p; along z P_l^m turns its sign with l + m. And the
    temperature itself is odd along the mean gradient, even across it.

    Parameters
    ----------
    spheres : Spheres
    gradient : (3,) float array, K/length
        Along one axis if there are mirror images.
    order : int
        Highest degree.

    Returns
    -------
    (2, n, entries) float array
    """
    n, m = entries(order)
    x, y, z = spheres.flips.T[:, :, None]
    odd = np.any(spheres.flips & (np.asarray(gradient) != 0), axis=1)[:, None]
    real = np.where(odd, -1.0, 1.0) * np.where(x, (-1.0) ** m, 1.0) * np.where(z, (-1.0) ** (n + m), 1.0)
    return np.stack([real, np.where(x ^ y, -real, real)])


def uniform(spheres, gradient, order):
    """c that a uniform gradient makes at all spheres, without its value at the centres.

    g.x = g_z R_10 + 2 Re(-(g_x - i g_y)/sqrt(2) R_11).

    Parameters
    ----------
    spheres : Spheres
    gradient : (3,) float array, K/length
    order : int
        Highest degree.

    Returns
    -------
    (2, n, entries) float array, K
    """
    table = np.zeros((2, len(spheres.radii), (order + 1) * (order + 2) // 2))
    table[0, :, 1] = gradient[2] * spheres.radii
    table[0, :, 2] = -gradient[0] / math.sqrt(2) * spheres.radii
    table[1, :, 2] = gradient[1] / math.sqrt(2) * spheres.radii
    return table


def homogeneous(spheres, gradient) -> Solved:
    """The solution of order 0, the matrix alone.

    Parameters
    ----------
    spheres : Spheres
    gradient : (3,) float array, K/length

    Returns
    -------
    Solved
    """
    applied = uniform(spheres, gradient, 1)
    return Solved(0, np.zeros_like(applied)[:, :, :1], applied[:, :, :1], -np.asarray(gradient), 0, 0.0)


def dipoles(spheres, source):
    """Moments p of the temperatures p.x/r^3.

    Parameters
    ----------
    spheres : Spheres
    source : (2, n, entries) float array, K
        b of all spheres.

    Returns
    -------
    (n, 3) float array, K length^2
    """
    root = math.sqrt(2)
    return np.stack([-root * source[0, :, 2], root * source[1, :, 2], source[0, :, 1]], axis=1) * (
        spheres.radii[:, None] ** 2
    )


def solve_order(spheres, table, gradient, order, *, tolerance, guess=None, threads=1) -> Solved:
    """Solve for multipoles up to one degree.

    Parameters
    ----------
    spheres : Spheres
    table : Translation
        Up to degree 2 order at least.
    gradient : (3,) float array, K/length
        Along one axis if there are mirror images.
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
    count, signs = spheres.count, mirror_signs(spheres, gradient, order)
    alpha = np.stack([polarisability(s, n) for s in spheres.contrasts[:count]])
    applied = uniform(spheres, gradient, order)[:, :count]
    shape = applied.shape

    def everywhere(own):
        return np.take(own, spheres.original, axis=1) * signs

    def system(vector):
        source = vector.reshape(shape)
        return (source + alpha * received(spheres, table, everywhere(source), threads)).ravel()

    load, start = (-alpha * applied).ravel(), np.zeros(shape)
    if guess is not None and guess.order <= order:
        start[:, :, : guess.source.shape[2]] = guess.source[:, :count]
    b, iterations = gmres(system, load, start.ravel(), tolerance)
    source = b.reshape(shape)
    local = received(spheres, table, everywhere(source), threads) + applied
    left, norm = float(np.linalg.norm(source + alpha * local)), float(np.linalg.norm(load))
    residual = left / norm if norm > 0 else left
    # The recomputed residual may exceed GMRES' own by rounding.
    if not residual <= 2 * max(tolerance, 1e-14):
        raise RuntimeError(f"multipole: residual {residual:.2e} > {tolerance:.2e} after {iterations} iterations")
    moments = dipoles(spheres, everywhere(source)).sum(axis=0)
    mean = np.asarray(gradient) - 4 * math.pi / np.prod(spheres.size) * moments
    return Solved(order, everywhere(source), everywhere(local), -mean, iterations, residual)


def gmres(system, load, start, tolerance):
    """Full GMRES (Saad and Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856), without restarts.

    Parameters
    ----------
    system : callable (n,) float array -> (n,) float array
        The matrix times a vector.
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
