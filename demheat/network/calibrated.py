"""The papers' contact network: links between touching particles with transmission surfaces pi R_m^2 (C_t = 1).

Source: Haddad et al. 2021, eqs. 2-3 and 7-9.
"""

import numpy as np
from scipy.sparse import csgraph
from scipy.spatial import cKDTree

from demheat.laws import Calibrated
from demheat.network.base import SIDES, Facets, row_numbers, wall_normals
from demheat.packing.neighbours import as_graph, contacts
from demheat.packing.walls import wall_distance
from demheat.scene import ROUND_AXES

MEANS = {
    "arithmetic": lambda a, b: 0.5 * (a + b),
    "harmonic": lambda a, b: 2.0 * a * b / (a + b),
    "geometric": lambda a, b: np.sqrt(a * b),
}
# The papers impose wall temperatures at the centres of the particles that touch the wall. A wall link this short, in
# radii, holds the centre at the wall's temperature to 1e-4 of the drop over one link.
ISOTHERMAL = 1e-4
# A particle overlapping or touching a wall within this part of its radius is always in contact with it.
LEAST_GAP = 1e-3
# Packings are layered near a wall. Under a linear field their links were found to carry 4 % less than in the bulk at 3
# mean radii from it, 1.5 % less at 5, and as much within the scatter of 0.5 % from 6 on.
LAYER = 6.0
# Least radius of a sphere with a bulk, in widths of that layer.
THICK = 1.5
_NO_BULK = (
    "wall = 'surface': the packing of size {} has no bulk {:g} mean radii away from its walls; use more particles or "
    "wall = 'center'"
)


def contact_facets(packing, law: Calibrated) -> Facets:
    """Contact network of a packing with S = pi R_m^2, R_m the mean of two radii (C_t = 1)."""
    links = contacts(packing, coordination=law.coordination, gap=law.gap, additive=law.additive)
    facets = joined_facets(packing, links, sparse=law.sparse)
    here, there = np.repeat(packing.radii, np.diff(facets.indptr)), packing.radii[facets.indices]
    facets = facets._replace(area=np.pi * MEANS[law.mean](here, there) ** 2)
    return at_walls(packing, facets, law.wall)


def joined_facets(packing, links, *, sparse) -> Facets:
    """Links and wall links of particles in contact, before their law gives them surfaces."""
    indptr, indices, gap = links
    walls = _wall_contacts(packing, max(gap, LEAST_GAP))
    alive = np.ones(packing.number, dtype=bool)
    if sparse == "nearest":
        indptr, indices = _joined(packing, indptr, indices, 2)
    elif sparse == "drop":
        alive = _well_linked(indptr, indices, walls[0])
        indptr, indices = _without(indptr, indices, ~alive)
        walls = [column[alive[walls[0]]] for column in walls]
    particle, side = walls
    length, image = _lengths(packing, indptr, indices)
    _check_apart(indptr, indices, length)
    here, there = np.repeat(packing.radii, np.diff(indptr)), packing.radii[indices]
    length *= here / (here + there)
    volumes = np.where(alive, packing.radii, 0.0) ** 3
    volumes *= packing.volume / volumes.sum()
    shares = _wall_shares(packing, particle, side)
    height = ISOTHERMAL * packing.radii[particle]
    facets = Facets(indptr, indices, image, None, length, particle, side, shares, height, volumes)
    return facets._replace(wall_normal=_normals(packing, facets)) if ROUND_AXES[packing.domain] else facets


def at_walls(packing, facets, wall) -> Facets:
    """Facets whose wall links act in the centres of their particles, "center", or at the wall, "surface"."""
    return facets._replace(wall_distance=surface_distances(facets, packing)) if wall == "surface" else facets


