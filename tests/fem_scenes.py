"""Scenes on which finite elements are tried; importing them skips a test module where gmsh is missing."""

import numpy as np
import pytest

from demheat.scene import Material, Scene, Sphere
from references import fem, mesh

try:
    mesh.load_gmsh()
except ImportError as error:
    pytest.skip(str(error), allow_module_level=True)

# Steady heat.
ELEMENTS = [{"order": 1}, {"order": 2, "curved": False}, {"order": 2}]
COARSE = 0.2
# Heat in time.
UNIT = Material(1.0, 1.0, 1.0)
KINDS = [{"elements": "hexahedra"}, {"order": 1}, {"order": 2}]


def ball(conductivity=10.0, center=(0.5, 0.5, 0.5), radius=1 / 3):
    return Sphere(center, radius, Material(conductivity))


def scene(*inclusions, size=(1.0, 1.0, 1.0), matrix=1.0, **load):
    load = load or {"walls": {"y-": 0.0, "y+": 1.0}}
    return Scene(size=size, matrix=Material(matrix), inclusions=inclusions, **load)


def points_in(size, count=200):
    """Random points, and points on faces, edges and corners of the box."""
    rng = np.random.default_rng(0)
    inside, snapped = rng.random((count, 3)), rng.random((count, 3))
    snapped[rng.random((count, 3)) < 0.6] = 1.0
    snapped[rng.random((count, 3)) < 0.4] = 0.0
    return np.vstack([inside, snapped]) * size


def cube(material=UNIT, side=1.0, **parts):
    return Scene((side,) * 3, material, **({"initial": 0.0} | parts))


def last(of, times, **knobs):
    return list(fem.evolve(of, times, **knobs))[-1]
