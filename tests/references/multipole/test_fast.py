"""The fast multipole method beside all pairs by Ewald's sums: what is made, solutions, fields, which is chosen."""

import math
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Material, Scene, Sphere, gallery
from references import multipole
from references.exact import lattice
from references.multipole import exchange, field, truncation
from references.multipole.arrangement import arrange, smallest_gap
from references.multipole.far_sums import far_sums, mirror_parities
from references.multipole.fast import FastMultipole, Plan, far_degree, plan
from references.multipole.field import Evaluator
from references.multipole.sums import entries, periodic_irregular
from references.multipole.system import solve_order
from references.multipole.translations import Translation, received, translation, unmirrored

# Cells by which 40 small spheres exchange, none of them a near image of itself; degrees and what they leave.
SHAPE, DEGREE = (5, 6, 5), 16
SIZE = np.array([1.0, 1.2, 1.1])


def random_spheres(count=40, sizes=(0.05, 0.09), seed=0):
    """Disjoint ones of unequal radius and contrast."""
    rng, centers, radii = np.random.default_rng(seed), [], []
    while len(centers) < count:
        center, radius = rng.random(3) * SIZE, rng.uniform(*sizes)
        apart = np.reshape(centers, (-1, 3)) - center
        apart -= SIZE * np.round(apart / SIZE)
        if np.all(np.linalg.norm(apart, axis=1) > 1.1 * (np.array(radii) + radius)):
            centers.append(center)
            radii.append(radius)
    return unmirrored(np.array(centers), np.array(radii), rng.choice([0.1, 8.0, 50.0], count), SIZE)


def forced(shape=SHAPE, degree=DEGREE, precision=1e-12):
    return Plan(np.array(shape), degree, precision, 0.0, 0.0)


def by_cells(monkeypatch):
    """Let cells do what all pairs do for few spheres."""
    monkeypatch.setattr(exchange, "direct_seconds", lambda *_: math.inf)


@pytest.mark.parametrize("shape", [SHAPE, (1, 2, 7)])
def test_far_sums_and_near_images_are_the_periodic_sums(shape):
    shape, degree = np.array(shape), 6
    edge = SIZE / shape
    near = np.array(list(product(range(-2, 3), repeat=3)))
    half = shape // 2 + 1
    offsets = np.stack(np.meshgrid(*[np.arange(n) for n in half], indexing="ij"), axis=-1).reshape(-1, 3)
    whole = periodic_irregular(offsets * edge, degree, SIZE, edge.min())
    n, _ = entries(degree)
    unit = edge.min() ** (n + 1.0)
    alone = far_sums(shape, edge, np.zeros((1, 3), dtype=int), degree)
    assert_allclose(alone[0] * unit, whole[0] * unit, rtol=0, atol=1e-13)
    found = far_sums(shape, edge, near, degree)
    for row, offset, total in zip(found, offsets, whole, strict=True):
        images = near[np.all((near - offset) % shape == 0, axis=1) & np.any(near != 0, axis=1)] * edge
        r = np.linalg.norm(images, axis=1)
        part = sum(_irregular_row(image, degree) for image in images) if len(r) else 0.0
        assert_allclose((row + part) * unit, total * unit, rtol=0, atol=1e-12)


def _irregular_row(offset, degree):
    from references.multipole.sums import harmonics

    r = np.linalg.norm(offset)
    row = harmonics(offset[None] / r, degree)[0] / r ** (entries(degree)[0] + 1.0)
    row[0] = 0.0
    return row


def test_mirror_parities():
    point, degree = np.array([[0.48, -0.6, 0.64]]), 5
    row = _irregular_row(point[0], degree)
    for axis in range(3):
        image = _irregular_row(np.where(np.arange(3) == axis, -1, 1) * point[0], degree)
        real, imaginary = mirror_parities(*entries(degree))[:, axis]
        assert_allclose(image, real * row.real + 1j * imaginary * row.imag, rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("sizes", "shape"),
    [((0.07, 0.07), SHAPE), ((0.02, 0.09), SHAPE), pytest.param((0.07, 0.07), (3, 3, 3), marks=pytest.mark.slow)],
)
def test_what_cells_make_is_what_all_pairs_make(sizes, shape):
    spheres, order = random_spheres(sizes=sizes), 4
    n, m = entries(order)
    source = np.random.default_rng(1).normal(size=(2, 40, len(n))) * 0.3**n * (n > 0)
    source[1][:, m == 0] = 0.0
    expected = received(spheres, translation(spheres, 2 * order), source)
    found = received(spheres, FastMultipole(spheres, forced(shape, 22)), source)
    # By `far_degree` 4e-10 of b, which are 0.3 and less, in units of c, some times more.
    assert_allclose(found, expected, rtol=0, atol=2e-9)
    threads = received(spheres, FastMultipole(spheres, forced(shape, 22)), source, threads=2)
    assert np.array_equal(found, threads)


