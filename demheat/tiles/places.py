"""The same particle in two slabs, found by its place."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from demheat.tiles.slabs import Slabs

# Two slabs make one particle of the same numbers: so far apart, in radii, they are two.
SAME = 1e-6
NOBODY = -1


def found_at(points: np.ndarray, own: np.ndarray, slabs: Slabs) -> np.ndarray:
    """Which of a slab's own particles lies at each point, (k,) int array; NOBODY where none does."""
    if not len(points):
        return np.empty(0, dtype=np.int64)
    x, slack = own[:, slabs.axis], SAME * slabs.unit
    near = np.flatnonzero((x >= points[:, slabs.axis].min() - slack) & (x <= points[:, slabs.axis].max() + slack))
    if not len(near):
        return np.full(len(points), NOBODY)
    away, place = cKDTree(own[near]).query(points)
    return np.where(away <= slack, near[place], NOBODY)
