"""Perfect conductors by particles: the limit of good ones, held by walls, whole by heat, infinite where they span."""

import math
import warnings

import numpy as np
import perfect_bodies
import pytest
from numpy.testing import assert_allclose
from perfect_bodies import (
    CELL,
    FILMS,
    FROM_ZERO,
    MATRIX,
    MIDDLE,
    OF_FILMS,
    PERFECT,
    POINTS,
    SPANNING,
    X,
    Y,
    beside_a_pore,
    body,
)
from spared import slow_but

from demheat import Box, Convection, Cylinder, Layer, Material, Radiation, Sphere, dem, solve
from demheat.scene.perfect import INFINITE
from demheat.scene.shapes import Union
from references.exact import lattice


@pytest.fixture(autouse=True)
def coarse_without_infinities():
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        warnings.simplefilter("ignore", UserWarning)
        yield


BODIES = perfect_bodies.BODIES | {
    "layer at a wall": lambda k: body(Layer(0, 0.0, 0.4, k), **X),
    "layer that resists": lambda k: body(Layer(0, 0.3, 0.7, k, resistance=0.1), **CELL),
    "rod": lambda k: body(Cylinder(MIDDLE, 0.2, (1, 0.2, 0), k, length=0.6), **X),
    "union": lambda k: body(Union([Sphere((0.4, 0.5, 0.5), 0.2, k), Box((0.6, 0.5, 0.5), (0.3, 0.2, 0.2), k)], k), **X),
    "unlike": lambda k: body(
        Sphere((0.3, 0.4, 0.5), 0.2, k),
        Sphere((0.75, 0.6, 0.5), 0.15, k, resistance=0.02),
        Sphere((0.2, 0.85, 0.2), 0.1, Material(7.0)),
        **X,
    ),
}


@pytest.mark.parametrize(
    "name", slow_but({"across faces", "half at a flux", "layer that resists", "union", "unlike"}, BODIES)
)
def test_the_limit_of_good_conductors(name):
    """At 1e6 times the matrix's conductivity all is off by some millionths, by its own."""
    perfect, good = (solve(BODIES[name](Material(k)), particles=1000) for k in (math.inf, MATRIX * 1e6))
    assert_allclose(perfect.conductivity, good.conductivity, rtol=2e-5)
    assert_allclose(perfect.temperature_at(POINTS), good.temperature_at(POINTS), rtol=0, atol=2e-4)
    most = np.abs(good.flux_at(POINTS)).max()
    assert_allclose(perfect.flux_at(POINTS), good.flux_at(POINTS), rtol=0, atol=1e-4 * most)
    assert_allclose(perfect.mean_flux, good.mean_flux, rtol=0, atol=2e-5 * np.abs(good.mean_flux).max())
    assert perfect.scene.perfect
    assert perfect.error.lower < perfect.conductivity < perfect.error.upper
    # Bodies are one unknown each, and good ones, too: a contrast that neither sees.
    assert perfect.stats["unknowns"] == good.stats["unknowns"]
    assert perfect.stats["iterations"] <= good.stats["iterations"]
    if not perfect.scene.periodic:
        heat = perfect.wall_heat
        # What goes in comes out, to the solver's tolerance over a hundred wall cells.
        assert_allclose(heat["x-"], -heat["x+"], rtol=1e-6)


@pytest.mark.parametrize("resistance", [0.0, 0.2])
def test_a_cubic_array(resistance):
    radius = lattice.radius("sc", 0.4)
    scene = body(Sphere(MIDDLE, radius, PERFECT, resistance=resistance * radius / MATRIX), **X)
    expected = lattice.conductivity("sc", math.inf, 0.4, resistance=resistance)
    # At contrast 1e6: .33 % and .0013 %.
    assert_allclose(solve(scene, particles=5000).conductivity / MATRIX, expected, rtol=5e-3 if not resistance else 1e-4)


def test_layers_are_exact_and_one_temperature():
    field = solve(body(Layer(0, 0.3, 0.7, PERFECT), **X), particles=1000)
    assert_allclose(field.conductivity, MATRIX / 0.6, rtol=1e-7)
    inside = POINTS * (0.3, 1, 1) + (0.35, 0, 0)
    # The best there is: 1e8 times the matrix's conductivity.
    assert_allclose(field.temperature_at(inside), 25.0, rtol=0, atol=1e-6)
    assert_allclose(field.flux_at(inside), np.tile(field.mean_flux, (len(inside), 1)), rtol=0, atol=1e-4)


def test_a_film_between_two_perfect_layers():
    """What resists parts them, and heat crosses it."""
    for load in (X, CELL):
        assert_allclose(solve(body(*FILMS, **load), particles=1000).conductivity, OF_FILMS, rtol=1e-7)


def test_multigrid_and_all_axes():
    scene = body(Sphere(MIDDLE, 0.4, PERFECT), **X)
    by_size, multigrid = (solve(scene, particles=2000, solver=solver).conductivity for solver in ("cg", "amg"))
    assert_allclose(multigrid, by_size, rtol=1e-7)
    fields = dem.solve_axes(scene, particles=2000)
    assert_allclose(fields[0].conductivity, by_size, rtol=1e-12)
    assert [field.scene.axis for field in fields] == [0, 1, 2]


@pytest.mark.parametrize("scene", SPANNING.values(), ids=SPANNING)
def test_what_spans_is_infinite(scene):
    with pytest.raises(ValueError, match=INFINITE):
        solve(scene, particles=1000)


