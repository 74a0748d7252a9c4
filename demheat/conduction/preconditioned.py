"""Preconditioned conjugate gradients on the rows of a network."""

import numpy as np

from demheat.conduction.products import advance, dot, multiplier


def preconditioned(links, diagonal, precondition, r, x, limit, most, done):
    """Conjugate gradients that add to x until |r| <= limit; returns the iterations done.

    Directions are made orthogonal by what the residual changed (Polak and Ribiere), since the preconditioner, in single
    precision, is symmetric to its rounding only.
    """
    z, q = np.empty_like(r), np.empty_like(r)
    norm, p, rz = np.sqrt(dot(r, r)), np.zeros_like(r), 1.0
    alpha, multiply = 0.0, multiplier(links, diagonal, len(r))
    first = norm
    for iteration in range(most):
        if norm <= limit:
            return iteration
        done(_share(norm, first, limit))
        precondition(r, norm, z)
        beta = -alpha * dot(q, z) / rz if iteration else 0.0
        rz = dot(r, z)
        p *= beta
        p += z
        product = multiply(p, q)
        if not product > 0.0:  # rounding has made the matrix indefinite
            return iteration + 1
        alpha = rz / product
        norm = np.sqrt(advance(alpha, p, q, x, r))
    return most


def by_diagonal(diagonal):
    """The preconditioner of Jacobi; rows with zero have no equation."""
    inverse = np.divide(1.0, diagonal, out=np.zeros_like(diagonal), where=diagonal > 0)

    def precondition(r, _, z):
        np.multiply(inverse, r, out=z)

    return precondition


def _share(norm, first, limit):
    """How much of the way from the first norm of the residual to its limit is done, in digits."""
    return float(min(1.0, np.log(max(first / norm, 1.0)) / np.log(first / limit))) if first > limit > 0 else 0.0
