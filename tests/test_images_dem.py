"""The DEM on an image: phases at the centres of particles, facets across the faces of voxels."""

import warnings

import numpy as np
import pytest

from demheat import Image, Material, Scene, evolve, solve
from demheat.tensor import conductivity_tensor
from references import bracket, fem, fft

K = {0: Material(1.0, 2.0, 3.0), 1: Material(10.0, 4.0, 5.0)}


def ball(n=12, radius=0.36):
    x = (np.arange(n) + 0.5) / n - 0.5
    return sum(np.meshgrid(x**2, x**2, x**2, indexing="ij")) <= radius**2


def cell(**load):
    load = load or {"gradient": (0.0, 1.0, 0.0)}
    return Scene.of_image(Image(ball(), 1 / 12, K), **load)


def test_particles_see_the_image():
    """As far from its voxels' own conductivity as random centres and facets leave it: some per cent with 2000."""
    field = solve(cell(), particles=2000)
    bound = bracket.voxels.solve(cell())
    assert 0.95 * bound.lower < field.conductivity < 1.05 * bound.upper
    assert abs(field.conductivity / fft.solve(cell()).conductivity - 1) < 0.05
    np.testing.assert_allclose(field.fractions, field.scene.image.fractions, atol=0.01)
    assert np.array_equal(field.samples.phase, field.scene.phase_at(field.samples.points))


def test_one_label_is_exact():
    scene = Scene.of_image(Image(np.zeros((3, 4, 5), int), 0.25, K), walls={"y-": 20.0, "y+": 30.0})
    field = solve(scene, particles=500, tolerance=1e-12)
    assert field.conductivity == pytest.approx(1.0, rel=1e-10)
    points = np.random.default_rng(0).random((20, 3)) * scene.size
    np.testing.assert_allclose(field.temperature_at(points), 20 + 10 * points[:, 1], atol=1e-8)


def test_the_same_by_walls_laws_and_axes():
    walls = cell(walls={"x-": 0.0, "x+": 1.0})
    k = fft.solve(walls).conductivity
    for law in ({}, {"law": "calibrated", "wall": "surface"}):
        # Contacts alone are far coarser than facets.
        assert abs(solve(walls, particles=1000, **law).conductivity / k - 1) < (0.25 if law else 0.08)
    from demheat.dem import solve_axes

    tensor = conductivity_tensor(solve_axes(cell(), particles=1000))
    np.testing.assert_allclose(np.diag(tensor), k, rtol=0.08)


def test_an_image_in_time():
    """Towards the steady state; the heat that it holds is that of its materials."""
    scene = cell(walls={"y-": 0.0, "y+": 1.0}, initial=0.5)
    # Slowest: a matrix of diffusivity 1/6 m2/s over one metre, a time of half a second.
    for found in (evolve(scene, [5.0], particles=500), fem.evolve(scene, [5.0], elements="hexahedra")):
        (field,) = found
        heats = field.wall_heat
        assert heats["y+"] == pytest.approx(-heats["y-"], rel=0.02)
        assert field.conductivity == pytest.approx(fft.solve(scene).conductivity, rel=0.08)


def test_labels_without_a_particle_are_named():
    labels = np.zeros((30, 30, 30), int)
    labels[3, 4, 5] = 1
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        solve(Scene.of_image(Image(labels, 1.0, K), gradient=(1, 0, 0)), particles=200)
    assert any("no particle lies in labels [1] of the image" in str(each.message) for each in caught)
