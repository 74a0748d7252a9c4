"""Only here: transients of the DEM against exact series, in phases and pores, far beyond rest."""

import re

import numpy as np
import pytest
from numpy.testing import assert_allclose
from transient_scenes import BOX, METAL, SLAB, last

from demheat import Material, Scene, Sphere, UniformSource, evolve
from demheat.conduction.integrators import linear
from demheat.packing.cache import relaxed
from references import series


@pytest.mark.parametrize("integrator", ["auto", "tr-bdf2-multigrid"])
def test_slab_against_the_series(integrator):
    times = [0.05, 0.1, 0.2]
    fields = list(evolve(SLAB, times, particles=3000, integrator=integrator))
    for field, exact in zip(fields, series.evolve(SLAB, times), strict=True):
        assert field.time == exact.time
        points, _, temperature, _, _ = field.samples
        error = temperature - exact.temperature_at(points)
        # Second order in the spacing, 0.07 L against a front of about 0.15 L at .05 s; found .004, .0025, .0016.
        assert np.sqrt(np.mean(error**2)) < 10 * {0.05: 0.006, 0.1: 0.004, 0.2: 0.0025}[field.time]
        # The mean gradient is that between the walls, whatever the profile.
        assert_allclose(field.mean_flux[1], -3300.0, rtol=1e-10)
        assert_allclose(field.wall_heat["y+"], exact.wall_heat["y+"], rtol=0.05)
    stats = fields[-1].stats
    assert stats["integrator"] != "auto" and stats["steps"] >= 3
    # Linear solves are asked for a fifth of the accuracy, 1e-3 of the span, and stop below it.
    assert 1e-7 < stats["residual"] <= 2.1e-4 if stats["integrator"].startswith("tr-bdf2") else stats["residual"] == 0


@pytest.mark.parametrize(("law", "wall"), [("calibrated", "center"), ("platonic", "surface")])
def test_contact_laws(law, wall):
    field = last(SLAB, [0.2], particles=3000, law=law, wall=wall)
    exact = next(iter(series.evolve(SLAB, [0.2])))
    points, _, temperature, _, _ = field.samples
    # Not exact for linear fields: a few per cent of the span of 10 K; found 0.3 to 0.6 K at this size.
    assert np.sqrt(np.mean((temperature - exact.temperature_at(points)) ** 2)) < 1.0
    assert field.stats["energy_error"] < 1e-10
    held = np.isclose(temperature, 35.0, atol=1e-9).sum()
    assert held > 50 if wall == "center" else held == 0
    assert 30.0 < field.wall_heat["y+"] < 100.0 and (field.stats["calibration"] == 1.0) == (law == "platonic")


@pytest.mark.parametrize("integrator", ["tr-bdf2", "tr-bdf2-multigrid"])
def test_implicit_steps_of_a_body_at_rest(integrator):
    """Its span says nothing of what comes: linear solves go down to rounding."""
    warmed = Scene(size=BOX, matrix=METAL, walls={"y+": lambda t: 20.0 if t < 5.0 else 30.0}, initial=20.0)
    field = last(warmed, [5.5], particles=300, integrator=integrator)
    # Half a second after the jump 22.87 at the far end by the series; a cell's middle is 3 mm off it, where it is 22.9.
    assert_allclose(field.samples.temperature.min(), 22.87, atol=0.1)
    assert field.samples.temperature.max() < 30.0
    heated = Scene(size=BOX, matrix=METAL, initial=20.0, sources=[UniformSource(7020.0)])
    field = last(heated, [5.0], particles=300, integrator=integrator, accuracy=1e-5)
    # 1 K/s; the solver's 0.2e-6 of 5 K in each step.
    assert_allclose(field.samples.temperature, 25.0, atol=1e-5)


def test_a_sphere_against_the_series():
    metal = Material(185.0, density=2700.0, heat_capacity=900.0)
    scene = Scene(size=BOX, matrix=metal, domain="sphere", walls={"round": 200.0}, initial=20.0)
    times = [5.0, 10.0]
    for field, exact in zip(evolve(scene, times, particles=3000), series.evolve(scene, times), strict=True):
        points, volumes, temperature, _, _ = field.samples
        assert_allclose(volumes.sum(), np.pi / 6 * 1e-3, rtol=1e-9)
        # Second order in the spacing; found 1.5 K rms at 5 s of a span of 180 K.
        assert np.sqrt(np.mean((temperature - exact.temperature_at(points)) ** 2)) < 3.0
        assert field.stats["energy_error"] < 1e-10 and field.stats["spectral_ratio"] < 20
        assert_allclose(np.linalg.norm(field.mean_flux), 0.0, atol=0.02 * 185.0 * 180.0 / 0.05)


