"""Transients by the discrete element method: against exact series, its heat balance, and what it refuses."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Flux, Material, MovingCylinder, Scene, Sphere, UniformSource, evolve
from demheat.conduction.integrators import linear
from demheat.packing.base import make_packing
from demheat.packing.cache import relaxed
from references import series

METAL = Material(33.0, density=7800.0, heat_capacity=0.9)
BOX = (0.1, 0.1, 0.1)
SLAB = Scene(size=BOX, matrix=METAL, walls={"y-": 25.0, "y+": 35.0}, initial=25.0)
INTEGRATORS = ("euler", "rkl2", "tr-bdf2", "tr-bdf2-multigrid")


def last(scene, times, **knobs):
    *_, field = evolve(scene, times, **{"particles": 1000} | knobs)
    return field


@pytest.mark.parametrize("integrator", ["auto", *INTEGRATORS])
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


def test_errors_fall_at_second_order_in_the_spacing():
    errors = []
    for number in (700, 5600):
        field = last(SLAB, [0.2], particles=number, accuracy=1e-5)
        exact = next(iter(series.evolve(SLAB, [0.2])))
        points, _, temperature, _, _ = field.samples
        errors.append(np.sqrt(np.mean((temperature - exact.temperature_at(points)) ** 2)))
    # A factor of 8 in number is 2 in spacing: 4 times less; one packing each, so less is asked.
    assert errors[0] / errors[1] > 2.5


def test_a_field_at_points():
    field = last(SLAB, [0.2], particles=3000)
    points = np.array([[0.05, y, 0.05] for y in (0.025, 0.05, 0.075, 0.09)])
    # Haddad et al. 2021, eq. 17, at these points; linear inside cells, so about as good as in the centres.
    assert_allclose(field.temperature_at(points), [25.7976, 27.4834, 30.6420, 33.1761], atol=0.06)
    assert field.flux_at(points).shape == (4, 3)


@pytest.mark.parametrize("law", ["calibrated", "platonic"])
@pytest.mark.parametrize("wall", ["center", "surface"])
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


@pytest.mark.parametrize("integrator", INTEGRATORS)
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
    # The flux's integral by the steps taken: second order for all but Euler, whose steps are many.
    assert_allclose(stats["heat_in"]["x+"], 1e4 * np.sin(2.0) * 3e-4, rtol=0.01)
    assert "y-" not in stats["heat_in"] and stats["heat_in"]["x-"] != 0
    whole = 2790.0 * 880.0 * field.samples.volumes @ (field.samples.temperature - 25.0)
    assert_allclose(whole, stats["heat_change"], rtol=1e-10)


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


ALUMINIUM = Material(185.0, density=2700.0, heat_capacity=900.0)


@pytest.mark.parametrize("knobs", [*({"integrator": name} for name in ("auto", *INTEGRATORS)), {"step": 7.0}])
def test_a_pulse_of_flux_brings_its_heat(knobs):
    pulse = Flux(lambda t: 1e5 if 50.033 <= t <= 50.533 else 0.0)
    field = last(Scene(size=BOX, matrix=ALUMINIUM, walls={"y+": pulse}, initial=20.0), [100.0], particles=300, **knobs)
    # 1e5 W/m2 on 0.01 m2 for half a second; each jump is known to 1e-7 s.
    assert_allclose(field.stats["heat_in"]["y+"], 500.0, rtol=1e-6)
    assert field.stats["energy_error"] < 1e-10


@pytest.mark.parametrize("integrator", ["auto", *INTEGRATORS])
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


TRACK = Scene(
    size=BOX,
    matrix=Material(1.0, density=2700.0, heat_capacity=900.0),
    initial=20.0,
    sources=[MovingCylinder(2, 0.01, 1e7, start=(0.005, 0.05), velocity=(0.018, 0.0))],
)


@pytest.mark.parametrize("integrator", ["rkl2", "tr-bdf2"])
@pytest.mark.parametrize("accuracy", [1e-2, 1e-3, 1e-4])
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
        evolve(Scene(**vars(scene) | {"sources": [MovingCylinder(2, 0.008, 1e8, start=(0.0, 0.015))]}), [1e-3])


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


def test_pores_keep_their_temperature():
    pore = Sphere((0.05, 0.05, 0.05), 0.03, Material(0.0, density=1.0, heat_capacity=1.0))
    field = last(Scene(size=BOX, matrix=METAL, inclusions=[pore], walls={"y+": 35.0}, initial=25.0), [10.0])
    inside = field.samples.phase == 1
    assert inside.sum() > 50
    assert_allclose(field.samples.temperature[inside], 25.0, rtol=1e-12)
    assert_allclose(field.samples.temperature[~inside], 35.0, atol=0.02)  # accuracy, 1e-3 of 10 K, and its tail


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


@pytest.mark.parametrize("law", ["calibrated", "platonic"])
def test_contact_laws_in_a_sphere(law):
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
    assert (0.5 < field.stats["calibration"] < 0.9) == (law == "calibrated")


@pytest.mark.parametrize(("domain", "surface"), [("sphere", np.pi * 0.01), ("cylinder-y", np.pi * 0.01)])
def test_a_flux_through_a_round_wall_brings_its_power(domain, surface):
    scene = Scene(size=BOX, matrix=METAL, domain=domain, walls={"round": Flux(500.0)}, initial=25.0)
    field = last(scene, [0.05, 0.1], particles=500)
    # The planes in the wall's place have more area, and would bring in 1e-3 too much; rounding.
    assert_allclose(field.stats["heat_in"]["round"], 500.0 * surface * 0.1, rtol=1e-12)
    assert_allclose(field.wall_heat["round"], 500.0 * surface, rtol=1e-12)


def test_a_step_by_hand():
    limit = last(SLAB, [1e-4], integrator="euler").stats["step_limit"]
    field = last(SLAB, [0.02], integrator="euler", step=0.9 * limit)
    assert field.stats["step"] <= 0.9 * limit and field.stats["steps"] == np.ceil(0.02 / (0.9 * limit))
    found = pytest.raises(ValueError, next, evolve(SLAB, [0.02], particles=1000, integrator="euler", step=1.1 * limit))
    assert "explicit Euler is unstable above" in str(found.value)
    assert float(re.search(r"above (\S+) s", str(found.value))[1]) == pytest.approx(limit, rel=1e-5)
    assert last(SLAB, [0.02], integrator="rkl2", step=0.005).stats["steps"] == 4


def test_the_same_packing_gives_the_same_bits():
    packing = relaxed(1000, size=BOX, periodic=False, seed=5)
    first, second = (last(SLAB, [0.02, 0.1], packing=packing).samples.temperature for _ in range(2))
    assert np.array_equal(first, second)
    assert not np.array_equal(first, last(SLAB, [0.02, 0.1], seed=6).samples.temperature)


def scattered(size, periodic):
    """A packing of a size that is not the scene's: tests are collected by each worker, which must not compile then."""
    centers = np.random.default_rng(0).random((100, 3)) * size
    return make_packing(centers, np.full(100, 1e-3), size, periodic, {})


