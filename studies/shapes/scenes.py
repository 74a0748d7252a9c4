"""The scenes: each shape in a cell of one edge, where an exact value is known."""

import math

import numpy as np

from demheat import Scene, Sphere
from demheat.gallery import EDGE, HADDAD, scaled
from demheat.powers import cube_root
from demheat.scene import Box, Cylinder, Ellipsoid, HalfSpace, LevelSet

# Depth of cells along fibres and rods, and of the square, in edges: nothing changes along it.
DEPTH = 0.25
# Off the middle and off the lattices of voxels and particles.
PLACE = (0.53, 0.46, 0.11)
ALONG_X = (100.0, 0.0, 0.0)
# Of the ellipsoid: semi-axes to each other, and its turn, rad about x, y, z as one rotation vector.
RATIOS, TURN = (3.0, 2.0, 1.5), (0.4, 0.7, -0.5)
# Of the rod with ends, in edges; along the diagonal of no face.
ROD = {"radius": 0.2, "axis": (1.0, 2.0, 3.0), "length": 0.5}


def fibre(contrast, fraction, *, kapitza=0.0):
    """Square array of fibres, across them."""
    radius = EDGE * math.sqrt(fraction / math.pi)
    resistance = kapitza * radius / HADDAD.conductivity
    shape = Cylinder(_place(), radius, (0, 0, 1), scaled(HADDAD, contrast), resistance=resistance)
    return Scene((EDGE, EDGE, DEPTH * EDGE), HADDAD, [shape], gradient=ALONG_X)


def square_rod(contrast):
    """Square rods on a quarter of the area, edges and all; walls are its planes of symmetry."""
    middle = (EDGE / 2, EDGE / 2, DEPTH * EDGE / 2)
    shape = Box(middle, (EDGE / 2, EDGE / 2, EDGE), scaled(HADDAD, contrast))
    return Scene((EDGE, EDGE, DEPTH * EDGE), HADDAD, [shape], walls={"x-": 10.0, "x+": 0.0})


def ellipsoid(contrast, fraction):
    """Cubic array of turned ellipsoids."""
    shape = Ellipsoid(_place(), semi_axes(fraction), scaled(HADDAD, contrast), rotation=TURN)
    return Scene((EDGE, EDGE, EDGE), HADDAD, [shape], gradient=ALONG_X)


def semi_axes(fraction):
    """Semi-axes of the ellipsoid, m."""
    unit = cube_root(fraction * EDGE**3 / (4 / 3 * math.pi * math.prod(RATIOS)))
    return tuple(unit * ratio for ratio in RATIOS)


def diagonal(contrast):
    """Square between two walls, cut along its diagonal."""
    middle = (EDGE / 2, EDGE / 2, DEPTH * EDGE / 2)
    shape = HalfSpace(middle, (1, 1, 0), scaled(HADDAD, contrast))
    return Scene((EDGE, EDGE, DEPTH * EDGE), HADDAD, [shape], walls={"x-": 10.0, "x+": 0.0})


def ball(shape, contrast, fraction):
    """Simple cubic array of balls."""
    radius, material = EDGE * cube_root(3 * fraction / (4 * math.pi)), scaled(HADDAD, contrast)
    middle = np.full(3, EDGE / 2)

    def function(points):
        return np.sum((points - middle) ** 2, axis=1) - radius**2

    limits = ((0.02 * EDGE,) * 3, (0.98 * EDGE,) * 3)
    made = {"sphere": Sphere(tuple(middle), radius, material), "level set": LevelSet(function, limits, material)}
    return Scene((EDGE, EDGE, EDGE), HADDAD, [made[shape]], gradient=ALONG_X)


def rod(contrast):
    """Cubic array of short rods with flat ends."""
    radius, length = ROD["radius"] * EDGE, ROD["length"] * EDGE
    shape = Cylinder(_place(), radius, ROD["axis"], scaled(HADDAD, contrast), length=length)
    return Scene((EDGE, EDGE, EDGE), HADDAD, [shape], gradient=ALONG_X)


def _place():
    return tuple(EDGE * each for each in PLACE)
