"""Only here: heat of sources, pulses and fluxes in time that is lost, or not as much as they say."""

from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from spared import slow_but
from transient_scenes import ALUMINIUM, BOX, INTEGRATORS, METAL, last

from demheat import Flux, Material, MovingCylinder, Scene, UniformSource, evolve


@pytest.mark.parametrize("integrator", ["rkl2", "tr-bdf2"])
def test_uniform_heating_of_an_insulated_body(integrator):
    scene = Scene(size=BOX, matrix=METAL, initial=20.0, sources=[UniformSource(7020.0)])
    for field in evolve(scene, [0.5, 2.0], particles=300, integrator=integrator):
        # 7020 W/m3 over 7020 J/(m3 K) is 1 K/s, the same everywhere; rounding, and the linear solver's tolerance.
        assert_allclose(field.samples.temperature, 20.0 + field.time, atol=3e-4 if "bdf2" in integrator else 1e-10)
    assert_allclose(field.stats["heat_in"]["sources"], 7020.0 * 1e-3 * 2.0, rtol=1e-12)
    assert field.stats["energy_error"] < 1e-10


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_heat_is_conserved_with_a_moving_source_and_a_flux_in_time(integrator):
    scene = Scene(
        size=(0.05, 0.03, 0.01),
        matrix=Material(134.0, density=2790.0, heat_capacity=880.0),
        walls={"x-": lambda t: 25.0 + 5.0 * t, "x+": Flux(lambda t: 1e4 * np.cos(t))},
        initial=25.0,
        sources=[MovingCylinder(2, 0.008, 1e8, start=(0.01, 0.015), velocity=(0.005, 0.0))],
    )
    field = last(scene, [1.0, 2.0], particles=600, integrator=integrator)
    stats = field.stats
    # Conserved to rounding; also by the implicit steps, whose solver takes out the sum of its residual.
    assert stats["energy_error"] < 1e-10
    # The power is the same at all times: pi/4 d^2 times the thickness.
    assert_allclose(stats["heat_in"]["sources"], 1e8 * np.pi / 4 * 0.008**2 * 0.01 * 2.0, rtol=1e-9)
    # The flux's integral by the steps taken: second order for all but Euler, which is .018 off by its largest ones.
    assert_allclose(stats["heat_in"]["x+"], 1e4 * np.sin(2.0) * 3e-4, rtol=0.025 if integrator == "euler" else 0.01)
    assert "y-" not in stats["heat_in"] and stats["heat_in"]["x-"] != 0
    whole = 2790.0 * 880.0 * field.samples.volumes @ (field.samples.temperature - 25.0)
    assert_allclose(whole, stats["heat_change"], rtol=1e-10)


@pytest.mark.parametrize("knobs", [{"integrator": "euler"}, {"integrator": "auto"}, {"step": 7.0}])
def test_a_pulse_of_flux_brings_its_heat(knobs):
    pulse = Flux(lambda t: 1e5 if 50.033 <= t <= 50.533 else 0.0)
    field = last(Scene(size=BOX, matrix=ALUMINIUM, walls={"y+": pulse}, initial=20.0), [100.0], particles=300, **knobs)
    # 1e5 W/m2 on 0.01 m2 for half a second; each jump is known to 1e-7 s.
    assert_allclose(field.stats["heat_in"]["y+"], 500.0, rtol=1e-6)
    assert field.stats["energy_error"] < 1e-10


@pytest.mark.parametrize("integrator", ["rkl2", "tr-bdf2"])
def test_a_source_that_passes_through_brings_its_heat(integrator):
    source = MovingCylinder(2, 0.02, 1e7, start=(-1.0, 0.05), velocity=(0.4, 0.0), clip=True)
    scene = Scene(size=BOX, matrix=ALUMINIUM, initial=20.0, sources=[source])
    field = last(scene, [100.0], particles=300, integrator=integrator)
    # Its power for the time of its axis in the body, 0.25 s; steps of a tenth of 0.05 s err by 1e-3 at the edges.
    assert_allclose(field.stats["heat_in"]["sources"], 1e7 * np.pi / 4 * 0.02**2 * 0.1 * 0.25, rtol=1e-3)


