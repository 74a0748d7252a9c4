"""Only here: estimates of error without their safety, or what is missing read wrongly off coarser runs."""

import math
import warnings
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from method_scenes import METHODS

from demheat import Box, Laguerre, Layer, Material, Scene, Sphere, evolve, gallery, solve
from demheat.dem.estimate import estimator_of
from demheat.dem.options import Particles
from demheat.error import Estimate, Fine, Refinement, beside, by_refinement, known, missing, of_conductivity_alone
from demheat.scene.volumes import fractions
from references import exact, fem, fft, multipole, series
from references.fem import estimate as of_elements
from references.fft import estimate as of_voxels

RULE = Refinement("coarser", 2.0, 1.5, 3.0, 2.0)


def made(level, *, off=1.0, scene=None):
    """A solution of a body that conducts 5, off by 0.1 2^(1.5 level) and by a tenth of that in degrees."""
    scene = scene or Scene((1.0,) * 3, Material(1.0), walls={"x-": 0.0, "x+": 1.0})
    return SimpleNamespace(
        scene=scene,
        fractions=fractions(scene),
        time=None,
        conductivity=5 + off * 0.1 * 2 ** (1.5 * level),
        mean_flux=np.array([-5 - off * 0.1 * 2 ** (1.5 * level), 0.2 * 2 ** (1.5 * level), 0.0]),
        temperature_at=lambda points: points[:, 0] + 0.01 * 2 ** (1.5 * level),
        wall_temperature={"x-": 0.0, "x+": 1.0},
    )


def coarser(level, **how):
    """One run of a size."""
    yield made(level, **how)


def test_what_is_missing_is_read_off_the_changes():
    changes = np.diff([5 + 0.1 * 2 ** (1.5 * level) for level in range(3)])
    assert missing(changes, 2.0, 1.5) == pytest.approx(0.1, rel=1e-12)
    # An error that crosses zero between the first two: the next change tells.
    assert missing([0.0, 0.8], 2.0, 1.5) == pytest.approx(0.8 / (2**1.5 * (2**1.5 - 1)), rel=1e-12)
    # A faster fall than the order that is known of the method is not believed.
    assert missing([0.1], 2.0, 1.0) == pytest.approx(0.1, rel=1e-12)


def test_another_refinement_adds_what_it_changes():
    rule = RULE._replace(also=2.0)
    estimate = by_refinement(made(0), coarser, rule, also=lambda first: made(1, off=0.5))
    nowhere = by_refinement(made(0), coarser, rule, also=lambda first: None)
    # Half of the error of the first coarser run, 0.1 2^1.5, twice.
    assert estimate.upper - nowhere.upper == pytest.approx(0.1 * 2**1.5, rel=1e-10)


def test_intervals_are_what_is_missing_times_a_safety():
    estimate = by_refinement(made(0), coarser, RULE)
    assert estimate.runs == (made(0).conductivity, made(1).conductivity, made(2).conductivity)
    middle = made(0).conductivity
    # Rounding of a sum besides, 1e-12.
    assert estimate.upper - middle == pytest.approx(3 * 0.1, rel=1e-10)
    assert middle - estimate.lower == pytest.approx(3 * 0.1, rel=1e-10)
    assert estimate.temperature == pytest.approx(2 * 0.01, rel=1e-10)
    # The component that changes most tells of all.
    assert estimate.flux == pytest.approx(3 * 0.2, rel=1e-10)
    # What iterations leave is added.
    left = by_refinement(made(0), coarser, RULE, residual=0.01)
    assert left.upper - middle == pytest.approx(0.3 + 0.01 * middle, rel=1e-10)
    span = np.ptp([0.0, 1.01])  # of the points and walls; the points do not reach the ends
    assert 0.02 + 0.01 * 0.98 < left.temperature < 0.02 + 0.01 * 1.001 * span


