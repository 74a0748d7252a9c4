"""A method of one's own: seven-point differences on voxels that have the material of their centre, by a sparse solver.

python -m studies run sphere_benchmark --quick --method examples.own_method.finite_differences

`estimate(scene)` is all that the benchmark needs of a module; a row is made for each of KNOBS.
"""

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import cg

KNOBS = [{"voxels": 16}, {"voxels": 32}]


def estimate(scene, *, voxels=32):
    """Effective conductivity along the load, W/(m K)."""
    scene.require("finite differences", steady=True, pores=False, walls="one isothermal pair")
    size = np.array(scene.size)
    shape = np.maximum(1, np.rint(size / size.max() * voxels)).astype(int)
    h = size / shape
    centres = (np.stack(np.indices(shape), axis=-1).reshape(-1, 3) + 0.5) * h
    k = scene.conductivities[scene.phase_at(centres)].reshape(shape)
    number = np.arange(k.size).reshape(shape)
    first, second, conductance, rise = [], [], [], []
    for axis in range(3):
        area = np.prod(h) / h[axis]
        kept = slice(None) if scene.periodic else slice(None, shape[axis] - 1)
        here, there = (np.moveaxis(np.roll(number, -by, axis), axis, 0)[kept] for by in (0, 1))
        a, b = k.ravel()[here], k.ravel()[there]
        first, second = [*first, here.ravel()], [*second, there.ravel()]
        conductance.append((2 * a * b / (a + b) * area / h[axis]).ravel())
        rise.append(np.full(here.size, scene.gradient[axis] * h[axis] if scene.periodic else 0.0))
    i, j, g, rise = map(np.concatenate, (first, second, conductance, rise))
    off = coo_matrix((g, (i, j)), shape=(k.size, k.size)).tocsr()
    off = off + off.T
    diagonal, load = np.asarray(off.sum(axis=1)).ravel(), np.bincount(i, g * rise, k.size)
    load -= np.bincount(j, g * rise, k.size)
    if not scene.periodic:
        axis = scene.axis
        held = {end: np.take(number, index, axis).ravel() for end, index in (("-", 0), ("+", -1))}
        to_wall = 2 * k.ravel() * np.prod(h) / h[axis] ** 2
        for end, cells in held.items():
            diagonal[cells] += to_wall[cells]
            load[cells] += to_wall[cells] * scene.walls["xyz"[axis] + end]
    matrix = diags(diagonal) - off
    warm, failed = cg(matrix, load, rtol=1e-8, M=diags(1 / diagonal), maxiter=5000)
    if failed:
        raise RuntimeError(f"conjugate gradients: no convergence in {failed} steps")
    if scene.periodic:
        # Twice the energy per volume, over the squared mean gradient.
        return np.sum(g * (warm[j] - warm[i] + rise) ** 2) / scene.volume / np.dot(scene.gradient, scene.gradient)
    low, high = (scene.walls["xyz"[axis] + end] for end in "-+")
    entering = np.sum(to_wall[held["-"]] * (low - warm[held["-"]]))
    return entering * size[axis] / (scene.volume / size[axis]) / (low - high)
