"""Largest rate of a network: the spectral radius of C^-1 A, which limits explicit steps.

Bounds from the rows (Gershgorin) are certain but up to twice too large. Lanczos iterations in the inner product of the
capacities (Lanczos 1950) approach the largest eigenvalue from below; its residual bounds what is missing.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh_tridiagonal

from demheat import transient_kernels as kernels

MOST = 400


class Spectrum(NamedTuple):
    """What limits an explicit step.

    Attributes
    ----------
    radius : float, 1/s
        Not below the largest eigenvalue of C^-1 A: the largest Ritz value plus its residual, or the rows' bound where
        that is less.
    ritz : float, 1/s
        Not above it.
    rows : float, 1/s
        Gershgorin's bound.
    positivity : float, s
        Largest step with which every new temperature is a mean of old ones: min C / sum H.
    mean_row : float, 1/s
        Mean of sum H / C; the radius over this tells slivers.
    iterations : int
    """

    radius: float
    ritz: float
    rows: float
    positivity: float
    mean_row: float
    iterations: int

    @property
    def limit(self):
        """Largest stable step of explicit Euler, s; infinite where no particle exchanges heat."""
        return 2.0 / self.radius if self.radius > 0 else np.inf


def spectrum(system, *, tolerance=0.01, seed=0):
    """Spectral radius of a system from the safe side.

    Parameters
    ----------
    system : System
    tolerance : float
        On the residual relative to the eigenvalue: the bound is at most this much above it once iterations converge;
        if they do not, the rows' bound stands in.
    seed : int
        Of the starting vector.

    Returns
    -------
    Spectrum
    """
    own = system.diagonal * system.inverse
    between = system.diagonal - np.bincount(system.tie_row, system.tie_conductance, minlength=len(own))
    rows = float(np.max((system.diagonal + between) * system.inverse))
    if not rows > 0:
        return Spectrum(0.0, 0.0, 0.0, np.inf, 0.0, 0)
    ritz, residual, iterations = _lanczos(system, own, tolerance, seed)
    radius = min(rows, ritz + residual) if residual <= tolerance * ritz else rows
    return Spectrum(radius, ritz, rows, 1.0 / own.max(), float(own[system.inverse > 0].mean()), iterations)


def _lanczos(system, own, tolerance, seed):
    """Largest Ritz value, its residual and the iterations done."""
    weight, nothing = system.capacity, np.zeros(len(own))
    # The fastest modes sit where the rows are large: a start that favours those spares iterations.
    v = np.random.default_rng(seed).standard_normal(len(own)) * (own / own.max()) ** 3
    v /= np.sqrt(_dot(weight, v, v))
    before, beta, w = np.zeros_like(v), 0.0, np.empty_like(v)
    alphas, betas = [], []
    for _ in range(MOST):
        kernels.rates(*system.links, nothing, v, w)
        np.negative(w, out=w)
        alphas.append(_dot(weight, w, v))
        w -= alphas[-1] * v + beta * before
        beta = float(np.sqrt(_dot(weight, w, w)))
        ritz, residual = _top(alphas, betas, beta)
        if residual <= tolerance * ritz or beta <= 1e-14 * ritz:
            break
        betas.append(beta)
        before, v = v, w / beta
    return ritz, residual, len(alphas)


def _dot(weight, a, b):
    # Not by BLAS, whose threads spin for longer than such a product takes.
    return float(np.einsum("i,i,i->", weight, a, b))


def _top(alphas, betas, beta):
    """Largest eigenvalue of the tridiagonal matrix, and the residual that its vector leaves."""
    last = len(alphas) - 1
    values, vectors = eigh_tridiagonal(alphas, betas, select="i", select_range=(last, last))
    return float(values[0]), beta * abs(float(vectors[-1, 0]))
