"""Only here: walls that exchange heat in time, against series with Biot numbers, lumped bodies and bricks."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from transient_scenes import last

from demheat import Convection, Flux, Material, Radiation, Scene, Sphere, UniformSource, evolve
from demheat.packing.cache import relaxed
from demheat.scene import STEFAN_BOLTZMANN
from references import fem, series

UNIT = Material(1.0, 1.0, 1.0)
BOX = (1.0, 1.0, 1.0)


def off(field, right):
    """Root mean square over the particles."""
    points, volumes, temperature, _, _ = field.samples
    return math.sqrt(volumes @ (temperature - right.temperature_at(points)) ** 2 / volumes.sum())


@pytest.mark.parametrize(
    ("walls", "integrator"),
    [
        *(({"y-": 1.0, "y+": Convection(2.0, 0.0)}, name) for name in ("euler", "rkl2", "tr-bdf2")),
        ({"y-": Convection(0.7, 1.0)}, "auto"),
    ],
)
def test_slab_with_convection_against_the_series(walls, integrator):
    scene, times = Scene(BOX, UNIT, walls=walls, initial=0.0), [0.05, 0.3]
    for field, right in zip(
        evolve(scene, times, particles=1000, integrator=integrator), series.evolve(scene, times), strict=True
    ):
        # Second order in the spacing of .1 before a front of .3, and less of it later: h^2 / 8 times a curvature of 5;
        # and of the heat, of which explicit steps err most at first.
        assert off(field, right) < 0.008
        for name in walls:
            assert_allclose(field.wall_temperature[name], right.wall_temperature[name], atol=0.02)
            largest = max(map(abs, right.wall_heat.values()))
            assert_allclose(
                field.wall_heat[name], right.wall_heat[name], atol=(0.1 if field.time < 0.1 else 0.06) * largest
            )
    assert field.stats["energy_error"] < 1e-10


def test_surroundings_that_change():
    """A lumped body follows its surroundings' ramp with a lag of its time constant, here 0.5 s."""
    scene = Scene(BOX, Material(1e3, 1.0, 1.0), walls={"x-": Convection(2.0, lambda t: 3.0 * t)}, initial=0.0)
    field = last(scene, [1.0], particles=100, accuracy=1e-4)
    right = 3.0 * (1.0 - 0.5 + 0.5 * math.exp(-2.0))
    # The body is as warm as one, but for a Biot number of 2e-3.
    assert_allclose(field.samples.temperature, right, atol=2e-3 * 3.0)
    assert_allclose(field.wall_heat["x-"], 2.0 * (3.0 - field.wall_temperature["x-"]), rtol=1e-12)


def test_a_round_wall():
    """A lumped sphere: what the film takes goes with the true surface, to the body's volume in facets."""
    scene = Scene(BOX, Material(1e4, 1.0, 1.0), walls={"round": Convection(2.0, 0.0)}, initial=1.0, domain="sphere")
    field = last(scene, [0.1], particles=600, accuracy=1e-5)
    assert_allclose(field.samples.temperature, math.exp(-2.0 * 6.0 * 0.1), atol=3e-4)


def lumped(around, rate, start, time):
    """Temperature of a body that loses rate (T^4 - around^4), K/s; closed form, solved for T by halving."""
    if around == 0:
        return (start**-3 + 3 * rate * time) ** (-1 / 3)

    def past(T):
        return (math.log((around + T) / abs(around - T)) + 2 * math.atan(T / around)) / (4 * around**3 * rate)

    low, high = min(start, around), max(start, around)
    for _ in range(200):
        middle = 0.5 * (low + high)
        # Warming bodies are warmer later, cooling ones colder.
        late = past(middle) - past(start) > time
        low, high = (low, middle) if late == (start < around) else (middle, high)
    return middle


@pytest.mark.parametrize(("around", "start"), [(0.0, 1000.0), (1000.0, 300.0), (400.0, 900.0)])
def test_a_lumped_body_radiates(around, start):
    walls = {"x-": Radiation(0.8, around), "z+": Radiation(0.2, around)}
    metal = Material(1e5, 1000.0, 1.0)
    scene = Scene(BOX, metal, walls=walls, initial=start)
    field = last(scene, [5.0], particles=100, accuracy=1e-4)
    right = lumped(around, STEFAN_BOLTZMANN / 1000.0, start, 5.0)
    # As warm as one but for a Biot number of up to 2e-3, and the accuracy asked for.
    assert_allclose(field.samples.temperature, right, atol=3e-3 * abs(start - around))
    assert abs(right - start) > 50.0 and field.stats["energy_error"] < 1e-10
    for name, load in walls.items():
        surface = field.wall_temperature[name]
        assert_allclose(field.wall_heat[name], load.emissivity * STEFAN_BOLTZMANN * (around**4 - surface**4), rtol=1e-3)


