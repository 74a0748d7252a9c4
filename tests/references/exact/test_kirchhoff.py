"""k(T) in closed form: the slope of the temperature times its own k is one flux; which scenes have a transform."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Convection, Dependence, Flux, Layer, Material, Scene, Sphere
from references import exact
from references.exact.kirchhoff import linear

RISING, FALLING = Dependence.linear(0.02, 20.0, (0.0, 100.0)), Dependence([(0, 2.0), (40, 0.5), (100, 1.0)])
WALLS = {"y-": 0.0, "y+": 100.0}


def body(*shapes, k=2.0, own=RISING, **walls):
    return Scene((1.0, 1.0, 1.0), Material(k, dependence=own), shapes, walls=walls or WALLS)


def test_a_slab_conducts_the_mean_over_its_temperatures():
    field = exact.solve(body())
    assert_allclose(field.conductivity, 2.0 * RISING.mean(0.0, 100.0), rtol=1e-13)
    points = np.random.default_rng(0).random((20, 3))
    # 1 + beta (T - T0) is linear: theta is a square, T its root.
    theta = points[:, 1] * 160.0
    assert_allclose(field.temperature_at(points), (-0.6 + np.sqrt(0.36 + 0.04 * theta)) / 0.02, rtol=1e-12)


@pytest.mark.parametrize("resistance", [0.0, 0.3])
def test_layers_each_with_their_own(resistance):
    layer = Layer(1, 0.3, 0.7, Material(0.5, dependence=FALLING), resistance=resistance)
    field = exact.solve(body(layer))
    flux = field.mean_flux[1]
    points = np.random.default_rng(0).random((200, 3))
    step = 1e-5
    slope = (field.temperature_at(points + [0, step, 0]) - field.temperature_at(points - [0, step, 0])) / (2 * step)
    inside = np.min(np.abs(points[:, 1, None] - [0.3, 0.7]), axis=1) > step
    phase, warmth = field.scene.phase_at(points), field.temperature_at(points)
    k = field.scene.conductivities[phase] * field.scene.dependences.factor(phase, warmth)
    # A kink of the factor may lie within a step.
    assert_allclose((k * slope)[inside], -flux, rtol=1e-4)
    jumps = [
        float(np.diff(field.temperature_at(np.array([[0.5, y - 1e-12, 0.5], [0.5, y + 1e-12, 0.5]])))[0])
        for y in (0.3, 0.7)
    ]
    assert_allclose(jumps, -flux * resistance, atol=1e-7)
    assert_allclose(field.temperature_at(np.array([[0.5, 0.0, 0.5], [0.5, 1.0, 0.5]])), [0.0, 100.0], atol=1e-10)


def test_what_follows_alike_is_linear_in_the_transform():
    sphere = Sphere((0.5, 0.5, 0.5), 0.3, Material(20.0, dependence=RISING))
    plain = Scene((1, 1, 1), Material(2.0), [Sphere((0.5,) * 3, 0.3, Material(20.0))], walls=WALLS)
    field, simple = exact.solve(body(sphere)), exact.solve(plain)
    assert_allclose(field.conductivity, simple.conductivity * RISING.mean(0.0, 100.0), rtol=1e-12)
    points = np.random.default_rng(0).random((20, 3))
    assert_allclose(RISING.integral(field.temperature_at(points)), 1.6 * simple.temperature_at(points), rtol=1e-10)
    assert field.stats["form"] == "sc array, Kirchhoff"


def test_imposed_fluxes_stay():
    field = exact.solve(body(**{"y-": 0.0, "y+": Flux(100.0)}))
    assert_allclose(field.wall_heat["y+"], 100.0, rtol=1e-13)
    assert_allclose(field.wall_temperature["y+"], RISING.inverse(50.0), rtol=1e-12)


@pytest.mark.parametrize(
    "scene",
    [
        body(Sphere((0.5,) * 3, 0.3, Material(1.0))),
        body(Sphere((0.5,) * 3, 0.3, Material(1.0, dependence=FALLING))),
        body(Sphere((0.5,) * 3, 0.3, Material(1.0, dependence=RISING), resistance=0.1)),
        body(**{"y-": 0.0, "y+": Convection(3.0, 20.0)}),
        Scene((1, 1, 1), Material(1.0), walls=WALLS),
    ],
)
def test_what_is_not_linear_has_no_transform(scene):
    assert linear(scene) is None


def test_pores_do_not_matter():
    pore = body(Sphere((0.5,) * 3, 0.3, Material(0.0)))
    found, own = linear(pore)
    assert own == RISING and not found.varies
    assert_allclose(
        exact.solve(pore).conductivity / exact.solve(found).conductivity, RISING.mean(0.0, 100.0), rtol=1e-12
    )
