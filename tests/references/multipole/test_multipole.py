"""Spheres in a periodic cell by multipoles: against cubic arrays, plain sums, voxels, series and themselves."""

import math
from functools import cache
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Layer, Material, Scene, Sphere, gallery
from references import exact, fft, multipole
from references.exact import lattice
from references.multipole import solver
from references.multipole import sums as multipole_sums
from references.multipole.field import Evaluator

# A box without any symmetry, two materials, three radii; the smallest gap, 0.104, is a third of the smallest diameter.
SIZE = (1.0, 1.2, 0.9)
PARTS = [((0.05, 0.4, 0.3), 0.25, 20.0), ((0.55, 0.9, 0.2), 0.2, 20.0), ((0.5, 0.45, 0.75), 0.15, 0.1)]
CUBIC = {"sc": gallery.simple_cubic, "bcc": gallery.body_centred, "fcc": gallery.face_centred}
AXES = np.eye(3)


def box(gradient=(0.0, 0.0, 1.0), shift=(0.0, 0.0, 0.0), parts=PARTS, size=SIZE):
    spheres = [Sphere(np.add(center, shift), radius, Material(k)) for center, radius, k in parts]
    return Scene(size, Material(1.0), spheres, gradient=gradient)


@cache
def solved(order=14):
    return multipole.solve(box((0.5, -1.0, 2.0)), order=order, points_per_axis=30)


def tensor(spheres, order):
    return np.array([-multipole.solve(box(axis, parts=spheres), order=order).mean_flux for axis in AXES])


def surface_points(count):
    """Points on the surfaces, their normals and the numbers of their spheres."""
    normals = np.random.default_rng(1).normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    number = np.arange(count) % len(PARTS)
    centers, radii = np.array([c for c, _, _ in PARTS]), np.array([r for _, r, _ in PARTS])
    return centers[number] + radii[number, None] * normals, normals, number


# Cubic arrays.


@pytest.mark.parametrize("kind", CUBIC)
@pytest.mark.parametrize(("contrast", "fraction"), [(10.0, 0.3), (0.0, 0.4), (1e6, 0.2)])
def test_cubic_arrays_as_cells_of_one_two_and_four_spheres(kind, contrast, fraction):
    scene = CUBIC[kind](contrast, fraction=fraction, axis=1)
    found = multipole.solve(scene, order=20, tolerance=1e-12)
    expected = scene.matrix.conductivity * lattice.conductivity(kind, contrast, fraction)
    # Issue's tolerance; order 20 leaves 5e-10 at most (the pores in the simple cubic array).
    assert_allclose(found.conductivity, expected, rtol=1e-8)
    assert_allclose(found.mean_flux[[0, 2]], 0, rtol=0, atol=1e-11 * abs(found.mean_flux[1]))  # rounding
    assert_allclose(found.fractions[1:].sum(), fraction, rtol=1e-14)


def test_simple_cubic_array_as_eight_spheres():
    scene = gallery.simple_cubic(10.0, fraction=0.3)
    edge, sphere = scene.size[0], scene.inclusions[0]
    spheres = [
        Sphere(np.add(sphere.center, np.multiply(edge, cell)), sphere.radius, sphere.material)
        for cell in product((0, 1), repeat=3)
    ]
    doubled = Scene((2 * edge,) * 3, scene.matrix, spheres, gradient=(30.0, 20.0, 10.0))
    found = multipole.solve(doubled, order=14, tolerance=1e-12)
    expected = -scene.matrix.conductivity * lattice.conductivity("sc", 10.0, 0.3) * np.array(doubled.gradient)
    # Order 14 leaves 8e-10.
    assert_allclose(found.mean_flux, expected, rtol=3e-9)


