"""Only here: shapes whose distance, normal, bounds or images are another's, by points and differences."""

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat import Layer, Material, Sphere
from demheat.scene.shapes import Shape

M = Material(2.0)
PERIOD = np.array([1.0, 1.5, 2.0])
BALL = Sphere((0.1, 0.7, 1.9), 0.3, M)
SHEET = Layer(1, 0.2, 0.5, M)
THICK = Layer(2, 0.1, 1.8, M)
SHAPES = [BALL, SHEET, THICK]


@pytest.fixture(params=[None, PERIOD], ids=["once", "repeated"])
def period(request):
    return request.param


@pytest.fixture(params=SHAPES, ids=lambda shape: f"{shape.kind}-{shape.volume_in(PERIOD, periodic=True):.2g}")
def shape(request):
    return request.param


@pytest.fixture
def points():
    return np.random.default_rng(0).uniform(-0.5, 1.5, (4000, 3)) * PERIOD


def test_inside_is_where_the_distance_is_not_positive(shape, period, points):
    inside, distance = shape.contains(points, period=period), shape.distance(points, period=period)
    assert inside.any() and not inside.all()
    assert_array_equal(inside, distance <= 0)
    assert_array_equal(Shape.contains(shape, points, period=period), inside)


def test_the_distance_is_that_to_the_surface_along_the_normal(shape, period, points):
    distance, normal = shape.distance(points, period=period), shape.normal(points, period=period)
    assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-14)
    foot = points - distance[:, None] * normal
    assert_allclose(shape.distance(foot, period=period), 0.0, atol=1e-13)  # rounding of coordinates up to 3
    # A hair out and in from the surface.
    for step in (1e-6, -1e-6):
        assert_allclose(shape.distance(foot + step * normal, period=period), step, rtol=1e-6)


def test_images_are_those_of_all_periods(shape, points):
    shifts = np.stack(np.meshgrid(*[np.arange(-2, 3)] * 3, indexing="ij"), -1).reshape(-1, 3) * PERIOD
    once = np.min([shape.distance(points + shift) for shift in shifts], axis=0)
    assert_allclose(shape.distance(points, period=PERIOD), once, atol=1e-14)


def test_bounds_hold_it_and_no_more(shape, points):
    low, high = shape.bounds()
    inside = points[shape.contains(points)]
    assert np.all((inside >= low) & (inside <= high))
    for end, side in ((low, -1), (high, 1)):
        for axis in np.flatnonzero(np.isfinite(end)):
            # The nearest point of the surface to one far out along the axis is at the end.
            far = np.array(shape.point_in(PERIOD, periodic=False))
            far[axis] += 100.0 * side
            assert_allclose(shape.distance(far[None])[0], abs(far[axis] - end[axis]), rtol=1e-12)
    center, radius = shape.ball()
    assert np.all(np.linalg.norm(inside - center, axis=1) <= radius)


def test_volumes_are_those_of_points(shape):
    n = 60
    axes = [(np.arange(n) + 0.5) / n * side for side in PERIOD]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    share = shape.contains(grid, period=PERIOD).mean()
    # A surface passes a share of some 6 area h of the cells, half of them on either side.
    assert_allclose(shape.volume_in(PERIOD, periodic=True) / PERIOD.prod(), share, rtol=2e-2)
    assert shape.volume == (math.inf if not shape.bounded else shape.volume_in(PERIOD, periodic=True))


def test_turned_axes(shape, points):
    order = (2, 0, 1)
    assert_allclose(shape.turned(order).distance(points[:, order]), shape.distance(points), atol=1e-14)
    assert shape.turned((0, 1, 2)) == shape


def test_a_layer_that_fills_the_period_has_no_face():
    whole = Layer(0, 0.0, 1.0, M)
    assert np.all(whole.distance(np.zeros((1, 3)), period=PERIOD) == -np.inf)
    assert whole.distance(np.zeros((1, 3)))[0] == 0.0


def test_the_centre_of_a_sphere_has_a_normal():
    assert_array_equal(BALL.normal(np.array([BALL.center])), [[1.0, 0.0, 0.0]])


def test_what_a_shape_must_supply_is_asked_for():
    class Blob(Shape):
        pass

    with pytest.raises(TypeError, match="bounds.*distance.*normal.*turned.*volume"):
        Blob()


def test_engine_and_references_ask_the_shape_and_not_its_type():
    root = Path(__file__).parents[4]
    for package in ("demheat", "references"):
        for path in (root / package).rglob("*.py"):
            for line in path.read_text(encoding="utf-8").splitlines():
                assert not ("isinstance(" in line and ("Sphere" in line or "Layer" in line)), f"{path}: {line}"
