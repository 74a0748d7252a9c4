"""Parts of the walkers beside slow or exact forms: a biased step would hide in the noise of whole walks."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.scene import Layer, LevelSet, Material, Scene, Sphere
from references.walkers import steps, sums
from references.walkers.sampled import Sampled
from references.walkers.surfaces import Surfaces

CELL = (1.0, 0.8, 1.2)


def scene(**load):
    spheres = [Sphere((0.2, 0.3, 0.4), 0.18, Material(3.0)), Sphere((0.7, 0.5, 0.8), 0.22, Material(0.2))]
    spheres.append(Sphere((0.7, 0.5, 0.8), 0.1, Material(7.0)))
    return Scene(CELL, Material(1.0), spheres, **(load or {"gradient": (1.0, 0.0, 0.0)}))


def test_the_nearest_surface_in_a_cell():
    body, points = scene(), np.random.default_rng(0).uniform(-2.0, 2.0, (500, 3))
    number, away, following = Surfaces(body, 0.5).nearest(points)
    slow = np.sort(np.abs([s.distance(points, period=body.period) for s in body.inclusions]), axis=0)
    assert_allclose(away, slow[0], atol=1e-14)  # rounding of places up to two periods away
    # The next one is found where it is within reach, and beyond nothing nearer than that.
    assert_allclose(np.minimum(following, 0.5), np.minimum(slow[1], 0.5), atol=1e-14)
    own = np.abs(
        [body.inclusions[n].distance(x[None], period=body.period)[0] for n, x in zip(number, points, strict=True)]
    )
    assert_allclose(own, away, atol=1e-14)


def test_many_surfaces_are_filed_in_cells():
    spheres = [
        Sphere((x, y, z), 0.08, Material(2.0)) for x in (0.1, 0.35, 0.6, 0.85) for y in (0.2, 0.6) for z in (0.3, 0.9)
    ]
    body = Scene(CELL, Material(1.0), spheres, gradient=(1.0, 0.0, 0.0))
    surfaces, points = Surfaces(body, 0.1), np.random.default_rng(0).random((800, 3)) * CELL
    assert surfaces.dims.prod() > 10
    slow = np.sort(np.abs([s.distance(points, period=body.period) for s in spheres]), axis=0)
    _, away, following = surfaces.nearest(points)
    assert_allclose(away, slow[0], atol=1e-15)  # rounding
    assert_allclose(np.minimum(following, 0.1), np.minimum(slow[1], 0.1), atol=1e-15)


def test_a_box_is_mirrored_in_its_walls():
    body = scene(walls={"x-": 0.0, "x+": 1.0})
    surfaces, points = Surfaces(body, 0.1), np.random.default_rng(0).random((300, 3)) * CELL
    number, away, _ = surfaces.nearest(points)
    mirrored, shifted = points * [1, -1, 1], points + [0, 2 * CELL[1], 0]
    for other in (mirrored, shifted):
        assert_allclose(surfaces.nearest(other)[1], away, atol=1e-13)  # rounding of the fold
        assert np.array_equal(surfaces.phase(other), surfaces.phase(points))
    _, normal = surfaces.side(points, number)
    assert_allclose(surfaces.side(mirrored, number)[1], normal * [1, -1, 1], atol=1e-12)


def test_surfaces_that_lie_on_each_other_are_one():
    layers = [Layer(0, 0.2, 0.5, Material(2.0)), Layer(0, 0.5, 0.9, Material(3.0))]
    body = Scene(CELL, Material(1.0), layers, gradient=(1.0, 0.0, 0.0))
    _, away, following = Surfaces(body, 0.1).nearest(np.array([[0.49, 0.1, 0.1]]))
    assert_allclose(away, 0.01)
    assert following[0] > 0.1
    # One without a jump is none.
    same = Scene(CELL, Material(1.0), [*layers, Sphere((0.7, 0.4, 0.5), 0.1, Material(3.0))], gradient=(1.0, 0.0, 0.0))
    assert len(Surfaces(same, 0.1).shapes) == 2


@pytest.mark.parametrize("period", [None, np.ones(3)])
def test_a_shape_asked_at_nodes(period):
    center = np.array([0.5, 0.5, 0.5] if period is None else [0.1, 0.5, 0.5])
    shape = LevelSet(lambda x: ((x - center) ** 2).sum(1) ** 2 - 0.0081, (center - 0.35, center + 0.35), Material(2.0))
    points = np.random.default_rng(0).random((3000, 3))
    offsets = points - center
    offsets -= 0 if period is None else np.round(offsets)
    true = np.linalg.norm(offsets, axis=1) - 0.3
    sampled = Sampled(shape, np.ones(3), period)
    found = sampled.distance(points, period=period)
    # Nearby the distance, but for the slope of the nodes', 1 - cos of some 3 / 32 / 0.3; elsewhere no more than it.
    near = np.abs(true) < 0.5 / 32
    assert near.sum() > 100
    assert_allclose(found[near], true[near], atol=0.02 / 32)
    assert np.all(np.abs(found) < np.abs(true) * 1.01 + 1e-4)
    assert np.median(np.abs(found) / np.abs(true)) > 0.5
    away, slope = sampled.surface(points[near], period=period)
    feet = points[near] - away[:, None] * slope
    inner, outer = (shape.contains(feet + sign * 2e-5 * slope, period=period) for sign in (-1, 1))
    assert inner.all() and not outer.any()


def test_leaps_have_no_drift_and_the_mean_squares_that_are_told():
    """At a surface too, where the walker itself drifts to the better conductor."""
    body = Scene((1.0,) * 3, Material(1.0), [Layer(0, 0.25, 0.75, Material(4.0))], gradient=(1.0, 0.0, 0.0))
    through, surfaces = steps.medium(body, 0.1, np.eye(3)), Surfaces(body, 0.2)
    count, rng = 40000, np.random.default_rng(0)
    place, phase = np.tile([0.25, 0.3, 0.3], (count, 1)), np.zeros(count, int)
    added = steps.advance(surfaces, through, place, phase, rng)
    root = np.sqrt(count)
    for which in (steps.LEAPS, steps.RESISTED):
        own = added[:, which]
        assert np.all(np.abs(own.mean(axis=0)) < 4 * own.std(axis=0) / root)
    leaps, resisted = added[:, steps.LEAPS], added[:, steps.RESISTED]
    both, own = through.columns
    told = (added[:, [steps.SQUARE] * 3], added[:, both], added[:, own])
    for product, mean in zip((leaps**2, leaps * resisted, resisted**2), told, strict=True):
        assert np.all(np.abs((product - mean).mean(axis=0)) < 4 * product.std(axis=0) / root)
    # Four times as often into what conducts four times as well; one attempt in 1 / .625 is taken.
    moved = np.linalg.norm(added[:, steps.PLACE], axis=1) > 0.05
    assert abs(moved.mean() - 0.625) < 4 * 0.49 / root
    assert abs((added[moved, 0] > 0).mean() - 0.8) < 4 * 0.4 / np.sqrt(moved.sum())
    assert np.array_equal(phase[moved] == 1, added[moved, 0] > 0)
    # The ball holds a walker R^2 / 6 of its own time: here the sides' capacities are 1, their mean conductivity 2.5.
    assert_allclose(added[:, steps.CLOCK].mean() / moved.mean(), 0.01 / 6 / 2.5, rtol=4 * 0.78 / root)


def test_mean_products_at_a_surface_are_those_of_flux_and_gradient():
    """Of the temperature with the leaps as the flux, with those over conductivities as the gradient, in the ball."""
    body = Scene((1.0,) * 3, Material(1.0), [Layer(0, 0.25, 0.75, Material(4.0))], gradient=(1.0, 0.0, 0.0))
    through, surfaces, count = steps.medium(body, 0.1, np.eye(3)), Surfaces(body, 0.2), 100000
    phase = np.zeros(count, int)
    place = np.tile([0.25, 0.3, 0.3], (count, 1))
    added = steps.advance(surfaces, through, place, phase, np.random.default_rng(0))
    leaps, resisted, time = added[:, steps.LEAPS], added[:, steps.RESISTED], added[:, steps.CLOCK].mean()
    # A unit flux across the surface, and a unit gradient along it; the ball is half of 1, half of 4.
    across = np.where(phase == 1, 0.25, 1.0) * added[:, 0]
    along = added[:, 1]
    for product, expected in (
        (across * leaps[:, 0], 1.0),
        (across * resisted[:, 0], 0.5 * (1 + 0.25)),
        (along * leaps[:, 1], 2.5),
        (along * resisted[:, 1], 1.0),
    ):
        assert abs(product.mean() - 2 * time * expected) < 4 * product.std() / np.sqrt(count)


@pytest.mark.parametrize("away", [0.03, -0.03])
def test_a_bent_surface_beside_a_walker_moves_it_nowhere(away):
    """Outside and inside of a sphere: no drift, and the mean square that is told along the surface."""
    body = Scene((1.0,) * 3, Material(1.0), [Sphere((0.5,) * 3, 0.3, Material(0.25))], gradient=(1.0, 0.0, 0.0))
    through, surfaces, count = steps.medium(body, 0.15, np.eye(3)), Surfaces(body, 0.3), 100000
    place = np.tile([0.8 + away, 0.5, 0.5], (count, 1))
    phase = surfaces.phase(place)
    added = steps.advance(surfaces, through, place, phase, np.random.default_rng(0))
    leaps = added[:, steps.LEAPS]
    # Half of them leave: what is told is that they were near.
    assert 0.3 < (added[:, steps.SQUARE] < 0.0015).mean() < 0.7
    # A chance as beside a plane would be wrong by half of 0.03^2 / 0.3, three times this.
    assert abs(leaps[:, 0].mean()) < 4 * leaps[:, 0].std() / np.sqrt(count) < 0.0012
    off = leaps[:, 1:] ** 2 - added[:, [steps.SQUARE]]
    assert np.all(np.abs(off.mean(axis=0)) < 4 * off.std(axis=0) / np.sqrt(count))


def test_sums_over_lags():
    rng = np.random.default_rng(0)
    one, other = rng.normal(size=(2, 9, 4, 2))
    found = sums.over_lags(one, other, (2, 5))
    for longest, sum_ in zip((2, 5), found, strict=True):
        slow = sum(
            9 / (9 - abs(i - j)) * one[i] * other[j] for i in range(9) for j in range(9) if abs(i - j) <= longest
        )
        assert_allclose(sum_, slow, rtol=1e-12)  # rounding
    assert_allclose(sums.over_lags(one, one, (3,))[0], sums.over_lags(one, one.copy(), (3,))[0], rtol=1e-12)


def test_what_known_means_explain_is_taken_off():
    rng = np.random.default_rng(0)
    others, noise = rng.normal(size=(5000, 2)), rng.normal(size=5000)
    own = np.column_stack([2.0 + others @ [3.0, -1.0] + 0.1 * noise, others])
    said = sums.fitted(own)
    assert_allclose(said, 2.0 + 0.1 * noise, atol=0.02)  # slopes are known to .1 / sqrt(5000), four of them
    assert said.std() < 0.11


@pytest.mark.parametrize(("steady_from", "expected"), [(0, 0), (1, 1), (2, 2)])
def test_the_lag_that_is_enough(steady_from, expected):
    """Sums change up to a lag, and then only by what scatters about 0."""
    rng = np.random.default_rng(0)
    base, noise = rng.normal(size=2000), rng.normal(size=(3, 2000))
    means = np.array([1.0 if lag >= steady_from else 3.0 - lag for lag in range(3)])
    noise -= noise.mean(axis=1, keepdims=True)
    own = (means[:, None] + 0.1 * (base - base.mean()) + 0.02 * noise)[..., None]
    mean, error, lag = sums.chosen(own)
    assert lag == expected
    assert mean == pytest.approx(1.0)
    assert error == pytest.approx(0.1 / np.sqrt(2000), rel=0.1)


def test_a_change_that_is_not_for_certain_counts():
    """Of one and a half standard errors the half, in quadrature."""
    rng = np.random.default_rng(0)
    base, noise = rng.normal(size=(2, 2000))
    base, noise = base - base.mean(), noise - noise.mean()
    later = base + 0.5 * noise
    step = 1.5 * (later - base).std() / np.sqrt(1999)
    _, error, lag = sums.chosen(np.array([base, later + step])[..., None])
    assert lag == 0
    assert error == pytest.approx(np.hypot(base.std() / np.sqrt(1999), step / 3))
    # Three are a change.
    assert sums.chosen(np.array([base, later + 2 * step])[..., None])[2] == 1
