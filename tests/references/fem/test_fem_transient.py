"""Elements in time: order in step and size, heat to the last digit, the error asked for; what is refused or ends."""

import math

import numpy as np
import pytest
from fem_scenes import KINDS, UNIT, cube, last
from numpy.testing import assert_allclose

from demheat.scene import Flux, Layer, Material, MovingCylinder, Scene, Sphere, UniformSource
from references import fem

STEEL = Material(33.0, 7800.0, 0.9)  # Haddad et al. 2021, table 1
SIZE = {"hexahedra": 0.25, 1: 0.34, 2: 0.5}


def kind_size(kind):
    return SIZE[kind.get("order", "hexahedra")]


def modes(x):
    return np.sin(np.pi * x[:, 1])


# ---------------------------------------------------------------- exact series


def slab(fraction, fourier):
    """Temperature between walls at 0 (x = 0) and 1 (x = L), from 0: x/L plus sines (Haddad et al. 2021, eq. 17)."""
    n = np.arange(1, 200)
    terms = 2 / np.pi * (-1.0) ** n / n * np.exp(-((n * np.pi) ** 2) * fourier)
    return fraction + np.sin(np.pi * np.outer(fraction, n)) @ terms


# In K of a span of 10, at the earliest time, where the layer of heat is 1.5 edges of the bricks or 1.2 of the
# tetrahedra thick: found .21 and .018.
@pytest.mark.parametrize(
    ("knobs", "limit"), [({"elements": "hexahedra", "size": 0.0099}, 0.3), ({"size": 0.0125}, 0.03)]
)
def test_slab_of_haddad(knobs, limit):
    of = cube(STEEL, 0.1, walls={"y-": 25.0, "y+": 35.0}, initial=25.0)
    fractions = np.linspace(0.05, 0.95, 19)
    points = np.column_stack([np.full(19, 0.03), 0.1 * fractions, np.full(19, 0.06)])
    times = [0.0, 0.05, 0.1, 0.2]
    for field, time in zip(fem.evolve(of, times, accuracy=1e-4, **knobs), times, strict=True):
        assert field.time == time
        if time:
            exact = 25 + 10 * slab(fractions, 33 / (7800 * 0.9) * time / 0.01)
            assert_allclose(field.temperature_at(points), exact, atol=limit)
            assert field.stats["energy_error"] < 1e-8
    assert_allclose(exact[[4, 9, 14, 17]], [25.7976, 27.4834, 30.6420, 33.1761], atol=1e-4)
    # Heat through the walls is less accurate by one order.
    n = np.arange(1, 99)
    sums = [np.sum(sign**n * np.exp(-((n * np.pi) ** 2) * 0.0940171)) for sign in (-1, 1)]
    exact = 33 * 10 * 0.1 * (1 + 2 * np.array(sums)) * [-1, 1]
    assert_allclose([field.wall_heat["y-"], field.wall_heat["y+"]], exact, rtol=0.03)


# ---------------------------------------------------------------- orders


def fitted(errors):
    return np.log2(np.array(errors[:-1]) / errors[1:])


def test_second_order_in_time_to_the_exact_decay_of_the_grid():
    """A sine is an eigenvector of the equations of a uniform grid, whose decay in time is known exactly."""
    of, angle = cube(walls={"y-": 0.0, "y+": 0.0}, initial=modes), np.pi / 4
    rate = 3 * 16 * 2 * (1 - math.cos(angle)) / (2 + math.cos(angle)) / 1
    errors = []
    for count in (4, 8, 16):
        field = last(of, [0.2], elements="hexahedra", size=0.25, step=0.2 / count, tolerance=1e-12)
        assert field.stats["steps"] == count
        errors.append(abs(field.temperature_at(np.full(3, 0.5))[0] - math.exp(-rate * 0.2)))
    # The slope nears 2 from either side by a term of the relative size of a step.
    assert_allclose(fitted(errors), 2, atol=0.15)


def test_second_order_in_time_under_loads_that_change():
    walls = {"y-": lambda t: math.sin(5 * t), "y+": Flux(lambda t: math.cos(9 * t))}
    of = cube(walls=walls, sources=(MovingCylinder(2, 0.3, 20.0, (0.3, 0.4), (0.5, 0.3)),), initial=modes)
    knobs = {"elements": "hexahedra", "size": 0.34, "tolerance": 1e-12}
    at = [last(of, [0.5], step=0.5 / n, **knobs).temperature_at(np.full(3, 0.7))[0] for n in (20, 40, 80, 160)]
    # Differences of successive solutions fall like the error; kinks where source points change bricks blur it.
    assert np.all(fitted(np.abs(np.diff(at))) > 1.7)


