"""Conjugate gradients preconditioned by multigrid, on the rows of a network."""

import numpy as np

from demheat.conduction import steady_kernels as kernels


def preconditioned(links, diagonal, precondition, r, x, limit, most, done):
    """Conjugate gradients that add to x until |r| <= limit; returns the iterations done.

    Directions are made orthogonal by what the residual changed (Polak and Ribiere), since the preconditioner, in single
    precision, is symmetric to its rounding only.
    """
    z, q = np.empty_like(r), np.empty_like(r)
    norm, p, rz = np.sqrt(kernels.dot(r, r)), np.zeros_like(r), 1.0
    alpha = 0.0
    first = norm
    for iteration in range(most):
        if norm <= limit:
            return iteration
        done(_share(norm, first, limit))
        precondition(r, norm, z)
        beta = -alpha * kernels.dot(q, z) / rz if iteration else 0.0
        rz = kernels.dot(r, z)
        kernels.direct(beta, z, p)
        alpha = rz / kernels.apply(links, diagonal, p, q)
        norm = np.sqrt(kernels.advance(alpha, p, q, x, r))
    return most


def _share(norm, first, limit):
    """How much of the way from the first norm of the residual to its limit is done, in digits."""
    return float(min(1.0, np.log(max(first / norm, 1.0)) / np.log(first / limit))) if first > limit > 0 else 0.0
