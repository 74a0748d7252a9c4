"""The geometry and the conductances of a network of particles, as arrays."""

from typing import NamedTuple

import numpy as np

from demheat.scene import WALLS

# Names of the walls by their codes in `wall_side`.
SIDES = (*WALLS, "round")
# Rows for which nothing need be compiled: NumPy is as fast, and to compile takes longer than to solve.
FEW = 4096


class Facets(NamedTuple):
    """Surfaces between particles and towards walls, in compressed rows (each link stands in both of its rows)."""

    indptr: np.ndarray  # (n + 1,) int64 array: Row pointers
    indices: np.ndarray  # (m,) uint32 array: The other particle of each link
    # (m,) uint8 array: Which periodic image of it: 9 (sx + 1) + 3 (sy + 1) + sz + 1 with shifts s in -1, 0, 1 boxes
    image: np.ndarray
    area: np.ndarray  # (m,) float array, m2: Transmission surface S_pq, the same from both ends
    # (m,) float array, m: From the row's centre to the facet's plane along the link (negative beyond a facet that has
    # passed it)
    distance: np.ndarray
    # wall_particle, wall_side: (w,) int arrays: Particle and side (0 to 5 = x-, x+, y-, y+, z-, z+; 6 = round) of each
    # wall facet
    wall_particle: np.ndarray
    wall_side: np.ndarray
    # wall_area, wall_distance: (w,) float arrays, m2 and m: Distance to the wall along the facet's normal
    wall_area: np.ndarray
    wall_distance: np.ndarray
    volumes: np.ndarray  # (n,) float array, m3: Cell volumes
    # (w, 3) float array, optional: Outward unit vector of each wall facet; laws without it have flat walls only
    wall_normal: np.ndarray | None = None


class Network(NamedTuple):
    """Conductances between particles and towards walls, and what is needed to read a field off their temperatures.

    What `Facets` has, too, is the same here.
    """

    centers: np.ndarray  # (n, 3) float array, m
    size: np.ndarray  # (3,) float array, m
    indptr: np.ndarray
    indices: np.ndarray
    image: np.ndarray
    conductance: np.ndarray  # (m,) float array, W/K: H_pq = k S_pq / d_pq, symmetric
    wall_particle: np.ndarray
    wall_side: np.ndarray
    wall_conductance: np.ndarray  # (w,) float array, W/K
    wall_area: np.ndarray
    wall_distance: np.ndarray
    volumes: np.ndarray
    phase: np.ndarray  # (n,) int array
    wall_normal: np.ndarray | None = None
    # From here on what only evaluation needs: a network that is solved but not sampled may lack it.
    radii: np.ndarray | None = None  # (n,) float array, m
    periodic: np.ndarray | None = None  # (3,) bool array: Axis by axis
    area: np.ndarray | None = None  # (m,) float array, m2: Of each link's facet, those that conduct, C_t included
    distance: np.ndarray | None = None  # Radical cells do without: `link_distances` finds it from the radii
    cells: bool = True  # Facets bound cells that fill the body, as radical ones do: what is linear is exact
    # What a Field says of it: law, calibration (C_t), tessellation_s, network_s and packing, how that was made
    stats: dict | None = None
    # Links that should conduct do; if not, bodies that no heat passes are looked for though all phases conduct
    whole: bool = True
    # Numbers of links, and of wall facets, that join no body: they conduct what a gap lets pass
    over: tuple[np.ndarray, np.ndarray] | None = None


def wall_normals(walls):
    """Outward unit vectors of the wall facets of a Facets or a Network, (w, 3) float array."""
    if walls.wall_normal is not None:
        return walls.wall_normal
    normals = np.zeros((len(walls.wall_side), 3))
    normals[np.arange(len(normals)), walls.wall_side // 2] = 2.0 * (walls.wall_side % 2) - 1.0
    return normals


# Of the image in the box itself.
HERE = 13


def image_codes(steps):
    """Codes of periodic images, which `image_shifts` takes back."""
    return ((np.asarray(steps) + 1) @ np.array([9, 3, 1])).astype(np.uint8)


def image_shifts(image, size):
    """Offsets of periodic images."""
    code = np.asarray(image, dtype=np.int16)
    return np.stack([code // 9 - 1, code // 3 % 3 - 1, code % 3 - 1], axis=1) * np.asarray(size)


def radical_distances(square, weight, other):
    """Distance from a site to the radical plane that parts it from another."""
    return (square + weight - other) / (2.0 * np.sqrt(square))


def link_distances(network):
    """Distance from each row's centre to the facet of each link, (m,) float array, m."""
    if network.distance is not None:
        return network.distance
    links = network.indptr, network.indices, network.image
    square = np.einsum("ij,ij->i", *[branches(network.centers, network.size, *links)] * 2)
    weight = network.radii**2
    return radical_distances(square, np.repeat(weight, np.diff(network.indptr)), weight[network.indices])


def row_numbers(indptr):
    """Row of each entry of a compressed-row structure, (m,) int64 array."""
    return np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))


def branches(centers, size, indptr, indices, image):
    """Vectors from each row's centre to the centre (image) of its neighbour."""
    way, away = centers[indices] - np.repeat(centers, np.diff(indptr), axis=0), np.flatnonzero(image != HERE)
    way[away] += image_shifts(image[away], size)
    return way


def without_links(network, still):
    """A Network without the links of some particles, which exchange no heat."""
    cut = np.repeat(still, np.diff(network.indptr))
    walls = np.where(still[network.wall_particle], 0.0, network.wall_conductance)
    # Links are symmetric: mostly those of pores conduct nothing anyway, and nothing is copied.
    if not np.any(network.conductance[cut]):
        return network._replace(wall_conductance=walls)
    cut |= still[network.indices]
    return network._replace(conductance=np.where(cut, 0.0, network.conductance), wall_conductance=walls)
