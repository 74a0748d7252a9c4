"""Elements whose k follows the temperature, beside Kirchhoff's transform: layers, spheres, resistances, walls."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Convection, Dependence, Flux, Layer, Material, Radiation, Scene, Sphere
from references import exact, fem
from references.fem import varying

RISING = Dependence.linear(0.02, 20.0, (0.0, 100.0))
WALLS = {"y-": 0.0, "y+": 100.0}
POINTS = np.random.default_rng(0).random((200, 3))


def body(*shapes, k=2.0, own=RISING, walls=WALLS):
    return Scene((1.0, 1.0, 1.0), Material(k, dependence=own), shapes, walls=walls)


@pytest.mark.parametrize("order", [1, 2])
def test_a_slab_conducts_the_mean_over_its_temperatures(order):
    """The integral of k(T) grad T is that of theta's, whatever the mesh: the quadrature of linear factors is exact."""
    field = fem.solve(body(), size=0.5, order=order)
    assert_allclose(field.conductivity, exact.solve(body()).conductivity, rtol=1e-9)
    assert field.stats["residual"] <= 1e-9 and field.stats["rounds"] > 3
    assert_allclose(sum(field.wall_heat.values()), 0.0, atol=1e-6)


def rms(field, right):
    return np.sqrt(np.mean((field.temperature_at(POINTS) - right.temperature_at(POINTS)) ** 2))


@pytest.mark.parametrize(("order", "rate"), [(1, 1.5), (2, 2.3)])
def test_temperatures_come_nearer_on_finer_meshes(order, rate):
    """Theory is an order more than that of the elements; the rate was set before, with half an order for the mesh."""
    layer = Layer(1, 0.3, 0.7, Material(0.5, dependence=RISING))
    scene = body(layer)
    coarse, fine = (rms(fem.solve(scene, size=size, order=order), exact.solve(scene)) for size in (0.25, 0.125))
    assert np.log2(coarse / fine) > rate


def test_spheres_follow_the_transform():
    sphere = Sphere((0.5, 0.5, 0.5), 0.3, Material(20.0, dependence=RISING))
    field, right = fem.solve(body(sphere), size=0.25), exact.solve(body(sphere))
    # Those of the linear scene on this mesh: 1e-3.
    assert_allclose(field.conductivity, right.conductivity, rtol=2e-3)
    assert rms(field, right) < 0.5
    samples = field.samples
    assert_allclose(samples.volumes @ samples.flux, field.mean_flux, rtol=1e-3, atol=0.1)


@pytest.mark.parametrize("load", [Flux(150.0), Convection(5.0, 100.0)])
def test_other_walls(load):
    """Theta is linear in the slab: of a flux by the flux, of a film by the root where it lets in what passes."""
    field = fem.solve(body(walls={"y-": 0.0, "y+": load}), size=0.2)
    heat, end = field.wall_heat["y+"], field.wall_temperature["y+"]
    assert_allclose(2.0 * RISING.integral(end), heat, rtol=5e-3)
    assert_allclose(heat, 150.0 if isinstance(load, Flux) else 5.0 * (100.0 - end), rtol=1e-7)
    assert_allclose(-field.wall_heat["y-"], heat, rtol=1e-6)


def test_surfaces_that_resist():
    layer = Layer(1, 0.3, 0.7, Material(0.5, dependence=RISING), resistance=0.3)
    field, right = fem.solve(body(layer), size=0.2), exact.solve(body(layer))
    assert_allclose(field.conductivity, right.conductivity, rtol=2e-3)


def test_pores():
    pore = Sphere((0.5, 0.5, 0.5), 0.3, Material(0.0))
    field, right = fem.solve(body(pore), size=0.3), exact.solve(body(pore))
    assert_allclose(field.conductivity, right.conductivity, rtol=2e-3)
    assert np.isnan(field.temperature_at(np.array([[0.5] * 3])))


def test_what_does_not_converge_says_so(monkeypatch):
    monkeypatch.setattr(varying, "ROUNDS", 2)
    with pytest.raises(RuntimeError, match="residual .* after 2 rounds"):
        fem.solve(body(), size=0.5)


def test_what_cannot_says_so():
    glowing = body(walls={"y-": 300.0, "y+": Radiation(0.8, 500.0)})
    words = "finite elements iterate for it or for walls that radiate"
    with pytest.raises(NotImplementedError, match=f"Material.dependence in phase 0.*{words}") as error:
        fem.solve(glowing)
    assert "\n" not in str(error.value)