BAD = [
    ({"times": []}, "times"),
    ({"times": [0.2, 0.1]}, "times"),
    ({"times": [-1.0, 0.1]}, "times"),
    ({"times": [0.1, float("nan")]}, "times"),
    *(({"times": odd}, "times = ") for odd in (["a"], "abc", {0.1: 1}, (t for t in [0.1]), [0.1j], ["1", "2"], 0.1)),
    ({"times": [[0.1], [0.2, 0.3]]}, "times = [[0.1]"),
    ({"accuracy": True}, "accuracy = True"),
    ({"step": True}, "step = True"),
    ({"step": "a"}, "step = 'a'"),
    ({"conforming": "no"}, "conforming = 'no'"),
    ({"allow_few": "x"}, "allow_few = 'x'"),
    ({"particles": "a"}, "particles = 'a'"),
    ({"particles": 1e3}, "particles = 1000.0"),
    ({"integrator": "magic"}, "integrator = 'magic'"),
    ({"accuracy": 0.0}, "accuracy = 0.0"),
    ({"accuracy": 1.0}, "accuracy = 1.0"),
    ({"step": -1.0}, "step = -1.0"),
    ({"step": float("inf")}, "step = inf"),
    ({"law": "magic"}, "law = 'magic'"),
    ({"law": "calibrated", "conforming": True}, "conforming = True"),
    ({"sparse": "drop"}, "sparse = 'drop'"),
    ({"interface": "magic"}, "interface = 'magic'"),
    ({"particles": 50}, "particles = 50"),
    ({"packing": scattered((0.1, 0.1, 0.2), periodic=False)}, "packing of size"),
    ({"packing": scattered(BOX, periodic=True)}, "packing of size"),
]


