"""Conductances of links, with the rule for links that join two materials."""

import numpy as np

from demheat.laws import RULES
from demheat.network.base import FEW, Network, branches, image_shifts, row_numbers
from demheat.network.links_kernels import Places, lengths
from demheat.runtime.threads import shared_out

# Rows connected at once: bounds the scratch memory (some 1.5 kB a row, 25 MB).
BLOCK = 16384


def link_conductivity(k_here, k_there, share, *, rule="harmonic"):
    """Conductivity of links between two materials."""
    if rule not in RULES:
        raise ValueError(f"interface = {rule!r}: must be one of {', '.join(RULES)}")
    share = np.clip(share, 0.0, 1.0)
    least = np.minimum(k_here, k_there)
    if rule == "arithmetic":
        # Pores exchange no heat, whatever is beside them.
        return np.where(least > 0, share * k_here + (1.0 - share) * k_there, 0.0)
    series = share * k_there + (1.0 - share) * k_here
    return np.divide(k_here * k_there, series, out=np.zeros_like(series), where=(least > 0) & (series > 0))


def connect(packing, facets, phase, conductivities, *, rule="harmonic", cells=True, resistance=None) -> Network:
    """Conductances H = k S / d of facets between particles of given phases.

    Where the interface has a resistance R it is in series, 1/H = d/(k S) + R/S: exact where the facet lies on it. Of
    where facets are and how they lie it may be told, as those that lean are less surface than their area.
    """
    conductivity = conductivities[phase]
    wall = conductivity[facets.wall_particle] * facets.wall_area / facets.wall_distance
    conductance = _conductances(packing, facets, conductivity, rule)
    return Network(
        centers=packing.centers,
        size=packing.size,
        indptr=facets.indptr,
        indices=facets.indices,
        image=facets.image,
        conductance=_resisted(conductance, packing, facets, phase, resistance),
        wall_particle=facets.wall_particle,
        wall_side=facets.wall_side,
        wall_conductance=wall,
        wall_area=facets.wall_area,
        wall_distance=facets.wall_distance,
        volumes=facets.volumes,
        phase=phase,
        wall_normal=facets.wall_normal,
        radii=packing.radii,
        periodic=packing.periodic,
        area=facets.area,
        distance=None if cells else facets.distance,  # follows from the radii: 8 bytes less for each link
        cells=cells,
    )


def _conductances(packing, facets, conductivity, rule):
    """Conductance of each link, (m,) float array, W/K; block by block."""
    conductance = _lengths(packing, facets)
    for start in range(0, packing.number, BLOCK):
        rows = np.arange(start, min(packing.number, start + BLOCK))
        links = slice(facets.indptr[rows[0]], facets.indptr[rows[-1] + 1])
        row = np.repeat(rows, np.diff(facets.indptr[start : start + len(rows) + 1]))
        there, length = facets.indices[links], conductance[links]
        k, beyond = conductivity[row], conductivity[there]
        unlike = np.flatnonzero(k != beyond)
        share = facets.distance[links][unlike] / length[unlike]
        k[unlike] = link_conductivity(k[unlike], beyond[unlike], share, rule=rule)
        conductance[links] = k * facets.area[links] / length
    return conductance


def _resisted(conductance, packing, facets, phase, resistance):
    """The conductances with what interfaces resist in series, in place."""
    if resistance is None:
        return conductance
    here, there = np.repeat(phase, np.diff(facets.indptr)), phase[facets.indices]
    unlike = np.flatnonzero((here != there) & (facets.area > 0))
    found, met = conductance[unlike], resistance(here[unlike], there[unlike], *_feet(packing, facets, unlike))
    conductance[unlike] = found / (1.0 + found * met / facets.area[unlike])
    return conductance


def _feet(packing, facets, links):
    """Where links meet their facets, and unit vectors along them, two (k, 3) float arrays."""
    row = row_numbers(facets.indptr)[links]
    here, there = packing.centers[row], packing.centers[facets.indices[links]]
    way = there + image_shifts(facets.image[links], packing.size) - here
    way /= np.linalg.norm(way, axis=1)[:, None]
    return here + facets.distance[links][:, None] * way, way


def _lengths(packing, facets):
    """Distance between the centres of each link, (m,) float array, m."""
    links = facets.indptr, facets.indices
    if packing.number <= FEW:
        way = branches(packing.centers, packing.size, *links, facets.image)
        return np.sqrt(np.einsum("ij,ij->i", way, way))
    length, places = np.empty(len(facets.indices)), Places(packing.centers, packing.size, facets.image)
    shared_out(lengths, packing.number, *links, places, length, piece=BLOCK)
    return length