def test_intervals_of_the_conductivity_alone_ask_for_no_temperature():
    """They are the same; coats, whose interval goes with the temperature, ask for it all the same."""

    def refused(points):
        raise AssertionError("a temperature was asked for")

    def cold(level):
        return SimpleNamespace(**{**vars(made(level)), "temperature_at": refused})

    whole = by_refinement(made(0), coarser, RULE)
    with of_conductivity_alone():
        alone = by_refinement(cold(0), lambda level: iter([cold(level)]), RULE)
    assert alone[:4] == whole[:4] and alone.runs == whole.runs and math.isnan(alone.temperature)
    with pytest.raises(AssertionError, match="a temperature was asked for"):
        by_refinement(cold(0), coarser, RULE)


def test_a_coarser_run_that_is_close_by_luck_is_told_by_another():
    def lucky(level):
        return [made(level - 1)]

    def twice(level):
        return [made(level - 1), made(1)][: 3 - level]

    half = [by_refinement(made(0), of, RULE).upper - made(0).conductivity for of in (lucky, twice)]
    # Of 5.1, 5.1, 5.28 the last change alone tells, at a step; of 5.28 beside 5.1 it tells all.
    assert half == pytest.approx([3 * 0.1 / 2**1.5, 3 * 0.1], rel=1e-9)


def test_beside_edges_orders_are_no_higher_than_those_of_the_field_there():
    """The edge of a good conductor has the power 2/3: .9 times 4/3 for a rule of second order, all of a slower one."""
    rod = Scene((1.0,) * 3, Material(1.0), [Box((0.5,) * 3, (0.5,) * 3, Material(1e9))], gradient=(1.0, 0.0, 0.0))

    def half(rule):
        estimate = by_refinement(made(0, scene=rod), partial(coarser, scene=rod), rule)
        return (estimate.upper - estimate.lower) / 2

    def told(order):  # by the second change, of errors that grow with the power 1.5
        return 3 * 0.1 * 2**1.5 * (2**1.5 - 1) / (2**order * (2**order - 1))

    # Powers are tried in steps of 1/2000.
    assert half(RULE._replace(order=2.0)) == pytest.approx(told(0.9 * 4 / 3), rel=2e-3)
    assert half(RULE._replace(order=1.0)) == pytest.approx(told(1.0), rel=1e-9)


def test_what_all_runs_see_alike_is_the_least_of_an_interval():
    ball = Scene((1.0,) * 3, Material(1.0), [Sphere((0.5,) * 3, 0.3, Material(9.0))], gradient=(1.0, 0.0, 0.0))

    def found(least):
        return by_refinement(made(0, scene=ball), partial(coarser, scene=ball), RULE, fine=Fine(least=least))

    # It makes 4.1 of 5.1; fluxes are as far off.
    half = (found(0.5).upper - found(0.5).lower) / 2
    assert half == pytest.approx(0.5 * 4.1, rel=1e-9)
    assert found(0.5).flux == pytest.approx(0.5 * 4.1 / 5.1 * np.linalg.norm(made(0).mean_flux), rel=1e-9)
    assert found(1e-3)[1:4] == found(0.0)[1:4]


def test_what_a_method_knows_besides_counts_where_runs_tell_little():
    def half(levels, least):
        runs = dict(enumerate(levels))
        estimate = by_refinement(made(runs[0]), lambda n: [made(runs[n])], RULE, least=least)
        return (estimate.upper - estimate.lower) / 2

    plain, turned = half((0, 1, 2), 0.0), half((0, 1, 0), 0.0)
    assert half((0, 1, 2), 10.0) == pytest.approx(1.15 * plain, rel=1e-9)
    assert half((0, 1, 2), 1.1 * plain) == pytest.approx(1.1 * plain, rel=1e-9)
    # Runs that differ less and less are not close in by their order either.
    assert half((0, 0.2, 0.6), 2.0) < 1.0 < half((0, 0.2, 0.3), 2.0) == pytest.approx(2.0, rel=1e-9)
    assert turned < 2.0 == pytest.approx(half((0, 1, 0), 2.0), rel=1e-9)


