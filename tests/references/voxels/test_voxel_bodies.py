"""Bodies of voxels with pores: beside a search by hand, by faces, by links and through cut voxels."""

import numpy as np
import pytest
from bodies_by_hand import walk
from numpy.testing import assert_array_equal

from demheat import Layer, Material, Scene
from references.voxels import bodies_kernels as kernels
from references.voxels.bodies import bodies
from references.voxels.paint import voxelise

PORE, METAL = Material(0.0), Material(2.0)


@pytest.mark.twin
@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("jump", [(1.0, 0.0, 0.0), (1.0, -0.5, 2.0)])
@pytest.mark.parametrize("part, most", [(0.3, 1000), (0.5, 7), (0.7, 1)])
def test_bodies_beside_those_found_by_hand(periodic, jump, part, most):
    shape, jump, rng = (4, 5, 3), np.array(jump), np.random.default_rng(3)
    solid, below = rng.random(shape) < 0.8, tuple(rng.random((3, *shape)) < part)
    found = kernels.Found(
        np.where(solid, np.int32(kernels.OPEN), np.int32(kernels.NONE)),
        np.zeros((60, 3), np.int16),
        np.zeros(60, bool),
        np.empty(60, np.int32),
    )
    state = np.zeros(4, np.int64)
    while kernels.gather(below, periodic, jump, found, state, most):
        pass
    edges = []
    for place in np.ndindex(shape):
        for axis in range(3):
            before = list(place)
            before[axis] -= 1
            step = np.zeros(3, int)
            step[axis] = -1 if before[axis] < 0 else 0
            if below[axis][place] and (periodic or before[axis] >= 0):
                a, b = (int(np.ravel_multi_index(p, shape, mode="wrap")) for p in (place, before))
                edges += [(a, b, step), (b, a, -step)]
    label, climbs = walk(solid.ravel(), edges, jump)
    assert_array_equal(found.label.ravel(), label)
    assert_array_equal(found.climbs[: state[3]], climbs)


def passing(inclusions, gradient, laminate, linked=False, matrix=METAL):
    scene = Scene((1.0, 1.0, 1.0), matrix, inclusions, gradient=gradient)
    found = bodies(scene, voxelise(scene, (5, 5, 5), laminate=laminate), gradient, linked=linked)
    return bool(found.passing.any())


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_layer_thinner_than_a_voxel_blocks_where_it_is_seen(axis):
    thin = [Layer(axis, 0.43, 0.48, PORE)]
    across, along = np.eye(3)[axis], np.eye(3)[axis - 1]
    # Plain voxels do not see it, as their centres lie beside it; laminates and links do.
    assert passing(thin, across, laminate=False)
    assert not passing(thin, across, laminate=True)
    assert not passing(thin, across, laminate=True, linked=True)
    assert passing(thin, along, laminate=True) and passing(thin, along, laminate=True, linked=True)


def test_a_poor_layer_in_a_cut_voxel_blocks_nothing():
    poor = [Layer(0, 0.43, 0.48, Material(1e-12))]
    assert passing(poor, (1.0, 0.0, 0.0), laminate=True)
    assert passing(poor, (1.0, 0.0, 0.0), laminate=True, linked=True)


def test_a_slab_is_climbed_along_its_plane_only():
    bar = [Layer(2, 0.0, 0.4, METAL)]
    assert passing(bar, (1.0, -1.0, 0.0), laminate=False, matrix=PORE)
    assert not passing(bar, (0.0, 0.0, 1.0), laminate=False, matrix=PORE)
