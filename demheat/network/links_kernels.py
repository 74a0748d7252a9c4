"""What compiled loops need of a network: its links, and where they lead; how links are found from facets."""

from typing import NamedTuple

import numpy as np
from numba import njit

# Options of kernels of which threads do pieces, from `first` to `last`: they make no array, so that no references are
# counted, and hold no lock.
IN_PIECES = {"cache": True, "error_model": "numpy", "_nrt": False, "nogil": True}


# Code of the image in the box itself.
HERE = 13


class Links(NamedTuple):
    """Links of a network in compressed rows; each stands in both of its rows."""

    indptr: np.ndarray  # (n + 1,) int64 array: Row pointers
    indices: np.ndarray  # (m,) uint32 array: The other particle of each link
    conductance: np.ndarray  # (m,) float array, W/K


class Places(NamedTuple):
    """Where the ends of links lie."""

    centers: np.ndarray  # (n, 3) float array, m
    size: np.ndarray  # (3,) float array, m: Of the box
    # (m,) uint8 array: Which periodic image of its other end each link leads to: 9 (sx + 1) + 3 (sy + 1) + sz + 1, see
    # `Facets`
    image: np.ndarray


def links_of(network):
    """Links of a Network for kernels."""
    return Links(network.indptr, network.indices, network.conductance)


def places_of(network):
    """Places of a Network for kernels."""
    return Places(network.centers, network.size, network.image)


@njit(cache=True, error_model="numpy", _nrt=False, inline="always")
def _way(i, j, code, centers, size):
    """Vector from a particle to an image of another."""
    u, v, w = centers[j, 0] - centers[i, 0], centers[j, 1] - centers[i, 1], centers[j, 2] - centers[i, 2]
    if code != HERE:  # few are not
        u += (code // 9 - 1) * size[0]
        v += (code // 3 % 3 - 1) * size[1]
        w += (code % 3 - 1) * size[2]
    return u, v, w


@njit(cache=True, error_model="numpy", _nrt=False)
def rise_along(i, e, links, places, gradient, x):
    """Rise of the temperature from a particle to its neighbour (image) along a link, and the way there.

    i, e : int; the particle and one of its links
    links : Links
    places : Places
    gradient : (3,) float array, K/m
    x : (n,) float array, K; temperatures less the linear field of the gradient
    Returns:
    rise : float, K
    u, v, w : float, m; vector from the particle to its neighbour
    """
    j = links.indices[e]
    u, v, w = _way(i, j, np.int64(places.image[e]), places.centers, places.size)
    return x[j] - x[i] + gradient[0] * u + gradient[1] * v + gradient[2] * w, u, v, w


@njit(**IN_PIECES)
def lengths(first, last, indptr, indices, places, length):
    """Distances between the ends of links of rows from first to last.

    indptr : (n + 1,) int64 array; row pointers
    indices : (m,) uint32 array; the other particle of each link
    places : Places
    length : (m,) float array, m, out
    """
    for i in range(np.uint64(first), np.uint64(last)):
        for e in range(np.uint64(indptr[i]), np.uint64(indptr[i + np.uint64(1)])):
            u, v, w = _way(i, indices[e], np.int64(places.image[e]), places.centers, places.size)
            length[e] = np.sqrt(u * u + v * v + w * w)


@njit(**IN_PIECES)
def match_links(first, last, indptr, indices, image, area, matched):
    """Give each link of rows from first to last one area, from those that its two cells see.

    first, last : int
    indptr : (n + 1,) int64 array; row pointers
    indices : (m,) uint32 array; the other cell of each link
    image : (m,) uint8 array; which periodic image of it
    area : (m,) float array, m2; as seen from the row's cell
    matched : (m,) float array, m2, out; the mean of both; 0 where only one of the cells sees the facet
    """
    one = np.uint64(1)
    for p in range(np.uint64(first), np.uint64(last)):
        for e in range(np.uint64(indptr[p]), np.uint64(indptr[p + one])):
            q, back = np.uint64(indices[e]), 26 - image[e]
            matched[e] = 0.0
            for r in range(np.uint64(indptr[q]), np.uint64(indptr[q + one])):
                if indices[r] == p and image[r] == back:
                    matched[e] = 0.5 * (area[e] + area[r])
                    break
