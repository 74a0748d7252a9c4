"""Exact transients by finite volumes and by the equations: methods in time stand on them."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from demheat import Flux, Layer, Material, MovingCylinder, Scene, UniformSource
from references.exact.series import evolve

# Haddad et al. (2021): steel of the slab, aluminium of the sphere.
SLAB, SPHERE = Material(33.0, 7800.0, 0.9), Material(185.0, 2700.0, 900.0)
ONE = Material(2.0, 4.0, 0.25)  # diffusivity 2


def last(scene, time, **knobs):
    (field,) = evolve(scene, [time], **knobs)
    return field


def slab(axis=1, size=(0.5, 2.0, 1.5), initial=3.0, sources=(), **walls):
    walls = {"xyz"[axis] + {"low": "-", "high": "+"}[name]: load for name, load in walls.items()}
    return Scene(size, ONE, walls=walls, initial=initial, sources=sources)


LOADS = {
    "held": {"low": 5.0, "high": -2.0},
    "held-insulated": {"low": 5.0},
    "insulated-held": {"high": 5.0},
    "flux-held": {"low": Flux(7.0), "high": 1.0},
    "flux": {"high": Flux(7.0)},
    "fluxes": {"low": Flux(-3.0), "high": Flux(7.0)},
    "insulated": {},
}


@pytest.mark.parametrize(
    ("time", "expected"),
    [
        (0.05, (25.0054, 25.2110, 27.4889, 31.4464)),
        (0.1, (25.1440, 26.0296, 29.1488, 32.4432)),
        (0.2, (25.7976, 27.4834, 30.6420, 33.1761)),
    ],
)
def test_slab_of_haddad(time, expected):
    scene = Scene((0.1, 0.1, 0.1), SLAB, walls={"y-": 25.0, "y+": 35.0}, initial=25.0)
    points = np.array([(0.03, y, 0.07) for y in (0.025, 0.05, 0.075, 0.09)])
    # Half of the last digit of values worked out apart, by finite volumes and another sum.
    assert_allclose(last(scene, time).temperature_at(points), expected, rtol=0, atol=5e-5)


def test_sphere_of_haddad():
    scene = Scene((0.1,) * 3, SPHERE, domain="sphere", walls={"round": 200.0}, initial=20.0)
    fields = list(evolve(scene, (1, 5, 10, 30)))
    assert [field.time for field in fields] == [1, 5, 10, 30]
    found = [field.temperature_at(np.full(3, 0.05))[0] for field in fields]
    assert_allclose(found, (20.31666, 120.77809, 182.17817, 199.95631), rtol=0, atol=5e-6)  # as above


@pytest.mark.parametrize("load", LOADS)
def test_against_finite_volumes(load):
    """Two hundred cells, integrated to 1e-9 in time: their own error is the square of the cell."""
    walls, n, length, power = LOADS[load], 200, 2.0, 5.0
    scene = slab(sources=[UniformSource(power)], **walls)
    h, k, capacity = length / n, ONE.conductivity, 1.0

    def rate(_, temperature):
        heat = np.zeros(n + 1)
        heat[1:-1] = -k * np.diff(temperature) / h
        for name, end, sign, cell in (("low", 0, 1, 0), ("high", n, -1, -1)):
            wall = walls.get(name, Flux(0.0))
            into = wall.value if isinstance(wall, Flux) else 2 * k * (wall - temperature[cell]) / h
            heat[end] = sign * into
        return (-np.diff(heat) / h + power) / capacity

    times = [0.01, 0.1, 0.7]
    cells = solve_ivp(rate, (0, times[-1]), np.full(n, 3.0), "LSODA", times, rtol=1e-9, atol=1e-9, lband=1, uband=1)
    middles = (np.arange(n) + 0.5) * h
    points = np.column_stack([0 * middles + 0.1, middles, 0 * middles + 0.3])
    for field, expected in zip(evolve(scene, times), cells.y.T, strict=True):
        # h^2 / (8 * diffusivity * time) is 6e-4 at the first time, of steps up to 5 K; later less.
        assert_allclose(field.temperature_at(points), expected, rtol=0, atol=4e-3)


def slope(field, points, step=1e-5):
    """Gradient by central differences."""
    moves = step * np.eye(3)
    sides = [field.temperature_at(points + move) - field.temperature_at(points - move) for move in moves]
    return np.stack(sides, axis=1) / (2 * step)


BODIES = {
    "box": slab(axis=2, low=5.0, high=Flux(3.0), sources=[UniformSource(5.0)]),
    "cylinder": Scene((1, 1, 2), ONE, domain="cylinder-z", walls={"z-": 5.0, "z+": -2.0}, initial=3.0),
    "sphere": Scene((1, 1, 1), ONE, domain="sphere", walls={"round": 5.0}, initial=3.0, sources=[UniformSource(5.0)]),
}


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("fourier", [0.008, 0.05])  # images, modes
def test_fourier_and_the_heat_equation(name, fourier):
    scene = BODIES[name]
    time = fourier * (0.5 if name == "sphere" else scene.size[2]) ** 2 / 2.0
    dt = 1e-4 * time
    rng = np.random.default_rng(0)
    # Off the walls, where differences would look outside.
    points = np.array(scene.size) * (0.5 + 0.28 * (2 * rng.random((40, 3)) - 1))
    early, field, late = evolve(scene, (time - dt, time, time + dt))
    flux = field.flux_at(points)
    # Differences: steps squared over the width of the layer squared.
    assert_allclose(flux, -2.0 * slope(field, points), rtol=0, atol=1e-5)
    step = 1e-4
    spread = sum(
        (field.flux_at(points + move)[:, k] - field.flux_at(points - move)[:, k]) / (2 * step)
        for k, move in enumerate(step * np.eye(3))
    )
    rate = (late.temperature_at(points) - early.temperature_at(points)) / (2 * dt)
    power = sum(source.power_density for source in scene.sources)
    assert np.abs(rate).max() > 0.1 and np.abs(flux).max() > 1e-3
    assert_allclose(rate, -spread + power, rtol=0, atol=1e-4 * np.abs(rate).max() + 1e-5)


@pytest.mark.parametrize("name", BODIES)
def test_heat_is_conserved(name):
    """Heat stored between two times is what came through the walls and from the sources."""
    scene = BODIES[name]
    start, stop = 0.02, 0.15
    nodes, weights = np.polynomial.legendre.leggauss(40)
    times = (start + stop) / 2 + (stop - start) / 2 * nodes
    first, *fields, end = evolve(scene, [start, *times, stop], points_per_axis=40)
    walls = sum(w * sum(field.wall_heat.values()) for w, field in zip(weights, fields, strict=True))
    power = sum(source.power_density for source in scene.sources) * scene.volume
    entered = (stop - start) * (walls / 2 + power)
    stored = (end.samples.temperature - first.samples.temperature) @ end.samples.volumes
    assert_allclose(stored, entered, rtol=2e-3)  # midpoint sums over 40 parts: 1/40^2 of the curvature
    assert abs(entered) > 0.05


@pytest.mark.parametrize("domain", ["box", "cylinder-y", "sphere"])
def test_samples_fill_the_body_evenly(domain):
    field = last(Scene((2, 2, 2), ONE, domain=domain, initial=3.0), 0.1, points_per_axis=16)
    points, volumes, temperature, phase, flux = field.samples
    assert_allclose(volumes.sum(), field.scene.volume, rtol=1e-13)
    assert_allclose(points.mean(axis=0), 1.0, atol=1e-12)
    spread = {"box": (1 / 3,) * 3, "sphere": (1 / 5,) * 3}.get(domain)
    spread = spread or [1 / 3 if letter == domain[-1] else 1 / 4 for letter in "xyz"]
    # Second moments of the body; midpoint sums over 16 parts are off by up to 1/16^2.
    assert_allclose(((points - 1) ** 2).mean(axis=0), spread, rtol=5e-3)
    assert_allclose(temperature, 3.0, rtol=1e-15)
    assert not flux.any() and not phase.any()
    assert_allclose(field.temperature_at(points), temperature, rtol=1e-15)


def test_mean_flux_is_that_of_the_samples():
    for name, field in ((name, last(scene, 0.05, points_per_axis=40)) for name, scene in BODIES.items()):
        mean = field.samples.flux.mean(axis=0)
        assert_allclose(mean, field.mean_flux, atol=2e-3 * np.abs(field.samples.flux).max(), err_msg=name)


def test_time_zero_and_outside():
    field = last(BODIES["sphere"], 0.0)
    assert field.temperature_at((0.5, 0.5, 0.5))[0] == 3.0 and field.wall_heat == {"round": math.inf}
    for evaluate in (field.temperature_at, field.flux_at):
        with pytest.raises(ValueError, match="outside the sphere"):
            evaluate((0.01, 0.01, 0.01))
    beam = last(slab(low=Flux(2.0), high=1.0), 0.0)
    assert beam.wall_heat == {"y-": 1.5, "y+": -math.inf}
    assert last(slab(low=3.0), 0.0).wall_heat == {"y-": 0.0}


def moving():
    return MovingCylinder(axis=2, diameter=0.1, power_density=1.0, start=(0.5, 0.5))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"inclusions": [Layer(0, 0.2, 0.5, Material(3.0, 1.0, 1.0))]}, "1 inclusions of other materials"),
        ({"matrix": Material(0.0, 1.0, 1.0)}, "conductivity = 0"),
        ({"initial": lambda points: points[:, 0]}, "initial is a function"),
        ({"sources": [moving()]}, "MovingCylinder"),
        ({"walls": {"y-": lambda time: time}}, "'y-'.* depends on time"),
        ({"walls": {"y-": Flux(lambda time: time)}}, "'y-'.* depends on time"),
        ({"walls": {"y-": 1.0, "x-": 2.0}}, "two axes"),
        ({"walls": {"round": 1.0}, "domain": "cylinder-z"}, "cylinder-z loaded at"),
        ({"walls": {"round": Flux(1.0)}, "domain": "sphere"}, "a flux through"),
    ],
)
def test_what_has_no_series_is_refused(change, words):
    scene = Scene(**{"size": (1, 1, 1), "matrix": ONE, "walls": {"y-": 1.0}, "initial": 0.0, **change})
    with pytest.raises(NotImplementedError, match=words):
        evolve(scene, [0.1])