def test_fields_of_a_cubic_array_are_the_exact_ones():
    scene = gallery.body_centred(10.0, fraction=0.3, axis=0)
    found, expected = multipole.solve(scene, order=18), exact.solve(scene)
    points = 0.3 * np.random.default_rng(0).random((500, 3)) - 0.1
    # Terms of degree 19 and more: in the flux 7e-6 of the mean at the surfaces, some tens of times less in temperature.
    assert_allclose(found.temperature_at(points), expected.temperature_at(points), rtol=0, atol=3e-7 * 10)
    assert_allclose(found.flux_at(points), expected.flux_at(points), rtol=0, atol=2e-5 * 4000)


# Any spheres.


def test_an_arrangement_without_symmetry_agrees_with_voxels():
    found = multipole.solve(box(), order=10).mean_flux[2]
    coarse, fine = (fft.solve(box(), voxels=n, threads=1).mean_flux[2] for n in (32, 64))
    # Laminate voxels err at first order or a little better, here 2.0e-3 and 0.72e-3 (0.32e-3 at 128).
    assert_allclose(found, fine, rtol=1e-3)
    assert 1.8 < (coarse - found) / (fine - found) < 4


def test_tensor_is_symmetric_and_positive():
    k = tensor(PARTS, 8)
    # Tolerance of the solves, 1e-10; symmetry holds at any order.
    assert_allclose(k, k.T, rtol=0, atol=1e-9)
    assert abs(k[0, 1]) > 1e-4
    assert np.linalg.eigvalsh(k).min() > 0.5


def test_shifting_all_spheres_changes_nothing():
    shift = (0.31, -0.77, 2.05)
    here, there = solved(), multipole.solve(box((0.5, -1.0, 2.0), shift), order=14)
    assert_allclose(there.mean_flux, here.mean_flux, rtol=1e-9)  # tolerance of the solves
    points = np.random.default_rng(2).random((200, 3)) * SIZE
    moved = there.temperature_at(points + shift) - np.dot((0.5, -1.0, 2.0), shift)
    # Tolerance of the solves again; a point beside a surface could change sides by rounding, none does.
    assert_allclose(moved, here.temperature_at(points), rtol=0, atol=1e-8)
    assert_allclose(there.flux_at(points + shift), here.flux_at(points), rtol=0, atol=1e-7)


def test_turning_the_cell_turns_the_flux():
    turned = [(np.roll(center, 1), radius, k) for center, radius, k in PARTS]
    scene = box(np.roll((0.5, -1.0, 2.0), 1), parts=turned, size=tuple(np.roll(SIZE, 1)))
    found = multipole.solve(scene, order=14).mean_flux
    assert_allclose(found, np.roll(solved().mean_flux, 1), rtol=1e-9)  # tolerance of the solves


def test_dilute_spheres_of_two_materials():
    parts = [((0.2, 0.3, 0.25), 0.04, 30.0), ((0.7, 0.8, 0.6), 0.06, 0.2), ((0.3, 0.9, 0.7), 0.05, 30.0)]
    beta = np.array([(k - 1) / (k + 2) for _, _, k in parts])
    phi = np.array([4 / 3 * math.pi * r**3 for _, r, _ in parts]) / np.prod(SIZE)
    first = 3 * np.sum(phi * beta)
    # Over the three axes dipoles act on each other only through their mean, as in Maxwell's formula at second order.
    found = np.trace(tensor(parts, 4)) / 3
    # Third order: fractions of 1e-3 times (radius/distance)^6, 1e-5 at most.
    assert_allclose(found - 1, first + first**2 / 3, rtol=0, atol=3e-8)
    assert abs(first**2 / 3) > 3e-7


def test_no_contrast_and_no_spheres():
    for parts in ([], [(center, radius, 1.0) for center, radius, _ in PARTS]):
        field = multipole.solve(box((1.0, 2.0, 3.0), parts=parts))
        points = np.random.default_rng(0).random((50, 3))
        assert_allclose(field.mean_flux, (-1.0, -2.0, -3.0), rtol=1e-14)
        assert_allclose(field.temperature_at(points), points @ (1.0, 2.0, 3.0), rtol=1e-13)
        assert_allclose(field.flux_at(points), np.tile(field.mean_flux, (50, 1)), rtol=1e-13)
        assert field.stats["truncation"] == 0


