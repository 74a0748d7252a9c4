"""Links between voxel centres against points along them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.scene import Layer, Material, Scene, Sphere
from references.voxels.links import links

MATRIX, GOOD, POOR = Material(1.0), Material(7.0), Material(0.2)


def cell(*inclusions, walls=None):
    load = {"walls": walls} if walls else {"gradient": (1.0, 0.0, 0.0)}
    return Scene((1.0, 1.0, 1.0), MATRIX, inclusions, **load)


@pytest.mark.parametrize("walls", [None, {"x-": 0.0, "x+": 1.0}, {"z-": 0.0, "z+": 1.0}])
def test_links_against_points_along_them(walls):
    scene = cell(
        Layer(1, 0.0, 0.31, POOR),
        Sphere((0.9, 0.66, 0.95), 0.3, GOOD),
        Sphere((0.9, 0.7, 0.95), 0.2, POOR),
        walls=walls,
    )
    shape = np.array((6, 7, 5))
    found = links(scene, shape)
    conductivity = scene.conductivities
    steps = (np.arange(4000) + 0.5) / 4000 - 0.5
    rng = np.random.default_rng(0)
    for axis in range(3):
        assert found[axis].shape == tuple(shape + np.eye(3, dtype=int)[axis])
        for index in rng.integers(0, shape, (40, 3)):
            points = np.tile((index + 0.5) / shape, (len(steps), 1))
            x = (index[axis] + steps) / shape[axis]
            # A wall mirrors the link that ends on it.
            points[:, axis] = np.abs(x) if walls else x % 1
            expected = 1 / np.mean(1 / conductivity[scene.phase_at(points)])
            if walls and index[axis] == 0 and "xyz"[axis] + "-" not in walls:
                expected = 0.0
            # Each end of a piece is found to 1 / 4000 of the link, where resistivities differ by up to 5.
            assert_allclose(found[axis][tuple(index)], expected, rtol=4e-3)


def test_links_in_a_conductor_beyond_rounding():
    """1 + (1e-18 - 1) is nothing, and so was the resistance."""
    for walls in (None, {"x-": 0.0, "x+": 1.0}):
        for found in links(cell(Sphere((0.5, 0.5, 0.5), 0.4, Material(1e18)), walls=walls), (5, 5, 5)):
            assert np.all(np.isfinite(found)) and 1e17 < found.max() < 1e19


def test_links_of_a_periodic_cell_close():
    for axis, link in enumerate(links(cell(Sphere((0.02, 0.97, 0.5), 0.3, GOOD)), (8, 9, 10))):
        ends = np.moveaxis(link, axis, 0)
        assert np.array_equal(ends[0], ends[-1])
