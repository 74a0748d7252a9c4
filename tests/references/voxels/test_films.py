"""Films: only here is seen one that leaks where the grid's planes, walls or other films meet it."""

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from spared import slow_but

from demheat import Box, Layer, Material, Scene, Sphere
from references import fft
from references.exact import lattice

RADIUS = lattice.radius("sc", 0.2)
WALLS = {"x-": 0.0, "x+": 1.0}


def solved(*inclusions, voxels, **load):
    return fft.solve(Scene((1.0, 1.0, 1.0), Material(1.0), inclusions, **(load or {"walls": WALLS})), voxels=voxels)


@pytest.mark.parametrize(
    ("r", "contrast"), slow_but({(0.5, 10.0), (0.05, 1000.0)}, product([0.05, 0.5, 20.0], [10.0, 1000.0]))
)
def test_arrays_are_found_to_half_a_per_cent(contrast, r):
    """A film smeared by its own area would leak more the more voxels there are: 40 % with 64."""
    exact = lattice.conductivity("sc", contrast, 0.2, resistance=r)
    own = Sphere((0.53, 0.46, 0.48), RADIUS, Material(contrast), resistance=r * RADIUS)
    assert_allclose(solved(own, voxels=64, gradient=(1.0, 0.0, 0.0)).conductivity, exact, rtol=5e-3)  # asked for


@pytest.mark.parametrize("load", [{"walls": WALLS}, {"gradient": (1.0, 0.0, 0.0)}])
@pytest.mark.parametrize("low, high", [(0.25, 0.75), (0.0, 0.5), (0.5, 1.0)])
def test_faces_on_planes_of_the_grid_count_once(low, high, load):
    """Boxes on planes conduct as those a little smaller do, and what lies on a wall is no surface."""
    found = []
    for less in (0.0, 1e-4):
        ends = [low + less * (low > 0 or "gradient" in load), high - less * (high < 1 or "gradient" in load)]
        corners = (ends[0], 0.25 + less, 0.25 + less), (ends[1], 0.75 - less, 0.75 - less)
        middle, size = np.mean(corners, axis=0), np.subtract(*corners[::-1])
        own = Box(tuple(middle), tuple(size), Material(50.0), resistance=0.3)
        found.append(solved(own, voxels=16, **load).conductivity)
    # Where faces meet, voxels that are cut know other normals than whole ones; a film too many or too few is far more.
    assert_allclose(found[0], found[1], rtol=1e-2)


def test_two_films_in_a_voxel_are_in_series():
    scene = Scene(
        (1.0, 1.0, 1.0),
        Material(1.0),
        [Layer(0, 0.3, 0.5, Material(3.0), resistance=0.2), Layer(0, 0.31, 0.49, Material(5.0), resistance=0.4)],
        walls=WALLS,
    )
    whole = 0.8 + 0.02 / 3 + 0.18 / 5 + 2 * 0.2 + 2 * 0.4
    with pytest.warns(UserWarning, match="coats thinner than a voxel"):
        field = fft.solve(scene, voxels=10)
    assert_allclose(field.conductivity, 1 / whole, rtol=1e-9)  # the solver's tolerance