@pytest.mark.parametrize(
    ("knobs", "sizes", "order"),
    [({"elements": "hexahedra"}, (0.25, 0.125), 2), ({"order": 1}, (0.25, 0.125), 2), ({"order": 2}, (0.25, 0.125), 3)],
)
def test_declared_order_in_space(knobs, sizes, order):
    of, errors = cube(walls={"y-": 0.0, "y+": 0.0}, initial=modes), []
    for size in sizes:
        field = last(of, [0.05], size=size, step=0.005, tolerance=1e-11, **knobs)
        s = field.samples
        exact = modes(s.points) * math.exp(-(np.pi**2) * 0.05)
        errors.append(math.sqrt(s.volumes @ (s.temperature - exact) ** 2))
    # Unstructured meshes do not refine evenly: their sizes alone shift a slope by some tenths. Ten steps leave an error
    # in time of 3e-5, under a tenth of the finest in space.
    assert fitted(errors)[0] > order - 0.3


def test_accuracy_asked_for_is_nearly_met():
    """The estimated error of one step is the limit; those of all steps add up to a few times as much."""
    of, knobs = cube(walls={"y-": 0.0, "y+": 1.0}), {"elements": "hexahedra", "size": 0.125, "tolerance": 1e-11}
    fine = last(of, [0.1], accuracy=1e-7, **knobs)
    for accuracy in (1e-3, 1e-4, 1e-5):
        field = last(of, [0.1], accuracy=accuracy, **knobs)
        error = math.sqrt(np.mean((field.samples.temperature - fine.samples.temperature) ** 2))
        assert error < 10 * accuracy
        # An estimate a hundred times too careful would waste 5 times the steps.
        assert error > 0.02 * accuracy
        assert field.stats["steps"] < fine.stats["steps"]


def test_a_load_that_jumps_is_followed():
    of = cube(walls={"y-": Flux(lambda t: 0.0 if t < 0.0503 else 1.0)})
    field = last(of, [0.1], elements="hexahedra", size=0.25, accuracy=1e-4)
    # The jump is known to 1e-9 of the run, and equations are solved to that.
    assert_allclose(field.stats["heat_change"], 0.0497, rtol=1e-8)


def test_a_pulse_after_a_long_rest_is_not_passed_over():
    bricks = {"elements": "hexahedra", "size": 0.125}
    (early, late) = fem.evolve(cube(walls={"y-": 0.0, "y+": 1.0}), [0.14, 0.15], **bricks)
    after = late.samples.temperature - early.samples.temperature
    # Steps had grown to the whole rest of the run, and at none of their stages was the wall warm.
    pulse = cube(walls={"y-": 0.0, "y+": lambda t: float(0.15 <= t < 0.16)})
    for times in ([0.3], [0.15, 0.3], [0.155, 0.16, 0.3]):
        field = last(pulse, times, **bricks)
        # Estimated errors of 2e-5 of the span in each step add up to a few times as much.
        assert_allclose(field.samples.temperature, after, atol=2e-4)
        assert after.max() > 0.01 and field.stats["energy_error"] < 1e-12
    smooth = cube(walls={"y-": 0.0, "y+": lambda t: math.exp(-(((t - 0.155) / 0.003) ** 2))})
    # As long in all, and as warm: a tenth is what its shape changes.
    scale = 0.003 * math.sqrt(math.pi) / 0.01
    assert_allclose(last(smooth, [0.3], **bricks).samples.temperature, scale * after, atol=1e-3)


def test_a_load_that_jumps_at_once_is_as_one_that_is_there():
    bricks = {"elements": "hexahedra", "size": 0.25}
    there, sudden = (
        last(cube(walls={"y-": 0.0, "y+": wall}), [0.05], **bricks) for wall in (1.0, lambda t: float(t > 0))
    )
    # Steps are others: a few times the accuracy of one.
    assert_allclose(sudden.samples.temperature, there.samples.temperature, atol=1e-4)


def test_times_may_be_next_to_each_other():
    of = cube(walls={"y-": 0.0, "y+": 1.0})
    one, other = fem.evolve(of, [0.1, np.nextafter(0.1, 1.0)], elements="hexahedra", size=0.25)
    # Of a step of 1e-17 s rounding leaves as much.
    assert_allclose(other.samples.temperature, one.samples.temperature, rtol=1e-12)


def test_a_wall_may_come_near_to_another():
    # In a steady state rounding would leave nothing of what flows.
    of = cube(walls={"y-": 25.0, "y+": lambda t: 25.0 + 10.0 * math.exp(-t)}, initial=25.0)
    field = last(of, [26.0], elements="hexahedra", size=0.5)
    assert 0 < np.abs(field.samples.temperature - 25.0).max() < 1e-2
    with pytest.raises(ValueError, match="rounding leaves little"):
        fem.solve(cube(walls={"y-": 25.0, "y+": 25.0 + 1e-10}, initial=25.0))


