"""Mirror images between walls: which are needed, which only repeat the box, and what they cannot do."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Flux, Material, Scene, Sphere, gallery
from references import exact, fft, multipole
from references.multipole import arrangement
from references.multipole.system import solve_order
from references.multipole.translations import translation

# Nothing symmetric, two materials; the gaps to the walls and between the spheres are a fifth of a diameter or more.
SPHERES = [Sphere((0.3, 0.4, 0.45), 0.2, Material(7.0)), Sphere((0.7, 0.75, 0.6), 0.22, Material(0.1))]
SIZE = (1.0, 1.1, 0.9)


def box(axis=1, low=25.0, high=35.0, spheres=SPHERES, size=SIZE, **walls):
    return Scene(size, Material(1.0), spheres, walls={"xyz"[axis] + "-": low, "xyz"[axis] + "+": high, **walls})


def on_face(axis, side, count=40):
    points = np.random.default_rng(0).random((count, 3)) * SIZE
    points[:, axis] = side * SIZE[axis]
    return points


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_walls_hold_their_temperature_and_sides_are_insulated(axis):
    field = multipole.solve(box(axis), order=5)
    for side, temperature in ((0, 25.0), (1, 35.0)):
        # By symmetry, whatever the degree: rounding of the sums.
        assert_allclose(field.temperature_at(on_face(axis, side)), temperature, rtol=0, atol=1e-11)
    for across in {0, 1, 2} - {axis}:
        for side in (0, 1):
            through = field.flux_at(on_face(across, side))[:, across]
            assert_allclose(through, 0.0, rtol=0, atol=1e-11 * np.abs(field.mean_flux).max())
    # By symmetry there is no mean flux across the load; the rest is heat that enters and leaves.
    assert_allclose(np.delete(field.mean_flux, axis), 0.0, rtol=0, atol=1e-12)
    area = field.scene.volume / SIZE[axis]
    names = ["xyz"[axis] + side for side in "-+"]
    assert_allclose([field.wall_heat[name] for name in names], field.mean_flux[axis] * area * np.array([1, -1]))
    assert field.wall_temperature == {names[0]: 25.0, names[1]: 35.0}


@pytest.mark.parametrize("place", ["in two walls", "in eight corners"])
def test_spheres_that_walls_cut_through_their_centres_are_whole_in_the_mirror(place):
    scene, array = gallery.sphere_in_cube(10.0), exact.solve(gallery.sphere_in_cube(10.0, periodic=True))
    whole, edge = scene.inclusions[0], scene.size[0]
    ends = {"in two walls": [1], "in eight corners": [0, 1, 2]}[place]
    centers = np.full((2 ** len(ends), 3), edge / 2)
    centers[:, ends] = edge * np.array(list(product((0, 1), repeat=len(ends))))
    found = multipole.solve(replace(scene, inclusions=[replace(whole, center=tuple(c)) for c in centers]), order=12)
    assert_allclose(found.conductivity, array.conductivity, rtol=1e-10)  # order 12 leaves 2e-11
    assert_allclose(found.fractions[1:].sum(), array.fractions[1], rtol=1e-13)
    # The array moved by half an edge.
    points = edge * np.random.default_rng(2).random((50, 3))
    there = points + np.where(np.isin([0, 1, 2], ends), edge / 2, 0.0)
    assert_allclose(found.flux_at(points), array.flux_at(there), rtol=0, atol=2e-5 * 4000)  # terms of degree 13
    rise = array.temperature_at(there) - array.temperature_at([[edge / 2, edge / 2, edge / 2]])
    assert_allclose(found.temperature_at(points), 25.0 + rise, rtol=0, atol=1e-6)


def test_images_that_only_repeat_the_box_are_left_out(monkeypatch):
    scene = box(
        2, spheres=[Sphere((0.5, 0.3, 0.45), 0.15, Material(7.0)), Sphere((0.5, 0.8, 0.45), 0.2, Material(0.1))]
    )
    made = arrangement.arrange(scene).spheres
    assert len(made.radii) == 4 and made.count == 2
    few = multipole.solve(scene, order=6)
    monkeypatch.setattr(arrangement, "_symmetric", lambda *_: False)
    assert len(arrangement.arrange(scene).spheres.radii) == 16
    many = multipole.solve(scene, order=6)
    points = np.random.default_rng(3).random((50, 3)) * SIZE
    # Tolerance of the solves, 1e-10.
    assert_allclose(few.mean_flux, many.mean_flux, rtol=0, atol=1e-9 * np.abs(many.mean_flux).max())
    assert_allclose(few.temperature_at(points), many.temperature_at(points), rtol=1e-9)
    assert_allclose(few.flux_at(points), many.flux_at(points), rtol=0, atol=1e-8 * np.abs(many.mean_flux).max())


@pytest.mark.parametrize("other", [{"radius": 0.16}, {"material": Material(2.0)}, {"center": (0.71, 0.3, 0.45)}])
def test_spheres_that_differ_from_their_mirror_image_are_mirrored(other):
    pair = [Sphere((x, 0.3, 0.45), 0.15, Material(7.0)) for x in (0.3, 0.7)]
    made = arrangement.arrange(box(spheres=pair)).spheres
    assert len(made.radii) == 4 and not made.flips[:, [0, 2]].any()
    changed = arrangement.arrange(box(spheres=[pair[0], replace(pair[1], **other)])).spheres
    assert len(changed.radii) == 8 and changed.flips[:, 0].any()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_images_as_unknowns_of_their_own_come_out_as_images(axis):
    spheres, gradient, _, _ = arrangement.arrange(box(axis))
    free = spheres._replace(original=np.arange(16), flips=np.zeros((16, 3), bool))
    own, all_free = (
        solve_order(s, translation(s, 8), gradient, 4, tolerance=1e-13, guess=None) for s in (spheres, free)
    )
    scale = np.abs(own.source).max()
    # Tolerance of the solves.
    assert_allclose(own.source, all_free.source, rtol=0, atol=1e-12 * scale)
    assert_allclose(own.local, all_free.local, rtol=0, atol=1e-12 * np.abs(own.local).max())
    assert own.iterations == all_free.iterations


@pytest.mark.filterwarnings("ignore:gaps beside inclusions")
def test_a_box_without_symmetry_agrees_with_voxels():
    found = multipole.solve(box(), accuracy=1e-6)
    # Laminate voxels err at first order or a little better, here 1.3e-4 at 32 a side.
    coarse, fine = (fft.solve(box(size=(1.0, 1.0, 1.0)), voxels=n, threads=1).conductivity for n in (16, 32))
    cube = multipole.solve(box(size=(1.0, 1.0, 1.0)), accuracy=1e-6).conductivity
    assert_allclose(fine, cube, rtol=3e-4)
    assert 1.5 < (coarse - cube) / (fine - cube) < 5
    # The samples fill the box and say the same.
    samples = found.samples
    assert_allclose(samples.volumes.sum(), found.scene.volume, rtol=1e-12)
    assert np.array_equal(samples.phase, found.scene.phase_at(samples.points))
    mean = samples.volumes @ samples.flux / samples.volumes.sum()
    assert_allclose(mean, found.mean_flux, rtol=0, atol=0.01 * np.linalg.norm(found.mean_flux))  # midpoints of 24^3


def test_a_sphere_that_touches_a_wall_is_one_material_with_its_image():
    field = multipole.solve(box(spheres=[Sphere((0.3, 0.2, 0.45), 0.2, Material(7.0)), SPHERES[1]]), order=4)
    # Points taken for points of the wall may lie beyond it by rounding, here in the image.
    inside, beyond = field.flux_at([(0.3, 5e-10, 0.45), (0.3, -5e-10, 0.45)])
    # The temperature is odd in the wall: tangential fluxes, small by the degrees left out, turn over there; 1e-9 apart.
    assert_allclose(beyond, inside * [-1, 1, -1], rtol=1e-6, atol=1e-6)
    assert field.stats["smallest_gap"] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("scene", "reason"),
    [
        (Scene(SIZE, Material(1.0), SPHERES, walls={"x-": 0.0}), r"walls \['x-'\]; only two opposite"),
        (box(**{"x-": 3.0}), "only two opposite"),
        (box(**{"x-": Flux(1.0)}), "only two opposite"),
        (box(spheres=[SPHERES[0], Sphere((0.75, 0.9, 0.6), 0.22, Material(2.0))]), r"inclusions\[1\] is cut by a wall"),
        (box(spheres=[Sphere((0.3, -0.05, 0.4), 0.2, Material(2.0))]), r"inclusions\[0\] is cut by a wall"),
        (box(spheres=[Sphere((0.5, 0.0, 0.45), 0.5, Material(2.0))]), r"inclusions\[0\] is cut by a wall"),
    ],
)
def test_what_mirror_images_cannot_do_is_refused(scene, reason):
    with pytest.raises(NotImplementedError, match=reason):
        multipole.solve(scene)