def test_contact_laws_in_a_sphere():
    law = "calibrated"
    metal = Material(185.0, density=2700.0, heat_capacity=900.0)
    scene = Scene(size=BOX, matrix=metal, domain="sphere", walls={"round": 200.0}, initial=20.0)
    field = last(scene, [10.0], particles=3000, law=law)
    (exact,) = series.evolve(scene, [10.0])
    points, _, temperature, _, _ = field.samples
    held = np.isclose(temperature, 200.0, atol=1e-9)
    reach = np.linalg.norm(points - 0.05, axis=1) + relaxed(3000, size=BOX, periodic=False, domain="sphere").radii
    # Held are those that touch the wall within the gap, some 6 % of a radius.
    assert 300 < held.sum() < 1500 and reach[held].min() > 0.045 and reach[~held].max() < 0.05
    # A few per cent of the span of 180 K: temperatures act a radius inside of the wall.
    assert 0.5 < np.sqrt(np.mean((temperature - exact.temperature_at(points)) ** 2)) < 12.0
    assert field.stats["energy_error"] < 1e-10
    assert 0.5 < field.stats["calibration"] < 0.9


def test_a_step_by_hand():
    limit = last(SLAB, [1e-4], integrator="euler").stats["step_limit"]
    field = last(SLAB, [0.02], integrator="euler", step=0.9 * limit)
    assert field.stats["step"] <= 0.9 * limit and field.stats["steps"] == np.ceil(0.02 / (0.9 * limit))
    found = pytest.raises(ValueError, next, evolve(SLAB, [0.02], particles=1000, integrator="euler", step=1.1 * limit))
    assert "explicit Euler is unstable above" in str(found.value)
    assert float(re.search(r"above (\S+) s", str(found.value))[1]) == pytest.approx(limit, rel=1e-5)
    assert last(SLAB, [0.02], integrator="rkl2", step=0.005).stats["steps"] == 4


@pytest.mark.parametrize(
    ("integrator", "accuracy", "relaxations"),
    [("tr-bdf2", 1e-3, 1e7), ("tr-bdf2-multigrid", 1e-6, 1e17), ("tr-bdf2", 1e-3, 1e49)],
)
def test_far_beyond_the_steady_state(integrator, accuracy, relaxations):
    """The bound on what a solve leaves grows with the step; what it leaves does not."""
    settled = BOX[0] ** 2 * METAL.density * METAL.heat_capacity / METAL.conductivity
    knobs = {"particles": 300, "integrator": integrator, "accuracy": accuracy}
    field = last(SLAB, [relaxations * settled], **knobs)
    # k A (35 - 25) / L, to the accuracy; and no heat is lost, to rounding.
    assert field.wall_heat["y+"] == pytest.approx(33.0, rel=accuracy)
    assert field.stats["energy_error"] < 1e-12


def test_stages_that_do_not_converge_are_said(monkeypatch):
    monkeypatch.setattr(linear, "CORRECTIONS", 0)
    with pytest.raises(RuntimeError, match="after .* iterations, asked for"):
        last(SLAB, [1e18], particles=300, integrator="tr-bdf2")


def bowl(x):
    """Cold in the middle of the box, by up to 10 K."""
    return 20.0 + 4e3 * (x[:, 0] - 0.05) ** 2


def test_capacities_are_those_of_the_phases():
    ball = Sphere((0.05, 0.05, 0.05), 0.03, Material(33.0, density=7800.0, heat_capacity=9.0))
    scene = Scene(size=BOX, matrix=METAL, inclusions=[ball], initial=bowl)
    start, end = evolve(scene, [0.0, 50.0], particles=1000)
    assert_allclose(start.samples.temperature, bowl(start.samples.points), rtol=1e-14)
    assert start.stats["steps"] == 0
    inside = end.samples.volumes[end.samples.phase == 1].sum()
    capacity = 7020.0 * (1e-3 - inside) + 70200.0 * inside
    assert_allclose(inside, 4 / 3 * np.pi * 0.03**3, rtol=0.02)
    # The long run leaves the mean over heat capacities: heat is kept, and the rest has decayed.
    weights = np.where(start.samples.phase == 1, 70200.0, 7020.0) * start.samples.volumes
    mean = weights @ start.samples.temperature / capacity
    assert_allclose(end.samples.temperature, mean, atol=1e-3)  # accuracy, 1e-3 of 10 K, and a decay by 1e-4
    assert abs(end.stats["heat_change"]) < 1e-9 * capacity * 10


def test_pores_keep_what_sources_put_into_them():
    pore = Sphere((0.05, 0.05, 0.05), 0.03, Material(0.0, density=1.0, heat_capacity=1.0))
    scene = Scene(
        size=BOX, matrix=METAL, inclusions=[pore], walls={"y+": 25.0}, initial=25.0, sources=[UniformSource(10.0)]
    )
    field = last(scene, [10.0])
    # 10 W/m3 for 10 s over 1 J/(m3 K); the metal gives its own to the wall, all but 10 L^2 / (2 k) = 1.5 mK of it.
    inside = field.samples.phase == 1
    assert_allclose(field.samples.temperature[inside], 125.0, rtol=1e-9)
    assert np.all(field.samples.temperature[~inside] < 25.01)