# Order.


def test_conductivity_rises_to_its_limit_and_the_stated_error_covers_what_is_left():
    scene = gallery.random_dispersion(12, fraction=0.25, gap=0.05, seed=3, axis=2)
    limit = multipole.solve(scene, order=18).conductivity
    errors = []
    for order in (4, 6, 8, 10):
        found = multipole.solve(scene, order=order)
        errors.append(limit - found.conductivity)
        # Truncated multipoles are trial fields: spheres that conduct better approach from below.
        assert 0 < errors[-1] < found.stats["truncation"] * limit < 30 * errors[-1]
    assert all(b < 0.5 * a for a, b in zip(errors[:-1], errors[1:], strict=True))
    free = multipole.solve(scene, accuracy=1e-4)
    assert abs(free.conductivity / limit - 1) < 1e-4
    orders, values = zip(*free.stats["convergence"], strict=True)
    assert orders[-1] == free.stats["order"]
    assert values[-1] == pytest.approx(free.conductivity, rel=1e-14)


def test_touching_spheres_are_refused_or_their_error_is_said():
    touching = [((0.3, 0.5, 0.5), 0.2, 1e6), ((0.7, 0.5, 0.5), 0.2, 1e6)]
    scene = box((1.0, 0.0, 0.0), parts=touching)
    with pytest.raises(RuntimeError, match="smallest gap .* needs order"):
        multipole.solve(scene, accuracy=1e-9)
    rough, fine = (multipole.solve(scene, order=order) for order in (8, 24))
    left = 1 - rough.conductivity / fine.conductivity
    # It converges like a power of the order there: the geometric estimate says the size of the error, not more.
    assert left > 1e-3
    assert rough.stats["truncation"] > 0.3 * left


# Fields.


def test_temperature_and_normal_flux_are_continuous():
    jumps = []
    for order in (8, 14):
        points, normals, number = surface_points(300)
        out, into = points + 1e-9 * normals, points - 1e-9 * normals
        field = solved(order)
        step = field.temperature_at(out) - field.temperature_at(into)
        turn = np.einsum("ij,ij->i", field.flux_at(out) - field.flux_at(into), normals)
        jumps.append((np.abs(step).max(), np.abs(turn).max() / np.linalg.norm(field.mean_flux)))
    # What degrees above the order leave, falling with it; 1e-9 times the jump of the slope besides.
    assert jumps[1][0] < 3e-5
    assert jumps[1][1] < 3e-3
    assert jumps[1][0] < 0.2 * jumps[0][0]
    assert jumps[1][1] < 0.3 * jumps[0][1]
    # The bound that is stated is of the size of the jumps.
    assert 0.05 < jumps[1][1] / solved().stats["field_truncation"] < 20


def test_flux_is_the_slope_of_the_temperature():
    field = solved()
    points, normals, _ = surface_points(60)
    h = 1e-5
    # A hundredth inside and outside of surfaces; central differences err by h^2 = 1e-10 times third derivatives, 1e3.
    for place in (points + 0.01 * normals, points - 0.01 * normals, 0.3 * points):
        slope = [(field.temperature_at(place + h * e) - field.temperature_at(place - h * e)) / (2 * h) for e in AXES]
        k = field.scene.conductivities[field.scene.phase_at(place)]
        assert_allclose(field.flux_at(place), -k[:, None] * np.transpose(slope), rtol=0, atol=1e-6 * 20)


