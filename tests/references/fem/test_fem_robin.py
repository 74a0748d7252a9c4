"""Convection and radiation at walls by finite elements: exact where temperatures are linear, and beside series."""

import math

import numpy as np
import pytest
from fem_scenes import ELEMENTS, KINDS, UNIT, cube, last, scene
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from demheat import Convection, Flux, Layer, Material, Radiation, Sphere, referee
from demheat.scene import STEFAN_BOLTZMANN
from references import fem, mesh, series
from references.fem.bricks import hexahedra
from references.fem.robin import RobinWalls, on_triangles

COARSE = 0.4
POINTS = np.random.default_rng(3).random((40, 3))


@pytest.mark.parametrize("elements", ELEMENTS)
@pytest.mark.parametrize(
    "walls",
    [(100.0, Convection(3.0, 20.0)), (Convection(0.1, 20.0), 100.0), (Convection(50.0, -5.0), Convection(0.3, 60.0))],
)
def test_slab_with_convection_is_exact(walls, elements):
    field = fem.solve(scene(walls=dict(zip(("y-", "y+"), walls, strict=True))), size=COARSE, **elements)
    (low, a), (high, b) = ((0.0, w) if isinstance(w, float) else (1 / w.coefficient, w.temperature) for w in walls)
    flux = (a - b) / (low + 1.0 + high)
    # Linear temperatures are in the space of the elements: the tolerance of 1e-9.
    assert_allclose(field.temperature_at(POINTS), a - flux * (low + POINTS[:, 1]), atol=1e-6)
    assert_allclose(field.wall_temperature["y+"], b + flux * high, atol=1e-6)
    assert_allclose([field.wall_heat["y-"], field.wall_heat["y+"]], [flux, -flux], rtol=1e-6)
    assert_allclose(field.conductivity, 1.0, rtol=1e-6)


@pytest.mark.parametrize("elements", ELEMENTS)
@pytest.mark.parametrize(("hot", "around"), [(1000.0, 300.0), (3.0, 5000.0)])
def test_slab_that_radiates(hot, around, elements):
    made = scene(matrix=100.0, walls={"x-": hot, "x+": Radiation(0.98, around)})
    field = fem.solve(made, size=COARSE, **elements)
    right = brentq(
        lambda T: 100.0 * (hot - T) - 0.98 * STEFAN_BOLTZMANN * (T**4 - around**4), 0.0, 1e4, xtol=1e-12, rtol=1e-15
    )
    assert_allclose(field.wall_temperature["x+"], right, rtol=1e-8)
    assert_allclose(field.wall_heat["x+"], -100.0 * (hot - right), rtol=1e-7)
    assert field.stats["residual"] <= 1e-9 and field.stats["rounds"] <= 15
    assert_allclose(sum(field.wall_heat.values()), 0.0, atol=1e-7 * abs(field.wall_heat["x+"]))


def test_the_order_of_the_walls_does_not_matter():
    """Temperatures count from the first wall's: at an edge a held wall's nodes may be part of a film."""
    walls = {"x-": 400.0, "y-": Convection(3.0, 20.0), "x+": Flux(5.0), "z+": Radiation(0.9, 350.0)}
    one, other = (fem.solve(scene(walls=dict(each)), size=COARSE) for each in (walls.items(), reversed(walls.items())))
    # The tolerance of 1e-9.
    assert_allclose(one.temperature_at(POINTS), other.temperature_at(POINTS), atol=1e-5)
    for field in (one, other):
        assert_allclose(sum(field.wall_heat.values()), 0.0, atol=1e-6 * field.wall_heat["x-"])
    assert_allclose(one.wall_heat["y-"], other.wall_heat["y-"], rtol=1e-7)


@pytest.mark.parametrize("load", [Convection(3.0, 20.0), Radiation(0.5, 20.0)])
def test_a_body_at_rest_has_the_temperature_of_its_surroundings(load):
    field = fem.solve(scene(Layer(0, 0.4, 0.6, Material(0.0)), walls={"x-": 100.0, "x+": load}), size=COARSE)
    assert_allclose(field.temperature_at([[0.9, 0.5, 0.5], [0.1, 0.5, 0.5]]), [20.0, 100.0], rtol=1e-12)
    assert field.wall_heat == {"x-": 0.0, "x+": 0.0}


def test_radiation_that_is_not_met_is_an_error(monkeypatch):
    monkeypatch.setattr("references.fem.radiation.ROUNDS", 1)
    with pytest.raises(RuntimeError, match="1 rounds of Newton's method"):
        fem.solve(scene(walls={"x-": 1000.0, "x+": Radiation(0.98, 300.0)}), size=COARSE)


def surfaces():
    made = mesh.make(scene(), size=COARSE, order=2)
    yield on_triangles(made, made.walls["y+"].triangles), made.points
    space = hexahedra(cube(), COARSE)
    yield space.walls["y+"].surface(), space.points


