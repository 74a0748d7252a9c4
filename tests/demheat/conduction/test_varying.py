"""Only here: conductances that follow the temperature, exact where Kirchhoff's transform is."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import demheat
from demheat import Convection, Dependence, Flux, Layer, Material, Radiation, Scene, Sphere, dem
from demheat.conduction import varying
from demheat.sampling.halo import halo_flux
from demheat.tensor import conductivity_tensor
from references import exact
from references.exact.kirchhoff import linear

RISING, FALLING = Dependence.linear(0.02, 20.0, (0.0, 100.0)), Dependence([(0, 2.0), (40, 0.5), (100, 1.0)])
WALLS = {"y-": 0.0, "y+": 100.0}
POINTS = np.random.default_rng(0).random((200, 3))
# What the equations leave: the tolerance, times the condition of some thousand equations at most.
TIGHT, LEFT = {"particles": 1000, "tolerance": 1e-11}, 1e-8


def body(*shapes, k=2.0, own=RISING, walls=WALLS):
    return Scene((1.0, 1.0, 1.0), Material(k, dependence=own), shapes, walls=walls)


def sphere(k=20.0, own=RISING, **more):
    return Sphere((0.5, 0.5, 0.5), 0.3, Material(k, dependence=own), **more)


@pytest.mark.parametrize(
    "layers",
    [
        (),
        (Layer(1, 0.3, 0.7, Material(0.5, dependence=FALLING)),),
        (Layer(1, 0.3, 0.7, Material(0.5, dependence=FALLING), resistance=0.3),),
        (Layer(1, 0.0, 0.5, Material(30.0)),),
    ],
)
def test_layers_are_exact(layers):
    field, right = demheat.solve(body(*layers), **TIGHT), exact.solve(body(*layers))
    assert_allclose(field.conductivity, right.conductivity, rtol=LEFT)
    assert field.stats["residual"] <= 1e-11 and field.stats["rounds"] > 3
    samples = field.samples
    assert_allclose(samples.temperature, right.temperature_at(samples.points), atol=100 * LEFT)
    assert_allclose(samples.flux, right.flux_at(samples.points), atol=1e-6 * abs(right.mean_flux[1]))
    # Between particles, too: what is fitted is the transform.
    assert_allclose(field.temperature_at(POINTS), right.temperature_at(POINTS), atol=1e-5)
    assert_allclose(field.flux_at(POINTS), right.flux_at(POINTS), atol=1e-5 * abs(right.mean_flux[1]))
    assert_allclose(field.heat_through(1, 0.4), right.mean_flux[1], rtol=LEFT)


def test_what_follows_alike_is_the_linear_network_in_the_transform():
    """To the residual, not to the error of the packing."""
    simple, own = linear(body(sphere()))
    field, plain = demheat.solve(body(sphere()), **TIGHT), demheat.solve(simple, **TIGHT)
    assert_allclose(field.mean_flux, plain.mean_flux, rtol=LEFT, atol=LEFT * abs(plain.mean_flux[1]))
    assert_allclose(field.temperature_at(POINTS), own.inverse(plain.temperature_at(POINTS)), atol=1e-5)
    assert_allclose(field.flux_at(POINTS), plain.flux_at(POINTS), atol=1e-6 * abs(plain.mean_flux[1]))


def test_pores_and_what_nothing_reaches():
    pore = (sphere(0.0, None), Sphere((0.5, 0.5, 0.5), 0.1, Material(3.0, dependence=FALLING)))
    simple = (sphere(0.0, None), Sphere((0.5, 0.5, 0.5), 0.1, Material(3.0)))
    field = demheat.solve(body(*pore), **TIGHT)
    plain = demheat.solve(Scene((1.0, 1.0, 1.0), Material(2.0), simple, walls={"y-": 0.0, "y+": 160.0}), **TIGHT)
    assert_allclose(field.mean_flux[1], plain.mean_flux[1], rtol=LEFT)
    assert np.isnan(field.temperature_at(np.array([[0.5, 0.5, 0.5], [0.5, 0.75, 0.5]]))).all()


@pytest.mark.parametrize("load", [Flux(150.0), Convection(5.0, 100.0), Radiation(0.9, 150.0)])
def test_other_walls(load):
    """Theta is linear in the slab: what enters is its slope, and what the wall lets in at its own temperature."""
    field = demheat.solve(body(walls={"y-": 0.0, "y+": load}), **TIGHT)
    heat, end = field.wall_heat["y+"], field.wall_temperature["y+"]
    assert_allclose(2.0 * RISING.integral(end), heat, rtol=1e-7)
    if isinstance(load, Radiation):
        expected = 0.9 * demheat.scene.STEFAN_BOLTZMANN * (150.0**4 - end**4)
    else:
        expected = 150.0 if isinstance(load, Flux) else 5.0 * (100.0 - end)
    assert_allclose(heat, expected, rtol=1e-7)
    points = np.column_stack([np.full(9, 0.5), np.linspace(0.05, 0.95, 9), np.full(9, 0.5)])
    assert_allclose(2.0 * RISING.integral(field.temperature_at(points)), heat * points[:, 1], rtol=1e-4)
    assert_allclose(halo_flux(field, walls="mirror", ratio=3.0)[:, 1], -heat, rtol=1e-4)


def test_loads_along_all_axes():
    scene = body(Layer(1, 0.3, 0.7, Material(0.5, dependence=RISING)))
    found = conductivity_tensor(dem.solve_axes(scene, **TIGHT))
    assert_allclose(found, conductivity_tensor(exact.solve_axes(scene)), rtol=1e-7, atol=1e-12)


def test_what_does_not_converge_says_so(monkeypatch):
    monkeypatch.setattr(varying, "ROUNDS", 2)
    with pytest.raises(RuntimeError, match="relative residual .* after 2 rounds"):
        demheat.solve(body(), particles=500)


REFUSING = {
    "facets anywhere": {"conforming": False},
    "arithmetic mean": {"interface": "arithmetic"},
    "contacts": {"law": "calibrated", "wall": "surface"},
    "platonic": {"law": "platonic"},
}


@pytest.mark.parametrize("what", REFUSING)
def test_laws_without_facets_on_interfaces_say_so(what):
    with pytest.raises(NotImplementedError, match="Material.dependence in phase 0.*only law 'laguerre' with") as error:
        demheat.solve(body(), particles=1000, **REFUSING[what])
    assert "\n" not in str(error.value)


def test_transients_say_so():
    metal = Material(1.0, 1.0, 1.0, dependence=RISING)
    scene = Scene((1, 1, 1), metal, walls={"x-": 0.0}, initial=1.0)
    with pytest.raises(NotImplementedError, match="is for steady states"):
        next(demheat.evolve(scene, [1.0], particles=1000))
