"""Homogeneous bricks: the equations split into one eigenproblem per axis, so each solve takes a few matrix products.

Source: Lynch, Rice and Thomas, Numer. Math. 6 (1964) 185: M / tau + K is a sum of products of matrices of one axis,
M = Mx My Mz and K = Kx My Mz + Mx Ky Mz + Mx My Kz; vectors V with V'MV = 1 and V'KV diagonal diagonalise all of it.
"""

import numpy as np
from scipy.linalg import eigh

# Of one element of unit length: integrals of products of the two shape functions and of their slopes.
MASS = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
STIFFNESS = np.array([[1.0, -1.0], [-1.0, 1.0]])


def separable(grid, conductivity, capacity, free):
    """Exact inverse of M / tau + K of a homogeneous grid, as a function of tau."""
    shape = tuple(len(x) for x in grid)
    chosen = np.zeros(shape, bool)
    chosen.flat[free] = True
    kept = [np.flatnonzero(chosen.any(axis=tuple(a for a in range(3) if a != axis))) for axis in range(3)]
    values, vectors = zip(*(_modes(x, k) for x, k in zip(grid, kept, strict=True)), strict=True)
    rates = values[0][:, None, None] + values[1][:, None] + values[2]

    def solve(tau, load):
        modal = _apply(load.reshape(rates.shape), [v.T for v in vectors])
        return _apply(modal / (capacity / tau + conductivity * rates), vectors).ravel()

    return solve


def _modes(x, kept):
    """Eigenvalues (k,), 1/m2, and vectors (k, k) of linear elements along one axis, other nodes held."""
    mass, stiffness = np.zeros((len(x), len(x))), np.zeros((len(x), len(x)))
    for place, width in enumerate(np.diff(x)):
        block = slice(place, place + 2)
        mass[block, block] += MASS * width
        stiffness[block, block] += STIFFNESS / width
    return eigh(stiffness[np.ix_(kept, kept)], mass[np.ix_(kept, kept)])


def _apply(values, matrices):
    """One matrix along each axis of (a, b, c) values."""
    for axis, matrix in enumerate(matrices):
        values = np.moveaxis(np.tensordot(matrix, values, axes=(1, axis)), 0, axis)
    return values
