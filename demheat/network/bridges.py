"""Facets across gaps too narrow for twins: between their particles heat passes as if nothing lay between the bodies.

Where bodies touch there always are such facets. What they carry between good conductors would be too much by the more,
the better those conduct, and hardly less with more particles: they carry what the gap lets pass. Between bad ones they
carry too little, and what the answer is if the matrix lies in their place tells by how much at most.
"""

from typing import NamedTuple

import numpy as np

from demheat.network.base import SIDES, Network, image_shifts, link_distances, row_numbers
from demheat.network.gap_links import Facets, across
from demheat.scene.resistances import between as resisting
from demheat.scene.shapes.base import TOUCH

# Conductivities of bodies over that between them, or the other way round, from which facets across gaps matter: below
# it the answers are right to what fewer particles tell.
CONTRAST = 25.0
# Part of what gaps let pass that is not known: the more, the more of it is how lines of flow draw together in the
# bodies, which goes with the inverse of the contrast. Arrays that touch, in cubic order at 100, ask for .9 of it.
KNOWN, DRAWN, MOST = 0.05, 60.0, 0.7
# Of a particle's way to a wall, where it is looked whether its body goes on to the wall.
NEAR = 1e-6


class Over(NamedTuple):
    """Links over gaps, and wall facets over gaps before walls."""

    links: np.ndarray  # (m,) int array
    feet: np.ndarray  # (w,) int array: Numbers of wall facets


class _Group(NamedTuple):
    """Facets of one gap."""

    which: np.ndarray  # (n,) int array: Links, or wall facets
    phases: tuple  # Of the bodies, or of the one before a wall
    facets: Facets


def matter(scene) -> bool:
    """Whether inclusions conduct so much better or worse than what they lie in that facets across gaps matter."""
    return bool(np.any(_good(scene)[1:] | _bad(scene)[1:]))


def bad(scene) -> bool:
    """Whether some of them conduct so much worse."""
    return bool(np.any(_bad(scene)[1:]))


def needed(packing: dict, scene) -> bool:
    """Whether twins were left out of gaps that matter, as the provenance of a packing says."""
    return packing.get("of", packing).get("pairs_left_out", 0) > 0 and matter(scene)


def over_gaps(network: Network, scene) -> Over:
    """Links and wall facets over gaps between good conductors, or before them."""
    row, good = row_numbers(network.indptr), _good(scene)
    links = np.flatnonzero(good[network.phase[row]] & good[network.phase[network.indices]])
    links = links[_over_gaps(network, scene, row[links], links)]
    feet = _before_walls(network, scene)
    return Over(links, feet[good[network.phase[network.wall_particle[feet]]]])


def bridged(network: Network, scene, perfect=None) -> Network:
    """The same network where links over gaps between good conductors conduct as the gaps let them.

    Perfect conductors, by phase, stay joined where they touch.
    """
    found, least = over_gaps(network, scene), _least_gap(network)
    conductance, wall = network.conductance.copy(), network.wall_conductance.copy()
    perfect = np.zeros(len(scene.materials), bool) if perfect is None else perfect
    gaps = (
        (conductance, _links(network, scene, found.links), least),
        # A wall is a mirror.
        (wall, _feet(network, scene, found.feet), 0.5 * least),
    )
    over = [[np.empty(0, int)], [np.empty(0, int)]]
    for kind, (into, groups, narrow) in enumerate(gaps):
        for group in groups:
            own, width = across(into[group.which], group.facets, narrow)
            touching = group.facets.resistance == 0 and width <= TOUCH * max(scene.size)
            if not (touching and perfect[list(group.phases)].all()):
                into[group.which] = own
                over[kind].append(group.which)
    over = tuple(np.concatenate(each) for each in over)
    return network._replace(conductance=conductance, wall_conductance=wall, over=over)


def loosened(network: Network, scene) -> Network:
    """The same network where gaps between good conductors let pass as much less as is not known of it."""
    if network.over is None:
        return network
    (links, feet), k = network.over, scene.mean_conductivities
    contrast = k / np.maximum(k[scene.parents()], 1e-300)
    part = 1.0 - np.minimum(KNOWN + DRAWN / np.maximum(contrast, CONTRAST), MOST)
    conductance, wall = network.conductance.copy(), network.wall_conductance.copy()
    ends = network.phase[row_numbers(network.indptr)[links]], network.phase[network.indices[links]]
    conductance[links] *= np.minimum(part[ends[0]], part[ends[1]])
    wall[feet] *= part[network.phase[network.wall_particle[feet]]]
    return network._replace(conductance=conductance, wall_conductance=wall)


def _least_gap(network):
    packing = network.stats["packing"]
    return packing.get("of", packing)["least_gap"]


def filled(network: Network, scene) -> Network:
    """The same network where links over gaps between bad conductors conduct as what lies in the gaps."""
    conductance, wall = network.conductance.copy(), network.wall_conductance.copy()
    k, of_bad = scene.mean_conductivities, _bad(scene)
    # Of the surroundings of each phase; the matrix has none.
    beside, row = k[scene.parents()], row_numbers(network.indptr)
    links = np.flatnonzero(of_bad[network.phase[row]] & of_bad[network.phase[network.indices]])
    links = links[_over_gaps(network, scene, row[links], links)]
    way = _ways(network, row[links], links)
    conductance[links] = beside[network.phase[row[links]]] * network.area[links] / np.linalg.norm(way, axis=1)
    feet = _before_walls(network, scene)
    feet = feet[of_bad[network.phase[network.wall_particle[feet]]]]
    phase = network.phase[network.wall_particle[feet]]
    wall[feet] = beside[phase] * network.wall_area[feet] / network.wall_distance[feet]
    return network._replace(conductance=conductance, wall_conductance=wall)