def test_temperature_is_periodic_but_for_the_mean_gradient():
    field, points = solved(), np.random.default_rng(4).random((50, 3)) * SIZE
    away = points + np.array(SIZE) * (3, -2, 1)
    rise = np.dot(np.array(SIZE) * (3, -2, 1), (0.5, -1.0, 2.0))
    assert_allclose(field.temperature_at(away) - rise, field.temperature_at(points), rtol=0, atol=1e-12)  # rounding
    assert_allclose(field.flux_at(away), field.flux_at(points), rtol=0, atol=1e-10)  # rounding


def test_samples_average_to_the_mean_flux():
    samples, field = solved().samples, solved()
    assert_allclose(samples.volumes.sum(), field.scene.volume, rtol=1e-12)
    mean = samples.volumes @ samples.flux / samples.volumes.sum()
    # Midpoints of 30^3 cells, 1 in 10 cut by a surface at random.
    assert_allclose(mean, field.mean_flux, rtol=0, atol=0.01 * np.linalg.norm(field.mean_flux))
    periodic = samples.temperature - samples.points @ (0.5, -1.0, 2.0)
    assert abs(samples.volumes @ periodic) < 1e-3 * np.abs(periodic).max() * field.scene.volume
    assert_allclose(np.bincount(samples.phase) / len(samples.phase), field.fractions, rtol=0, atol=2e-3)


def test_field_does_not_depend_on_the_splitting(monkeypatch):
    spheres, _ = solver._spheres(box())
    history = solver._converged(spheres, np.array([0.3, 0.5, 1.0]), 6, 1e-5, 1e-12, 1, 1.0)
    points = np.random.default_rng(5).random((100, 3)) * spheres.size
    found = []
    for eta in (1.0, 3.0, 8.0):
        split = multipole_sums.splitting(spheres.size, 0.5, 6, eta)
        monkeypatch.setattr("references.multipole.field._splitting", lambda spheres, order, split=split: split)
        found.append(Evaluator(spheres, history[-1], (0.3, 0.5, 1.0))(points)[0])
    # Rounding: waves of degree 1 cancel to a digit or two.
    assert_allclose(found[1], found[0], rtol=0, atol=1e-12)
    assert_allclose(found[2], found[0], rtol=0, atol=1e-12)


def test_a_solve_that_does_not_converge_raises(monkeypatch):
    monkeypatch.setattr("references.multipole.system.MOST_ITERATIONS", 3)
    with pytest.raises(RuntimeError, match="residual .* after 3 iterations"):
        multipole.solve(box(), order=6)


# zeta_2.


@pytest.mark.parametrize("kind", CUBIC)
def test_zeta2_of_cubic_arrays(kind):
    for fraction in (4 * math.pi / 81, 0.5):
        found = multipole.zeta2(CUBIC[kind](fraction=fraction))
        assert_allclose(found, lattice.zeta2(kind, fraction), rtol=1e-10)  # degrees left out, 1e-11
    if kind == "sc":
        assert_allclose(found, 0.17376, rtol=0, atol=5e-6)  # half a unit of the last digit printed


def test_zeta2_is_the_third_order_of_the_conductivity():
    parts = [(center, radius, 1.0) for center, radius, _ in PARTS]
    phi, found = sum(4 / 3 * math.pi * r**3 for _, r, _ in parts) / np.prod(SIZE), []
    for beta in (0.02, -0.02):
        k = np.trace(tensor([(c, r, (1 + 2 * beta) / (1 - beta)) for c, r, _ in parts], 8)) / 3
        found.append(((k - 1 - 3 * phi * beta - 3 * (phi * beta) ** 2) / beta**3 - 3 * phi**3) / (6 * phi * (1 - phi)))
    # The mean of both signs is even in beta: beta^2 = 4e-4 of c_3 remains, ten times more of zeta_2.
    assert_allclose(np.mean(found), multipole.zeta2(box(parts=parts)), rtol=4e-3)