def test_integrals_over_a_wall():
    for surface, points in surfaces():
        on, x = points[:, 1] == 1.0, points[:, 0]
        assert_allclose(surface.load(1.0).sum(), 1.0, rtol=1e-14)
        assert not surface.load(1.0)[~on].any()
        # Integrals of x and x^2 over the unit square; x is in both spaces.
        assert_allclose(surface.load(1.0) @ x, 1 / 2, rtol=1e-13)
        assert_allclose(x @ surface.matrix(1.0) @ x, 1 / 3, rtol=1e-13)
        assert_allclose(surface.load(surface.at(x) ** 4).sum(), 1 / 5, rtol=1e-13)


def test_the_tangent_of_radiation():
    for surface, points in surfaces():
        robin = RobinWalls({"y+": (Radiation(0.7, 300.0), surface)}, len(points))
        warm, change = 500.0 + 100.0 * points[:, 0], np.random.default_rng(0).random(len(points))
        up, down = (robin.radiated({"y+": 300.0}, warm + sign * 0.1 * change) for sign in (1, -1))
        found = -(robin.tangent(warm) @ change)
        # Central differences of a fourth power: (0.1/500)^2.
        assert_allclose((up - down) / 0.2, found, rtol=1e-6, atol=1e-9 * np.abs(found).max())
        assert_allclose(
            robin.radiated({"y+": 300.0}, warm).sum(), robin.entering({"y+": 300.0}, warm)["y+"], rtol=1e-12
        )


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("walls", [{"y-": 1.0, "y+": Convection(2.0, 0.0)}, {"y-": Convection(0.7, 1.0)}])
def test_slab_in_time_against_the_series(walls, kind):
    made, times, size = cube(walls=walls), [0.05, 0.3], 0.25 if kind.get("order") == 2 else 0.125
    for field, right in zip(fem.evolve(made, times, size=size, **kind), series.evolve(made, times), strict=True):
        # Second order in h = 1/8 before a front of a quarter, and less of it later: h^2 / 8 times a curvature of 10.
        off = referee.rms(field.temperature_at(POINTS) - right.temperature_at(POINTS))
        assert off < (0.02 if field.time < 0.1 else 0.004)
        for name in walls:
            largest = max(map(abs, right.wall_heat.values()))
            assert_allclose(field.wall_temperature[name], right.wall_temperature[name], atol=0.01)
            assert_allclose(field.wall_heat[name], right.wall_heat[name], atol=0.05 * largest)
    assert field.stats["energy_error"] < 1e-8


def test_surroundings_that_change():
    made = cube(Material(1e4, 1.0, 1.0), walls={"x-": Convection(2.0, lambda t: 3.0 * t)})
    field = last(made, [1.0], size=0.5, elements="hexahedra")
    assert_allclose(field.temperature_at(POINTS), 3.0 * (0.5 + 0.5 * math.exp(-2.0)), atol=1e-3)


def test_a_blaze_in_one_step():
    """Tangents of the step's start, at 300 K, are a thousandth of those at its end."""
    made = cube(walls={"x-": Radiation(1.0, 3000.0)}, initial=300.0)
    field = last(made, [0.05], size=0.25, elements="hexahedra", step=0.05)
    # A film of 6 kW/(m2 K) before 1 W/(m K): the wall is nearly as warm as what it sees.
    assert 2900.0 < field.wall_temperature["x-"] < 3000.0 and field.stats["energy_error"] < 1e-8


def test_steps_of_radiation_halve():
    made = cube(
        Material(50.0, 1000.0, 1.0),
        walls={"x-": 1200.0, "x+": Radiation(1.0, 300.0)},
        initial=lambda x: 1200.0 - 900.0 * x[:, 0],
    )
    right, *others = (
        last(made, [4.0], size=0.3, elements="hexahedra", step=4.0 / n).temperature_at(POINTS) for n in (128, 4, 8, 16)
    )
    errors = [np.sqrt(np.mean((other - right) ** 2)) for other in others]
    # Second order.
    assert errors[2] < 0.5 and all(a / b > 3.0 for a, b in zip(errors[:-1], errors[1:], strict=True))


def test_a_composite_keeps_its_heat_in_time():
    walls = {"x-": Convection(3.0, 500.0), "x+": Radiation(0.9, 300.0), "y-": Flux(30.0), "z+": 400.0}
    made = cube(inclusions=[Sphere((0.5, 0.5, 0.5), 0.3, Material(20.0, 2.0, 3.0))], walls=walls, initial=400.0)
    field = last(made, [0.05, 0.2], size=0.4, order=1)
    assert field.stats["energy_error"] < 1e-7 and set(field.stats["heat_in"]) == {*walls, "sources"}
    assert UNIT.conductivity == 1.0
