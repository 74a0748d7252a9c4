"""Facets of cells that were cut in chunks, brought together in the order of their cells, compiled."""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

from demheat.network.polyhedron_kernels import PLAIN


class Gathered(NamedTuple):
    """Facets in the order of their cells, links and walls apart: what `gather_facets` writes.

    Attributes
    ----------
    indices, image, area, distance : (m,) uint32, uint8 and float arrays
        Of links.
    side, wall_area, wall_distance : (w,) int64 and float arrays
        Of walls: planes of a round wall from 6 on.
    """

    indices: np.ndarray
    image: np.ndarray
    area: np.ndarray
    distance: np.ndarray
    side: np.ndarray
    wall_area: np.ndarray
    wall_distance: np.ndarray


@njit(**PLAIN)
def _gather_chunk(place, e, w, cut, out):
    """Bring the facets of one chunk to the places from e on for links, from w on for walls."""
    for s in range(cut.used[place]):
        j = cut.neighbour[place, s]
        if j >= 0:
            out.indices[e], out.image[e] = j, cut.image[place, s]
            out.area[e], out.distance[e] = cut.area[place, s], cut.distance[place, s]
            e += 1
        else:
            out.side[w] = -1 - j
            out.wall_area[w], out.wall_distance[w] = cut.area[place, s], cut.distance[place, s]
            w += 1


@njit(cache=True, parallel=True)
def gather_facets(chunks, link, end, cut, out):
    """Bring the facets of some chunks to where they belong.

    Parameters
    ----------
    chunks : (c,) int64 array
        As `cut_cells` got them.
    link, end : (all chunks + 1,) int64 arrays
        Where the links and the walls of each chunk begin.
    cut : Cut
    out : Gathered, out
    """
    for place in prange(len(chunks)):
        _gather_chunk(np.int64(place), link[chunks[place]], end[chunks[place]], cut, out)
