"""Numba kernels of conjugate gradients: their vector work, and what inverts the homogeneous medium.

Kernels work on the planes low <= i < high of the first axis, or on columns of modes; see `hexahedron_kernels`.
"""

from typing import NamedTuple

import numpy as np

from references.fft.hexahedron_kernels import compiled


class Vectors(NamedTuple):
    """The vectors of conjugate gradients, one value per node, and the nodes' weights in the preconditioner."""

    # (mx, my, mz) float array, K: Temperature less its linear part.  Voxels have their nodes at the corners.  Periodic:
    # m = n.  Walls: mx = nx - 1 (those on the two isothermal walls are zero and left out), my = ny + 1, mz = nz + 1.
    # Links have theirs at the voxel centres: m = n
    theta: np.ndarray
    residual: np.ndarray  # (mx, my, mz) float array, W/m3
    direction: np.ndarray  # (mx, my, mz) float array, K
    work: np.ndarray  # (mx, my, mz or more) float array: An operator's result, W/m3, or a preconditioned one, K
    # weight_y, weight_z: (my,) and (mz,) float arrays: A node's weight is their product: 1 over the share of a whole
    # cell that it owns
    weight_y: np.ndarray
    weight_z: np.ndarray
    partial: np.ndarray  # (mx,) float64 array, W K/m3: Sums over the planes of `dot`


class Symbol(NamedTuple):
    """Factors per axis of the symbol of minus the discrete Laplacian, sx cy cz + cx sy cz + cx cy sz."""

    # tuple of three float arrays, 1/m2: s = (2 sin(k / 2) / spacing)^2; that of x as wide as a column of modes
    sine: tuple
    # tuple of three float arrays: c = cos(k / 2)^2 for voxels, 1 for links, which gives the seven-point Laplacian
    cosine: tuple


@compiled
def divide(rows, first, count, symbol, scale):
    """Divide each mode by the symbol of minus the Laplacian; empty modes become 0.

    rows, first, count : see `sweeps.Transform.columns`; one component, W/m3 before and K after, changed in place
    symbol : Symbol
    scale : float
    """
    s, c = symbol.sine, symbol.cosine
    mz = len(s[2])
    along, across = s[0], c[0]
    for r in range(count):
        j, k = divmod(first + r, mz)
        both, cross = c[1][j] * c[2][k], s[1][j] * c[2][k] + c[1][j] * s[2][k]
        row = rows[0, r]
        for i in range(len(row)):
            symbol_here = along[i] * both + across[i] * cross
            row[i] *= scale / symbol_here if symbol_here > 0 else 0 * scale


@compiled
def start(vectors, low, high):
    """residual = -work; work = weighted residual, ready for the preconditioner.  Padding is left alone.

    vectors : Vectors
    low, high : int; planes of nodes
    """
    residual, work = vectors.residual, vectors.work
    for i in range(low, high):
        for j in range(residual.shape[1]):
            r, w = residual[i, j], work[i, j]
            for k in range(len(r)):
                r[k] = -w[k]
            for k in range(len(r)):
                w[k] = r[k] * (vectors.weight_y[j] * vectors.weight_z[k])


@compiled
def step(vectors, alpha, low, high):
    """theta += alpha direction; residual -= alpha work; work = weighted residual.

    vectors : Vectors
    alpha : float
    low, high : int; planes of nodes
    """
    theta, direction, residual, work = vectors.theta, vectors.direction, vectors.residual, vectors.work
    for i in range(low, high):
        for j in range(residual.shape[1]):
            t, p, r, w = theta[i, j], direction[i, j], residual[i, j], work[i, j]
            for k in range(len(r)):
                t[k] += alpha * p[k]
            for k in range(len(r)):
                r[k] -= alpha * w[k]
            for k in range(len(r)):
                w[k] = r[k] * (vectors.weight_y[j] * vectors.weight_z[k])


@compiled
def dot(vectors, low, high):
    """partial[i] = sum of residual * work over plane i.

    vectors : Vectors
    low, high : int; planes of nodes
    """
    residual, work = vectors.residual, vectors.work
    for i in range(low, high):
        total = 0.0
        for j in range(residual.shape[1]):
            r, w = residual[i, j], work[i, j]
            for k in range(len(r)):
                total += r[k] * w[k]
        vectors.partial[i] = total


@compiled
def turn(vectors, beta, low, high):
    """direction = work + beta direction.

    vectors : Vectors
    beta : float
    low, high : int; planes of nodes
    """
    direction, work = vectors.direction, vectors.work
    for i in range(low, high):
        for j in range(direction.shape[1]):
            p, w = direction[i, j], work[i, j]
            for k in range(len(p)):
                p[k] = w[k] + beta * p[k]