@pytest.mark.parametrize("shape, half", [("box", 0.4 * 0.9), ("sphere", 0.9**2 / 4.1)])
def test_linear_elements_tell_of_quadratic_ones_whose_runs_tell_little(shape, half):
    """An error of a unit by linear ones where a body makes 4.1 of 5.1; what runs differ by tells little."""
    body = Box((0.5,) * 3, (0.5,) * 3, Material(1e9)) if shape == "box" else Sphere((0.5,) * 3, 0.3, Material(9.0))
    scene = Scene((1.0,) * 3, Material(1.0), [body], gradient=(1.0, 0.0, 0.0))

    def again(coarser=1.0, order=2, **knobs):
        field = off_by(1.0 if order == 1 else 0.101 if 1.3 < coarser < 1.5 else 0.1)
        field.scene, field.fractions = scene, fractions(scene)
        return field

    estimate = of_elements.estimated(again(), again, "curved")
    assert (estimate.upper - estimate.lower) / 2 == pytest.approx(half, rel=1e-9)


def test_linear_elements_are_not_asked_of_coats():
    scene = gallery.coated_sphere(3.0, 2.0)

    def again(coarser=1.0, order=2, **knobs):
        assert order == 2
        field = off_by(0.0)
        field.scene, field.fractions = scene, fractions(scene)
        return field

    assert of_elements.estimated(again(), again, "curved").upper == pytest.approx(5.0, rel=1e-9)


def test_what_is_misplaced_by_chance_is_no_change():
    """Along a layer that conducts 3, of half of the body: 1 + 2 f of a run that holds so much of it."""
    layer = Layer(1, 0.25, 0.75, Material(3.0))
    scene = Scene((1.0,) * 3, Material(1.0), [layer], walls={"x-": 0.0, "x+": 1.0})

    def holding(share):
        field = made(0, scene=scene, off=0.0)
        field.fractions, field.conductivity = np.array([1 - share, share]), 1 + 2 * share
        return field

    runs = {1: 0.48, 2: 0.55}
    estimate = by_refinement(holding(0.51), lambda n: [holding(runs[n])], RULE._replace(chance=True))
    # What the first holds too much, raised by a quarter.
    assert (estimate.upper - estimate.lower) / 2 == pytest.approx(1.25 * 0.02, rel=1e-9)


def test_coats_are_at_least_as_uncertain_as_their_temperature():
    """Errors of coat and core may cancel in the conductivity: that of the temperature does not."""
    k, core = Material(2.0), Sphere((0.5,) * 3, 0.1, Material(3.0))
    walls = {"walls": {"x-": 0.0, "x+": 1.0}}
    rule = RULE._replace(coats=1.5)

    def half(inclusions, off):
        scene = Scene((1.0,) * 3, Material(1.0), inclusions, **walls)
        estimate = by_refinement(made(0, scene=scene, off=off), partial(coarser, scene=scene, off=off), rule)
        return estimate.upper - made(0, off=off).conductivity, estimate.temperature

    coated = [Sphere((0.5,) * 3, 0.2, k), core]
    plain, warmth = half([core], 1.0)
    assert half(coated, 1.0)[0] == pytest.approx(plain, rel=1e-9)
    # Nothing changes in the conductivity of 5: the temperature's error, of a drop of a degree or so, counts.
    assert half([core], 0.0)[0] < 1e-9
    assert 1.5 * 5 * warmth * 0.98 < half(coated, 0.0)[0] < 1.5 * 5 * warmth * 1.001


def test_the_level_of_a_periodic_cell_is_no_error():
    scene = Scene((1.0,) * 3, Material(1.0), gradient=(1.0, 0.0, 0.0))
    estimate = by_refinement(made(0, scene=scene), partial(coarser, scene=scene), RULE)
    assert estimate.temperature < 1e-9


def test_coarser_runs_that_cannot_be_made():
    def only_one(level):
        if level > 1:
            raise ValueError("voxels: too few")
        warnings.warn("particles are large", stacklevel=1)
        yield made(level)

    # Its warning is kept back: a warning would be an error here.
    assert len(by_refinement(made(0), only_one, RULE).runs) == 2

    def none(level):
        raise ValueError("voxels: too few")

    with pytest.raises(RuntimeError, match="no coarser run to compare with: voxels: too few"):
        by_refinement(made(0), none, RULE)


