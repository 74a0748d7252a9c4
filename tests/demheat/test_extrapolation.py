"""Only here: limits that are read wrongly off coarser runs, intervals about them without their safety, or refusals."""

import math
import pickle
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from demheat import Box, Laguerre, Material, Platonic, Scene, Sphere, evolve, gallery, solve
from demheat.dem import estimate as of_particles
from demheat.dem.options import Particles
from demheat.error import Fine
from demheat.extrapolation import Limit, by_extrapolation
from demheat.scene.volumes import fractions
from references import exact, fem, fft, multipole

ONE = Material(1.0)
RULE = Limit("coarser", 2.0, 3.0, 2.0, 1.5)
PLAIN = Scene((1.0,) * 3, ONE, walls={"x-": 0.0, "x+": 1.0})


def made(level, *, order=3.0, off=0.1, scene=PLAIN, **more):
    """A solution of a body that conducts 5, off by so much, and by twice that across."""
    wrong = off * 2 ** (order * level)
    found = {"fractions": fractions(scene), "conductivity": 5 + wrong}
    return SimpleNamespace(scene=scene, time=None, mean_flux=np.array([-5 - wrong, 2 * wrong, 0.0]), **found | more)


def coarser(level, **how):
    """One run of a size."""
    yield made(level, **how)


def limit(rule=RULE, *, scene=PLAIN, fine=None, residual=0.0, first=None, **how):
    field = made(0, scene=scene, **how) if first is None else first
    return by_extrapolation(
        field, partial(coarser, scene=scene, **how), rule, residual=residual, **({} if fine is None else {"fine": fine})
    )


def test_errors_of_one_power_are_taken_off():
    found = limit()
    assert found.conductivity == pytest.approx(5.0, rel=1e-12)
    assert found.mean_flux == pytest.approx([-5.0, 0.0, 0.0], abs=1e-12)
    assert found.runs == (5.1, 5.8, 11.4) and found.order == 3.0 and found.how == "coarser"


def test_intervals_count_on_a_slower_fall():
    found = limit()
    # The second change, 5.6 for .7, asks for more: 5.6 / (4 (4 - 1)) times the safety; rounding besides.
    assert found.upper - found.conductivity == pytest.approx(1.5 * 5.6 / 12, rel=1e-9)
    assert found.conductivity - found.lower == pytest.approx(1.5 * 5.6 / 12, rel=1e-9)
    # Of the flux the component that changes most.
    assert found.flux == pytest.approx(2 * 1.5 * 5.6 / 12, rel=1e-9)
    left = limit(residual=0.01)
    assert left.upper - left.conductivity == pytest.approx(1.5 * 5.6 / 12 + 0.01 * 5.1, rel=1e-9)
    # The first power in the end would take off all of the change, not a seventh.
    last = limit(RULE._replace(last=1.0, safety=0.5))
    assert last.upper - last.conductivity == pytest.approx(0.7 * (1 - 1 / 7), rel=1e-9)
    # Nothing conducts less than nothing.
    assert limit(off=-4.0).lower == 0.0


@pytest.mark.parametrize("order, taken", [(2.2, 2.2), (1.7, 2.0), (3.4, 3.0), (1.2, math.inf), (3.6, math.inf)])
def test_an_order_that_sizes_must_show_is_taken_where_it_is_believed(order, taken):
    found = limit(RULE._replace(shown=(1.5, 3.5)), order=order)
    assert found.order == pytest.approx(taken, rel=1e-9)
    first, second = 5.1, 5 + 0.1 * 2**order
    left = 0.0 if taken == math.inf else (second - first) / (2**taken - 1)
    assert found.conductivity == pytest.approx(first - left, rel=1e-12)


def test_runs_that_turn_show_no_order():
    turned = {1: 5.3, 2: 5.0}
    rule = RULE._replace(shown=(1.5, 3.5))
    found = by_extrapolation(made(0), lambda level: coarser(level, conductivity=turned[level]), rule)
    assert found.conductivity == 5.1 and found.order == math.inf
    # The interval counts on what is left in the end: .3 / (2 (2 - 1)) for .3 / (4 (4 - 1)), beside .2 for .2 / 3.
    assert found.upper - 5.1 == pytest.approx(1.5 * 0.2 / 3, rel=1e-9)
    last = by_extrapolation(made(0), lambda level: coarser(level, conductivity=turned[level]), rule._replace(last=1.0))
    assert last.upper - 5.1 == pytest.approx(1.5 * 0.2, rel=1e-9)


def test_a_run_that_is_close_by_luck_is_told_by_another():
    def twice(level):
        yield made(level, conductivity=5.1 if level == 1 else 11.4)
        if level == 1:
            yield made(level)

    lucky, told = (by_extrapolation(made(0), of, RULE._replace(slow=1.0, safety=1.0)) for of in (coarser, twice))
    # The first run tells the limit, the other the change: 5.6 and .7 or, from 5.1 to 11.4, 6.3.
    assert told.conductivity == 5.1 and lucky.conductivity == pytest.approx(5.0, rel=1e-12)
    assert told.upper - 5.1 == pytest.approx(6.3 / 2, rel=1e-9)
    near = by_extrapolation(made(0), lambda level: twice(1), RULE._replace(slow=1.0, safety=1.0))
    assert near.upper - near.conductivity == pytest.approx(0.7, rel=1e-9)