def test_heat_of_a_wall_that_is_warm_for_a_while():
    scene = Scene(size=BOX, matrix=ALUMINIUM, walls={"y+": lambda t: 120.0 if 130 <= t <= 140 else 20.0}, initial=20.0)
    during, after = evolve(scene, [141.0, 9000.0], particles=300, integrator="tr-bdf2")
    # Depth sqrt(4 a t / pi) = 3.1 cm at 10 s, of 100 K over 0.01 m2, less the same from the end of the pulse on; cells
    # of 1.5 cm do that to some 10 %.
    taken = 2700.0 * 900.0 * 100.0 * 0.01 * np.sqrt(4 * 185.0 / 2.43e6 / np.pi) * (np.sqrt(11.0) - 1.0)
    assert_allclose(during.stats["heat_in"]["y+"], taken, rtol=0.1)
    # All that came in and went out again is counted, not what is left of it.
    assert abs(after.stats["heat_in"]["y+"]) < 1e-4 * taken and after.stats["energy_error"] < 1e-12


@pytest.mark.parametrize(("domain", "surface"), [("sphere", np.pi * 0.01), ("cylinder-y", np.pi * 0.01)])
def test_a_flux_through_a_round_wall_brings_its_power(domain, surface):
    scene = Scene(size=BOX, matrix=METAL, domain=domain, walls={"round": Flux(500.0)}, initial=25.0)
    field = last(scene, [0.05, 0.1], particles=500)
    # The planes in the wall's place have more area, and would bring in 1e-3 too much; rounding.
    assert_allclose(field.stats["heat_in"]["round"], 500.0 * surface * 0.1, rtol=1e-12)
    assert_allclose(field.wall_heat["round"], 500.0 * surface, rtol=1e-12)


TRACK = Scene(
    size=BOX,
    matrix=Material(1.0, density=2700.0, heat_capacity=900.0),
    initial=20.0,
    sources=[MovingCylinder(2, 0.01, 1e7, start=(0.005, 0.05), velocity=(0.018, 0.0))],
)


@pytest.mark.parametrize(
    ("integrator", "accuracy"),
    slow_but({("rkl2", 1e-2), ("tr-bdf2", 1e-4)}, product(["rkl2", "tr-bdf2"], [1e-2, 1e-4])),
)
def test_accuracy_under_a_moving_source(integrator, accuracy):
    """Cells of half the source's size and hardly any conduction, which forgives nothing."""
    right = under_source()
    field = last(TRACK, [5.0], particles=3000, integrator=integrator, accuracy=accuracy)
    off = field.samples.temperature - right.temperature
    # Found 0.03 to 0.15 of it.
    assert np.sqrt(right.volumes @ off**2 / right.volumes.sum()) < 0.5 * accuracy * np.ptp(right.temperature)
    assert field.stats["steps"] < 400


@cache
def under_source():
    """Samples after 5 s by steps of a hundredth of the time in which the source crosses its diameter."""
    return last(TRACK, [5.0], particles=3000, integrator="rkl2", step=5.6e-3).samples


def test_lost_power_of_a_clipped_source_is_reported():
    source = MovingCylinder(2, 0.008, 1e8, start=(0.0, 0.015), clip=True)
    scene = Scene(size=(0.05, 0.03, 0.01), matrix=METAL, initial=25.0, sources=[source])
    field = last(scene, [1e-3], particles=300)
    # Half of it is outside.
    assert_allclose(field.stats["lost_power"], 1e8 * np.pi / 8 * 0.008**2 * 0.01, rtol=1e-9)
    with pytest.raises(ValueError, match="clip"):
        evolve(replace(scene, sources=[MovingCylinder(2, 0.008, 1e8, start=(0.0, 0.015))]), [1e-3])