def surface_distances(facets, packing):
    """Effective distances between wall and centres with which imposed temperatures act at the wall.

    A wall link is H = k S_w a / h, with h the distance from the centre to the wall and S_w its share of the wall. The
    factor a of each axis makes a linear field right on average: under T = x the network's mean flux along x over a
    column from wall to wall, (sum over links of H b_x^2 + sum over wall links of H h^2) / volume with H in units of k
    and b the branch vector, equals its value in the bulk, `LAYER` mean radii away from the walls. What links lack in
    the layer at the wall, where there are fewer of them, the wall links thus make up for. All links scale with C_t. In
    a sphere the field is T = r, the distance from its centre, and the flux the mean radial one.
    """
    distance = np.empty(len(facets.wall_side))
    for side in np.unique(facets.wall_side):
        here = facets.wall_side == side
        distance[here] = heights(packing, side)[facets.wall_particle[here]]
    facets, factor = facets._replace(wall_distance=distance), np.ones(len(distance))
    for axis in _flat_walls(packing):
        factor[facets.wall_side // 2 == axis] = _wall_factor(facets, packing, axis)
    if packing.domain == "sphere":
        factor[:] = _sphere_factor(facets, packing)
    return distance / factor


def heights(packing, side):
    """Distance of every centre from a wall."""
    return wall_distance(packing, SIDES[side])


def _wall_factor(facets, packing, axis):
    """Factor a of `surface_distances` for the two walls across one axis."""
    layer, length = LAYER * np.mean(packing.radii), packing.size[axis]
    column = _side_depth(packing, axis) >= layer
    reaching = column[facets.wall_particle] & (facets.wall_side // 2 == axis)
    if not column.any() or length <= 3 * layer:
        raise ValueError(_NO_BULK.format(packing.size.tolist(), LAYER))
    rows = row_numbers(facets.indptr)
    inside = column[rows]
    rows, columns = rows[inside], facets.indices[inside]
    x = packing.centers[:, axis]
    low, high = np.minimum(x[rows], x[columns]), np.maximum(x[rows], x[columns])
    flow = 0.5 * _conductances(facets, packing, rows, inside) * (high - low)
    within = np.minimum(high, length - layer) - np.maximum(low, layer)
    bulk = flow @ np.maximum(within, 0.0) / (length - 2 * layer)
    lacking = bulk * length - flow @ (high - low)
    carried = facets.wall_area[reaching] @ facets.wall_distance[reaching]
    return _made_up(lacking, carried)


def _sphere_factor(facets, packing):
    """Factor a of `surface_distances` for the wall of a sphere.

    Under T = r a conductivity k has as the integral of its radial flux k times the volume. Within a layer's width of
    the centre, or half of the bulk's radius if that is less, links are too long for T to be even along them: left out.
    """
    layer, radius = LAYER * np.mean(packing.radii), packing.size[0] / 2
    if radius <= THICK * layer:
        raise ValueError(_NO_BULK.format(packing.size.tolist(), LAYER))
    begin, end = min(layer, (radius - layer) / 2), radius - layer
    r = np.linalg.norm(packing.centers - packing.size / 2, axis=1)
    rows = row_numbers(facets.indptr)
    low, high = np.minimum(r[rows], r[facets.indices]), np.maximum(r[rows], r[facets.indices])
    flow = 0.5 * _conductances(facets, packing, rows) * (high - low)
    volume = 4 / 3 * np.pi * (np.array([end, radius]) ** 3 - begin**3)
    bulk = flow @ np.maximum(np.minimum(high, end) - np.maximum(low, begin), 0.0) / volume[0]
    lacking = bulk * volume[1] - flow @ np.maximum(high - np.maximum(low, begin), 0.0)
    return _made_up(lacking, facets.wall_area @ facets.wall_distance)


def _conductances(facets, packing, rows, inside=slice(None)):
    """Conductances of links over the conductivity, with facets that divide them by the radii."""
    columns = facets.indices[inside]
    share = packing.radii[rows] / (packing.radii[rows] + packing.radii[columns])
    return facets.area[inside] * share / facets.distance[inside]


def _made_up(lacking, carried):
    """What wall links make up for, over what they carry."""
    if not (lacking > 0 and carried > 0):
        raise ValueError(
            "wall = 'surface': the network has no layer at its walls with fewer links than inside, or no particle "
            "touches them; the packing must have been made between hard walls"
        )
    return lacking / carried


def _side_depth(packing, axis):
    """Distance of each centre from the walls that do not cut `axis`, m; infinite without such walls."""
    depth = np.full(packing.number, np.inf)
    for k in _flat_walls(packing):
        if k != axis:
            depth = np.minimum(depth, np.minimum(heights(packing, 2 * k), heights(packing, 2 * k + 1)))
    return np.minimum(depth, heights(packing, SIDES.index("round"))) if ROUND_AXES[packing.domain] else depth


def _joined(packing, indptr, indices, least):
    """Rows with links added, both ways, from each particle with fewer than `least` to its nearest."""
    sparse = np.flatnonzero(np.diff(indptr) < least)
    if len(sparse) == 0:
        return indptr, indices
    box, n = np.where(packing.periodic, packing.size, 0.0), packing.number
    _, near = cKDTree(packing.centers, boxsize=box).query(packing.centers[sparse], k=min(n, 33))
    offsets = packing.centers[near] - packing.centers[sparse][:, None]
    offsets -= box * np.round(offsets / packing.size)
    surface = np.linalg.norm(offsets, axis=2) - packing.radii[near]
    surface[near == sparse[:, None]] = np.inf
    chosen = np.take_along_axis(near, np.argsort(surface, axis=1, kind="stable")[:, :least], axis=1).ravel()
    ends = np.repeat(sparse, len(chosen) // len(sparse))
    # One number per link, ascending as the rows are.
    present = row_numbers(indptr) * n + indices.astype(np.int64)
    added = np.setdiff1d(np.concatenate((ends * n + chosen, chosen * n + ends)), present)
    merged = np.insert(present, np.searchsorted(present, added), added)
    return _pointers(merged // n, n), (merged % n).astype(np.uint32)


def _well_linked(indptr, indices, touching):
    """Particles of the largest cluster in which each has 2 links or more, walls counted as one."""
    held = np.zeros(len(indptr) - 1, dtype=np.int64)
    held[touching] = 1
    alive = np.ones(len(held), dtype=bool)
    while True:
        sparse = alive & (np.diff(indptr) + held < 2)
        if not sparse.any():
            break
        alive &= ~sparse
        indptr, indices = _without(indptr, indices, sparse)
    _, cluster = csgraph.connected_components(as_graph(indptr, indices), directed=False)
    return alive & (cluster == np.argmax(np.bincount(cluster)))


def _without(indptr, indices, gone):
    """Rows without the links to or from some particles."""
    rows = row_numbers(indptr)
    kept = ~(gone[rows] | gone[indices])
    return _pointers(rows[kept], len(gone)), indices[kept]


def _pointers(rows, n):
    return np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=n))])