GLOWING = Scene(BOX, Material(50.0, 1000.0, 1.0), walls={"x-": 1200.0, "x+": Radiation(1.0, 300.0)}, initial=300.0)


@pytest.mark.parametrize(
    ("integrator", "counts", "order", "most"), [("rkl2", (16, 32, 64), 2, 0.1), ("euler", (1000, 2000), 1, 0.2)]
)
def test_steps_of_radiation_halve(integrator, counts, order, most):
    """Half the step, a half or a quarter of the error, beside tiny steps of second order on the same packing."""
    packing = relaxed(150, size=BOX, periodic=False, seed=0)

    def warmth(name, count):
        return last(GLOWING, [16.0], packing=packing, integrator=name, step=16.0 / count).samples.temperature

    right = warmth("rkl2", 512)
    errors = [np.sqrt(np.mean((warmth(integrator, count) - right) ** 2)) for count in counts]
    # Of a span of 900 K; an order less a tenth of it.
    assert errors[-1] < most and all(a / b > 2 ** (0.9 * order) for a, b in zip(errors[:-1], errors[1:], strict=True))


def test_radiation_in_time_beside_bricks():
    (right,) = fem.evolve(GLOWING, [8.0], elements="hexahedra", size=0.1)
    field = last(GLOWING, [8.0], particles=1000, accuracy=1e-4)
    points, volumes, temperature, _, _ = field.samples
    # Both of second order, elements of a tenth: of the span of 900 K; found below.
    assert math.sqrt(volumes @ (temperature - right.temperature_at(points)) ** 2 / volumes.sum()) < 0.005 * 900.0
    assert_allclose(field.wall_temperature["x+"], right.wall_temperature["x+"], atol=0.01 * 900.0)
    assert_allclose(field.wall_heat["x+"], right.wall_heat["x+"], rtol=0.02)


def test_explicit_steps_are_those_of_a_held_wall():
    """However well surroundings radiate, a step that is stable where the wall is held is stable."""
    packing = relaxed(150, size=BOX, periodic=False, seed=0)
    held = replace(GLOWING, walls={"x-": 1200.0, "x+": 300.0})
    limits = [last(scene, [0.1], packing=packing).stats["step_limit"] for scene in (GLOWING, held)]
    assert limits[0] == limits[1]
    blazing = replace(GLOWING, matrix=Material(1e-3, 1.0, 1.0), walls={"x+": Radiation(1.0, 3000.0)})
    field = last(blazing, [2000.0], packing=packing, integrator="euler")
    # A film of 6 kW/(m2 K) before a poor conductor: it is as warm as its surroundings. Steps at the limit swing by
    # 500 K at first; that dies out.
    assert_allclose(field.wall_temperature["x+"], 3000.0, rtol=1e-4)
    assert np.abs(field.samples.temperature - 3000.0).max() < 250.0


@pytest.mark.parametrize("integrator", ["tr-bdf2", "tr-bdf2-multigrid"])
def test_linear_stages_do_not_radiate(integrator):
    with pytest.raises(NotImplementedError, match="a wall that radiates: its stages are linear"):
        evolve(GLOWING, [1.0], integrator=integrator)


def test_surroundings_are_in_kelvin_at_any_time():
    scene = Scene(BOX, UNIT, walls={"x-": lambda t: 1.0 - t, "x+": Radiation(1.0, 300.0)}, initial=300.0)
    with pytest.raises(ValueError, match=r"Scene.walls\['x-'\] at .* >= 0 K"):
        last(scene, [2.0], particles=100)


def test_a_composite_keeps_its_heat_in_time():
    walls = {"x-": Convection(3.0, 500.0), "x+": Radiation(0.9, 300.0), "y-": Flux(30.0), "z+": 400.0}
    ball = Sphere((0.5, 0.5, 0.5), 0.3, Material(20.0, 2.0, 3.0))
    scene = Scene(BOX, UNIT, [ball], walls=walls, initial=350.0, sources=[UniformSource(10.0)])
    field = last(scene, [0.05, 0.2], particles=300)
    assert field.stats["energy_error"] < 1e-10
    assert set(field.stats["heat_in"]) == {*walls, "sources"}
    weights = [6.0 if phase else 1.0 for phase in field.samples.phase]
    gained = field.samples.volumes * weights @ (field.samples.temperature - 350.0)
    assert_allclose(gained, field.stats["heat_change"], rtol=1e-10)
