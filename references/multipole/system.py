"""The linear system of the multipole method: N spheres in a periodic cell under a mean gradient.

Around sphere i the temperature is sum (c_lm (r/a)^l + b_lm (a/r)^(l+1)) Y_lm, a its radius: c is what the mean
gradient, the other spheres and all images make there, and the interface gives b_lm = -alpha_l c_lm with alpha_l =
l (s - 1) / (l s + l + 1), s the contrast (Rayleigh 1892; Sangani and Acrivos, Proc. R. Soc. A 386 (1983) 263). So
b + alpha T b = -alpha c_gradient, T the translation between spheres, solved by GMRES. Of spheres that are mirror images
of others only the others' b are unknown.

Tables and units are those of `translations`.
"""

import math
from typing import NamedTuple

import numpy as np

from references.exact.lattice import polarisability
from references.multipole.sums import entries
from references.multipole.translations import received

MOST_ITERATIONS = 400


class Solved(NamedTuple):
    """Multipoles of one order."""

    order: int
    # source, local: (2, n, entries) float arrays, K: b and c of all spheres
    source: np.ndarray
    local: np.ndarray
    mean_flux: np.ndarray  # (3,) float array, K/length: Over the conductivity of the matrix
    iterations: int
    residual: float  # Relative, recomputed
    precision: float = 0.0  # Relative, of what spheres make at each other
    pairs: int = 0  # Of spheres so near that they are solved by all degrees


def mirror_signs(spheres, gradient, order):
    """Signs by which the b, or the c, of all spheres follow from those of the spheres that they mirror.

    Mirrored along x the azimuth p turns into pi - p, along y into -p; along z P_l^m turns its sign with l + m. And the
    temperature itself is odd along the mean gradient, even across it.
    """
    n, m = entries(order)
    x, y, z = spheres.flips.T[:, :, None]
    odd = np.any(spheres.flips & (np.asarray(gradient) != 0), axis=1)[:, None]
    real = np.where(odd, -1.0, 1.0) * np.where(x, (-1.0) ** m, 1.0) * np.where(z, (-1.0) ** (n + m), 1.0)
    return np.stack([real, np.where(x ^ y, -real, real)])


def uniform(spheres, gradient, order):
    """c that a uniform gradient makes at all spheres, without its value at the centres.

    g.x = g_z R_10 + 2 Re(-(g_x - i g_y)/sqrt(2) R_11).
    """
    table = np.zeros((2, len(spheres.radii), (order + 1) * (order + 2) // 2))
    table[0, :, 1] = gradient[2] * spheres.radii
    table[0, :, 2] = -gradient[0] / math.sqrt(2) * spheres.radii
    table[1, :, 2] = gradient[1] / math.sqrt(2) * spheres.radii
    return table


def homogeneous(spheres, gradient) -> Solved:
    """The solution of order 0, the matrix alone."""
    applied = uniform(spheres, gradient, 1)
    return Solved(0, np.zeros_like(applied)[:, :, :1], applied[:, :, :1], -np.asarray(gradient), 0, 0.0)


def dipoles(spheres, source):
    """Moments p of the temperatures p.x/r^3."""
    root = math.sqrt(2)
    return np.stack([-root * source[0, :, 2], root * source[1, :, 2], source[0, :, 1]], axis=1) * (
        spheres.radii[:, None] ** 2
    )


def solve_order(
    spheres, table, gradient, order, *, tolerance, guess=None, threads=1, heard=None, received=received
) -> Solved:
    """Solve for multipoles up to one degree."""
    n, _ = entries(order)
    count, signs = spheres.count, mirror_signs(spheres, gradient, order)
    own = zip(spheres.contrasts[:count], spheres.resistances[:count], strict=True)
    alpha = np.stack([polarisability(s, n, resistance) for s, resistance in own])
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
    b, iterations = gmres(system, load, start.ravel(), tolerance, heard)
    source = b.reshape(shape)
    local = received(spheres, table, everywhere(source), threads) + applied
    left, norm = float(np.linalg.norm(source + alpha * local)), float(np.linalg.norm(load))
    residual = left / norm if norm > 0 else left
    # The recomputed residual may exceed GMRES' own by rounding.
    if not residual <= 2 * max(tolerance, 1e-14):
        raise RuntimeError(f"multipole: residual {residual:.2e} > {tolerance:.2e} after {iterations} iterations")
    moments = dipoles(spheres, everywhere(source)).sum(axis=0)
    mean = np.asarray(gradient) - 4 * math.pi / np.prod(spheres.size) * moments
    return Solved(order, everywhere(source), everywhere(local), -mean, iterations, residual, table.precision)


def gmres(system, load, start, tolerance, heard=None):
    """Full GMRES (Saad and Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856), without restarts."""
    first = load - system(start) if np.any(start) else load.copy()
    size, wanted = float(np.linalg.norm(first)), tolerance * float(np.linalg.norm(load))
    if size <= wanted:
        return start, 0
    # One vector after another: few are needed, and all of them would fill the memory.
    basis, columns = [first / size], np.zeros((MOST_ITERATIONS + 1, MOST_ITERATIONS))
    for k in range(MOST_ITERATIONS):
        vector = system(basis[k])
        # Twice, for orthogonality to rounding; einsum, for BLAS would wake its threads for so little.
        for _ in range(2):
            parts = [float(np.einsum("i,i", other, vector)) for other in basis]
            columns[: k + 1, k] += parts
            vector = vector - _combined(parts, basis)
        norm = columns[k + 1, k] = math.sqrt(np.einsum("i,i", vector, vector))
        target = np.zeros(k + 2)
        target[0] = size
        weights = np.linalg.lstsq(columns[: k + 2, : k + 1], target, rcond=None)[0]
        left = float(np.linalg.norm(target - columns[: k + 2, : k + 1] @ weights))
        # The vectors of the basis have length 1, whatever that of the load.
        if left <= wanted or norm <= 1e-15:
            break
        if heard:
            heard(math.log(min(left / size, 1.0)) / math.log(wanted / size))
        basis.append(vector / norm)
    return start + _combined(weights, basis), k + 1


def _combined(weights, basis):
    total = np.zeros_like(basis[0])
    for weight, vector in zip(weights, basis, strict=False):
        total += weight * vector
    return total
