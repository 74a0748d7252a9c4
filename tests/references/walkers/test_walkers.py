"""Walkers find what is known exactly, within the interval that they tell; the same seed walks the same ways."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from spared import slow_but

from demheat import gallery
from demheat.scene import Ellipsoid, Flux, Image, Layer, LevelSet, Material, Scene, Sphere
from references import exact, multipole, walkers
from references.walkers.solver import directions_of

CELL = (1.0, 1.0, 1.0)
MIDDLE = (0.5, 0.5, 0.5)
ALONG = {"gradient": (0.0, 1.0, 0.0)}
PAIR = (Sphere((0.1, 0.4, 0.2), 0.25, Material(0.2)), Sphere((0.6, 0.85, 0.6), 0.3, Material(5.0)))
LAYERS = (Layer(0, 0.1, 0.5, Material(2.5)), Layer(0, 0.5, 0.8, Material(0.4)))
EGG = Ellipsoid(MIDDLE, (0.2, 0.3, 0.4), Material(0.1))


def cell(*inclusions, **load):
    return Scene(CELL, Material(1.0), inclusions, **(load or ALONG))


def ball(contrast, **load):
    return cell(Sphere(MIDDLE, 1 / 3, Material(contrast)), **load)


# Scenes, walks and radii of the balls on surfaces, as cheap as shows what would be wrong; a value where none is exact.
KNOWN = {
    "layers across": (cell(*LAYERS, gradient=(1.0, 0.0, 0.0)), 400, 0.12, None),
    "pore": (ball(0.0), 300, 0.1, None),
    "walls": (ball(10.0, walls={"y-": 0.0, "y+": 1.0}), 200, 0.12, None),
    "body-centred": (gallery.body_centred(0.1, fraction=0.4), 300, None, None),
    "coated": (gallery.coated_sphere(), 100, None, None),
    "unlike, skewed": (Scene((1.0, 1.2, 0.9), Material(1.0), PAIR, gradient=(1.0, -2.0, 0.5)), 200, 0.12, None),
    # Quadratic finite elements of size .1 and .07 give .893748 and .893738.
    "ellipsoid": (cell(EGG, gradient=(0.0, 0.0, 1.0)), 200, 0.12, 0.89374),
}


def known(name):
    scene, _, _, value = KNOWN[name]
    if value is not None:
        return value
    return (multipole if name.startswith("unlike") else exact).solve(scene).conductivity


@pytest.mark.parametrize("name", slow_but({"layers across", "pore", "body-centred"}, KNOWN))
def test_what_is_known(name):
    scene, walks, radius, _ = KNOWN[name]
    found = walkers.solve(scene, walks=walks, radius=radius, seed=1)
    # Four standard errors: of all these cases none in thousands of seeds.
    assert abs(found.conductivity - known(name)) < 4 * found.error + found.bias
    # Narrow enough to tell.
    assert 0 < found.error < 0.04 * found.conductivity
    assert found.lower < found.conductivity < found.upper


def test_the_bits_are_those_of_the_seed():
    one, again, other = (walkers.solve(ball(0.2), walks=100, radius=0.2, seed=seed) for seed in (3, 3, 4))
    assert one == again and one.stats == again.stats
    assert one.conductivity != other.conductivity


def test_other_units():
    """Powers of two change no digit."""
    one = walkers.solve(ball(0.25), walks=100, radius=0.125)
    small = Scene((0.25,) * 3, Material(4.0), [Sphere((0.125,) * 3, 1 / 12, Material(1.0))], gradient=(0.0, 8.0, 0.0))
    other = walkers.solve(small, walks=100, radius=0.03125)
    assert (other.conductivity, other.error) == (4 * one.conductivity, 4 * one.error)


@pytest.mark.slow
def test_the_interval_shrinks_as_theory_says():
    few, many = (walkers.solve(ball(0.2), walks=walks, radius=0.1, seed=2) for walks in (100, 900))
    # The square root of nine; either may have the longest lag for the shortest, which scatters 1.7 times as much.
    assert 3 / 1.75 < few.error / many.error < 3 * 1.75
    # The default radius falls as the fourth root, and what it makes wrong as its square.
    assert many.bias == pytest.approx(few.bias, rel=0.05)
    few, many = (walkers.solve(ball(0.2), walks=walks) for walks in (100, 400))
    assert few.stats["radius"] / many.stats["radius"] == pytest.approx(4**0.25)
    assert few.bias / many.bias == pytest.approx(2.0, rel=0.1)


def test_nothing_to_choose():
    assert walkers.solve(cell()).conductivity == 1.0
    assert walkers.solve(ball(1.0)).error == 0.0
    assert walkers.solve(Scene(CELL, Material(0.0), **ALONG)).conductivity == 0.0


def test_axes_alike_are_averaged():
    layer = Layer(0, 0.2, 0.6, Material(3.0))
    for scene, axes in (
        (ball(0.5), 3),
        (ball(0.5, gradient=(1.0, 2.0, 0.0)), 3),
        (ball(0.5, walls={"z-": 0.0, "z+": 1.0}), 3),
        (cell(layer), 2),
        (cell(layer, gradient=(1.0, 0.0, 0.0)), 1),
        (cell(layer, gradient=(1.0, 1.0, 0.0)), 1),
    ):
        found = directions_of(scene)
        assert len(found) == axes
        # The load is among what they span, and they are as long as they should be.
        load = np.array(scene.gradient or (0.0, 0.0, 1.0))
        assert_allclose(load @ found.T @ found, load, atol=1e-15)  # rounding
        assert_allclose(np.linalg.norm(found, axis=1), 1.0)


def test_what_walkers_do_not_know():
    with pytest.raises(ValueError, match="scene = 3: must be a Scene"):
        walkers.solve(3)
    coat = Sphere(MIDDLE, 0.3, Material(2.0), resistance=0.1)
    image = Image(np.zeros((2, 2, 2), dtype=np.uint8), 0.5, {0: Material(1.0)})
    for scene, words in (
        (cell(coat), "resistance"),
        (ball(2.0, walls={"y-": Flux(1.0), "y+": 1.0}), "walls"),
        (Scene(CELL, Material(((2.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))), **ALONG), "tensor"),
        (Scene.of_image(image, **ALONG), "image"),
    ):
        with pytest.raises(NotImplementedError, match=words):
            walkers.solve(scene)


@pytest.mark.slow
def test_walkers_that_leave_a_surface_do_not_end_in_a_pore():
    """A level set's slope is that of a grid, so that a step straight off it may end on the other side."""
    half = LevelSet(
        lambda points: np.cos(2 * np.pi * points).sum(axis=1), ((0.0,) * 3, CELL), Material(0.0), periodic=True
    )
    found = walkers.solve(cell(half), walks=100, radius=0.12)
    # Of half of a primitive's labyrinth a third is left; finite elements of study `formless` give .330.
    assert abs(found.conductivity - 0.33) < 4 * found.error
