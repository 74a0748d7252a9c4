"""Bounds of the whole tensor on voxels: of an exact one, and beside those of one direction."""

import numpy as np
import pytest

from demheat import gallery
from demheat.scene import Material, Scene, Sphere
from references import multipole
from references.bracket import voxels


def test_it_is_the_bounds_of_every_direction():
    values, spacing = np.random.default_rng(0).uniform(0.1, 3.0, (4, 3, 5)), (1.0, 0.6, 1.7)
    found = voxels.bounds_tensor(values, spacing, tolerance=1e-13)
    for gradient in ((1.0, 0.0, 0.0), (1.0, -2.0, 0.5), (0.0, 3.0, -1.0)):
        one = voxels.bounds(values, spacing, gradient=gradient, tolerance=1e-13)
        unit = np.array(gradient) / np.linalg.norm(gradient)
        # Energies are flat at their least: the tolerance, besides what counts as rounding.
        assert unit @ found.greatest @ unit == pytest.approx(one.upper, rel=1e-9)
        assert unit @ found.least @ unit == pytest.approx(one.lower, rel=1e-9)
    assert np.linalg.eigvalsh(found.greatest - found.least).min() > 0


def test_an_oblique_tensor():
    spheres = [Sphere((0.35, 0.4, 0.3), 0.25, Material(20.0)), Sphere((0.7, 0.75, 0.62), 0.22, Material(20.0))]
    scene = Scene((1.0, 1.1, 0.9), Material(1.0), spheres, gradient=(1.0, 0.0, 0.0))
    along = [Scene(scene.size, scene.matrix, spheres, gradient=tuple(unit)) for unit in np.eye(3)]
    known = -np.array([multipole.solve(each, accuracy=1e-6).mean_flux for each in along]).T
    found = voxels.solve_tensor(scene, voxels=16)
    assert np.all(found.lower < known) and np.all(known < found.upper)
    for apart in (known - found.least, found.greatest - known):
        assert np.linalg.eigvalsh((apart + apart.T) / 2).min() > 0


def test_refusals():
    with pytest.raises(ValueError, match="periodic"):
        voxels.solve_tensor(gallery.sphere_in_cube(2.0), voxels=4)
    with pytest.raises(NotImplementedError, match="a conductivity is 0"):
        voxels.bounds_tensor(np.zeros((2, 2, 2)))