@pytest.mark.parametrize(("change", "words"), BAD)
def test_bad_input_before_any_work(change, words):
    knobs = {"times": [0.1]} | change
    with pytest.raises(ValueError, match=re.escape(words)):
        evolve(SLAB, knobs.pop("times"), **knobs)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"initial": None}, "Scene.initial = None"),
        ({"matrix": Material(1.0, density=1.0)}, "Material.heat_capacity = None"),
        ({"matrix": Material(1.0, heat_capacity=1.0)}, "Material.density = None"),
    ],
)
def test_scenes_that_lack_something(change, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        evolve(replace(SLAB, **change), [0.1])


def test_numbers_of_other_types():
    knobs = {"step": np.float32(0.01), "accuracy": np.float64(1e-3), "integrator": "rkl2", "particles": np.int64(300)}
    (field,) = evolve(SLAB, np.array([1], dtype=np.int32), **knobs, conforming=np.bool_(False))
    # Of a hundredth; 32 bits hold it to 2e-8 from below, which takes no step more.
    assert field.time == 1.0 and 100 <= field.stats["steps"] <= 101
    assert next(iter(evolve(SLAB, range(1, 3), particles=300, step=np.int64(1), integrator="tr-bdf2"))).time == 1.0


@pytest.mark.parametrize("load", [lambda t: float("nan"), Flux(lambda t: "a")])
def test_a_load_that_is_no_number_names_wall_and_time(load):
    with pytest.raises(ValueError, match=re.escape("Scene.walls['y+'] at 0.0 s")):
        evolve(Scene(size=BOX, matrix=METAL, walls={"y+": load}, initial=25.0), [0.1])
    late = Scene(size=BOX, matrix=METAL, walls={"y+": lambda t: 1.0 if t < 0.05 else float("nan")}, initial=25.0)
    with pytest.raises(ValueError, match=re.escape("Scene.walls['y+'] at 0.05")):
        last(late, [0.1], particles=300)


@pytest.mark.parametrize(
    ("initial", "words"),
    [
        (lambda x: x, "Scene.initial: gives shape (3, 3) of float64"),
        (lambda x: x[:, 0] + 1j, "Scene.initial: gives shape (3,) of complex128"),
        (lambda x: x[:, 0] * np.nan, "Scene.initial = nan at [0.05, 0.05, 0.05] m: must be finite"),
    ],
)
def test_an_initial_temperature_that_is_no_number(initial, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        evolve(Scene(size=BOX, matrix=METAL, walls={}, initial=initial), [0.1])


def test_what_is_not_supported_says_why():
    sphere = Scene(size=BOX, matrix=METAL, domain="sphere", walls={"round": 200.0}, initial=20.0)
    with pytest.raises(NotImplementedError, match="flat walls only"):
        evolve(sphere, [1.0], law="calibrated", wall="surface")
    ball = Sphere((0.05, 0.05, 0.05), 0.01, METAL)
    with pytest.raises(NotImplementedError, match="conforming"):
        evolve(replace(sphere, inclusions=[ball]), [1.0])
    with pytest.raises(NotImplementedError, match="two held walls meet|held walls meet"):
        corner = Scene(size=BOX, matrix=METAL, walls={"x-": 1.0, "y-": 2.0}, initial=25.0)
        evolve(corner, [1.0], law="calibrated")


@pytest.mark.parametrize(
    ("integrator", "accuracy", "relaxations"),
    [
        *(
            (name, *how)
            for name in ("tr-bdf2", "tr-bdf2-multigrid")
            for how in [(1e-3, 1e7), (1e-3, 1e12), (1e-6, 1e17)]
        ),
        ("tr-bdf2", 1e-3, 1e49),
    ],
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
