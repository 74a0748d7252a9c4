"""Edges, of boxes, rims and planes at walls: how slowly any elements close in on what happens there.

Where good and bad conductors alternate around an edge, as on a checkerboard, the temperature goes with a small power of
the distance from it, on a board of contrast s with the power (4 / pi) arctan(1 / sqrt(s)): .8 at 2, .39 at 10, .13 at
100, .04 at 1000. The energy that elements of a size miss goes with that size to twice the power: from a contrast of 25
on with its root or less. What joins the good ones at the edge, as voxels with temperatures at their corners do, errs
upwards, what parts them, as links between middles of voxels, downwards: to 98 and to 5.7 where 31.6 is right (48 voxels
along a board of contrast 1000), and twice as many voxels change that by a tenth. So such edges have no answer here.

The edge of a box or the rim of a cylinder alone has a power from 2/3 on, so that errors of second order fall with the
power 4/3 at contrasts far from 1. An inclined plane makes wedges with a wall and its image, with powers from 1/2 on,
and so does a cylinder that goes through a wall at an angle, and what is round that a wall cuts off its middle.
"""

from functools import lru_cache

import numpy as np

from demheat.scene.shapes.base import BESIDE

# Powers of the size below which methods have no answer, and where there is no edge.
SLOWEST, SMOOTH = 0.5, 2.0
# Cosine of the angle from which on a surface and a wall are not upright, nor parallel.
MEETS = 1e-9
# Of angles that are told apart, in radians: they move powers by no more than the steps in which these are tried.
DIGITS = 3
# The same of wedges at walls, of which there are as many as cut balls: powers move by .025 at most, near a cusp.
ALIKE = 2
# Powers that are tried, and least conductivity over the largest at an edge.
TRIED, LEAST = np.arange(1, 2001) / 2000, 1e-12


def edge_order(scene) -> float:
    """The power of their size with which errors of elements fall beside the worst edge of the scene, at most 2.

    Edges are those that shapes tell, and where planes, cylinders, spheres and ellipsoids go through walls at an angle.
    """
    if scene.anisotropic:
        return SMOOTH
    parts, k = [part for shape in scene.inclusions for part in shape.parts], scene.mean_conductivities
    return min((2 * each for each in (*_of_shapes(scene, parts, k), *_of_walls(scene, parts, k))), default=SMOOTH)


def _of_shapes(scene, parts, k):
    """Powers at edges of shapes."""
    edged = [(found, part.wedges(scene.size)) for part in parts if len(found := part.edges(scene.size))]
    if not edged:
        return []
    (around, angles), size = map(np.concatenate, zip(*edged, strict=True)), np.array(scene.size)
    if not scene.periodic:
        # Walls are mirrors: what touches one with an edge meets its image there.
        within = size / 2 - np.abs(around - size / 2)
        around = np.where(within < 0, np.where(around < 0, -around, 2 * size - around), around)
        near = np.all(within > -4 * BESIDE * size.max(), axis=(1, 2))
        around, angles = around[near], angles[near]
    there = k[scene.phase_at(around.reshape(-1, 3))].reshape(-1, 4)
    found = np.unique(np.column_stack([there, angles.round(DIGITS)]), axis=0)
    return [power(each[:4], each[4:]) for each in found]


def leaning(scene) -> np.ndarray:
    """Whether each inclusion goes through a wall at an angle, (number of inclusions,) bool array."""
    return np.array([any(len(_leans(part, scene)) for part in shape.parts) for shape in scene.inclusions], bool)


def _leans(part, scene):
    """Cosines between its normals and walls that it goes through, neither upright nor parallel."""
    leans = np.zeros(3) if scene.periodic else part.leans(scene.size)
    return leans[(leans > MEETS) & (leans < 1 - MEETS)]


def _of_walls(scene, parts, k):
    """Powers where what leans meets walls, which make wedges of it, at an angle of its own and at its supplement."""
    # Walls are mirrors: the wedge of an angle is one of twice that.
    found = {
        (part.material.mean_conductivity, wedge)
        for part in parts
        for wedge in (2 * np.arccos(_leans(part, scene))).round(ALIKE).tolist()
    }
    return [_of_wedge(own, float(k[0]), wedge) for own, wedge in found]


@lru_cache(maxsize=1024)
def _of_wedge(own, around, wedge):
    angles = np.array([wedge, 2 * np.pi - wedge])
    return min(power([own, around], each) for each in (angles, angles[::-1]))


def power(conductivities, angles=(np.pi / 2,) * 4) -> float:
    """Least power of the distance from an edge with which the temperature may go, at most 1.

    Around the edge, through wedges of some angles, the temperature and the flux across its rays come back to
    themselves.
    """
    k = np.asarray(conductivities, dtype=float)
    # Perfect conductors are as those that conduct so many times better than the rest.
    k = np.where(np.isinf(k), (k[np.isfinite(k)].max(initial=0.0) or 1.0) / LEAST, k)
    k = np.maximum(k, LEAST * k.max()) if k.max() > 0 else np.ones(len(angles))
    turned = np.eye(2)
    for each, angle in zip(k, angles, strict=True):
        cosine, sine = np.cos(angle * TRIED), np.sin(angle * TRIED)
        turned = np.array([[cosine, sine / each], [-each * sine, cosine]]).transpose(2, 0, 1) @ turned
    back = np.flatnonzero(np.trace(turned, axis1=1, axis2=2) >= 2.0)
    return float(TRIED[back[0]]) if len(back) else 1.0
