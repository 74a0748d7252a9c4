"""What compiled loops need of a network: its links, and where they lead; how links are found from facets."""

from typing import NamedTuple

import numpy as np
from numba import njit, prange


class Links(NamedTuple):
    """Links of a network in compressed rows; each stands in both of its rows.

    Attributes
    ----------
    indptr : (n + 1,) int64 array
        Row pointers.
    indices : (m,) uint32 array
        The other particle of each link.
    conductance : (m,) float array, W/K
    """

    indptr: np.ndarray
    indices: np.ndarray
    conductance: np.ndarray


class Places(NamedTuple):
    """Where the ends of links lie.

    Attributes
    ----------
    centers : (n, 3) float array, m
    size : (3,) float array, m
        Of the box.
    image : (m,) uint8 array
        Which periodic image of its other end each link leads to: 9 (sx + 1) + 3 (sy + 1) + sz + 1, see `Facets`.
    """

    centers: np.ndarray
    size: np.ndarray
    image: np.ndarray


def links_of(network):
    """Links of a Network for kernels."""
    return Links(network.indptr, network.indices, network.conductance)


def places_of(network):
    """Places of a Network for kernels."""
    return Places(network.centers, network.size, network.image)


@njit(cache=True)
def rise_along(i, e, links, places, gradient, x, branch):
    """Rise of the temperature from a particle to its neighbour (image) along a link, and the way there.

    Parameters
    ----------
    i, e : int
        The particle and one of its links.
    links : Links
    places : Places
    gradient : (3,) float array, K/m
    x : (n,) float array, K
        Temperatures less the linear field of the gradient.
    branch : (3,) float array, m, out
        Vector from the particle to its neighbour.

    Returns
    -------
    rise : float, K
    square : float, m2
        Squared length of the branch vector.
    """
    code = np.int64(places.image[e])
    j, centers, size = links.indices[e], places.centers, places.size
    branch[0] = centers[j, 0] - centers[i, 0] + (code // 9 - 1) * size[0]
    branch[1] = centers[j, 1] - centers[i, 1] + (code // 3 % 3 - 1) * size[1]
    branch[2] = centers[j, 2] - centers[i, 2] + (code % 3 - 1) * size[2]
    rise = x[j] - x[i]
    for k in range(3):
        rise += gradient[k] * branch[k]
    return rise, branch[0] ** 2 + branch[1] ** 2 + branch[2] ** 2


@njit(cache=True, parallel=True)
def match_links(indptr, indices, image, area, matched):
    """Give each link one area, from those that its two cells see.

    Parameters
    ----------
    indptr : (n + 1,) int64 array
        Row pointers.
    indices : (m,) uint32 array
        The other cell of each link.
    image : (m,) uint8 array
        Which periodic image of it.
    area : (m,) float array, m2
        As seen from the row's cell.
    matched : (m,) float array, m2, out
        The mean of both; 0 where only one of the cells sees the facet.
    """
    for p in prange(len(indptr) - 1):
        for e in range(indptr[p], indptr[p + 1]):
            q, back = indices[e], 26 - image[e]
            matched[e] = 0.0
            for r in range(indptr[q], indptr[q + 1]):
                if indices[r] == p and image[r] == back:
                    matched[e] = 0.5 * (area[e] + area[r])
                    break
