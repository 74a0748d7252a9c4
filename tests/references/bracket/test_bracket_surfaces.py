"""Curved interfaces end up on the side of the true ones that a bound needs, and no farther than it takes."""

import fem_scenes  # noqa: F401, skips without gmsh
import numpy as np
import pytest
from spared import slow_but

from demheat import gallery
from demheat.scene import Material, Scene, Sphere
from references.bracket import surfaces
from references.bracket.surfaces import distances, patches, pushed
from references.fem.elements import shapes
from references.mesh import make, sizes


def points_on(mesh, nodes):
    """Random points (t, 50, 3) of quadratic patches."""
    X = np.random.default_rng(0).dirichlet((0.5, 0.5, 0.5), 50)[:, 1:].T
    return np.einsum("qn,tnx->tqx", shapes(6, X)[0], mesh.points[nodes])


def scenes():
    cut = [Sphere((0.05, 0.5, 0.4), 0.3, Material(5.0)), Sphere((0.05, 0.5, 0.4), 0.2, Material(0.1))]
    yield gallery.sphere_in_cube(10.0)
    yield gallery.body_centred(0.1, fraction=0.3)
    yield Scene((1.0, 1.0, 0.8), Material(1.0), cut, gradient=(1.0, 0.0, 0.0))
    yield Scene((1.0, 1.0, 0.8), Material(1.0), cut, walls={"x-": 0.0, "x+": 1.0})


@pytest.mark.parametrize("scene", list(scenes()))
@pytest.mark.parametrize("size", slow_but({0.3}, [0.3, 0.1]))
def test_patches_are_on_their_side(scene, size):
    mesh = make(scene, size=size * max(scene.size))
    for upper in (True, False):
        moved, found = pushed(scene, mesh, upper=upper), patches(scene, mesh)
        off = np.linalg.norm(points_on(moved, found.nodes) - found.center[:, None], axis=2) / found.radius[:, None] - 1
        better = scene.conductivities[found.inner] > scene.conductivities[found.outer]
        outside = better == upper
        # Rounding of coordinates far from the centre.
        assert off[outside].min(initial=0) >= -1e-14
        assert off[~outside].max(initial=0) <= 1e-14
        # An arc of a third of the radius, as small spheres get, misses by 1e-4 of it, chords by 1e-2; some to spare.
        assert np.abs(off).max() < 0.05
        assert np.median(np.abs(off)) < 5e-3


@pytest.mark.parametrize("scene", list(scenes()))
def test_the_box_stays_filled(scene):
    mesh = make(scene, size=0.2 * max(scene.size))
    moved = pushed(scene, mesh, upper=True)
    assert moved.volumes.min() > 0
    assert moved.volumes.sum() == pytest.approx(scene.volume, rel=1e-12)
    for name, wall in moved.walls.items():
        axis = "xyz".index(name[0])
        assert np.all(moved.points[wall.triangles, axis] == (0 if name[1] == "-" else scene.size[axis]))
    apart = moved.points[moved.pairs[:, 0]] - moved.points[moved.pairs[:, 1]]
    # Twins differ by one side of the box; coordinates are rounded.
    assert np.abs(np.abs(apart).sum(axis=1)[:, None] - scene.size).min(axis=1).max(initial=0) < 1e-14 * max(scene.size)
    # More of what conducts better.
    conductivity = scene.conductivities
    assert conductivity[moved.phase] @ moved.volumes > conductivity[mesh.phase] @ mesh.volumes


def test_distances_bound_a_patch():
    rng = np.random.default_rng(1)
    nodes, center = rng.random((200, 6, 3)), rng.random((200, 3))
    X = rng.dirichlet((0.4, 0.4, 0.4), 400)[:, 1:].T
    true = np.linalg.norm(np.einsum("qn,tnx->tqx", shapes(6, X)[0], nodes) - center[:, None], axis=2)
    least, greatest = distances(nodes, center)
    assert np.all(least <= true.min(axis=1) + 1e-12)
    assert np.all(greatest >= true.max(axis=1) - 1e-12)
    # Of a patch in one point they are exact.
    point = np.repeat(nodes[:, :1], 6, axis=1)
    for each in distances(point, center):
        assert each == pytest.approx(np.linalg.norm(point[:, 0] - center, axis=1), rel=1e-12)


def test_coarse_elements_get_straight_edges_rather_than_none(monkeypatch):
    """Edges of 0.6 radii: one element would be inverted by the push (seen: without straightening this fails)."""
    monkeypatch.setattr(sizes, "ON_SPHERE", 0.6)
    scene = gallery.sphere_in_cube(10.0)
    mesh = make(scene, size=scene.size[0])
    moved, found = pushed(scene, mesh, upper=True), patches(scene, mesh)
    least, _ = distances(moved.points[found.nodes], found.center)
    assert np.all(least >= found.radius)
    assert np.sum(moved.curved) < np.sum(mesh.curved)
    assert moved.volumes.sum() == pytest.approx(scene.volume, rel=1e-12)
    monkeypatch.setattr(surfaces, "TRIES", 1)
    with pytest.raises(RuntimeError, match="too coarse"):
        pushed(scene, mesh, upper=True)
