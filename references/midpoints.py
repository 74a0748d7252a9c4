"""Samples at the midpoints of equal cells, for methods that have no points of their own."""

import numpy as np

from demheat.runtime.limits import check_memory
from demheat.scene.inputs import whole

# Least bytes that a sample takes: place, volume, temperature, phase and flux.
BYTES = 70


def check_points_per_axis(points_per_axis) -> None:
    """Raise ValueError unless a number of points along each axis is an integer of 1 or more, and fits into memory."""
    whole("points_per_axis", points_per_axis, "an integer >= 1", lambda v: v >= 1)
    check_memory("points_per_axis", points_per_axis, BYTES * int(points_per_axis) ** 3, power=3)


def midpoints(scene, points_per_axis):
    """Midpoints of equal cells of a box, the last axis running fastest, and the volumes of the cells."""
    axes = [(np.arange(points_per_axis) + 0.5) * length / points_per_axis for length in scene.size]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return points, np.full(len(points), scene.volume / len(points))
