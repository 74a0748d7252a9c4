"""Only here: gaps between surfaces, or to walls, that the search by cells misses; spheres that walls cut."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial import cKDTree

from demheat import Layer, Material, Scene, Sphere
from demheat.packing.twins.gaps import Interfaces
from demheat.packing.twins.interfaces import surfaces_of

MATRIX, OTHER = Material(1.0), Material(10.0)


def scene(kind, periodic):
    rng = np.random.default_rng(1)
    sites = (np.stack(np.meshgrid(*[np.arange(4)] * 3, indexing="ij"), -1).reshape(-1, 3) + 0.5) / 4
    if kind == "few":
        found = [Sphere((0.2, 0.2, 0.3), 0.15, OTHER), Sphere((0.2, 0.2, 0.3), 0.12, MATRIX)]
        found += [Sphere((0.7, 0.6, 0.2), 0.12, OTHER), Sphere((0.95, 0.3, 0.7), 0.2, OTHER)]
        found += [Layer(2, 0.95, 1.0, OTHER)]
    elif kind == "its own images":
        found = [Sphere((0.4, 0.5, 0.55), 0.485, OTHER), Sphere((0.4, 0.5, 0.55), 0.4, MATRIX)]
    else:
        radii = 0.1 * (1.0 if kind == "equal" else 10.0 ** -rng.random(64))
        found = [Sphere(c, r, OTHER) for c, r in zip(sites, np.broadcast_to(radii, 64), strict=True)]
    load = {"gradient": (0, 1, 0)} if periodic else {"walls": {"y-": 0.0, "y+": 1.0}}
    return Scene((1, 1, 1), MATRIX, found, **load)


@pytest.mark.parametrize("periodic", [True, False])
# The farther reach is come to by way of a nearer one where spheres are many.
@pytest.mark.parametrize("reach", [0.06, 0.4])
@pytest.mark.parametrize("kind", ["few", "its own images", "equal", "unequal"])
def test_gaps_are_those_of_one_surface_after_the_other(kind, reach, periodic):
    given = scene(kind, periodic)
    interfaces, surfaces = Interfaces(given, reach), surfaces_of(given)
    assert len(interfaces) == len(surfaces)
    points = np.random.default_rng(4).random((5000, 3))
    slow = np.min([surface.gap(points) for surface in surfaces], axis=0)
    seen = slow <= reach
    assert_allclose(interfaces.gap(points)[seen], slow[seen], rtol=0, atol=1e-15)
    assert np.all(interfaces.gap(points)[~seen] > reach)
    for number, surface in enumerate(surfaces):
        on, normals = surface.pattern(0.05, np.random.default_rng(number))
        slow = np.min([other.gap(on, skip_self=other is surface) for other in surfaces], axis=0)
        found, seen = interfaces.gap(on, np.full(len(on), number)), slow <= reach
        assert_allclose(found[seen], slow[seen], rtol=0, atol=1e-15)
        assert np.all(found[~seen] > reach)


@pytest.mark.parametrize("reach", [0.1, 0.4, 3.0])
def test_among_many_spheres_those_far_away_are_not_asked(reach):
    interfaces = Interfaces(scene("equal", True), reach)
    interfaces.gap(np.random.default_rng(4).random((5000, 3)))
    # All have a neighbour nearer than the mean distance of .25, within which spheres are asked first.
    assert interfaces.spheres.bins.cache_info().currsize == 1
    assert len(interfaces.spheres.bins(min(interfaces.spheres._reaches())).balls) < 100 * 64


def test_way_to_wall():
    interfaces = Interfaces(scene("equal", False), 0.3)
    points = np.array([[0.9, 0.5, 0.5], [0.9, 0.5, 0.5], [0.5, 0.5, 0.5], [0.1, 0.2, 0.5]])
    normals = np.array([[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [1.0, 0.0, 0.0], [0.8, 0.6, 0.0]])
    # Straight on, at an angle, beyond the reach, and backwards.
    assert_allclose(interfaces.way_to_wall(points, normals), [0.1, 0.1 / 0.6, np.inf, 0.125], rtol=1e-14)
    assert_allclose(interfaces.way_to_wall(points, normals, facing=0.9), [0.1, np.inf, np.inf, np.inf], rtol=1e-14)
    assert np.all(np.isinf(Interfaces(scene("equal", True), 0.3).way_to_wall(points, normals)))


def test_a_gap_to_a_wall_is_one_to_the_mirror_image():
    interfaces = Interfaces(
        Scene((1, 1, 1), MATRIX, [Sphere((0.3, 0.5, 0.5), 0.25, OTHER)], walls={"y-": 0.0, "y+": 1.0}), 0.3
    )
    points, normals = np.array([[0.05, 0.5, 0.5], [0.3, 0.75, 0.5]]), np.array([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    assert_allclose(interfaces.width(points, normals, np.zeros(2, int)), [0.1, 0.5], rtol=1e-13)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_points_on_a_plane_have_six_neighbours_each(axis):
    """A triangular pattern of 1 by sqrt(3)/2 spacings: in squares of that they would have four within 1.2 spacings."""
    (plane,) = surfaces_of(Scene((1, 1, 1), MATRIX, [Layer(axis, 0.4, 1.0, OTHER)], walls={"y-": 0.0, "y+": 1.0}))
    points, normals = plane.pattern(0.05, np.random.default_rng(1))
    assert np.array_equal(normals, np.tile(np.eye(3)[axis], (len(points), 1))) and np.all(points[:, axis] == 0.4)
    tree = cKDTree(np.delete(points, axis, axis=1), boxsize=1.0)
    # Found 5.9, as points are jittered by a tenth of the spacing each way.
    assert 5.5 < tree.count_neighbors(tree, 1.2 * 0.05) / len(points) - 1 < 6.1


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_spheres_that_walls_cut(axis):
    """A little at either end; a sphere that only touches a wall is whole, and so are all in a periodic cell."""
    places = np.full((4, 3), 0.5)
    places[:, axis] = 0.09, 0.91, 0.1, 0.5
    found = [Sphere(place, 0.1, OTHER) for place in places]
    walls = "xyz"[axis] + "-", "xyz"[axis] + "+"
    for load, cut in (
        ({"walls": dict.fromkeys(walls, 1.0)}, [True, True, False, False]),
        ({"gradient": (0, 1, 0)}, []),
    ):
        given = [Scene((1, 1, 1), MATRIX, [each], **load) for each in found]
        seen = [Interfaces(each, 0.05).spheres._cut(np.zeros(1, int))[0] for each in given]
        assert seen == (cut or [False] * 4)
