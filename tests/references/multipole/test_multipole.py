"""Multipoles beside cubic arrays and voxels; the truncation they tell is no less than what is left."""

import math
from dataclasses import replace

import numpy as np
import pytest
from multipole_scenes import CUBIC, PARTS, box
from numpy.testing import assert_allclose

from demheat import Material, Scene, Sphere, gallery
from references import fft, multipole
from references.exact import lattice
from references.multipole import truncation
from references.multipole.fast import FastMultipole, plan

# Cubic arrays.


@pytest.mark.parametrize("kind", CUBIC)
@pytest.mark.parametrize(("contrast", "fraction"), [(0.0, 0.4), (1e6, 0.2)])
def test_cubic_arrays_as_cells_of_one_two_and_four_spheres(kind, contrast, fraction):
    scene = CUBIC[kind](contrast, fraction=fraction, axis=1)
    found = multipole.solve(scene, order=20, tolerance=1e-12)
    expected = scene.matrix.conductivity * lattice.conductivity(kind, contrast, fraction, order=51, digits=10)
    # Order 20 leaves 5e-10 at most (the pores in the simple cubic array).
    assert_allclose(found.conductivity, expected, rtol=1e-8)
    assert_allclose(found.mean_flux[[0, 2]], 0, rtol=0, atol=1e-11 * abs(found.mean_flux[1]))  # rounding
    assert_allclose(found.fractions[1:].sum(), fraction, rtol=1e-14)


# Any spheres.


def test_an_arrangement_without_symmetry_agrees_with_voxels():
    found = multipole.solve(box(), order=10).mean_flux[2]
    coarse, fine = (fft.solve(box(), voxels=n, threads=1).mean_flux[2] for n in (32, 64))
    # Laminate voxels err at first order or a little better, here 2.0e-3 and 0.72e-3 (0.32e-3 at 128).
    assert_allclose(found, fine, rtol=1e-3)
    assert 1.8 < (coarse - found) / (fine - found) < 4


@pytest.mark.parametrize(("radius", "size"), [(1e-3, (1.0, 1.0, 1.0)), (1e-30, (1.0, 0.1, 1.0))])
def test_tiny_spheres_in_large_and_flat_cells(radius, size):
    """In the limit each is alone: a dipole in a matrix, the flux within it 3 k/(k + 2) times the matrix's."""
    spheres = [Sphere(np.multiply(where, size), radius, Material(5.0)) for where in ((0.5, 0.5, 0.5), (0.2, 0.3, 0.4))]
    field = multipole.solve(Scene(size, Material(1.0), spheres, gradient=(0.0, 1.0, 0.0)), points_per_axis=2)
    dilute = 1 + 3 * (5 - 1) / (5 + 2) * 2 * 4 / 3 * math.pi * radius**3 / math.prod(size)
    # Neighbours, their images included, are 0.1 away at least: 8 of their fields of (r/0.1)^3, and rounding.
    assert_allclose(field.conductivity, dilute, rtol=8 * (10 * radius) ** 3 * (dilute - 1) + 1e-13)
    inside = field.flux_at([spheres[0].center])[0]
    assert_allclose(inside, [0, -15 / 7, 0], atol=20 * (10 * radius) ** 3 + 1e-13)


def test_no_contrast_and_no_spheres():
    for parts in ([], [(center, radius, 1.0) for center, radius, _ in PARTS]):
        field = multipole.solve(box((1.0, 2.0, 3.0), parts=parts))
        points = np.random.default_rng(0).random((50, 3))
        assert_allclose(field.mean_flux, (-1.0, -2.0, -3.0), rtol=1e-14)
        assert_allclose(field.temperature_at(points), points @ (1.0, 2.0, 3.0), rtol=1e-13)
        assert_allclose(field.flux_at(points), np.tile(field.mean_flux, (50, 1)), rtol=1e-13)
        assert field.stats["truncation"] == 0


def test_a_solve_that_does_not_converge_raises(monkeypatch):
    monkeypatch.setattr("references.multipole.system.MOST_ITERATIONS", 3)
    with pytest.raises(RuntimeError, match="residual .* after 3 iterations"):
        multipole.solve(box(), order=6)


# Order.


def test_conductivity_rises_to_its_limit_and_the_stated_error_covers_what_is_left():
    scene = gallery.random_dispersion(12, fraction=0.25, gap=0.05, seed=3, axis=2)
    limit = multipole.solve(scene, order=16).conductivity
    errors = []
    for order in (4, 6, 8, 10):
        found = multipole.solve(scene, order=order)
        errors.append(limit - found.conductivity)
        # Truncated multipoles are trial fields: spheres that conduct better approach from below.
        assert 0 < errors[-1] < found.stats["truncation"] * limit < 10 * errors[-1]
    assert all(b < 0.5 * a for a, b in zip(errors[:-1], errors[1:], strict=True))
    free = multipole.solve(scene, accuracy=1e-4)
    assert abs(free.conductivity / limit - 1) < 1e-4
    orders, values = zip(*free.stats["convergence"], strict=True)
    assert orders[-1] == free.stats["order"]
    assert values[-1] == pytest.approx(free.conductivity, rel=1e-14)


