"""Only here: level sets whose values lead elsewhere than to their surface, and are believed."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat import Material, Scene, solve
from demheat.scene import LevelSet
from demheat.scene.shapes.traced import leads
from references import fft

MIDDLE, RADIUS = 0.5, 0.35
LIMITS = ((0.1, 0.1, 0.1), (0.9, 0.9, 0.9))


def away(points):
    return np.linalg.norm(points - MIDDLE, axis=1) - RADIUS


def cut_off(points):
    return np.clip(away(points), -0.01, 0.01)


def sign(points):
    return np.where(away(points) <= 0, -1.0, 1.0)


def cubed(points):
    return away(points) ** 3


def far_cut_off(points):
    return np.clip(away(points), -0.1, 0.1)


UNKNOWN = [cut_off, sign, cubed, far_cut_off]


def ball(function):
    return LevelSet(function, LIMITS, Material(20.0))


@pytest.mark.parametrize("function", UNKNOWN)
def test_values_that_do_not_lead_to_the_surface_are_seen(function):
    shape = ball(function)
    assert not leads(shape._onto, shape._holds, *shape.bounds())


def test_values_that_lead_there_are_used():
    for function in (away, lambda p: ((p - MIDDLE) ** 2).sum(axis=1) - RADIUS**2, lambda p: 1e-6 * np.tanh(away(p))):
        assert ball(function)._trace is True


@pytest.fixture(scope="module")
def shape():
    return ball(sign)


def test_distances_normals_and_volume(shape):
    points = np.random.default_rng(0).uniform(0.0, 1.0, (5000, 3))
    exact, near = away(points), np.abs(away(points)) < 0.02
    # Cells of 1/80, radius .35: near the surface to second order, farther to half a cell and what splines make of it.
    assert_allclose(shape.distance(points[near]), exact[near], rtol=0, atol=3e-4)
    inner = np.all((points > 0.1) & (points < 0.9), axis=1)
    assert_allclose(shape.distance(points[inner]), exact[inner], rtol=0, atol=0.01)
    outward = (points[near] - MIDDLE) / np.linalg.norm(points[near] - MIDDLE, axis=1)[:, None]
    assert_allclose(shape.normal(points[near]), outward, rtol=0, atol=0.02)
    assert_array_equal(shape.distance(points) <= 0, exact <= 0)
    assert_allclose(shape.volume, 4 / 3 * np.pi * RADIUS**3, rtol=1e-4)


def test_moved_and_turned_ones_are_not_measured_again(shape):
    calls = []

    def counted(points):
        calls.append(len(points))
        return sign(points)

    own = ball(counted)
    own.__dict__["_trace"] = shape._trace
    calls.clear()
    moved = own.placed((0.6, 0.5, 0.4)).turned((1, 2, 0))
    points = np.random.default_rng(1).uniform(0.2, 0.8, (50, 3))
    # Those points of the first one.
    first = points[:, [2, 0, 1]] - [0.1, 0.0, -0.1]
    assert_allclose(moved.distance(points), own.distance(first), rtol=0, atol=1e-12)
    assert_allclose(moved.normal(points), own.normal(first)[:, [1, 2, 0]], rtol=0, atol=1e-12)
    # Each asks once, what of the points is inside.
    assert calls == [len(points)] * 4


def test_conductivity_is_that_of_a_distance(shape):
    rule = "laminate"
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), [shape], gradient=(0, 1, 0))
    field = fft.solve(scene, voxels=16, rule=rule)
    same = fft.solve(Scene(scene.size, scene.matrix, [ball(away)], gradient=(0, 1, 0)), voxels=16, rule=rule)
    # The table's surface is within some 1e-4 of the sphere's.
    assert_allclose(field.conductivity, same.conductivity, rtol=1e-4)
    assert field.stats["rule"] == same.stats["rule"] != "plain"


def test_what_is_too_rough_has_no_surface():
    def rough(points):
        beside = (200 * points).astype(int).sum(axis=1) % 2
        return np.where((np.abs(points - MIDDLE).max(axis=1) < RADIUS) & (beside == 0), -1.0, 1.0)

    scene = Scene((1.0, 1.0, 1.0), Material(1.0), [ball(rough)], gradient=(0, 1, 0))
    assert not scene.inclusions[0].traceable
    # Half of the cube of 7/10, by cells of 1/60, a quarter of which on a face may be in or out.
    assert_allclose(scene.inclusions[0].volume, 0.343 / 2, rtol=0.05)
    assert fft.solve(scene, voxels=8).stats["rule"] == "plain"
    for ask in (lambda: solve(scene, particles=1000), lambda: fft.solve(scene, voxels=8, rule="laminate")):
        with pytest.raises(NotImplementedError, match="changes too often"):
            ask()
