"""Only here: fits that miss a harmonic cubic, reach over an interface or a gap, or are believed of few voxels."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Layer, Material, Scene, Sphere
from references import exact, fft, multipole
from references.fft import harmonic, interpolation


def lattice(radius, contrast, **more):
    return Scene((1.0, 1.0, 1.0), Material(1.0), [Sphere((0.5,) * 3, radius, Material(contrast))], **more)


def rms(found, true):
    return np.sqrt(np.mean(np.sum((found - true) ** 2, axis=1)) / np.mean(np.sum(true**2, axis=1)))


def test_polynomials_are_harmonic_and_all_there_are():
    # Second differences of cubics are exact to rounding: eps / step^2.
    step, x = 0.5, np.random.default_rng(0).normal(size=(50, 3))
    found = harmonic.polynomials(x)
    bent = sum(harmonic.polynomials(x + sign * step * axis) - found for axis in np.eye(3) for sign in (-1, 1))
    assert_allclose(bent, 0, atol=1e-12)
    assert np.linalg.matrix_rank(found) == 16


def test_a_harmonic_cubic_comes_back_to_rounding():
    rng = np.random.default_rng(1)
    away, weights = rng.normal(size=(5, 40, 3)), rng.random((5, 40))
    factors = rng.normal(size=(5, 16))
    values = np.einsum("nmk,nk->nm", harmonic.polynomials(away), factors)
    known, value, slope = harmonic.solved(away, weights, values, np.full(5, 2.0), np.full(5, np.inf))
    assert known.all()
    # Rounding of normal equations, whose condition may be 1e8 at most: 1e-16 of it.
    assert_allclose(value, factors[:, 0], atol=1e-8)
    assert_allclose(slope, factors[:, 1:4], atol=1e-8)


def test_of_what_lies_in_a_plane_nothing_is_known():
    """In a plane no slope across it is seen."""
    away = np.random.default_rng(2).normal(size=(1, 40, 3)) * (1.0, 1.0, 0.0)
    how = (np.ones((1, 40)), away[..., 0], np.full(1, 2.0), np.full(1, np.inf))
    assert not harmonic.solved(away, *how)[0].any()


@pytest.mark.parametrize(("contrast", "least"), [(10.0, 2.0), (0.01, 1.8)])
def test_fluxes_beside_a_sphere_are_nearer_than_between_voxels(contrast, least, monkeypatch):
    # Found: 3.8 and 2.4 times on 24^3 voxels.
    scene = lattice(0.43, contrast, gradient=(0, 0, 1))
    points = 0.01 + 0.98 * np.random.default_rng(3).random((400, 3))
    true = multipole.solve(scene, accuracy=1e-6).flux_at(points)
    field = fft.solve(scene, voxels=24)
    fit = rms(field.flux_at(points), true)
    monkeypatch.setattr(harmonic, "suits", lambda grid: False)
    between = rms(fft.solve(scene, voxels=24).flux_at(points), true)
    assert fit < between / least


# A ball of the matrix's own material makes cut voxels, so that faces on planes of the grid are no cut ones.
@pytest.mark.parametrize("more", [[], [Sphere((0.5, 0.5, 0.75), 0.2, Material(1.0))]], ids=["alone", "cut voxels"])
def test_fits_reach_over_no_interface(more):
    """Layers are linear on either side: exact up to the interface, where a fit over it would be off by a slope."""
    layer = Layer(2, 0.25, 0.5, Material(20.0))
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), [layer, *more], walls={"z-": 0.0, "z+": 1.0})
    points = np.random.default_rng(4).random((300, 3))
    points[:100, 2] = 0.25 + 1e-3 * (np.arange(100) - 50)
    field = fft.solve(scene, voxels=16, tolerance=1e-10)
    closed = exact.solve(Scene(scene.size, scene.matrix, [layer], walls=scene.walls))
    assert_allclose(field.flux_at(points), closed.flux_at(points), atol=1e-7)
    assert_allclose(field.temperature_at(points), closed.temperature_at(points), atol=1e-7)


def test_what_is_not_joined_to_the_point_does_not_count():
    whole = np.zeros((1, 8, 8, 8), bool)
    whole[0, :3], whole[0, 5:] = True, True
    seed = np.zeros_like(whole)
    seed[0, 1, 4, 4] = True
    assert np.array_equal(np.flatnonzero(harmonic.grown(seed, whole)[0].any(axis=(1, 2))), [0, 1, 2])


# Whole voxels in the smaller one are three across: around it a fit would not see it. The larger one holds some twenty,
# fewer than a fit within a body asks for.
@pytest.mark.parametrize(
    ("radius", "place"), [(0.1, (0.5, 0.5, 0.5)), (0.1, (0.5, 0.5, 0.65)), (0.15, (0.5, 0.5, 0.5))]
)
def test_few_voxels_leave_it_to_interpolation(radius, place, monkeypatch):
    known, kept = [], interpolation.fitted

    def seen(*given):
        fit = kept(*given)
        known.append(bool(fit.known.all()))
        return fit

    monkeypatch.setattr(interpolation, "fitted", seen)
    field = fft.solve(lattice(radius, 100.0, gradient=(0, 0, 1)), voxels=16)
    field.flux_at(np.array([place])), field.flux_at(np.array([[0.05, 0.05, 0.05]]))
    assert known == [False, True]


def test_fits_are_made_once_for_temperatures_and_fluxes(monkeypatch):
    calls, kept = [], interpolation.fitted
    monkeypatch.setattr(interpolation, "fitted", lambda *given: calls.append(1) or kept(*given))
    field = fft.solve(lattice(0.43, 10.0, gradient=(0, 0, 1)), voxels=16)
    points = np.random.default_rng(6).random((30, 3))
    field.temperature_at(points), field.flux_at(points)
    field.flux_at(points + 1e-9)
    assert len(calls) == 2
