"""Solids for tests: one of each kind, turned, and functions of level sets whose distances are known."""

import numpy as np

from demheat import Material, Scene
from demheat.scene import Box, Cylinder, Ellipsoid, HalfSpace, LevelSet, Torus

MATRIX, OTHER = Material(1.0), Material(5.0)


def turn(x, y, z):
    """A rotation about x, then y, then z, rad, as its matrix."""
    found = np.eye(3)
    for axis, angle in enumerate((x, y, z)):
        i, j = (a for a in range(3) if a != axis)
        step = np.eye(3)
        step[[i, j], [i, j]] = np.cos(angle)
        step[i, j], step[j, i] = -np.sin(angle), np.sin(angle)
        found = step @ found
    return found


TURN = turn(0.3, 0.5, 0.7)


def ball(points):
    """Below 0 in the ball of radius 0.3 about (0.5, 0.5, 0.5)."""
    return np.sum((points - 0.5) ** 2, axis=1) - 0.09


def torus(points):
    """Below 0 in a ring of radius 0.28, 0.12 thick either way."""
    x, y, z = (points - 0.5).T
    return (np.hypot(x, y) - 0.28) ** 2 + z**2 - 0.12**2


def cell(*inclusions, walls=False):
    load = {"walls": {"x-": 0.0, "x+": 1.0}} if walls else {"gradient": (1.0, 0.0, 0.0)}
    return Scene((1.0, 1.0, 1.0), MATRIX, inclusions, **load)


LIMITS = ((0.05, 0.05, 0.05), (0.95, 0.95, 0.95))
FIBRE = Cylinder((0.1, 0.7, 1.9), 0.3, (0, 0, 2), OTHER)
ROD = Cylinder((0.1, 0.7, 1.9), 0.2, (1, 2, 3), OTHER, length=0.5)
EGG = Ellipsoid((0.1, 0.7, 1.9), (0.4, 0.3, 0.2), OTHER, rotation=TURN)
BRICK = Box((0.1, 0.7, 1.9), (0.4, 0.3, 0.2), OTHER, rotation=TURN)
HOOP = Torus((0.1, 0.7, 1.9), 0.28, 0.12, (1, 2, 3), OTHER)
# A shape that derives from `Solid` adds one of it here: suites ask all of them the same.
SOLIDS = {"fibre": FIBRE, "rod": ROD, "egg": EGG, "brick": BRICK, "hoop": HOOP}
HALF = HalfSpace((0.3, 0.4, 0.5), (1, 2, 3), OTHER)
RING = LevelSet(torus, LIMITS, OTHER)
