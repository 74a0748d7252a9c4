"""A rank's particles, those of the layer around its slab besides, and their cells: of the whole body, to rounding.

Packings, twins and cells are made by the code that makes whole ones, of what lies in the slab or near it. What a slab
sees of its neighbours ends in planes where cells are wrong; that no cell of its own reaches them, and that all slabs'
own cells fill the body, is checked.
"""

from typing import NamedTuple

import numpy as np

from demheat.dem.networks import warn_of_twins
from demheat.dem.options import Particles
from demheat.laws import Laguerre
from demheat.mpi.slabs import Slabs
from demheat.network.base import Network
from demheat.network.interface import connect
from demheat.network.laguerre import drop_empty_cells, laguerre
from demheat.packing.base import Packing, wrap
from demheat.packing.cache import relaxed, replica, replicated
from demheat.packing.tile import tiled
from demheat.packing.twins.conforming import Part, conform
from demheat.scene import Scene
from demheat.scene.resistances import on_facets

# Columns of Facets for walls.
WALLS = ("wall_particle", "wall_side", "wall_area", "wall_distance", "wall_normal")
# Relative, of the volumes of all cells: as of a whole tessellation.
DEFECT = 1e-9


class Cells(NamedTuple):
    """The network that a slab sees."""

    # The slab's own particles first; after them those of its neighbours, at the images that it meets, of which the
    # outermost lack links
    network: Network
    own: int  # Number of the first
    packing: dict  # How the whole packing was made, with its twins


def part_of(scene: Scene, law: Laguerre, wanted: Particles, slabs: Slabs, comm) -> Packing:
    """The particles and twins that lie in a slab or near it, in the box."""
    # One makes what all read.
    for turn in (0, 1):
        if turn == min(comm.rank, 1):
            packing, part = _packed(scene, law, wanted, slabs)
        comm.Barrier()
    if law.conforming:
        packing = conform(packing, scene, seed=wanted.seed, gap_spacing=law.gap_spacing, part=part)
        if comm.rank == 0:
            warn_of_twins(packing, wanted.particles)
    return packing


def _packed(scene, law, wanted, slabs):
    """A slab's part of the packing, and what is known there of all of it."""
    body = {"size": scene.size, "seed": wanted.seed}
    if wanted.is_tiled(scene, law):
        here = tiled(wanted.particles, periodic=scene.periodic, keep=slabs.near, **body)
        return here, _part(here.radii, slabs)
    counts = wanted.repeats(scene, law)
    if counts.prod() > 1:
        here = replicated(wanted.particles, counts, periodic=scene.periodic, keep=slabs.near, **body)
        return here, _part(replica(wanted.particles, counts, **body).radii, slabs)
    whole = relaxed(wanted.particles, periodic=scene.periodic, allow_few=wanted.allow_few, **body)
    near = slabs.near(whole.centers)
    return whole._replace(centers=whole.centers[near], radii=whole.radii[near]), _part(whole.radii, slabs)


def _part(radii, slabs):
    """What is known of a whole packing by radii: all of them, one replica's, or some of equal ones."""
    return Part(float(radii.mean()), float(radii.max()), slabs.near)


def cells_of(scene: Scene, law: Laguerre, packing: Packing, slabs: Slabs, comm) -> Cells:
    """Cells of a rank's part of a packing, and their conductances."""
    (seen, own), provenance = _seen(packing, slabs), packing.provenance
    # Memory: what a slab sees of it is a copy.
    del packing
    local, low = seen.size.copy(), np.zeros(3)
    low[slabs.axis], high = slabs.seen
    local[slabs.axis] = high - low[slabs.axis]
    facets = laguerre(np.clip(seen.centers - low, 0.0, local), seen.radii**2, local, periodic=seen.periodic)
    own = int(np.count_nonzero(facets.volumes[:own] > 0))
    seen, facets = drop_empty_cells(seen, facets)
    facets = _without_cuts(facets, own, slabs)
    phase = scene.phase_at(wrap(seen.centers, seen.size, np.broadcast_to(scene.periodic, 3)))
    rule = {"rule": law.interface, "cells": law.cells, "resistance": on_facets(scene)}
    network = connect(seen, facets, phase, scene.conductivities, **rule)
    filled = comm.allreduce(float(network.volumes[:own].sum())) / scene.volume - 1.0
    if abs(filled) > DEFECT:
        raise RuntimeError(f"the cells of all slabs fill the body with a relative defect of {filled:.2e}")
    return Cells(network, own, provenance)


def _seen(packing, slabs):
    """What a slab sees as a packing, its own particles first, and their number."""
    x, (low, high) = packing.centers[:, slabs.axis], slabs.seen
    ours = slabs.owner(packing.centers) == slabs.rank
    parts = [(np.flatnonzero(ours), 0)]
    for turn in (-1, 0, 1) if slabs.periodic else (0,):
        there = x + turn * slabs.length
        parts.append((np.flatnonzero((there >= low) & (there <= high) & ~(ours & (turn == 0))), turn))
    rows = np.concatenate([rows for rows, _ in parts])
    centers, periodic = packing.centers[rows], packing.periodic.copy()
    centers[:, slabs.axis] += slabs.length * np.concatenate([np.full(len(rows), turn) for rows, turn in parts])
    periodic[slabs.axis] = False
    seen = Packing(centers, packing.radii[rows], packing.size, periodic, packing.provenance)
    return seen, int(np.count_nonzero(ours))


def _without_cuts(facets, own, slabs):
    """The facets without those of the planes that end what is seen."""
    here = np.zeros(len(facets.wall_side), dtype=bool)
    for end, cut in enumerate(slabs.cut):
        here |= cut & (facets.wall_side == 2 * slabs.axis + end)
    if np.any(facets.wall_particle[here] < own):
        raise RuntimeError(
            "a cell reaches beyond what its slab sees of its neighbours; use fewer ranks, or more particles"
        )
    return facets._replace(**{name: getattr(facets, name)[~here] for name in WALLS})


def own_part(network: Network, own: int) -> Network:
    """The network with the rows of the slab's own particles only: others have no links, no walls and no volume."""
    end, walls = network.indptr[own], network.wall_particle < own
    indptr = network.indptr.copy()
    indptr[own:] = end
    volumes = network.volumes.copy()
    volumes[own:] = 0.0
    links = {name: getattr(network, name)[:end] for name in ("indices", "image", "conductance", "area")}
    columns = ("particle", "side", "conductance", "area", "distance", "normal")
    ends = {name: getattr(network, name)[walls] for name in (f"wall_{each}" for each in columns)}
    return network._replace(indptr=indptr, volumes=volumes, **links, **ends)


def check_unknowns(comm, own: int) -> int:
    """The number of unknowns of all ranks, which PETSc counts in 32 bits."""
    total = comm.allreduce(own)
    if total >= 2**31:
        raise ValueError(f"particles: {total} unknowns, and this PETSc counts to {2**31 - 1}; must be fewer")
    return total
