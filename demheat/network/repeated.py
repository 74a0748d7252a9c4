"""Cells of particles that nothing but their own tile is near: cut once, for one tile, and repeated.

A radical cell is bounded by its neighbours alone. It is that of the tile if all the neighbours that it has there are in
their places and as heavy as it is, and no other site, a twin or one that a wall has moved, can reach it.
"""

import math

import numpy as np

from demheat.network.laguerre import laguerre
from demheat.network.repeated_kernels import Known
from demheat.packing.base import Packing
from demheat.packing.tile import FARTHEST, FIRST, choice_of, places_of
from demheat.packing.twins.conforming import Conformed
from demheat.powers import cube_root

# Tiles of a packing below which to cut the cells of one does not pay.
LEAST = 3


def farthest_of(packing: Packing) -> float:
    """How far from its particle a cell of a packing of tiles goes at most, m; infinite for too few tiles and others."""
    choice = choice_of(packing)
    if choice is None or packing.number < LEAST * choice.number:
        return np.inf
    # What is stretched along an axis is farther there.
    return FARTHEST * float(packing.radii[0]) * max(choice.edges) / cube_root(math.prod(choice.edges))


def known_cells(asked: Packing, made: Conformed) -> Known | None:
    """What is known of the cells of a packing that was asked for and made to conform; None if nothing is."""
    packing, radii, choice = made.packing, made.packing.radii, choice_of(asked)
    alone = made.alone & (radii == radii.max(where=made.alone, initial=0.0))
    where = None if choice is None or np.count_nonzero(alone) < LEAST * choice.number else places_of(asked)
    if where is None:
        return None
    place = np.where(made.origin < 0, -1, where.place[made.origin])
    here = (place >= 0) & (radii == radii[alone][0])
    site = np.full(len(where.points) * int(where.counts.prod()), -1, np.int32)
    site[place[here]] = np.flatnonzero(here)
    if not packing.periodic.all():
        # Sites that walls have moved are FIRST off them.
        room = np.minimum(packing.centers, packing.size - packing.centers).min(axis=1)
        alone &= room > (FIRST + 2.0 * FARTHEST) * asked.radii[0]
    place[~(alone & here)] = -1
    one = laguerre(where.points, np.zeros(len(where.points)), where.edges)
    columns = one.indptr, one.indices, one.image, one.area, one.distance, one.volumes
    return Known(place.astype(np.int32), site, where.counts, *columns)
