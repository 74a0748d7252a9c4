"""Arrays of fibres as scenes, turned and in units: the values of `fibres` end up along the right axes."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Flux, Material, Scene, Sphere
from demheat.scene import Cylinder
from demheat.tensor import conductivity_tensor
from references import exact
from references.exact import fibres

MATRIX, FIBRE = Material(2.0), Material(20.0)
RADIUS, EDGE, HEIGHT = 0.6, 2.0, 0.7
OBLIQUE = (1.0, -2.0, 0.5)
FRACTION = math.pi * RADIUS**2 / EDGE**2
HALF = 0.5 * math.sqrt(3) * EDGE


def array(axis, *, kind="square", resistance=0.0, fibre=FIBRE, **load):
    """Fibres along an axis, with a centre anywhere; of a hexagonal array neighbours lie along the axis before it."""
    order = [(axis - 2) % 3, (axis - 1) % 3, axis]
    size, shifts = np.array([EDGE, EDGE, HEIGHT]), [np.zeros(3)]
    if kind == "hexagonal":
        size[1], shifts = 2 * HALF, [np.zeros(3), np.array([EDGE / 2, HALF, 0.3])]
    turned = np.argsort(order)
    inclusions = [
        Cylinder(
            ((np.array([0.3, 1.9, 5.0]) + shift)[turned]).tolist(),
            RADIUS,
            -3.0 * np.eye(3)[axis],
            fibre,
            resistance=resistance,
        )
        for shift in shifts
    ]
    return Scene(size[turned].tolist(), MATRIX, inclusions, **(load or {"gradient": OBLIQUE}))


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize(("kind", "resistance"), [("square", 0.0), ("square", 0.15), ("hexagonal", 0.1)])
def test_the_tensor_is_that_of_the_array(axis, kind, resistance):
    scene = array(axis, kind=kind, resistance=resistance)
    fraction = FRACTION if kind == "square" else FRACTION * EDGE / HALF
    across = 2 * fibres.conductivity(kind, 10.0, fraction, resistance=resistance * 2.0 / RADIUS)
    wanted = across * np.eye(3)
    wanted[axis, axis] = 2 * fibres.along(10.0, fraction)
    fields = exact.solve_axes(scene)
    # Rounding of the fraction, worked out in another order.
    assert_allclose(conductivity_tensor(fields), wanted, rtol=1e-12, atol=1e-14)
    assert fields[0].stats["form"] == f"{kind} array of fibres"
    assert_allclose(sum(fields[0].fractions[1:]), fraction, rtol=1e-12)


def test_a_fibre_in_the_middle_of_a_box_is_the_array():
    middle = replace(array(2).inclusions[0], center=(1.0, 1.0, 0.0))
    scene = Scene((EDGE, EDGE, HEIGHT), MATRIX, [middle], walls={"y-": 5.0, "y+": 1.0})
    field = exact.solve(scene)
    k = 2 * fibres.conductivity("square", 10.0, FRACTION)
    assert_allclose(field.conductivity, k, rtol=1e-12)
    assert_allclose(field.wall_heat["y-"], k * 4.0 * HEIGHT, rtol=1e-12)
    # Walls across the load are those of symmetry: isothermal, and those along it pass no heat.
    along = np.linspace(0, EDGE, 9)
    walls = [np.column_stack([along, np.full(9, y), 0.2 + 0 * along]) for y in (0.0, EDGE)]
    for wall, temperature in zip(walls, (5.0, 1.0), strict=True):
        assert_allclose(field.temperature_at(wall), temperature, rtol=0, atol=1e-7)
    side = np.column_stack([0 * along, along, 0.2 + 0 * along])
    assert_allclose(field.flux_at(side)[:, 0], 0.0, rtol=0, atol=1e-6)
    aside = replace(middle, center=(1.01, 1.0, 0.0))
    with pytest.raises(NotImplementedError, match="exact.solve knows layers, arrays of spheres or fibres"):
        exact.solve(replace(scene, inclusions=[aside]))


@pytest.mark.parametrize(
    "change",
    [
        {"size": (EDGE, 1.01 * EDGE, HEIGHT)},
        {"inclusions": [Cylinder((1, 1, 0.3), RADIUS, (0, 0, 1), FIBRE, length=0.5)]},
        {"inclusions": [Cylinder((1, 1, 0.3), RADIUS, (0, 0, 1), FIBRE), Sphere((0, 0, 0), 0.1, FIBRE)]},
        {"inclusions": [Cylinder((0.5, 1, 0), 0.2, (0, 0, 1), FIBRE), Cylinder((1.5, 1, 0), 0.2, (0, 0, 1), FIBRE)]},
        {"matrix": Material(0.0)},
        {"gradient": None, "walls": {"z-": Flux(1.0), "z+": 0.0}},
    ],
)
def test_all_else_has_no_form(change):
    with pytest.raises(NotImplementedError, match="no closed form"):
        exact.solve(replace(array(2), **change))


def test_fibres_that_nearly_touch():
    near = replace(array(2).inclusions[0], radius=0.99999999 * EDGE / 2, material=Material(2e9))
    with pytest.raises(NotImplementedError, match="no closed form to six digits"):
        exact.solve(replace(array(2), inclusions=[near]))
