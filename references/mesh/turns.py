"""How each sphere is turned before it is cut: its poles and its seam off what cuts it. Geometry only, no mesher.

A sphere's surface is meshed in longitude and latitude. A pole near a curve, or a seam that runs along one or through
its corner, leaves parts of the surface that cannot be meshed; gmsh then refines the curves around them, whose periodic
twins stay as they are.
"""

import math
from functools import cache

import numpy as np

from demheat.scene.shapes.occ import GENERIC

# Turns to choose from where a sphere is cut.
CANDIDATES = 192
# Points of the seam that are looked at, from pole to pole.
ALONG = 37
# A seam that crosses a curve at right angles is as good as one that stays so far off, rad.
STEEP = 0.7


def turn(center, radius: float, planes) -> tuple[float, float, float, float]:
    """Axis and angle of the turn that keeps poles and seam farthest from the curves in which planes cut a sphere."""
    cuts = [np.asarray(across)[np.abs(across - c) < radius] for across, c in zip(planes, center, strict=True)]
    heights = [np.clip((cut - c) / radius, -1, 1) for cut, c in zip(cuts, center, strict=True)]
    if not any(map(len, heights)):
        return GENERIC
    axes, angles, rotations = _candidates()
    best = int(np.argmax(_clearance(rotations, heights)))
    return (*axes[best].tolist(), float(angles[best]))


@cache
def _candidates():
    """Axes (n, 3), angles (n,) and matrices (n, 3, 3) of rotations, evenly spread at random."""
    four = np.random.default_rng(0).standard_normal((CANDIDATES, 4))
    four /= np.linalg.norm(four, axis=1)[:, None]
    angles = 2 * np.arccos(four[:, 0])
    axes = four[:, 1:] / np.linalg.norm(four[:, 1:], axis=1)[:, None]
    cross = np.cross(np.eye(3), axes[:, None])
    sine, cosine = np.sin(angles)[:, None, None], np.cos(angles)[:, None, None]
    outer = axes[:, :, None] * axes[:, None]
    return axes, angles, cosine * np.eye(3) + sine * cross + (1 - cosine) * outer


def _clearance(rotations, heights):
    """Least angle (n,) between poles or seam and the circles at heights (over the radius) along x, y and z."""
    latitude = np.linspace(-np.pi / 2, np.pi / 2, ALONG)
    seam, ahead = (
        np.column_stack([c, np.zeros(ALONG), s])
        for c, s in (
            (np.cos(latitude), np.sin(latitude)),
            (-np.sin(latitude), np.cos(latitude)),
        )
    )
    seam, ahead = (np.einsum("nij,lj->nli", rotations, x) for x in (seam, ahead))
    least = np.full(len(rotations), np.inf)
    for axis in range(3):
        for height in heights[axis]:
            off = np.arccos(np.clip(seam[..., axis], -1, 1)) - math.acos(height)
            slope = ahead[..., axis] / np.maximum(np.sqrt(1 - seam[..., axis] ** 2), 1e-12)
            poles = np.minimum(np.abs(off[:, 0]), np.abs(off[:, -1]))
            # Distance that grows with the angle of the crossing: none where the seam touches the circle.
            least = np.minimum(least, np.minimum(poles, np.hypot(off, STEEP * slope).min(axis=1)))
    for corner in _corners(heights):
        least = np.minimum(least, np.arccos(np.clip(seam @ corner, -1, 1)).min(axis=1))
    return least


def _corners(heights):
    """Directions in which two planes cut a sphere of radius one."""
    found = []
    for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        for one in heights[a]:
            for other in heights[b]:
                rest = 1 - one**2 - other**2
                for sign in (-1, 1) if rest > 0 else ():
                    corner = np.empty(3)
                    corner[[a, b, c]] = one, other, sign * math.sqrt(rest)
                    found.append(corner)
    return found
