"""Fields of multipoles at any point: exact arrays, surfaces from both sides, slopes, whatever the splitting."""

import numpy as np
from multipole_scenes import PARTS, box, solved
from numpy.testing import assert_allclose

from demheat import gallery
from references import exact, multipole
from references.multipole import sums
from references.multipole.arrangement import arrange
from references.multipole.field import Evaluator
from references.multipole.truncation import converged


def surface_points(count):
    """Points on the surfaces, their normals and the numbers of their spheres."""
    normals = np.random.default_rng(1).normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    number = np.arange(count) % len(PARTS)
    centers, radii = np.array([c for c, _, _ in PARTS]), np.array([r for _, r, _ in PARTS])
    return centers[number] + radii[number, None] * normals, normals, number


def test_fields_of_a_cubic_array_are_the_exact_ones():
    scene = gallery.body_centred(10.0, fraction=0.3, axis=0)
    found, expected = multipole.solve(scene, order=18), exact.solve(scene)
    points = 0.3 * np.random.default_rng(0).random((500, 3)) - 0.1
    # Terms of degree 19 and more: in the flux 7e-6 of the mean at the surfaces, some tens of times less in temperature.
    assert_allclose(found.temperature_at(points), expected.temperature_at(points), rtol=0, atol=3e-7 * 10)
    assert_allclose(found.flux_at(points), expected.flux_at(points), rtol=0, atol=2e-5 * 4000)


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
        rises = [field.temperature_at(place + step) - field.temperature_at(place - step) for step in h * np.eye(3)]
        k = field.scene.conductivities[field.scene.phase_at(place)]
        assert_allclose(field.flux_at(place), -k[:, None] * np.transpose(rises) / (2 * h), rtol=0, atol=1e-6 * 20)


def test_field_does_not_depend_on_the_splitting(monkeypatch):
    made, gradient = arrange(box()), np.array([0.3, 0.5, 1.0])
    spheres = made.spheres
    history = converged(made._replace(gradient=gradient), order=6, accuracy=1e-5, tolerance=1e-12)
    points = np.random.default_rng(5).random((100, 3)) * spheres.size
    found = []
    for eta in (1.0, 3.0, 8.0):
        split = sums.splitting(spheres.size, 0.5, 6, eta)
        monkeypatch.setattr("references.multipole.field._splitting", lambda spheres, order, split=split: split)
        found.append(Evaluator(spheres, history[-1], gradient)(points)[0])
    # Rounding: waves of degree 1 cancel to a digit or two.
    assert_allclose(found[1], found[0], rtol=0, atol=1e-12)
    assert_allclose(found[2], found[0], rtol=0, atol=1e-12)
