"""Only here: perfect conductors by finite elements: exact values, the limit of good ones, bodies that are one."""

import math

import numpy as np
import perfect_bodies
import pytest
from numpy.testing import assert_allclose
from perfect_bodies import (
    CELL,
    FILMS,
    FROM_ZERO,
    MATRIX,
    MATRIX_THAT_SPANS,
    MIDDLE,
    OF_FILMS,
    PERFECT,
    POINTS,
    SPANNING,
    X,
    beside_a_pore,
    body,
)
from spared import slow_but

from demheat import Box, Convection, Layer, Material, Radiation, Scene, Sphere
from demheat.scene.perfect import INFINITE
from references import fem
from references.exact import lattice


# Spheres that resist, in cells, are among the limits below.
@pytest.mark.parametrize(("resistance", "expected"), [(0.2, 1.898010589), (0.0, 3.262566264)], ids=["film", "open"])
def test_a_cubic_array(resistance, expected):
    """An eighth of it, as fine as the whole by default: planes of symmetry are walls."""
    radius = lattice.radius("sc", 0.4)
    ball = Sphere((0.0, 0.0, 0.0), radius, PERFECT, resistance=resistance * radius / MATRIX)
    scene = Scene((0.5, 0.5, 0.5), Material(MATRIX), [ball], **X)
    # 6e-6 and 4.3e-5 were found of the whole: what these elements lack at contrast 100, too.
    assert_allclose(fem.solve(scene, size=1 / 26).conductivity / MATRIX, expected, rtol=1e-4)


@pytest.mark.slow
def test_a_cubic_array_in_its_cell():
    """The level of the temperature is free there, and the perfect ball's with it."""
    scene = body(Sphere(MIDDLE, lattice.radius("sc", 0.4), PERFECT), **CELL)
    # 4.3e-5 was found.
    assert_allclose(fem.solve(scene).conductivity / MATRIX, 3.262566264, rtol=1e-4)


BODIES = perfect_bodies.BODIES | {
    "across faces, film": lambda k: body(Sphere((0.1, 0.9, 0.5), 0.4, k, resistance=0.05), **CELL),
    "half at a wall, film": lambda k: body(Sphere((0.0, 0.5, 0.5), 0.3, k, resistance=0.05), **X),
    "in a fluid": lambda k: body(Sphere((1.0, 0.5, 0.5), 0.3, k), walls={"x-": 20.0, "x+": Convection(3.0, 30.0)}),
    "beside a pore": beside_a_pore,
}


@pytest.mark.parametrize(
    "name", slow_but({"across faces, film", "half at a wall", "beside a pore", "in a fluid"}, BODIES)
)
def test_the_limit_of_good_conductors(name):
    """At 1e6 times the matrix's conductivity all is off by some millionths."""
    perfect, good = (fem.solve(BODIES[name](Material(k)), size=0.18) for k in (math.inf, MATRIX * 1e6))
    assert_allclose(perfect.mean_flux, good.mean_flux, rtol=0, atol=2e-5 * np.abs(good.mean_flux).max())
    here, there = perfect.temperature_at(POINTS), good.temperature_at(POINTS)
    known = np.isfinite(here)
    assert_array_alike(np.isfinite(there), known)
    # In a periodic cell the level is free.
    level = (here - there)[known].mean() if perfect.scene.periodic else 0.0
    assert_allclose(here[known], (there + level)[known], rtol=0, atol=2e-4)
    # What the tolerance leaves in a good conductor: 2e-4 of the largest flux was found.
    most = np.abs(good.flux_at(POINTS)).max()
    assert_allclose(perfect.flux_at(POINTS), good.flux_at(POINTS), rtol=0, atol=1e-3 * most)
    for wall in perfect.scene.walls or {}:
        assert_allclose(perfect.wall_heat[wall], good.wall_heat[wall], rtol=2e-5)
    assert perfect.scene.perfect


def assert_array_alike(one, other):
    assert np.array_equal(one, other)


def test_layers_are_exact_and_one_temperature():
    field = fem.solve(body(Layer(0, 0.3, 0.7, PERFECT), **X), size=0.2)
    # The tolerance, and what a contrast of 1e8 adds.
    assert_allclose(field.conductivity, MATRIX / 0.6, rtol=2e-8)
    inside = POINTS * (0.3, 1, 1) + (0.35, 0, 0)
    assert_allclose(field.temperature_at(inside), 25.0, rtol=0, atol=1e-6)
    # Of 33; temperatures have eight digits for it.
    assert_allclose(field.flux_at(inside), np.tile(field.mean_flux, (len(inside), 1)), rtol=0, atol=2e-4)


def test_what_differs_in_a_good_conductor_acts_on_the_rest():
    """Its own resistance is 7e-6 of the whole."""
    field = fem.solve(body(Layer(0, 0.3, 0.7, Material(MATRIX * 1e5)), **X), size=0.4)
    assert_allclose(field.conductivity, MATRIX / (0.6 + 0.4e-5), rtol=1e-8)  # the solver's tolerance
    assert field.stats["rounds"] > 1  # solved apart


def test_bodies_that_films_part():
    for load in (X, CELL):
        assert_allclose(fem.solve(body(*FILMS, **load), size=0.2).conductivity, OF_FILMS, rtol=1e-7)
    whole = Layer(0, 0.0, 0.4, PERFECT, resistance=0.1), Layer(0, 0.4, 1.0, PERFECT)
    assert_allclose(fem.solve(body(*whole, **X), size=0.2).conductivity, 10.0, rtol=1e-7)


@pytest.mark.parametrize(("scene", "expected"), FROM_ZERO.values(), ids=FROM_ZERO)
def test_from_zero_to_infinity(scene, expected):
    assert_allclose(fem.solve(scene, size=0.2).conductivity, expected, rtol=1e-7)


@pytest.mark.slow
def test_all_axes():
    fields = fem.solve_axes(body(Sphere((0.1, 0.9, 0.5), 0.3, PERFECT), **CELL), size=0.15)
    assert_allclose([f.conductivity for f in fields], fields[0].conductivity, rtol=1e-3)


@pytest.mark.parametrize("scene", (SPANNING | MATRIX_THAT_SPANS).values(), ids=SPANNING | MATRIX_THAT_SPANS)
def test_what_spans_is_infinite(scene):
    with pytest.raises(ValueError, match=INFINITE):
        fem.solve(scene, size=0.2)


@pytest.mark.parametrize(
    "scene",
    [
        body(*(Box((x, 0.5, 0.5), (0.4, 0.4, 0.4), PERFECT) for x in (0.3, 0.7)), **CELL),
        body(Sphere(MIDDLE, 0.2, PERFECT), walls={"x-": 300.0, "x+": Radiation(0.5, 400.0)}),
    ],
    ids=["touching", "radiation"],
)
def test_what_elements_do_not_know_is_refused(scene):
    with pytest.raises(NotImplementedError) as error:
        fem.solve(scene, size=0.2)
    assert "\n" not in str(error.value)
