"""Scenes on a grid of voxels: volumes, laminates, phases."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.scene import Layer, Material, Scene, Sphere
from references.voxels.paint import grid_shape, voxelise

MATRIX, GOOD, POOR = Material(1.0), Material(7.0), Material(0.2)


def cell(*inclusions, size=(1.0, 1.0, 1.0), walls=None):
    load = {"walls": walls} if walls else {"gradient": (1.0, 0.0, 0.0)}
    return Scene(size, MATRIX, inclusions, **load)


def ball(radius):
    return 4 / 3 * np.pi * radius**3


@pytest.mark.parametrize(
    ("shape", "rtol"),
    # Twice the error found: the quadrature in one voxel is good to 1e-3 and averages over the cut voxels.
    [((8, 8, 8), 2e-4), ((33, 32, 31), 1e-5), ((64, 64, 64), 2e-6)],
)
@pytest.mark.parametrize("center", [(0.5, 0.5, 0.5), (0.41, 0.93, 0.06)])
def test_volume_of_a_sphere_across_periodic_faces(shape, rtol, center):
    grid = voxelise(cell(Sphere(center, 1 / 3, GOOD)), shape, laminate=True)
    assert_allclose(grid.fractions[1], ball(1 / 3), rtol=rtol)
    assert_allclose(grid.fractions.sum(), 1.0, rtol=1e-14)  # Rounding.


def test_a_sphere_smaller_than_a_voxel_keeps_its_volume():
    grid = voxelise(cell(Sphere((0.52, 0.49, 0.55), 0.1, GOOD)), (3, 3, 3), laminate=True)
    # The quadrature of a ball by 8 x 8 columns as wide as it: 0.9 % at most, see test_small_spheres.
    assert_allclose(grid.fractions[1], ball(0.1), rtol=1e-2)
    assert len(grid.cut) == 1
    # Its surface looks everywhere, so the tensor is isotropic up to the same quadrature (found 0.9 %).
    assert_allclose(grid.tensor[0, :3], grid.tensor[0, :3].mean(), rtol=2e-2)


def test_walls_cut_a_sphere_in_half():
    walls = {"z-": 0.0, "z+": 1.0}
    grid = voxelise(cell(Sphere((0.0, 0.45, 0.4), 0.3, GOOD), walls=walls), (20, 21, 22), laminate=True)
    assert_allclose(grid.fractions[1], ball(0.3) / 2, rtol=2e-5)  # Twice the quadrature error found.


def test_nested_spheres_leave_shells():
    scene = cell(Sphere((0.5,) * 3, 0.4, GOOD), Sphere((0.45, 0.5, 0.5), 0.3, POOR), Sphere((0.0,) * 3, 0.3, POOR))
    grid = voxelise(scene, (24, 24, 24), laminate=True)
    expected = [1 - ball(0.4) - ball(0.3), ball(0.4) - ball(0.3), ball(0.3), ball(0.3)]
    assert_allclose(grid.fractions, expected, atol=1e-5)  # The quadrature's error, as in the test of one sphere.


def test_layers_are_exact_on_and_off_the_faces():
    scene = cell(Layer(1, 0.25, 0.61, GOOD), Layer(1, 0.61, 0.9, POOR), Sphere((0.5, 0.4, 0.5), 0.1, MATRIX))
    grid = voxelise(scene, (4, 8, 4), laminate=True)
    assert_allclose(grid.fractions[2], 0.29, rtol=1e-12)  # Rounding.
    assert_allclose(grid.fractions[1] + grid.fractions[3], 0.36, rtol=1e-12)
    # Row 4 spans 0.5 to 0.625: 0.88 of it is the first layer, 0.12 the second, nothing is matrix.
    row = grid.tensor[grid.cut == np.ravel_multi_index((0, 4, 0), (4, 8, 4))][0]
    tangent, normal = 0.88 * 7 + 0.12 * 0.2, 1 / (0.88 / 7 + 0.12 / 0.2)
    assert_allclose(row, [tangent, normal, tangent, 0, 0, 0], atol=1e-12)


@pytest.mark.parametrize("thick", [1e-16, 1e-14, 1e-11])
def test_a_layer_as_thin_as_rounding_fills_no_voxel(thick):
    """One that begins in the middle of a voxel filled it, as its centre is in it."""
    grid = voxelise(cell(Layer(1, 0.5, 0.5 + thick, GOOD)), (4, 17, 4), laminate=True)
    assert grid.fractions[0] == 1.0 and not grid.phase.any()


def test_touching_layers_in_one_voxel_block_only_by_their_own_pores():
    scene = Scene(
        (1, 1, 1), Material(0.0), [Layer(0, 0, 0.45, GOOD), Layer(0, 0.45, 1.0, POOR)], gradient=(1.0, 0.0, 0.0)
    )
    grid = voxelise(scene, (5, 2, 2), laminate=True)
    # The matrix is 0 and nowhere: were rounding to leave a trace of it, the harmonic mean would be 0.
    assert_allclose(grid.tensor[:, 0], 1 / (0.25 / 7 + 0.75 / 0.2), rtol=1e-12)
    assert grid.fractions[0] == 0


def test_a_pore_blocks_the_normal_direction_only():
    scene = Scene((1, 1, 1), MATRIX, [Layer(2, 0.0, 0.3, Material(0.0))], gradient=(1.0, 0.0, 0.0))
    grid = voxelise(scene, (2, 2, 5), laminate=True)
    assert_allclose(grid.tensor, np.tile([0.5, 0.5, 0.0, 0, 0, 0], (4, 1)), atol=1e-12)


def test_cut_voxels_against_a_million_points():
    sphere = Sphere((0.47, 0.53, 0.5), 0.31, GOOD)
    shape = (9, 8, 7)
    grid = voxelise(cell(sphere), shape, laminate=True)
    inside = (np.arange(100) + 0.5) / 100
    for index, tensor in list(zip(grid.cut, grid.tensor, strict=True))[::25]:
        corner = np.array(np.unravel_index(index, shape))
        x = [(corner[a] + inside) / shape[a] - sphere.center[a] for a in range(3)]
        squared = x[0][:, None, None] ** 2 + x[1][:, None] ** 2 + x[2] ** 2
        part = np.mean(squared <= sphere.radius**2)
        full = tensor[[[0, 5, 4], [5, 1, 3], [4, 3, 2]]]
        arithmetic, harmonic = part * 7 + (1 - part), 1 / (part / 7 + (1 - part))
        # The trace is 2 A + H whatever the normal.  Points and quadrature agree to 2e-3 of the voxel.
        assert_allclose(np.trace(full), 2 * arithmetic + harmonic, rtol=4e-3)
        normal = np.array([a.mean() for a in x])
        normal /= np.linalg.norm(normal)
        # The surface turns by h / R = 0.4 inside a voxel; its mean normal is the centre's to a tenth of that.
        if arithmetic / harmonic > 1.05:
            assert abs(normal @ np.linalg.eigh(full)[1][:, 0]) > np.cos(0.04)


@pytest.mark.parametrize("walls", [None, {"y-": 0.0, "y+": 1.0}])
def test_plain_voxels_have_the_phase_of_their_centre(walls):
    # Off the grid, so that no centre lies on a surface.
    scene = cell(
        Layer(2, 0.03, 0.42, POOR),
        Sphere((0.05, 0.9, 0.62), 0.18, GOOD),
        Sphere((0.6, 0.5, 0.21), 0.17, GOOD),
        walls=walls,
    )
    shape = (13, 14, 15)
    grid = voxelise(scene, shape, laminate=False)
    points = (np.moveaxis(np.indices(shape), 0, -1).reshape(-1, 3) + 0.5) / shape
    assert np.array_equal(grid.phase.ravel(), scene.phase_at(points))
    assert len(grid.cut) == 0
    assert_allclose(grid.fractions, np.bincount(grid.phase.ravel(), minlength=4) / grid.phase.size, rtol=1e-14)


@pytest.mark.parametrize(
    ("voxels", "shape"), [(10, (5, 10, 3)), (1, (1, 1, 1)), ((3, 4, 5), (3, 4, 5)), (np.int64(20), (10, 20, 5))]
)
def test_grid_shape(voxels, shape):
    assert grid_shape(cell(size=(1.0, 2.0, 0.52)), voxels) == shape