def test_half_of_the_interval_is_within_the_accuracy():
    scene = gallery.random_dispersion(12, fraction=0.25, gap=0.01, seed=3, axis=2)
    field = multipole.solve(scene, accuracy=1e-3)
    # No more degrees than that takes: two of them leave 1/4 here.
    assert 2.5e-4 < field.error.upper / field.conductivity - 1 <= 1e-3
    # The linear system's residual is in the interval, too.
    for accuracy in np.geomspace(1e-2, 1e-3, 6):
        loose = multipole.solve(scene, accuracy=accuracy, tolerance=0.9 * accuracy)
        assert loose.error.upper / loose.conductivity - 1 <= accuracy
    with pytest.raises(ValueError, match="tolerance = 0.00095: must be <= 0.9 of the accuracy, 0.001"):
        multipole.solve(scene, accuracy=1e-3, tolerance=9.5e-4)


@pytest.mark.parametrize("core", [0.0, math.inf])
def test_intervals_beside_small_satellites_hold(core):
    """Terms of a large sphere fall more slowly beside small ones than beside its like, after rising at first.

    Their centres stand at a tenth of a small radius from its surface: the law of equal spheres missed by 2.6 halves.
    """
    large, small, gap = 0.3, 0.03, 0.01
    far = (large + small + gap) / math.sqrt(3)
    ways = 0.5 + far * (np.indices((2, 2, 2)).reshape(3, -1).T * 2 - 1)
    spheres = [Sphere((0.5,) * 3, large, Material(core)), *(Sphere(way, small, Material(1e4)) for way in ways)]
    scene = Scene((1,) * 3, Material(1.0), spheres, gradient=(0, 0, 1))
    # Of 28 degrees the next twelve change 2e-5: a fiftieth of the narrowest half.
    found = multipole.solve(scene, order=28, accuracy=1e-6).conductivity
    for accuracy in (1e-2, 1e-3):
        field = multipole.solve(scene, accuracy=accuracy)
        assert field.error.lower < found < field.error.upper
        assert field.error.upper - field.error.lower <= 2 * accuracy * found


def test_spheres_that_touch_are_solved_by_pairs_to_be_as_exact():
    """In the limit of a chain of good conductors no plain order would do."""
    scene = gallery.simple_cubic(1e3, fraction=math.pi / 6 * 0.9999)
    field = multipole.solve(scene, accuracy=1e-3)
    assert field.stats["pairs"] > 0 and field.stats["truncation"] + field.stats["inexactness"] <= 1e-3


def test_an_interval_knows_how_exactly_cells_exchange(monkeypatch):
    """Few degrees suffice of surfaces that resist, and solved to a hundredth they are off by that."""
    plain = gallery.random_dispersion(12, fraction=0.2, seed=3, axis=2)
    film = 0.5 * plain.inclusions[0].radius / plain.matrix.conductivity
    scene = replace(plain, inclusions=[replace(sphere, resistance=film) for sphere in plain.inclusions])
    monkeypatch.setattr(truncation, "exchange", lambda *told: FastMultipole(told[0], plan(*told)))
    exact = multipole.solve(scene, order=12)
    rough = multipole.solve(scene, accuracy=1e-2, tolerance=1e-6)
    assert rough.stats["truncation"] + rough.stats["residual"] < abs(rough.conductivity / exact.conductivity - 1)
    assert rough.error.lower < exact.conductivity < rough.error.upper
    # The error of what cells make at each other counts for a tenth.
    assert rough.stats["inexactness"] == pytest.approx(1e-4, rel=0.1)


def test_an_order_is_solved_as_exactly_as_asked(monkeypatch):
    asked, exchange = [], truncation.exchange
    monkeypatch.setattr(truncation, "exchange", lambda *told: asked.append(told[-1]) or exchange(*told))
    exact, rough = (multipole.solve(box(), order=10, accuracy=accuracy) for accuracy in (None, 1e-3))
    assert exact.stats["residual"] <= 1e-10 < rough.stats["residual"] <= 1e-6
    assert rough.stats["iterations"] < exact.stats["iterations"]
    # Where spheres exchange by cells, a tenth of the accuracy.
    assert asked == [1e-10, pytest.approx(1e-4)]
    # What is left of the sources counts for a hundredth of that in the conductivity.
    assert rough.mean_flux[2] == pytest.approx(exact.mean_flux[2], rel=1e-6)


def test_the_error_of_an_order_is_said_where_spheres_touch():
    touching = [((0.3, 0.5, 0.5), 0.2, 1e6), ((0.7, 0.5, 0.5), 0.2, 1e6)]
    scene = box((1.0, 0.0, 0.0), parts=touching)
    rough, fine = (multipole.solve(scene, order=order) for order in (8, 24))
    left = 1 - rough.conductivity / fine.conductivity
    # It converges like a power of the order there: the geometric estimate says the size of the error, not more.
    assert left > 1e-3
    assert rough.stats["truncation"] > 0.3 * left


@pytest.mark.parametrize("gap", [0.02, 0.1])
def test_changes_fall_at_last_as_the_gap_asks(gap):
    """Good conductors in cubic order; of two steps, since every other degree hardly matters there."""
    scene = gallery.simple_cubic(1e9, fraction=4 / 3 * math.pi * (0.5 / (1 + gap)) ** 3)
    values = [k for _, k in multipole.solve(scene, order=18).stats["convergence"]]
    changes = np.diff(values[-4:])
    # At 18 degrees, still a little faster.
    assert changes[-1] / changes[-3] == pytest.approx(math.exp(-8 * math.acosh(1 + gap)), rel=0.25)


# What is refused.
