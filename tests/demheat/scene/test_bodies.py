"""Only here: bodies inscribed in a box with walls elsewhere than they end."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat.scene import bodies

BODIES = {
    "box": (1.0, 2.0, 0.5),
    "cylinder-x": (2.0, 1.0, 1.0),
    "cylinder-y": (1.0, 0.7, 1.0),
    "cylinder-z": (1.0, 1.0, 3.0),
    "sphere": (2.0, 2.0, 2.0),
}


def some_inside(domain, number=60, seed=0):
    size = np.array(BODIES[domain])
    points = np.random.default_rng(seed).random((20 * number, 3)) * size
    return points[bodies.inside(points, domain, size)][:number], size


@pytest.mark.parametrize("domain", BODIES)
def test_volume_is_that_of_the_points_inside(domain):
    size, m = np.array(BODIES[domain]), 60
    grid = (np.indices((m, m, m)).reshape(3, -1).T + 0.5) / m * size
    # Cells cut by the surface, some 6 m^2, err at random by half a cell: far below 1 %.
    part = np.mean(bodies.inside(grid, domain, size))
    assert_allclose(bodies.domain_volume(domain, size), part * size.prod(), rtol=5e-3)


@pytest.mark.parametrize("domain", BODIES)
def test_walls_are_where_the_body_ends(domain):
    """From a point straight to any wall: on it at its distance, outside a hair later, inside a hair before."""
    points, size = some_inside(domain)
    for wall in bodies.wall_names(domain):
        distance = bodies.wall_distance(points, wall, domain, size)[:, None]
        normal = bodies.outward(points, wall, domain, size)
        assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-14)  # rounding
        foot = points + distance * normal
        assert_allclose(bodies.wall_distance(foot, wall, domain, size), 0.0, atol=1e-14)
        assert bodies.inside(foot - 1e-12 * normal, domain, size).all()
        assert not bodies.inside(foot + 1e-12 * normal, domain, size).any()
        # Slack is a part of the sides, which are 0.5 to 3.
        assert bodies.inside(foot + 1e-9 * normal, domain, size, slack=1e-8).all()
        assert not bodies.inside(foot + 1e-9 * normal, domain, size, slack=1e-10).any()


@pytest.mark.parametrize("domain", BODIES)
def test_nothing_is_nearer_than_the_nearest_wall(domain):
    points, size = some_inside(domain, 20)
    nearest = bodies.nearest_wall(points, bodies.wall_names(domain), domain, size)
    ball = np.random.default_rng(1).standard_normal((2000, 3))
    ball /= np.linalg.norm(ball, axis=1)[:, None]
    for point, radius in zip(points, nearest, strict=True):
        assert bodies.inside(point + 0.999999 * radius * ball, domain, size).all()
        # Of 2000 directions one or more leads within 0.2 rad of the wall's: 2 % farther.
        assert not bodies.inside(point + 1.1 * radius * ball, domain, size).all()


def test_periodic_axes_have_no_walls():
    assert bodies.wall_names("box", (True, False, True)) == ("y-", "y+")
    assert bodies.wall_names("cylinder-y", (False, True, False)) == ("round",)
    assert bodies.wall_names("cylinder-y") == ("y-", "y+", "round")
    assert_array_equal(bodies.nearest_wall(np.zeros((2, 3)), (), "box", (1, 1, 1)), np.inf)


def test_round_bodies_by_hand():
    # 3-4-5 and 2-3-6-7 triangles, exact in binary.
    assert bodies.from_middle(np.array([4.0, 9.0, 5.0]), "cylinder-y", (2, 7, 2)) == 5.0
    assert bodies.from_middle(np.array([3.0, 4.0, 7.0]), "sphere", (2, 2, 2)) == 7.0
    assert bodies.from_middle(np.array([3.0, 4.0, 7.0]), "box", (2, 2, 2)) == 0.0
    assert bodies.round_radius("sphere", (2, 2, 2)) == 1.0 and bodies.round_radius("box", (2, 2, 2)) == np.inf
    # In the middle no direction is special.
    middle = np.array([[1.0, 1.0, 1.0], [1.0, 0.2, 1.0]])
    assert np.isnan(bodies.outward(middle, "round", "cylinder-y", (2, 3, 2))).all()
    assert_array_equal(bodies.outward(middle, "y+", "cylinder-y", (2, 3, 2)), [[0, 1, 0], [0, 1, 0]])