def test_errors_fall_with_the_degree_as_is_said():
    spheres, order = random_spheres(), 4
    gradient = np.array([0.3, -1.0, 0.5])
    expected = solve_order(spheres, translation(spheres, 2 * order), gradient, order, tolerance=1e-13)
    for precision in (1e-4, 1e-10):
        degree = far_degree(SIZE / SHAPE, precision)
        fast = FastMultipole(spheres, forced(SHAPE, degree, precision))
        found = solve_order(spheres, fast, gradient, order, tolerance=1e-13)
        scale = np.abs(expected.source).max()
        assert np.abs(found.source - expected.source).max() < precision * scale
        flux = np.linalg.norm(found.mean_flux - expected.mean_flux) / np.linalg.norm(expected.mean_flux)
        assert flux < 0.1 * precision
    assert flux < 1e-11


def test_a_box_between_walls_by_cells(monkeypatch):
    parts = [Sphere((0.3, 0.4, 0.45), 0.2, Material(7.0)), Sphere((0.7, 0.75, 0.6), 0.22, Material(0.1))]
    scene = Scene((1.0, 1.1, 0.9), Material(1.0), parts, walls={"y-": 25.0, "y+": 35.0})
    expected = multipole.solve(scene, order=5)
    by_cells(monkeypatch)
    monkeypatch.setattr(field, "MANY", 1)
    found = multipole.solve(scene, order=5)
    assert_allclose(found.mean_flux, expected.mean_flux, rtol=0, atol=1e-9)  # tolerance of the solves
    points = np.random.default_rng(2).random((200, 3)) * scene.size
    assert_allclose(found.temperature_at(points), expected.temperature_at(points), rtol=0, atol=1e-8)
    assert_allclose(found.flux_at(points), expected.flux_at(points), rtol=0, atol=1e-7)


def test_fields_by_cells_are_those_by_waves(monkeypatch):
    spheres, gradient = random_spheres(), np.array([0.3, -1.0, 0.5])
    solved = solve_order(spheres, FastMultipole(spheres, forced()), gradient, 5, tolerance=1e-8)
    points = (3 * np.random.default_rng(3).random((300, 3)) - 1) * SIZE
    waves, owner = Evaluator(spheres, solved, gradient)(points)
    monkeypatch.setattr(field, "MANY", 1)
    cells, same = Evaluator(spheres, solved, gradient)(points)
    assert np.array_equal(owner, same) and 5 < np.sum(owner >= 0) < 280
    # `cell_field.PRECISION`, and ten times more of slopes per unit of length.
    assert_allclose(cells[:, 0], waves[:, 0], rtol=0, atol=1e-10)
    assert_allclose(cells[:, 1:], waves[:, 1:], rtol=0, atol=1e-8)


def test_many_spheres_go_by_cells_and_few_by_pairs():
    assert isinstance(exchange.exchange(random_spheres(4), 2, 1e-6), Translation)
    rng = np.random.default_rng(4)
    crowd = unmirrored(rng.random((5000, 3)) * 20, np.full(5000, 0.5), np.ones(5000), np.full(3, 20.0))
    chosen = plan(crowd, 8, 1e-6)
    assert chosen.setup + 60 * chosen.product < 0.01 * exchange.direct_seconds(crowd, 8)
    assert np.all(crowd.size / chosen.shape >= 1.05)
    assert truncation.highest_order(crowd) >= 14


def test_smallest_gap_is_that_of_all_pairs():
    for seed in range(5):
        spheres = random_spheres(20, sizes=(0.02, 0.12), seed=seed)
        apart = spheres.centers[:, None] - spheres.centers
        apart -= SIZE * np.round(apart / SIZE)
        gaps = np.linalg.norm(apart, axis=2) - spheres.radii - spheres.radii[:, None]
        expected = min(gaps[~np.eye(20, dtype=bool)].min(), SIZE.min() - 2 * spheres.radii.max())
        assert smallest_gap(spheres) == pytest.approx(expected, rel=1e-12)
    # Large ones closest to each other, small ones with their centres closer.
    centers = np.array([[0.2, 0.2, 0.5], [0.2, 0.71, 0.5], [0.51, 0.2, 0.5], [0.51, 0.71, 0.5]])
    pairs = unmirrored(centers, np.array([0.25, 0.25, 0.01, 0.01]), np.ones(4), SIZE)
    assert smallest_gap(pairs) == pytest.approx(0.01, rel=1e-12)
    assert smallest_gap(arrange(gallery.simple_cubic(10.0, fraction=0.3)).spheres) > 0


def test_a_needle_of_cells_is_the_cell():
    """Cells as long as that have no far ones: half their diagonal is more than what lies between."""
    cube, needle, longer = (far_degree(np.array([length, 1.0, 1.0]), 1e-6) for length in (1.0, 8.0, 100.0))
    assert longer == needle > cube
    good = Material(10.0)
    row = [Sphere((0.5 + n, 0.5, 0.5), 0.3, good) for n in range(8)]
    scene = Scene((8.0, 1.0, 1.0), Material(1.0), row, gradient=(1.0, 0.0, 0.0))
    right = lattice.conductivity("sc", 10.0, 4 / 3 * math.pi * 0.027)
    # The accuracy by the method's own estimate.
    assert_allclose(multipole.solve(scene, accuracy=1e-3).conductivity, right, rtol=1e-3)