def test_a_conductivity_below_zero_is_none():
    estimate = by_refinement(made(0), partial(coarser, off=100.0), RULE)
    assert estimate.lower == 0.0 < estimate.upper
    assert known(made(0), 0.1, "tables").lower == pytest.approx(0.9 * made(0).conductivity, rel=1e-10)


def test_beside_another_method_what_that_may_be_off_counts_too():
    """As far as the other method is, and what it may be off itself: of 5.1 beside 5.2828, said to be 5.0 to 5.5."""
    field, other = made(0), made(1)
    other.error = Estimate("somehow", 5.0, 5.5, flux=0.7, temperature=0.05)
    estimate = beside(field, other, "beside it")
    assert (estimate.lower, estimate.upper) == pytest.approx((5.1 - 0.4, 5.1 + 0.4), rel=1e-12)
    apart = math.hypot(0.1, 0.2) * (2**1.5 - 1)
    assert estimate.flux == pytest.approx(apart + 0.7, rel=1e-12)
    assert estimate.temperature == pytest.approx(0.01 * (2**1.5 - 1) + 0.05, rel=1e-9)  # of temperatures of order one
    assert estimate.runs == (made(0).conductivity, made(1).conductivity)


def off_by(error, **stats):
    """A solution that is off by so much of a conductivity of 5 and a third of it in temperature."""
    field = made(0, off=0.0)
    field.conductivity, field.mean_flux = 5 + error, np.array([-5 - error, 0.0, 0.0])
    field.temperature_at, field.stats = lambda points: points[:, 0] + error / 3, {"residual": 0.0} | stats
    return field


def by_elements(kind, linear=0.1):
    """Linear elements of the same size are off by `linear`."""

    def again(coarser=1.0, order=2, **knobs):
        return off_by(linear if order == 1 else 0.1 * coarser**2)

    return of_elements.estimated(off_by(0.1), again, kind)


def by_voxels(rule):
    levels = {64: 0, 45: 1, 32: 2}
    field = off_by(0.1, rule=rule, voxels=(64,) * 3)
    return of_voxels.estimated(field, lambda scene, voxels: off_by(0.1 * 2 ** (levels[voxels[0]] / 2)))


def by_particles(law, order, *, gaps=False):
    """Closer twins in gaps change 5 by .02 more."""

    def answer(law, wanted):
        level = {4000: 1, 1000: 2}[wanted.particles]
        more = 0.02 if gaps and law.gap_spacing < 0.8 else 0.0
        return off_by(0.1 * 4 ** (level * order / 3) + more, packing={"twins": 9, "even_twins": 8 if gaps else 9})

    return estimator_of(law, Particles(particles=16000, seed=0), answer)(off_by(0.1, packing={}))


@pytest.mark.parametrize(
    "of, conductivity, temperature",
    [
        (lambda: by_elements("curved"), 2.0, 1.2),
        (lambda: by_elements("straight"), 2.5, 1.2),
        (lambda: by_elements("linear"), 4.5, 2.0),
        (lambda: by_voxels("plain"), 2.2, 1.0),
        (lambda: by_voxels("laminate"), 1.2, 1.0),
        (lambda: by_voxels("links"), 1.5, 1.0),
        (lambda: by_particles(Laguerre(), 2), 1.0, 1.0),
        (lambda: by_particles(Laguerre(), 2, gaps=True), 1.0 + 0.2, 1.0 + 0.2),
        (lambda: by_particles(Laguerre(conforming=False), 1), 1.8, 1.0),
    ],
)
def test_methods_raise_what_they_lack_by_what_drawn_scenes_asked_for(of, conductivity, temperature):
    """Where an error of .1 grows with the order that is declared; study `estimates` has found the factors."""
    estimate = of()
    assert len(set(estimate.runs)) == 3
    # Rounding of conductivities of order one.
    assert (estimate.upper - estimate.lower) / 2 == pytest.approx(0.1 * conductivity, rel=1e-9)
    assert estimate.flux == pytest.approx(0.1 * conductivity, rel=1e-9)
    assert estimate.temperature == pytest.approx(0.1 / 3 * temperature, rel=1e-9)