def _good(scene):
    k = scene.mean_conductivities
    return (k >= CONTRAST * k[scene.parents()]) & (np.arange(len(k)) > 0)


def _bad(scene):
    k = scene.mean_conductivities
    return (CONTRAST * k <= k[scene.parents()]) & (np.arange(len(k)) > 0)


def _links(network, scene, links):
    """Links over gaps, gap by gap."""
    row = row_numbers(network.indptr)[links]
    here, there = network.phase[row], network.phase[network.indices[links]]
    start, way = network.centers[row], _ways(network, row, links)
    one, two = _copies(scene, here, start), _copies(scene, there, start + way)
    length = np.linalg.norm(way, axis=1)
    points = start + (link_distances(network)[links] / length)[:, None] * way - one * np.asarray(scene.size)
    k, parent, taken, resists = scene.mean_conductivities, scene.parents(), _taken(network, links), resisting(scene)
    keys, place = np.unique(np.column_stack([here, there, two - one]), axis=0, return_inverse=True)
    for number, (first, second, *steps) in enumerate(keys.tolist()):
        which = np.flatnonzero(place.ravel() == number)
        shift = np.array(steps) * scene.size
        between = _between(scene.inclusions[first - 1], scene.inclusions[second - 1], shift)
        resistivity = 1.0 / k[first] + 1.0 / k[second]
        own = 0.0 if resists is None else float(resists([first], [second])[0])
        ends = np.stack([taken[row[which]], taken[network.indices[links[which]]]])
        given = points[which], network.area[links[which]], between, float(k[parent[first]]), resistivity, own
        yield _Group(links[which], (first, second), Facets(*given, ends))


def _taken(network, links):
    """What passes from each particle into its body, (n,) float array, W/K; not by the links that are over gaps."""
    row = row_numbers(network.indptr)
    within = network.phase[row] == network.phase[network.indices]
    within[links] = False
    return np.bincount(row, np.where(within, network.conductance, 0.0), len(network.phase))


def _between(one, two, shift):
    """Distances from the surfaces of a body and another that is moved, and their outward normals."""

    def between(points):
        found = one.surface(points), two.surface(points - shift)
        return tuple(zip(*found, strict=True))

    return between


def _feet(network, scene, feet):
    """Wall facets over gaps, gap by gap."""
    particle, side = network.wall_particle[feet], network.wall_side[feet]
    phase, points, size = network.phase[particle], network.centers[particle].copy(), np.asarray(scene.size)
    points[np.arange(len(feet)), side // 2] = np.where(side % 2, size[side // 2], 0.0)
    k, parent, taken = scene.mean_conductivities, scene.parents(), _taken(network, np.empty(0, int))
    keys, place = np.unique(np.column_stack([phase, side]), axis=0, return_inverse=True)
    for number, (first, wall) in enumerate(keys.tolist()):
        which = np.flatnonzero(place.ravel() == number)
        between = _before(scene.inclusions[first - 1], wall // 2, size[wall // 2] if wall % 2 else 0.0)
        area, own = network.wall_area[feet[which]], float(scene.resistances[first])
        ends = np.stack([taken[particle[which]], np.full(len(which), np.inf)])
        given = points[which], area, between, float(k[parent[first]]), 1.0 / k[first], own
        yield _Group(feet[which], (first,), Facets(*given, ends))


def _before(body, axis, position):
    """Distances from the surface of a body and from a wall, and their outward normals."""
    sign = 1.0 if position == 0 else -1.0
    inward = sign * np.eye(3)[axis]

    def between(points):
        away, normal = body.surface(points)
        return (away, sign * (points[:, axis] - position)), (normal, np.tile(inward, (len(points), 1)))

    return between


def _over_gaps(network, scene, row, links):
    """Whether links within inclusions join bodies that do not lie in each other, or copies of one."""
    parent = scene.parents()
    here, there = network.phase[row], network.phase[network.indices[links]]
    apart = (here != there) & (parent[here] != there) & (parent[there] != here)
    if scene.periodic:
        start, way = network.centers[row], _ways(network, row, links)
        apart |= (here == there) & np.any(_copies(scene, here, start) != _copies(scene, here, start + way), axis=1)
    return apart


def _copies(scene, phase, points):
    """Which copy of its inclusion each point lies in, (n, 3) int array; 0 along what has no end."""
    low, high = (np.array(ends) for ends in zip(*(shape.bounds() for shape in scene.inclusions), strict=True))
    bounded = np.isfinite(low) & np.isfinite(high)
    middle = 0.5 * np.add(low, high, out=np.zeros_like(low), where=bounded)
    copy = np.rint((points - middle[phase - 1]) / scene.size).astype(int)
    return np.where(bounded[phase - 1], copy, 0)


def _before_walls(network, scene):
    """Numbers of wall facets of particles in bodies that end before the wall."""
    inner = network.phase[network.wall_particle] > 0
    feet = np.flatnonzero(inner & (network.wall_side < len(SIDES) - 1))
    particle, side = network.wall_particle[feet], network.wall_side[feet]
    points, axis = network.centers[particle].copy(), side // 2
    wall = np.where(side % 2, np.asarray(scene.size)[axis], 0.0)
    at = np.arange(len(feet))
    points[at, axis] = wall + NEAR * (points[at, axis] - wall)
    return feet[scene.phase_at(points) != network.phase[particle]]


def _ways(network, row, links):
    """From one centre of links to the other, (m, 3) float array, m."""
    return (
        network.centers[network.indices[links]]
        + image_shifts(network.image[links], network.size)
        - network.centers[row]
    )
