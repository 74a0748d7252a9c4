"""Edges of boxes that meet: how slowly any elements close in on what happens there.

Where good and bad conductors alternate around an edge, as on a checkerboard, the temperature goes with a small power of
the distance from it, on a board of contrast s with the power (4 / pi) arctan(1 / sqrt(s)): .8 at 2, .39 at 10, .13 at
100, .04 at 1000. The energy that elements of a size miss goes with that size to twice the power: from a contrast of 25
on with its root or less. What joins the good ones at the edge, as voxels with temperatures at their corners do, errs
upwards, what parts them, as links between middles of voxels, downwards: to 98 and to 5.7 where 31.6 is right (48 voxels
along a board of contrast 1000), and twice as many voxels change that by a tenth. So such edges have no answer here.

The edge of a box alone has a power from 2/3 on, so that errors of second order fall with the power 4/3 at contrasts far
from 1.
"""

from __future__ import annotations

from itertools import combinations, product

import numpy as np

from demheat.scene.shapes.box import Box

# Powers of the size below which methods have no answer, and where there is no edge.
SLOWEST, SMOOTH = 0.5, 2.0
# Points along an edge that are looked at, and how far beside it, of the shortest side of the box.
ALONG, BESIDE = 8, 1e-6
# Powers that are tried, and least conductivity over the largest at an edge.
TRIED, LEAST = np.arange(1, 2001) / 2000, 1e-12


def edge_order(scene) -> float:
    """The power of their size with which errors of elements fall beside the worst of the edges of boxes, at most 2."""
    boxes = [part for shape in scene.inclusions for part in shape.parts if isinstance(part, Box)]
    if not boxes or scene.anisotropic:
        return SMOOTH
    around, size = np.concatenate([_around(box, scene.size) for box in boxes]), np.array(scene.size)
    if not scene.periodic:
        # Walls are mirrors: what touches one with an edge meets its image there.
        within = size / 2 - np.abs(around - size / 2)
        around = np.where(within < 0, np.where(around < 0, -around, 2 * size - around), around)
        around = around[np.all(within > -4 * BESIDE * size.max(), axis=(1, 2))]
    k = scene.mean_conductivities[scene.phase_at(around.reshape(-1, 3))].reshape(-1, 4)
    return min((2 * power(four) for four in np.unique(k, axis=0)), default=SMOOTH)


def power(conductivities) -> float:
    """Least power of the distance from an edge with which the temperature may go, at most 1.

    Around the edge the temperature and the flux across its rays come back to themselves.
    """
    k = np.maximum(conductivities, LEAST * max(conductivities)) if max(conductivities) > 0 else np.ones(4)
    cosine, sine = np.cos(0.5 * np.pi * TRIED), np.sin(0.5 * np.pi * TRIED)
    turned = np.eye(2)
    for each in k:
        turned = np.array([[cosine, sine / each], [-each * sine, cosine]]).transpose(2, 0, 1) @ turned
    back = np.flatnonzero(np.trace(turned, axis1=1, axis2=2) >= 2.0)
    return float(TRIED[back[0]]) if len(back) else 1.0


def _around(box, size):
    """Points in the four quadrants around the edges of a box, (n, 4, 3) float array, m."""
    turn, half = np.array(box.rotation), 0.5 * np.array(box.sides)
    beside, found = BESIDE * min(*box.sides, *size), []
    for one, other in combinations(range(3), 2):
        along = 3 - one - other
        for ends in product((-1.0, 1.0), repeat=2):
            points = np.zeros((ALONG, 4, 3))
            points[:, :, along] = (((np.arange(ALONG) + 0.5) / ALONG - 0.5) * box.sides[along])[:, None]
            for axis, end, ways in ((one, ends[0], (-1, -1, 1, 1)), (other, ends[1], (-1, 1, 1, -1))):
                points[:, :, axis] = end * (half[axis] + beside * np.array(ways))
            found.append(points)
    return np.array(box.center) + np.concatenate(found) @ turn.T
