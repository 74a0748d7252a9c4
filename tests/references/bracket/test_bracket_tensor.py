"""Bounds of all entries of a tensor, none along an axis of the box; the bracket of one direction is theirs."""

import fem_scenes  # noqa: F401, skips without gmsh
import numpy as np
import pytest

from demheat import gallery
from demheat.scene import Layer, Material, Scene, Sphere
from references import bracket, exact, multipole

AXES = np.eye(3)


def oblique():
    """Two unlike spheres in a box of unlike sides: no axis of the tensor is one of the box."""
    spheres = [Sphere((0.35, 0.4, 0.3), 0.25, Material(20.0)), Sphere((0.7, 0.75, 0.62), 0.22, Material(20.0))]
    return Scene((1.0, 1.1, 0.9), Material(1.0), spheres, gradient=(1.0, 0.0, 0.0))


def test_an_oblique_tensor():
    scene = oblique()
    columns = [multipole.solve(_along(scene, unit), accuracy=1e-8).mean_flux for unit in AXES]
    known, found = -np.array(columns).T, bracket.solve_tensor(scene, size=0.15)
    # No axis is a principal one: the smallest of the other entries.
    assert np.abs(known[~np.eye(3, dtype=bool)]).min() > 0.005
    assert np.all(found.lower <= known) and np.all(known <= found.upper)
    for apart in (known - found.least, found.greatest - known):
        assert np.linalg.eigvalsh((apart + apart.T) / 2).min() > 0
    assert np.all(found.radius < 0.01 * known.max())
    # The bracket of one direction is that of the tensor, on the same mesh, but for what residuals are counted as.
    one = bracket.solve(_along(scene, (1.0, -2.0, 0.5)), size=0.15)
    unit = np.array([1.0, -2.0, 0.5]) / np.sqrt(5.25)
    assert one.upper == pytest.approx(unit @ found.greatest @ unit, rel=1e-6)
    assert one.lower == pytest.approx(unit @ found.least @ unit, rel=1e-5)


def test_layers():
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), [Layer(2, 0.2, 0.6, Material(9.0))], gradient=(0.0, 0.0, 1.0))
    found = bracket.solve_tensor(scene, size=0.4)
    known = np.diag([exact.solve(_along(scene, unit)).conductivity for unit in AXES])
    # Linear temperatures and constant fluxes: what is left is the margin for residuals.
    assert found.middle == pytest.approx(known, abs=1e-5)
    assert np.all(found.lower <= known) and np.all(known <= found.upper)


def _along(scene, gradient):
    return Scene(scene.size, scene.matrix, scene.inclusions, gradient=tuple(gradient))


def test_walls_are_refused():
    with pytest.raises(ValueError, match="periodic"):
        bracket.solve_tensor(gallery.sphere_in_cube(2.0))