def test_what_is_misplaced_in_all_runs_counts_besides():
    ball = Scene((1.0,) * 3, ONE, [Sphere((0.5,) * 3, 0.3, Material(9.0))], gradient=(-1.0, 0.0, 0.0))
    share = 0.27
    own = np.array([1 - share, share])
    found = limit(scene=ball, first=made(0, scene=ball, fractions=own))
    exactly = limit(scene=ball)
    # No other run has it: its part of what the ball makes, less what the change of it shows.
    part = 1 - fractions(ball)[1] / share
    shown = part / 3
    assert found.upper - exactly.upper == pytest.approx((part - shown) * 4.1, rel=1e-6)
    rough = limit(scene=ball, fine=Fine(rough=0.1))
    assert rough.upper - exactly.upper == pytest.approx(0.1 * 4.1, rel=1e-9)
    least = limit(scene=ball, fine=Fine(least=0.5))
    assert least.upper - least.lower == pytest.approx(2 * 0.5 * 4.1, rel=1e-9)


def test_what_coarser_runs_do_not_tell_of_is_refused():
    square = Scene((1.0,) * 3, ONE, [Box((0.5,) * 3, (0.4,) * 3, Material(9.0))], gradient=(1.0, 0.0, 0.0))
    ball = Sphere((0.5,) * 3, 0.3, Material(9.0))
    nested = Scene((1.0,) * 3, ONE, [ball, Sphere((0.5,) * 3, 0.2, Material(2.0))], gradient=(1.0, 0.0, 0.0))
    one = Scene((1.0,) * 3, ONE, [ball], gradient=(1.0, 0.0, 0.0))
    for refused, scene, how in (
        ("beside edges", square, {}),
        ("in others", nested, {}),
        ("finer than", one, {"fine": Fine([0])}),
        ("finer than", one, {"fractions": np.array([1.0, 0.0])}),
    ):
        with pytest.raises(NotImplementedError, match=f"extrapolated: .*{refused}"):
            limit(scene=scene, **how)

    def too_coarse(level):
        raise ValueError("voxels = 1")

    with pytest.raises(RuntimeError, match="no coarser runs to go by: voxels = 1"):
        by_extrapolation(made(0), too_coarse, RULE)


def test_methods_close_in_on_what_is_exact():
    """What is left of errors was found to be a fifth and two fifths; the DEM takes something off near one body only."""
    half = gallery.sphere_in_cube(10.0, fraction=0.5)
    right = exact.solve(half).conductivity
    fields = {
        0.5: solve(half, particles=16_000),
        0.8: fem.solve(half, size=0.01),
    }
    ball = gallery.sphere_in_cube(10.0)
    for most, field in [*fields.items(), (0.6, fft.solve(ball, voxels=48))]:
        k = right if field.scene is half else exact.solve(ball).conductivity
        found = field.extrapolated
        assert abs(found.conductivity - k) < most * abs(field.conductivity - k)
        assert found.lower <= k <= found.upper and len(found.runs) == 3
        assert field.extrapolated is found


def test_the_dem_takes_nothing_off_where_few_particles_lie_across_a_body():
    """Ten particles or so in a sphere show powers by chance."""
    cell = gallery.random_dispersion(20, fraction=0.1)
    field = solve(cell, particles=4000)
    found = field.extrapolated
    assert found.conductivity == field.conductivity and found.order == math.inf
    right = multipole.solve(cell, accuracy=1e-5).conductivity
    assert found.lower < right < found.upper


def test_a_whole_tensor_is_extrapolated():
    scene = Scene(
        (1.0, 1.2, 0.9),
        ONE,
        [Sphere((0.3, 0.3, 0.3), 0.22, Material(8.0)), Sphere((0.55, 0.62, 0.52), 0.15, Material(20.0))],
        gradient=(0.0, 1.0, 0.0),
    )
    right = np.stack([each.mean_flux for each in multipole.solve_axes(scene, accuracy=1e-6)])
    fields = fft.solve_axes(scene, voxels=40)
    limits = [each.extrapolated for each in fields]
    before = np.abs([each.mean_flux for each in fields] - right).max()
    after = np.abs([each.mean_flux for each in limits] - right)
    assert after.max() < 0.7 * before
    assert np.all(after <= np.array([[each.flux] for each in limits]))


def test_who_has_no_limit_says_so():
    ball = gallery.sphere_in_cube(10.0, fraction=0.05)
    for field in (
        exact.solve(ball),
        solve(ball, particles=500, law="platonic"),
        solve(ball, particles=500, conforming=False),
        fem.solve(ball, size=0.03, order=1),
        fft.solve(ball, voxels=16, rule="plain"),
    ):
        with pytest.raises(NotImplementedError, match=r"Field\.extrapolated"):
            field.extrapolated  # noqa: B018 - made when it is asked for
    hot = gallery.slab()
    (later,) = evolve(Scene(hot.size, hot.matrix, walls=hot.walls, initial=25.0), [0.1], particles=300)
    with pytest.raises(NotImplementedError, match="steady fields"):
        later.extrapolated  # noqa: B018
    assert of_particles.extrapolator_of(Platonic(), Particles(particles=1000, seed=0), None) is None
    assert of_particles.extrapolator_of(Laguerre(), Particles(particles=1000, seed=0), None) is not None


def test_a_stored_field_keeps_a_limit_that_was_asked_for():
    field = fft.solve(gallery.sphere_in_cube(10.0), voxels=20)
    with pytest.raises(NotImplementedError, match="a stored field"):
        pickle.loads(pickle.dumps(field)).extrapolated  # noqa: B018
    found = field.extrapolated
    assert pickle.loads(pickle.dumps(field)).extrapolated.conductivity == found.conductivity
