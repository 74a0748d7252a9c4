"""Elements that conduct by direction: exact bodies, and a linear map of the mesh that takes tensors to numbers."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Layer, Material, Scene, Sphere, orthotropic
from demheat.tensor import conductivity_tensor
from references import exact, fem
from references.fem.lookup import NodalField
from references.fem.system import solve_nodes
from references.mesh import make, split

ONE, OTHER = orthotropic(1, 4, 9, rotation=(0.3, -0.5, 0.8)), orthotropic(3, 1, 0.2, rotation=(1, 0, 2))


def body(*shapes, k=ONE, **load):
    return Scene((1.0, 1.0, 1.0), Material(k), shapes, **(load or {"gradient": (1.0, -0.5, 2.0)}))


@pytest.mark.parametrize("order", [1, 2])
def test_layers_are_exact(order):
    scene = body(Layer(1, 0.13, 0.41, Material(OTHER)), Layer(1, 0.6, 0.75, Material(2.0)))
    # Fluxes of the tolerance, 1e-11 of the largest.
    found, known = (
        conductivity_tensor(f)
        for f in (fem.solve_axes(scene, size=0.5, order=order, tolerance=1e-11), exact.solve_axes(scene))
    )
    assert_allclose(found, known, atol=1e-9)
    field, right = fem.solve(scene, size=0.5, order=order, tolerance=1e-11), exact.solve(scene)
    points = np.random.default_rng(0).random((50, 3))
    assert np.ptp(field.temperature_at(points) - right.temperature_at(points)) < 1e-9
    assert_allclose(field.flux_at(points), right.flux_at(points), atol=1e-8)
    samples = field.samples
    assert_allclose(samples.flux, right.flux_at(samples.points), atol=1e-8)
    assert_allclose(samples.volumes @ samples.flux, field.mean_flux, atol=1e-9)


def test_walls_that_bend_nothing():
    straight = body(
        Layer(1, 0.2, 0.5, Material(np.diag([0.5, 4.0, 1.0]))), k=np.diag([1.0, 2.0, 3.0]), walls={"y-": 1.0, "y+": 3.0}
    )
    field, right = fem.solve(straight, size=0.5), exact.solve(straight)
    assert_allclose(field.conductivity, right.conductivity, rtol=1e-8)
    assert_allclose(list(field.wall_heat.values()), [right.wall_heat[name] for name in field.wall_heat], rtol=1e-8)


# A shear and a stretch that keep the volume.
MAP = np.array([[1.0, 0.4, 0.0], [0.0, 1.25, -0.3], [0.0, 0.0, 0.8]])


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("load", [{"gradient": (1.0, -0.5, 2.0)}, {"walls": {"y-": 1.0, "y+": 3.0}}])
def test_a_mapped_mesh_is_a_change_of_coordinates(order, load):
    """x' = A x with K' = A K A^T / det A leaves temperatures and takes the flux to A q / det A, curved elements too."""
    plain = body(Sphere((0.45, 0.5, 0.55), 0.3, Material(20.0)), k=2.0, **load)
    mesh = split(plain, make(plain, size=0.45, order=order))
    one = solve_nodes(plain, mesh, 1e-11)
    tensor = MAP @ MAP.T
    tensor = (tensor + tensor.T) / 2
    mapped = mesh._replace(points=mesh.points @ MAP.T)
    shapes = [replace(s, material=Material(s.material.conductivity * tensor)) for s in plain.inclusions]
    other_load = (
        {"gradient": tuple(np.linalg.solve(MAP.T, plain.gradient))} if plain.periodic else {"walls": plain.walls}
    )
    bent = Scene(plain.size, Material(2.0 * tensor), shapes, **other_load)
    other = solve_nodes(bent, mapped, 1e-11)
    level = other.temperature[0] - one.temperature[0] if plain.periodic else 0.0
    assert_allclose(other.temperature, one.temperature + level, atol=1e-8)
    fluxes = (
        NodalField(bent, mapped, other.temperature).mean_flux(),
        NodalField(plain, mesh, one.temperature).mean_flux(),
    )
    assert_allclose(fluxes[0], MAP @ fluxes[1], rtol=1e-8)
    powers = NodalField(bent, mapped, other.temperature).power(), NodalField(plain, mesh, one.temperature).power()
    assert_allclose(powers[0], powers[1], rtol=1e-8)
    assert_allclose(list(other.wall_heat.values()), list(one.wall_heat.values()), rtol=1e-7)
