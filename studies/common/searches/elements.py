"""Where elements begin to heed the size that is asked for: in longer ones than curvature and gaps allow nothing is."""

import numpy as np

from references.mesh.lattice import CUBE, FEWEST
from references.mesh.sizes import GROWTH, wanted_sizes
from references.mesh.solids import known

# Points along the box's longest edge at which elements are the longest that they may be.
POINTS = 16


def longest(scene) -> float:
    """Size of elements above which meshes of a scene are the same, in edges of a cube as large as its box."""
    return _longest(scene) / scene.volume ** (1 / 3)


def _longest(scene):
    """The same, m."""
    if scene.domain != "box":
        return max(scene.size)
    if scene.image is not None:
        return max(scene.image.voxel)
    if not all(map(known, scene.inclusions)):
        return max(scene.size) / (CUBE * FEWEST)
    wanted = wanted_sizes(scene, max(scene.size))
    return float(_allowed(wanted, _points(scene.size)).max())


def _points(size):
    """Points of a grid in the box, its faces among them, (n, 3) float array, m."""
    counts = np.ceil(POINTS * np.divide(size, max(size))).astype(int) + 1
    ticks = [np.linspace(0.0, length, count) for length, count in zip(size, counts, strict=True)]
    return np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)


def _allowed(wanted, points):
    """Longest edges at points by what is near them, (n,) float array, m: as `references.mesh.cad` has them made."""
    found = np.full(len(points), wanted.size)
    for *center, radius, edge in wanted.balls:
        beyond = np.linalg.norm(points - center, axis=1) - radius
        found = np.minimum(found, edge + GROWTH * np.maximum(beyond, 0.0))
    for *center, inner, outer, edge in wanted.shells:
        off = np.abs(np.linalg.norm(points - center, axis=1) - (inner + outer) / 2)
        found = np.minimum(found, edge + GROWTH * off)
    for axis, start, stop, edge in wanted.slabs:
        along = points[:, int(axis)]
        beyond = np.maximum(start - along, along - stop)
        found = np.minimum(found, edge + GROWTH * np.maximum(beyond, 0.0))
    return found
