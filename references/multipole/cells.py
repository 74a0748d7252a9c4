"""Spheres sorted into the equal cells of a regular grid, for the fast multipole method."""

from itertools import product
from typing import NamedTuple

import numpy as np

# Cells so many steps apart in every direction are near.
WIDTH = 2


class Cells(NamedTuple):
    """A grid of cells and the spheres in them, numbered cell by cell."""

    shape: np.ndarray  # (3,) int array: Numbers of cells; they fill the periodic cell
    edge: np.ndarray  # (3,) float array, length: Of a cell
    start: np.ndarray  # (cells + 1,) int array: First sphere of each cell
    home: np.ndarray  # (n,) int array: Cell of each sphere, that of its centre
    places: np.ndarray  # (n, 3) float array, length: Of the spheres' centres, from the middles of their cells
    radii: np.ndarray  # (n,) float array, length
    receivers: np.ndarray  # (count,) int array: Spheres that are no mirror images
    near: np.ndarray  # (k, 3) int array: Offsets of near cells, the closest first
    negligible: float  # Degrees above which (radius/distance)^l stays below it are not exchanged in near cells


def sorted_into(shape, spheres, negligible):
    """Sort spheres into cells."""
    shape = np.asarray(shape, dtype=np.int64)
    edge = spheres.size / shape
    steps = np.floor(spheres.centers / edge).astype(np.int64)
    places = spheres.centers - (steps + 0.5) * edge
    home = np.ravel_multi_index(tuple((steps % shape).T), tuple(shape))
    order = np.argsort(home, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(home, minlength=int(np.prod(shape))))])
    near = np.array(list(product(range(-WIDTH, WIDTH + 1), repeat=3)))
    near = near[np.argsort(np.linalg.norm(near * edge, axis=1), kind="stable")]
    receivers = np.flatnonzero(spheres.original[order] == order)
    cells = Cells(shape, edge, start, home[order], places[order], spheres.radii[order], receivers, near, negligible)
    return cells, order
