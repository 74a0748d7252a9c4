"""Facets across gaps too narrow for twins: heat passes there from body to body as if nothing lay between.

Where bodies touch there always are such facets. What they carry between good conductors is too much by the more, the
better those conduct, and hardly less with more particles; with what lies between in their place it is too little.
"""

from __future__ import annotations

import numpy as np

from demheat.network.base import SIDES, Network, image_shifts, row_numbers

# Conductivities of bodies over that between them, or the other way round, from which facets across gaps matter: below
# it the answers are right to what fewer particles tell.
CONTRAST = 25.0
# Of a particle's way to a wall, where it is looked whether its body goes on to the wall.
NEAR = 1e-6


def matter(scene) -> bool:
    """Whether inclusions conduct so much better or worse than what they lie in that facets across gaps matter."""
    k = scene.mean_conductivities
    return bool(np.any(_steep(k[1:], k[1:], k[scene.parents()][1:])))


def filled(network: Network, scene) -> Network:
    """The same network where links over gaps conduct as what lies in the gaps."""
    conductance, wall = network.conductance.copy(), network.wall_conductance.copy()
    k, parent = scene.mean_conductivities, scene.parents()
    # Of the surroundings of each phase; the matrix has none.
    beside = k[parent]
    row = row_numbers(network.indptr)
    links = np.flatnonzero((network.phase[row] > 0) & (network.phase[network.indices] > 0))
    links = links[_over_gaps(network, scene, parent, row[links], links)]
    here, there = network.phase[row[links]], network.phase[network.indices[links]]
    steep = _steep(np.minimum(k[here], k[there]), np.maximum(k[here], k[there]), beside[here])
    links, here = links[steep], here[steep]
    way = _ways(network, row[links], links)
    conductance[links] = beside[here] * network.area[links] / np.linalg.norm(way, axis=1)
    feet = _before_walls(network, scene, beside)
    wall[feet] *= beside[network.phase[network.wall_particle[feet]]] / k[network.phase[network.wall_particle[feet]]]
    return network._replace(conductance=conductance, wall_conductance=wall)


def _over_gaps(network, scene, parent, row, links):
    """Whether links within inclusions join bodies that do not lie in each other, or copies of one."""
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


def _before_walls(network, scene, beside):
    """Numbers of wall facets of particles in bodies that end before the wall."""
    k, inner = scene.mean_conductivities, network.phase[network.wall_particle] > 0
    feet = np.flatnonzero(inner & (network.wall_side < len(SIDES) - 1))
    particle, side = network.wall_particle[feet], network.wall_side[feet]
    points, axis = network.centers[particle].copy(), side // 2
    wall = np.where(side % 2, np.asarray(scene.size)[axis], 0.0)
    at = np.arange(len(feet))
    points[at, axis] = wall + NEAR * (points[at, axis] - wall)
    phase = network.phase[particle]
    ends = scene.phase_at(points) != phase
    return feet[ends & _steep(k[phase], k[phase], beside[phase])]


def _steep(worst, best, between):
    """Whether bodies conduct much better, or much worse, than what lies between them."""
    return (worst >= CONTRAST * between) | (CONTRAST * best <= between)


def _ways(network, row, links):
    """From one centre of links to the other, (m, 3) float array, m."""
    return (
        network.centers[network.indices[links]]
        + image_shifts(network.image[links], network.size)
        - network.centers[row]
    )