def _lengths(packing, indptr, indices):
    """Length of each link to the nearest image, m, and that image's code; axis by axis to spare memory."""
    squares, code = np.zeros(len(indices)), np.zeros(len(indices), dtype=np.uint8)
    for k in range(3):
        x = packing.centers[:, k]
        step = x[indices] - np.repeat(x, np.diff(indptr))
        shift = -np.round(step / packing.size[k]) if packing.periodic[k] else np.zeros(len(step))
        squares += (step + shift * packing.size[k]) ** 2
        code = 3 * code + (shift + 1.0).astype(np.uint8)
    return np.sqrt(squares), code


def _check_apart(indptr, indices, length):
    """Two centres in one place would be a link of no length, and all temperatures not-a-number."""
    if len(length) and not length.min() > 0:
        link = int(np.argmin(length))
        row = int(np.searchsorted(indptr, link, side="right")) - 1
        raise ValueError(
            f"packing.centers: {row} and {indices[link]} coincide, contacts need a distance; leave one out"
        )


def _flat_walls(packing):
    """Axes with a flat wall at each end."""
    return [k for k in range(3) if not packing.periodic[k] and k not in ROUND_AXES[packing.domain]]


def walls_of(packing):
    """Numbers in `SIDES` of the walls of a packing."""
    flat = [2 * axis + end for axis in _flat_walls(packing) for end in (0, 1)]
    return [*flat, SIDES.index("round")] if ROUND_AXES[packing.domain] else flat


def _wall_contacts(packing, gap):
    """Particles within the gap of a wall, as (particle, side)."""
    particle, side = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    for s in walls_of(packing):
        touching = np.flatnonzero(heights(packing, s) <= packing.radii * (1.0 + gap))
        particle.append(touching)
        side.append(np.full(len(touching), s))
    return [np.concatenate(parts) for parts in (particle, side)]


def _wall_shares(packing, particle, side):
    """Part of its wall that each wall contact stands for, m2: together all of it, so that a flux enters in full."""
    share, axes = packing.radii[particle] ** 2, ROUND_AXES[packing.domain]
    # A flat wall times the length between the two is the volume; round area times radius over its axes is it, too.
    length = [*packing.size.repeat(2), packing.size[axes[0]] / 2 / len(axes) if axes else np.inf]
    walls = packing.volume / np.array(length)
    # Of a wall that nothing touches there is no share.
    whole = np.bincount(side, share, minlength=len(SIDES))[side]
    return walls[side] / whole * share


def _normals(packing, facets):
    """Outward unit vectors of the walls at the particles that touch them, (w, 3) float array."""
    flat = facets.wall_side < SIDES.index("round")
    normals, axes = np.zeros((len(flat), 3)), list(ROUND_AXES[packing.domain])
    normals[flat] = wall_normals(facets._replace(wall_side=facets.wall_side[flat]))
    off = (packing.centers[:, axes] - packing.size[axes] / 2)[facets.wall_particle[~flat]]
    normals[np.ix_(~flat, axes)] = off / np.linalg.norm(off, axis=1)[:, None]
    return normals
