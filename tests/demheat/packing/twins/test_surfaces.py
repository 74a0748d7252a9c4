"""Only here: few points of surfaces for which NumPy says something else than what is compiled for many."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from demheat.packing.twins import surfaces
from demheat.packing.twins import surfaces_kernels as kernels
from demheat.packing.twins.interfaces import fibonacci_sphere
from demheat.scene.shapes.bins import ball_bins


def test_patterns():
    start, balls = np.array([0, 12, 12, 400]), np.random.default_rng(0).random((3, 4))
    turns, found = Rotation.random(3, random_state=1).as_matrix(), np.empty((2, 400, 3))
    kernels.turned_patterns(0, 3, start, turns, balls, *found)
    # Steps of sines, and sines of angles up to 4000.
    assert_allclose(surfaces.turned_patterns(start, turns, balls), found, rtol=0, atol=1e-12)


@pytest.mark.parametrize("periodic", [True, False])
def test_gaps(periodic):
    rng, size, reach = np.random.default_rng(2), np.array([1.0, 0.8, 1.1]), 0.07
    balls = np.column_stack([size * rng.random((30, 3)), 0.3 * rng.random(30)])
    points, own, kin = size * rng.uniform(0.0, 1.0, (900, 3)), rng.integers(-1, 10, 900), np.arange(30) // 3
    bins = ball_bins(balls[:, :3], balls[:, 3] + reach, size, periodic=periodic)
    where, wanted = (points, own, kin, balls, bins, reach), np.empty(900)
    kernels.nearest_gaps(0, 900, *where, wanted)
    assert 100 < np.isinf(wanted).sum() < 800
    assert_allclose(surfaces.nearest_gaps(*where), wanted, rtol=0, atol=1e-14)  # rounding of distances of order 1


def test_volumes():
    sets = [fibonacci_sphere(n) @ Rotation.random(random_state=n).as_matrix().T for n in (12, 50, 300)]
    sets.append(np.concatenate([np.eye(3), -np.eye(3)]))
    count = np.array([len(each) for each in sets])
    own, normals = np.repeat(np.arange(4), count), np.concatenate(sets)
    order, areas = np.lexsort((normals[:, 2], own)), np.empty(len(normals))
    kernels.facet_areas(0, len(normals), np.append(0, np.cumsum(count)), own, normals[order], areas)
    found = [surfaces.circumscribed_volume(each) for each in sets]
    assert_allclose(found, np.bincount(own, areas) / 3.0, rtol=1e-13)  # rounding


@pytest.mark.parametrize("count", [3, 100, 103])
def test_no_end_is_no_volume(count):
    """Too few normals for a hull, those of half a sphere, and those that hardly enclose it."""
    assert np.isnan(surfaces.circumscribed_volume(fibonacci_sphere(200)[:count]))
