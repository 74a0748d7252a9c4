"""Voxels that conduct by direction: exact bodies, and a change of coordinates that takes tensors to numbers."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Layer, Material, Scene, Sphere, orthotropic
from demheat.scene.turned import turned
from demheat.tensor import conductivity_tensor
from references import exact, fft
from references.fft import cg
from references.fft.problem import Problem
from references.threads import Team
from references.voxels.paint import voxelise

ONE, OTHER = orthotropic(1, 4, 9, rotation=(0.3, -0.5, 0.8)), orthotropic(3, 1, 0.2, rotation=(1, 0, 2))
TIGHT = {"tolerance": 1e-9, "threads": 1}


def cell(*shapes, k=ONE, **load):
    return Scene((1.0, 1.0, 1.0), Material(k), shapes, **(load or {"gradient": (1.0, 0.0, 0.0)}))


@pytest.mark.parametrize("axis", range(3))
def test_layers_are_exact_in_laminate_voxels(axis):
    body = cell(
        Layer(axis, 0.13, 0.41, Material(OTHER)), Layer(axis, 0.6, 0.75, Material(2.0)), gradient=(1.0, -0.5, 2.0)
    )
    found, known = (
        conductivity_tensor(each) for each in (fft.solve_axes(body, voxels=8, **TIGHT), exact.solve_axes(body))
    )
    assert_allclose(found, known, atol=1e-12)
    field, right = fft.solve(body, voxels=8, **TIGHT), exact.solve(body)
    samples = field.samples
    # A voxel that is cut has the mean of both phases.
    whole = np.abs((samples.points[:, axis, None] - [0.13, 0.41, 0.6, 0.75]) * 8).min(axis=1) > 0.5
    assert_allclose(samples.flux[whole], right.flux_at(samples.points[whole]), atol=1e-10)
    points = samples.points[whole] + np.random.default_rng(0).uniform(-0.06, 0.06, (whole.sum(), 3))
    inside = body.phase_at(points) == samples.phase[whole]
    off = field.temperature_at(points[inside]) - right.temperature_at(points[inside])
    # Levels of a periodic cell are free; a cut voxel beside counts a hundredth of a whole one.
    assert np.ptp(off) < 1e-3


def test_a_sphere_lies_between_the_bounds_and_turns_with_its_cell():
    sphere = Sphere((0.45, 0.5, 0.6), 0.3, Material(OTHER))
    body = cell(sphere)
    fields = fft.solve_axes(body, voxels=12, **TIGHT)
    found = conductivity_tensor(fields)
    assert_allclose(found, found.T, atol=1e-8)  # the square of the tolerance, times a few
    f = fields[0].fractions
    voigt = np.einsum("p,pij->ij", f, body.tensors)
    reuss = np.linalg.inv(np.einsum("p,pij->ij", f, np.linalg.inv(body.tensors)))
    # Of matrices: certain.
    assert np.linalg.eigvalsh(voigt - found).min() > 0 and np.linalg.eigvalsh(found - reuss).min() > 0
    order = (2, 0, 1)
    again = conductivity_tensor(fft.solve_axes(turned(body, order), voxels=12, **TIGHT))
    assert_allclose(again, found[np.ix_(order, order)], rtol=1e-7, atol=1e-8)


def test_numbers_are_tensors():
    """The same numbers through the kernels for voxels with tensors: the last digits differ along one axis."""
    plain = fft.solve(cell(Sphere((0.45, 0.5, 0.6), 0.3, Material(7.0)), k=2.0), voxels=10, rule="laminate", **TIGHT)
    near = cell(
        Sphere((0.45, 0.5, 0.6), 0.3, Material(np.diag([7.0, 7.0, 7.0 + 1e-12]))), k=np.diag([2.0, 2.0, 2.0 + 1e-12])
    )
    assert near.anisotropic
    found = fft.solve(near, voxels=10, rule="laminate", **TIGHT)
    assert_allclose(found.mean_flux, plain.mean_flux, rtol=1e-10, atol=1e-12)
    points = np.random.default_rng(0).random((40, 3))
    assert_allclose(found.temperature_at(points), plain.temperature_at(points), atol=1e-9)


@pytest.mark.parametrize("load", [{"gradient": (1.0, 0.5, -2.0)}, {"walls": {"y-": 1.0, "y+": 3.0}}])
def test_a_stretched_box_is_a_change_of_coordinates(load):
    """Voxels of phases K_i = k_i diag(s^2) in a box stretched by s: temperatures of the cube, fluxes s q / det."""
    stretch = np.array([1.0, 2.0, 0.5])
    cube = cell(Sphere((0.5, 0.5, 0.5), 0.3, Material(20.0)), k=1.0)
    grid = voxelise(cube, (8, 8, 8), laminate=False)
    tensors = np.zeros((2, 6))
    tensors[:, :3] = grid.conductivity[:, None] * stretch**2
    longer = grid._replace(spacing=grid.spacing * stretch, conductivity=tensors[:, :3].mean(axis=1), tensors=tensors)
    walls = "walls" in load
    gradient = np.array([1.0, 0.0, 0.0]) if walls else np.array(load["gradient"])
    with Team(1) as team:
        how = {
            "links": None,
            "walls": walls,
            "dtype": np.float64,
            "team": team,
            "tolerance": 1e-9,
            "max_iterations": 999,
        }
        one = cg.solve(Problem(voxels=grid, gradient=gradient, **how))
        other = cg.solve(Problem(voxels=longer, gradient=gradient / stretch, **how))
        assert_allclose(other.mean_flux, one.mean_flux * stretch, rtol=1e-8, atol=1e-9)
        assert_allclose(other.state()[0], one.state()[0], atol=1e-8)


def test_pores_and_tensors_in_one_cell():
    pore = cell(Sphere((0.5,) * 3, 0.3, Material(0.0)))
    found = conductivity_tensor(fft.solve_axes(pore, voxels=8, rule="plain"))
    assert np.linalg.eigvalsh(np.array(ONE) * 0.95 - found).min() > 0 and np.linalg.eigvalsh(found).min() > 0
    field = fft.solve(pore, voxels=8, rule="plain")
    assert np.isnan(field.temperature_at(np.array([[0.5] * 3]))) and not field.flux_at(np.array([[0.5] * 3])).any()