# ---------------------------------------------------------------- heat


@pytest.mark.parametrize("kind", [KINDS[0], *(pytest.param(kind, marks=pytest.mark.slow) for kind in KINDS[1:])])
def test_heat_is_conserved(kind):
    """To ten times the linear tolerance, whatever loads it."""
    walls = {"x-": lambda t: 3 * t, "y-": 0.0, "z+": Flux(lambda t: 2 - t), "z-": 1.0}
    source = MovingCylinder(2, 0.3, 50.0, (0.3, 0.5), (3.0, 0.0))
    of = cube(walls=walls, sources=(UniformSource(2.0), source), initial=lambda x: x[:, 0] - 0.5)
    for tolerance in (1e-6, 1e-10):
        for field in fem.evolve(of, [0.05, 0.1], size=kind_size(kind), tolerance=tolerance, accuracy=1e-3, **kind):
            stats = field.stats
            assert stats["residual"] <= tolerance
            assert stats["energy_error"] <= 10 * tolerance
            # The integral of 2 - t over time, exact by the weights, and the power of both sources.
            assert_allclose(stats["heat_in"]["z+"], 2 * field.time - field.time**2 / 2, rtol=1e-12)
            power = 2 + 50 * math.pi * 0.15**2
            assert_allclose(stats["heat_in"]["sources"], power * field.time, rtol=1e-12)
            change = field.samples.volumes @ field.samples.temperature
            assert_allclose(stats["heat_change"], change, atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_capacities_and_conductivities_of_layers(kind):
    layers = [Layer(1, 0.0, 0.3, Material(4.0, 2.0, 5.0)), Layer(1, 0.6, 0.9, Material(0.5, 1.0, 3.0))]
    of = cube(inclusions=layers, walls={"y-": 0.0, "y+": 1.0})
    field = last(of, [400.0], size=kind_size(kind), accuracy=1e-3, **kind)
    resistance = 0.3 / 4 + 0.3 + 0.3 / 0.5 + 0.1
    # Steady by then; piecewise linear temperatures are exact.
    y = np.array([0.3, 0.6, 0.9])
    expected = np.array([0.075, 0.375, 0.975]) / resistance
    points = np.column_stack([np.full(3, 0.3), y, np.full(3, 0.4)])
    assert_allclose(field.temperature_at(points), expected, atol=1e-6)
    assert_allclose(field.mean_flux, [0, -1 / resistance, 0], atol=1e-6)
    mean = np.array([expected[0] / 2, expected[:2].mean(), expected[1:].mean(), (1 + expected[2]) / 2])
    assert_allclose(field.stats["heat_change"], mean @ [0.3 * 10, 0.3, 0.3 * 3, 0.1], rtol=1e-5)
    assert_allclose(field.fractions, [0.4, 0.3, 0.3], rtol=1e-9)


def test_field_at_the_start_and_temperatures_of_walls_in_time():
    of = cube(walls={"x-": lambda t: 1 + t, "x+": Flux(2.0)}, initial=lambda x: 1 + x[:, 1])
    first, second = fem.evolve(of, [0.0, 0.01], size=0.25, elements="hexahedra")
    points = np.array([[0.6, 0.25, 0.1], [1.0, 1.0, 1.0]])
    assert_allclose(first.temperature_at(points), 1 + points[:, 1], rtol=1e-12)
    assert first.time == 0 and first.stats["steps"] == 0
    assert_allclose([first.wall_temperature["x-"], second.wall_temperature["x-"]], [1.0, 1.01], rtol=1e-12)
    assert_allclose(first.wall_temperature["x+"], 1.5, rtol=1e-12)
    assert_allclose(second.wall_heat["x+"], 2.0, rtol=1e-12)


# ---------------------------------------------------------------- a round body


def test_flux_through_a_round_wall():
    of = Scene((0.4, 1.0, 1.0), UNIT, walls={"round": Flux(2.0)}, initial=0.0, domain="cylinder-x")
    field = last(of, [0.1], size=0.25, accuracy=1e-3)
    assert_allclose(field.stats["heat_change"], 2 * 0.4 * math.pi * 0.1, rtol=1e-3)  # area of the coarse surface
    assert field.stats["energy_error"] < 1e-8


# ---------------------------------------------------------------- bad input


@pytest.mark.parametrize(
    ("parts", "knobs", "words"),
    [
        ({}, {"order": 3}, "order = 3: must be 1 or 2 with tetrahedra"),
        ({}, {"order": 2, "elements": "hexahedra"}, "order = 2: must be 1 with hexahedra"),
        ({}, {"elements": "hexahedra", "size": 1e-3}, "size = 0.001 m: more than 2e"),
        ({"initial": None, "walls": {"x-": 0.0}}, {}, "Scene.initial = None"),
        ({"matrix": Material(1.0)}, {}, "Material.density = None in phase 0"),
    ],
)
def test_bad_input_is_refused_before_any_work(parts, knobs, words, monkeypatch):
    for name in ("make", "hexahedra"):
        monkeypatch.setattr(f"references.fem.transient.{name}", lambda *a, **k: pytest.fail("meshed"))
    of = Scene(**({"size": (1, 1, 1), "matrix": UNIT, "initial": 0.0} | parts))
    with pytest.raises(ValueError, match=words):
        fem.evolve(of, **({"times": [1.0]} | knobs))


def test_what_is_not_known_is_refused():
    ball = Sphere((0.5, 0.5, 0.5), 0.2, UNIT)
    hot = MovingCylinder(2, 0.2, 1.0, (0.5, 0.5))
    for parts, knobs, words in [
        ({"matrix": Material(0.0, 1.0, 1.0)}, {}, "pores"),
        ({"domain": "sphere", "sources": (hot,)}, {}, "a sphere: a MovingCylinder"),
        ({"domain": "sphere", "inclusions": (ball,)}, {}, "inclusions in a sphere"),
        (
            {"inclusions": (ball,)},
            {"elements": "hexahedra"},
            r"a sphere, Scene.inclusions\[0\]: hexahedra follow",
        ),
        ({"domain": "cylinder-x"}, {"elements": "hexahedra"}, "a cylinder-x: hexahedra"),
    ]:
        of = Scene(**({"size": (1, 1, 1), "matrix": UNIT, "initial": 0.0} | parts))
        with pytest.raises(NotImplementedError, match=words):
            last(of, [1.0], **knobs)


def test_an_initial_temperature_of_wrong_shape_is_named():
    with pytest.raises(ValueError, match=r"Scene.initial: gives shape \(3,\)"):
        last(cube(initial=lambda x: np.zeros(3)), [1.0], elements="hexahedra", size=0.5)


def test_no_convergence_is_no_result(monkeypatch):
    monkeypatch.setattr("references.fem.multigrid.MOST_ITERATIONS", 1)
    monkeypatch.setattr("references.fem.implicit.DIRECT", 0)
    with pytest.raises(RuntimeError, match=r"residual .* > tolerance 1.00e-09 after 1 iterations on \d+ unknowns"):
        last(cube(walls={"x-": 1.0}), [1.0], size=0.3)


def test_a_step_that_shrinks_to_nothing_is_an_error():
    rng = np.random.default_rng(0)
    of = cube(walls={"x-": Flux(lambda t: 1e3 * rng.standard_normal())})
    with pytest.raises(RuntimeError, match=r"after \d+ steps: the estimated error does not fall"):
        last(of, [1.0], elements="hexahedra", size=0.5, accuracy=1e-9, tolerance=1e-12)


def test_far_beyond_the_steady_state():
    walls = {"walls": {"x-": 0.0, "x+": 1.0}, "initial": 0.0}
    scene = Scene((1.0, 1.0, 1.0), UNIT, **walls)
    (field,) = fem.evolve(scene, [1e17], elements="hexahedra", size=0.25)
    # Temperatures are linear there, which bricks are exactly; to the tolerance of the equations.
    assert field.wall_heat["x+"] == pytest.approx(1.0, rel=1e-8)
    assert field.stats["energy_error"] < 1e-12


def test_a_coarse_beam_has_one_answer_everywhere_in_it():
    """The beam of Terreros et al. (2013), on elements as long as its radius: most on the surface are straight."""
    radius, metal = 0.116e-3, Material(134.0, 2790.0, 880.0)
    size = (2.184e-3, 2 * radius, 2 * radius)
    beam = Scene(size, metal, walls={"x-": 798.0}, initial=298.0, domain="cylinder-x")
    first, again = (last(beam, [0.05], size=1.2e-4) for _ in range(2))
    assert first.stats["straightened"] > 10
    along, across, way = np.random.default_rng(0).random((3, 300))
    y, z = np.sqrt(across) * (np.cos(2 * np.pi * way), np.sin(2 * np.pi * way))
    points = np.column_stack([along * size[0], radius * (1 + y), radius * (1 + z)])
    assert np.array_equal(first.temperature_at(points), again.temperature_at(points))
    # Exactly 642.828 K; elements over 1/20 of the length were found .93 K off.
    assert_allclose(first.temperature_at([[size[0], radius, radius]]), 642.828, atol=1.5)
