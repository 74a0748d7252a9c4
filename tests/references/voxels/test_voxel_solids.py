"""Voxels and links cut by any shape, against spheres, whose kernels integrate them, planes and points."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from solid_shapes import MATRIX, OTHER, RING, SOLIDS, TURN

from demheat import Layer, Scene, Sphere
from demheat.scene import Box, Ellipsoid, HalfSpace
from references.voxels.links import links
from references.voxels.paint import voxelise

SHAPE = (12, 14, 16)


def scene(shape, *, walls=False):
    load = {"walls": {"x-": 0.0, "x+": 1.0}} if walls else {"gradient": (1.0, 0.0, 0.0)}
    return Scene((1.0, 1.0, 1.0), MATRIX, [shape], **load)


@pytest.mark.parametrize("walls", [False, True])
@pytest.mark.parametrize("center", [(0.5, 0.5, 0.5), (0.0, 0.1, 0.93)])
def test_an_ellipsoid_of_equal_axes_is_painted_like_a_sphere(center, walls):
    shapes = Sphere(center, 0.3, OTHER), Ellipsoid(center, (0.3, 0.3, 0.3), OTHER, rotation=TURN)
    one, other = (voxelise(scene(shape, walls=walls), SHAPE, laminate=True) for shape in shapes)
    assert_array_equal(one.phase, other.phase)
    # Planes may graze a corner that the sphere does not reach; no more than a thousandth of any voxel.
    _, first, second = np.intersect1d(one.cut, other.cut, return_indices=True)
    assert len(first) == len(one.cut) and len(other.cut) < 1.1 * len(one.cut)
    # Entries from 1 to 5: the smaller voxels are flat where the sphere bends by a sixteenth of their side.
    assert_allclose(one.tensor[first], other.tensor[second], atol=0.1)
    assert np.mean(np.abs(one.tensor[first] - other.tensor[second])) < 0.01
    for ours, exact in zip(
        links(scene(shapes[1], walls=walls), SHAPE), links(scene(shapes[0], walls=walls), SHAPE), strict=True
    ):
        assert_allclose(ours, exact, rtol=1e-10)


@pytest.mark.parametrize(
    "shape",
    [*(each.placed((0.1, 0.9, 0.5)) for each in SOLIDS.values()), RING],
    ids=lambda shape: shape.kind,
)
def test_volumes_on_voxels_are_right_in_all(shape):
    whole = scene(shape)
    grid = voxelise(whole, SHAPE, laminate=True)
    assert_allclose(grid.fractions[1], shape.volume_in((1, 1, 1), periodic=True), rtol=1e-11)
    points = np.random.default_rng(0).random((100_000, 3))
    cells = np.ravel_multi_index((points * SHAPE).astype(int).T, SHAPE)
    inside = shape.contains(points, period=whole.period)
    # Voxels that are not cut are all in or all out, but for corners that planes miss.
    uncut = ~np.isin(cells, grid.cut)
    assert np.mean(inside[uncut] != (grid.phase.ravel()[cells[uncut]] == 1)) < 2e-3


def test_level_planes_are_layers():
    for point, outward, layer in (
        ((0.47, 0.3, 0.22), (1, 0, 0), Layer(0, 0.0, 0.47, OTHER)),
        ((0.47, 0.3, 0.22), (0, 0, -1), Layer(2, 0.22, 1.0, OTHER)),
    ):
        one, other = scene(HalfSpace(point, outward, OTHER), walls=True), scene(layer, walls=True)
        ours, exact = (voxelise(each, SHAPE, laminate=True) for each in (one, other))
        assert_array_equal(ours.cut, exact.cut)
        assert_allclose(ours.tensor, exact.tensor, rtol=1e-13)
        for a, b in zip(links(one, SHAPE), links(other, SHAPE), strict=True):
            assert_allclose(a, b, rtol=1e-12)


def test_what_goes_on_beyond_the_box_ends_with_its_voxels():
    """Seven sevenths of .035 m are a bit more than that, and there is no eighth voxel."""
    size = (0.035, 0.035, 0.035)
    assert 7 * (size[0] / 7) / (size[0] / 7) > 7
    half = HalfSpace((0.02, 0.0, 0.0), (1, 0, 0), OTHER)
    scene = Scene(size, MATRIX, [half], walls={"x-": 0.0, "x+": 1.0})
    assert_allclose(voxelise(scene, (7, 7, 7), laminate=False).fractions, [3 / 7, 4 / 7])


def test_inclined_planes_cut_exactly():
    plane = HalfSpace((0.5, 0.3, 0.2), (1, 2, 3), OTHER)
    grid = voxelise(scene(plane, walls=True), SHAPE, laminate=True)
    # x + 2 y + 3 z < 1.7: the corner of a cube, less its corner beyond y = 1 - of which there is none - and x = 1.
    volume = (1.7**3 - 0.7**3) / (6 * 1 * 2 * 3)
    assert_allclose(grid.fractions[1], volume, rtol=1e-13)
    normal = np.array([1.0, 2.0, 3.0]) / math.sqrt(14)
    # Along the plane the arithmetic mean, in every voxel; its normal is the one of all.
    across = np.array([3.0, 0.0, -1.0]) / math.sqrt(10)
    full = grid.tensor[:, [0, 5, 4, 5, 1, 3, 4, 3, 2]].reshape(-1, 3, 3)
    means = across @ full @ across
    assert np.all((means > 1) & (means < 5))
    harmonic = 1 / (((5 - means) / 4) / 1 + ((means - 1) / 4) / 5)
    assert_allclose(full @ normal, harmonic[:, None] * normal, rtol=1e-9)


def test_links_know_a_thin_plate_between_two_nodes():
    plate = Box((0.5, 0.5, 0.5), (0.01, 2.0, 2.0), OTHER)
    found = links(scene(plate, walls=True), (10, 8, 8))[0]
    # Of the link from 0.45 to 0.55 a tenth is five times as good.
    assert_allclose(found[5], 1 / (0.9 + 0.1 / 5), rtol=1e-9)
    assert_allclose(np.delete(found, [0, 5, 10], axis=0), 1.0, rtol=1e-12)