def test_particles_beside_edges_are_of_first_order():
    rod = Scene((1.0,) * 3, Material(1.0), [Box((0.5,) * 3, (0.5,) * 3, Material(1e9))], gradient=(1.0, 0.0, 0.0))

    def of(error):
        field = off_by(error, packing={})
        field.scene, field.fractions = rod, fractions(rod)
        return field

    def answer(law, wanted):
        return of(0.1 * 4 ** ({4000: 1, 1000: 2}[wanted.particles] / 3))

    estimate = estimator_of(Laguerre(), Particles(particles=16000, seed=0), answer)(of(0.1))
    assert (estimate.upper - estimate.lower) / 2 == pytest.approx(0.1, rel=1e-9)


def test_closer_twins_count_twice_around_coats():
    scene = gallery.coated_sphere(3.0, 2.0)

    def of(error):
        field = off_by(error, packing={"twins": 9, "even_twins": 8})
        field.scene, field.fractions, field.temperature_at = scene, fractions(scene), lambda points: points[:, 0]
        return field

    def answer(law, wanted):
        more = 0.02 if law.gap_spacing < 0.8 else 0.0
        return of(0.1 * 4 ** ({4000: 1, 1000: 2}[wanted.particles] * 2 / 3) + more)

    estimate = estimator_of(Laguerre(), Particles(particles=16000, seed=0), answer)(of(0.1))
    # With the square of their distance, .7 of it.
    assert (estimate.upper - estimate.lower) / 2 == pytest.approx(0.1 + 0.02 / (1 - 0.49), rel=1e-9)


@pytest.mark.parametrize("name", ["dem", "fem", "fft", "multipole"])
def test_methods_know_how_far_they_are_off(name):
    """On the sphere in a cube, at the suite's coarse resolution; off the middle, for no symmetry to help."""
    method, scene = METHODS[name], gallery.sphere_in_cube(10.0)
    right = exact.solve(scene)
    module = {"dem": None, "fem": fem, "fft": fft, "multipole": multipole}[method.module]
    knobs = method.knobs | method.at(method.coarse, scene.size[0])
    field = (module.solve if module else solve)(scene, **knobs)
    estimate = field.error
    assert estimate.lower <= right.conductivity <= estimate.upper
    assert estimate is field.error  # made once
    points = np.random.default_rng(5).random((300, 3)) * scene.size
    off = np.sqrt(np.mean((field.temperature_at(points) - right.temperature_at(points)) ** 2))
    assert off <= estimate.temperature


def test_stopped_heat_is_exactly_none():
    layer = Layer(1, 0.4, 0.6, Material(0.0))
    scene = Scene((1.0,) * 3, Material(1.0), [layer], walls={"y-": 0.0, "y+": 1.0})
    for field in (solve(scene, particles=1000), fft.solve(scene, voxels=16)):
        assert (field.error.lower, field.error.upper) == (0.0, 0.0)


def test_loads_without_a_conductivity_have_none():
    scene = Scene((1.0,) * 3, Material(1.0), [Sphere((0.5,) * 3, 0.3, Material(5.0))], walls={"x-": 0.0, "y+": 1.0})
    estimate = solve(scene, particles=1000).error
    assert math.isnan(estimate.lower) and math.isnan(estimate.upper)
    assert 0 < estimate.temperature < 1


def test_in_time_temperatures_are_estimated():
    metal = Material(conductivity=2.0, density=1.0, heat_capacity=1.0)
    scene = Scene((1.0,) * 3, metal, walls={"y-": 0.0, "y+": 1.0}, initial=0.0)
    points = np.random.default_rng(5).random((300, 3))
    (right,) = series.evolve(scene, [0.02])
    for fields in (evolve(scene, [0.02], particles=1000), fem.evolve(scene, [0.02], size=0.25)):
        (field,) = fields
        off = np.sqrt(np.mean((field.temperature_at(points) - right.temperature_at(points)) ** 2))
        assert off <= field.error.temperature < 0.2
        assert math.isnan(field.error.lower)
    assert right.error.temperature < 1e-11