ONE_BOX = body(Box((0.4, 0.5, 0.5), (0.6, 0.4, 0.4), PERFECT), **X)
ONE_BALL = body(Sphere(MIDDLE, 0.3, PERFECT), **X)
ALIKE = {
    "boxes that touch": (body(*(Box((x, 0.5, 0.5), (0.3, 0.4, 0.4), PERFECT) for x in (0.25, 0.55)), **X), ONE_BOX),
    "a ball in a ball": (body(Sphere(MIDDLE, 0.3, PERFECT), Sphere(MIDDLE, 0.2, PERFECT), **X), ONE_BALL),
}


@pytest.mark.parametrize("name", ALIKE)
def test_what_touches_is_one_body(name):
    found, expected = (solve(scene, particles=1000) for scene in ALIKE[name])
    # Twins on the surface between move cells beside it: 1e-5 and 2e-5 were found.
    assert_allclose(found.conductivity, expected.conductivity, rtol=1e-4)
    assert np.ptp(found.temperature_at([[0.3, 0.5, 0.5], [0.5, 0.5, 0.5], [0.6, 0.5, 0.5]])) < 1e-6


@pytest.mark.parametrize("load", [X, Y, CELL, {"gradient": (0.0, 10.0, 0.0)}], ids=["x", "y", "cell x", "cell y"])
def test_chains_are_more_than_good_ones(load):
    """Heat finds its way through contacts in points as the logarithm of the contrast, at 1e12, too."""

    def chain(k):
        return body(*(Sphere((0.2 + 0.2 * n, 0.5, 0.5), 0.1, Material(k)) for n in range(3)), **load)

    perfect, good = (solve(chain(k), particles=3000) for k in (math.inf, MATRIX * 1e12))
    # Of the load along the chain 1.5 % were found, across it nothing.
    assert good.conductivity * (1 - 1e-6) < perfect.conductivity < 1.03 * good.conductivity
    # Of 10 K; through the contacts heat finds its way at a contrast of 1e8: 6e-4 K were found.
    assert np.ptp(perfect.temperature_at([[0.2, 0.5, 0.5], [0.4, 0.5, 0.5], [0.6, 0.5, 0.5]])) < 2e-3


def test_a_ball_that_touches_a_wall_is_held():
    field = solve(body(Sphere((0.25, 0.5, 0.5), 0.25, PERFECT), **X), particles=2000)
    assert_allclose(field.temperature_at([[0.2, 0.5, 0.5], [0.4, 0.5, 0.5]]), 20.0, rtol=0, atol=1e-4)
    assert_allclose(field.wall_heat["x-"], -field.wall_heat["x+"], rtol=1e-6)


# A pore across the cell beside it: percolating, and half of the section.
ALONG = body(Box((0.5, 0.25, 0.5), (1.0, 0.5, 1.0), Material(2.0)), matrix=0.0, **X)


@pytest.mark.parametrize(("scene", "expected"), [*FROM_ZERO.values(), (ALONG, 1.0)], ids=[*FROM_ZERO, "along a pore"])
def test_from_zero_to_infinity(scene, expected):
    """Exact layers; the solver's tolerance."""
    assert_allclose(solve(scene, particles=1000).conductivity, expected, rtol=1e-7)


def test_pores_beside():
    perfect, good = (solve(beside_a_pore(Material(k)), particles=2000) for k in (math.inf, MATRIX * 1e6))
    assert_allclose(perfect.conductivity, good.conductivity, rtol=2e-5)
    assert np.isnan(perfect.temperature_at([[0.75, 0.5, 0.5]])[0])


def test_convection_beside():
    def scene(k):
        return body(Sphere((1.0, 0.5, 0.5), 0.2, Material(k)), walls={"x-": 0.0, "x+": Convection(3.0, 1.0)})

    perfect, good = (solve(scene(k), particles=2000) for k in (math.inf, MATRIX * 1e6))
    assert_allclose(perfect.wall_heat["x-"], good.wall_heat["x-"], rtol=2e-5)


@pytest.mark.parametrize(
    "scene",
    [
        body(Sphere(MIDDLE, 0.2, PERFECT), walls={"x-": 300.0, "x+": Radiation(0.5, 400.0)}),
        body(
            Sphere(MIDDLE, 0.2, PERFECT), Sphere((0.1, 0.1, 0.1), 0.05, Material(1.0, dependence=[(0, 1), (1, 2)])), **X
        ),
    ],
    ids=["radiation", "dependence"],
)
def test_what_particles_do_not_know_is_refused(scene):
    with pytest.raises(NotImplementedError) as error:
        solve(scene, particles=1000)
    assert "\n" not in str(error.value)


def test_a_gap_to_a_wall_that_cells_close():
    near = Box((0.5, 0.5, 0.5), (0.9998, 0.5, 0.5), PERFECT)
    try:
        field = solve(body(near, **X), particles=300)
    except NotImplementedError as error:
        assert "too thin for these particles" in str(error)  # noqa: PT017 - either is right
    else:
        # Gaps of 1e-4 on either side, .25 wide: that much heat at least.
        assert field.conductivity > 0.25 * MATRIX / 2e-4


def test_a_narrow_gap_with_many_particles():
    """The equations of nodes are aimed anew until what is left is small beside what passes: one aim missed it."""
    field = solve(body(Sphere(MIDDLE, 0.5 / 1.005, PERFECT), **CELL), particles=30_000)
    # By lattice sums; a gap of a hundredth is some particles' fifths wide.
    assert_allclose(field.conductivity / MATRIX, 7.65173, rtol=1e-2)
