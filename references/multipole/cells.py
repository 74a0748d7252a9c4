"""Spheres sorted into the equal cells of a regular grid, for the fast multipole method."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

# Cells so many steps apart in every direction are near.
WIDTH = 2


class Cells(NamedTuple):
    """A grid of cells and the spheres in them, numbered cell by cell.

    Attributes
    ----------
    shape : (3,) int array
        Numbers of cells; they fill the periodic cell.
    edge : (3,) float array, length
        Of a cell.
    start : (cells + 1,) int array
        First sphere of each cell.
    home : (n,) int array
        Cell of each sphere, that of its centre.
    places : (n, 3) float array, length
        Of the spheres' centres, from the middles of their cells.
    radii : (n,) float array, length
    receivers : (count,) int array
        Spheres that are no mirror images.
    near : (k, 3) int array
        Offsets of near cells, the closest first.
    negligible : float
        Degrees above which (radius/distance)^l stays below it are not exchanged in near cells.
    """

    shape: np.ndarray
    edge: np.ndarray
    start: np.ndarray
    home: np.ndarray
    places: np.ndarray
    radii: np.ndarray
    receivers: np.ndarray
    near: np.ndarray
    negligible: float


def sorted_into(shape, spheres, negligible):
    """Sort spheres into cells.

    Parameters
    ----------
    shape : (3,) int array
        Numbers of cells.
    spheres : Spheres
    negligible : float

    Returns
    -------
    Cells
    (n,) int array
        The spheres' numbers, cell by cell.
    """
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