def test_zeta2_ignores_shifts_and_conductivities():
    parts = [(center, radius, 7.0) for center, radius, _ in PARTS]
    pores = [(center, radius, 0.0) for center, radius, _ in PARTS]
    value = multipole.zeta2(box(parts=parts))
    assert_allclose(multipole.zeta2(box(shift=(0.4, 0.1, -0.3), parts=pores)), value, rtol=1e-10)  # rounding, amplified
    assert 0 < value < 1


# What is refused.


def test_what_it_cannot_do_it_says():
    material = Material(5.0)
    walls = Scene((1.0,) * 3, Material(1.0), [Sphere((0.5,) * 3, 0.2, material)], walls={"x-": 0.0, "x+": 1.0})
    layers = Scene((1.0,) * 3, Material(1.0), [Layer(0, 0.2, 0.4, material)], gradient=(1.0, 0.0, 0.0))
    nested = Scene(
        (1.0,) * 3,
        Material(1.0),
        [Sphere((0.5,) * 3, 0.4, material), Sphere((0.5,) * 3, 0.2, Material(2.0))],
        gradient=(1.0, 0.0, 0.0),
    )
    dead = Scene((1.0,) * 3, Material(0.0), [Sphere((0.5,) * 3, 0.2, material)], gradient=(1.0, 0.0, 0.0))
    for scene, reason in (
        (walls, "Scene.walls = "),
        (layers, r"a layer, Scene.inclusions\[0\]: multipole knows disjoint spheres"),
        (nested, r"Scene.inclusions\[1\], nested in \[0\]"),
        (dead, "no conductivity"),
    ):
        with pytest.raises(NotImplementedError, match=reason):
            multipole.solve(scene)
    for scene in (walls, layers, nested):
        with pytest.raises(NotImplementedError):
            multipole.zeta2(scene)


@pytest.mark.parametrize(
    "knob",
    [
        {"order": 0},
        {"order": 2.5},
        {"order": True},
        {"order": 1000},
        {"accuracy": 0.0},
        {"tolerance": math.nan},
        {"points_per_axis": 0},
        {"threads": 0},
    ],
)
def test_bad_knobs(knob):
    with pytest.raises(ValueError, match=f"{next(iter(knob))} = .*must be"):
        multipole.solve(box(), **knob)


def test_zeta2_of_two_materials_or_nothing_is_refused():
    for parts in (PARTS, []):
        with pytest.raises(ValueError, match="one material"):
            multipole.zeta2(box(parts=parts))


@pytest.mark.parametrize("order", [0, True, 81, 160, 5000])
def test_zeta2_refuses_orders_beyond_memory_and_numbers(order):
    with pytest.raises(ValueError, match=f"order = {order}: must be"):
        multipole.zeta2(gallery.simple_cubic(fraction=0.3), order=order)


def test_zeta2_at_its_highest_order():
    scene = gallery.face_centred(fraction=0.5)
    assert_allclose(multipole.zeta2(scene, order=80), lattice.zeta2("fcc", 0.5), rtol=1e-10)  # rounding, amplified


def test_zeta2_refuses_a_default_order_that_is_too_high(monkeypatch):
    # A sphere of a twentieth of the radius, nearly touching: (1/1.05)^(2 order) = 1e-15 at order 354.
    parts = [((0.5, 0.5, 0.5), 0.3, 2.0), ((0.5, 0.5, 0.816), 0.015, 2.0)]
    with pytest.raises(RuntimeError, match="smallest gap 0.001 m .* needs order .*; 80 is the highest"):
        multipole.zeta2(box(parts=parts))
    assert 0 < multipole.zeta2(box(parts=parts), order=20) < 1
    monkeypatch.setattr(solver, "MOST_BYTES", 1e4)
    scene = gallery.face_centred(fraction=0.5)
    with pytest.raises(RuntimeError, match="between 4 spheres .* is the highest"):
        multipole.zeta2(scene)
    with pytest.raises(ValueError, match="order = 20: must be <= 10 for 4 spheres"):  # sqrt(2e4/16/7) - 3
        multipole.zeta2(scene, order=20)
