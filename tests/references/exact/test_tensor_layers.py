"""Layers of tensors by the textbook's formula and their own slopes: the witness of elements and voxels."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Layer, Material, Scene, Sphere, orthotropic
from demheat.tensor import conductivity_tensor
from references import exact
from references.exact.inclined import laminate
from references.voxels.laminates import laminated

TENSORS = np.array(
    [orthotropic(1, 4, 9, rotation=(0.3, -0.5, 0.8)), orthotropic(3, 1, 0.2, rotation=(1, 0, 2)), 2 * np.eye(3)]
)
THICK = np.array([0.5, 0.28, 0.22])


def stack(axis=1, materials=TENSORS, resistance=0.0, **load):
    one, other, third = map(Material, materials)
    layers = [Layer(axis, 0.1, 0.38, other, resistance=resistance), Layer(axis, 0.6, 0.82, third)]
    return Scene((1.0, 1.0, 1.0), one, layers, **(load or {"gradient": (1.0, 0.0, 0.0)}))


@pytest.mark.parametrize("axis", range(3))
def test_the_tensor_is_that_of_the_textbook(axis):
    found = conductivity_tensor(exact.solve_axes(stack(axis)))
    assert_allclose(
        found, laminated(np.zeros(3, int), THICK, TENSORS, np.eye(3)[axis : axis + 1])[0], rtol=1e-13, atol=1e-14
    )
    assert_allclose(found, laminate(TENSORS, THICK, np.eye(3)[axis]), rtol=1e-13, atol=1e-14)


def test_of_numbers_it_is_the_laminate():
    numbers = np.array([1.0, 5.0, 0.2])
    for resistance in (0.0, 0.3):
        plain = conductivity_tensor(exact.solve_axes(stack(materials=numbers, resistance=resistance)))
        # Both faces of the layer resist.
        found = laminate(numbers, THICK, (0, 1, 0), resistance=2 * resistance)
        assert_allclose(found, plain, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("resistance", [0.0, 0.2])
def test_the_field_is_its_own(resistance):
    field = exact.solve(stack(resistance=resistance, gradient=(1.0, -0.5, 2.0)))
    points = np.random.default_rng(0).random((200, 3))
    step = 1e-6
    slope = np.stack(
        [field.temperature_at(points + step * e) - field.temperature_at(points - step * e) for e in np.eye(3)], 1
    ) / (2 * step)
    # Not where a step crosses an interface.
    y = points[:, 1]
    inside = np.min(np.abs(y[:, None] - [0, 0.1, 0.38, 0.6, 0.82, 1]), axis=1) > step
    tensors = field.scene.tensors[field.scene.phase_at(points)]
    expected = -np.einsum("nij,nj->ni", tensors, slope)
    assert_allclose(field.flux_at(points)[inside], expected[inside], atol=1e-8)
    assert np.ptp(field.flux_at(points)[:, 1]) < 1e-13
    ends = [field.temperature_at(points + e) - field.temperature_at(points) for e in np.eye(3)]
    assert_allclose(np.transpose(ends), np.tile([1.0, -0.5, 2.0], (200, 1)), atol=1e-13)


def test_between_walls_it_must_run_straight():
    straight = np.stack([np.diag([1.0, 2.0, 3.0]), np.diag([0.5, 4.0, 1.0]), TENSORS[2]])
    for axis, expected in (("y", 1 / (THICK @ (1 / straight[:, 1, 1]))), ("z", THICK @ straight[:, 2, 2])):
        field = exact.solve(stack(materials=straight, walls={axis + "-": 1.0, axis + "+": 3.0}))
        assert_allclose(field.conductivity, expected, rtol=1e-13)
        assert_allclose(sum(field.wall_heat.values()), 0.0, atol=1e-13)
    with pytest.raises(NotImplementedError, match="no closed form for .* under walls"):
        exact.solve(stack(walls={"y-": 1.0, "y+": 3.0}))
    # Turned about the load alone: all still runs along it, and every wall is as warm as it should be.
    about = np.stack([orthotropic(1, 2, 3, rotation=(0, 1, 0)), np.diag([0.5, 4.0, 1.0]), TENSORS[2]])
    assert_allclose(
        exact.solve(stack(materials=about, walls={"y-": 1.0, "y+": 3.0})).conductivity,
        laminate(about, THICK, (0, 1, 0))[1, 1],
    )


def test_what_is_none_is_refused():
    ball = Scene((1, 1, 1), Material(TENSORS[0]), [Sphere((0.5,) * 3, 0.2, Material(1.0))], gradient=(1, 0, 0))
    pore = stack(materials=[TENSORS[0], 0.0, 1.0])
    for scene in (ball, pore):
        with pytest.raises(NotImplementedError, match="no closed form"):
            exact.solve(scene)
