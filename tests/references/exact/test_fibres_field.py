"""Fields of arrays of fibres obey the equations on both sides of every surface; nothing else sees them so closely."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from references.exact import fibres, fibres_field

CASES = [
    ("square", 10.0, 0.5, 0.0),
    ("hexagonal", 0.1, 0.6, 0.0),
    ("square", 5.0, 0.4, 0.7),
    ("hexagonal", math.inf, 0.7, 0.3),
    ("square", 0.0, 0.77, 0.0),
    ("hexagonal", math.inf, 0.85, 0.0),
]
GRADIENT = (0.6, -0.8)
each = pytest.mark.parametrize(("kind", "contrast", "fraction", "resistance"), CASES)


def made(*case):
    return fibres.solve(*case[:3], resistance=case[3])


def circle(array, radius):
    turn = np.linspace(0, 2 * math.pi, 37)
    return radius * np.column_stack([np.cos(turn), np.sin(turn)])


@each
def test_interface_conditions(kind, contrast, fraction, resistance):
    array = made(kind, contrast, fraction, resistance)
    normals = circle(array, 1.0)
    inside, outside = (circle(array, array.radius * (1 + e)) for e in (-1e-12, 1e-12))
    through = [np.sum(fibres_field.flux(array, at, GRADIENT) * normals, axis=1) for at in (inside, outside)]
    # Series are cut at 13 digits of the conductivity; of the flux where gaps are narrow some five are fewer.
    assert_allclose(through[0], through[1], atol=1e-7)
    T = [fibres_field.temperature(array, at, GRADIENT) for at in (inside, outside)]
    # Flux out of the fibre times the resistance: T inside less T outside.
    assert_allclose(T[0] - T[1], resistance * array.radius * through[1] if contrast else T[0] - T[1], atol=1e-8)


@each
def test_flux_is_the_slope_of_temperature_and_has_no_sources(kind, contrast, fraction, resistance):
    array, h = made(kind, contrast, fraction, resistance), 1e-4
    points = np.random.default_rng(1).uniform(-1.5, 1.5, (200, 2))
    _, offsets, inside = fibres_field._cells(array, points)
    clear = np.abs(np.abs(offsets) - array.radius) > 5 * h
    clear &= ~inside if math.isinf(contrast) else True
    points, k = points[clear], np.where(inside[clear], contrast, 1.0)
    slope = np.empty_like(points)
    for axis, step in enumerate(h * np.eye(2)):
        at = [fibres_field.temperature(array, points + s * step, GRADIENT) for s in (-2, -1, 1, 2)]
        slope[:, axis] = (at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * h)
    # Fourth order, and rounding 1e-16 / h.
    assert_allclose(fibres_field.flux(array, points, GRADIENT), -np.where(k > 0, k, 0)[:, None] * slope, atol=1e-6)


@each
def test_periodic_and_continuous_across_cells(kind, contrast, fraction, resistance):
    array = made(kind, contrast, fraction, resistance)
    points = np.random.default_rng(2).uniform(-0.5, 0.5, (50, 2))
    here = fibres_field.temperature(array, points, GRADIENT)
    turn = 2 * math.pi / fibres.FOLD[kind]
    for shift in ([1.0, 0.0], [math.cos(turn), math.sin(turn)], [-2.0, 0.0]):
        there = fibres_field.temperature(array, points + shift, GRADIENT)
        assert_allclose(there - here, np.dot(GRADIENT, shift), atol=1e-12)
    # Along the edge of a cell both sides are summed from different sites.
    edge = np.column_stack([np.full(9, 0.5), np.linspace(-0.2, 0.2, 9)])
    sides = [fibres_field.flux(array, edge + [e, 0.0], GRADIENT) for e in (-1e-13, 1e-13)]
    assert_allclose(sides[0], sides[1], atol=1e-8)


@pytest.mark.parametrize(
    ("kind", "contrast", "fraction", "resistance"),
    [case for case in CASES if case[0] == "square"] + [("hexagonal", 0.1, 0.6, 0.0), ("hexagonal", math.inf, 0.6, 0.3)],
)
def test_the_mean_flux_between_two_rows(kind, contrast, fraction, resistance):
    """Nothing but matrix is crossed there: Gauss's rule along a row, for a load across it."""
    array = made(kind, contrast, fraction, resistance)
    height = 0.5 if kind == "square" else math.sqrt(3) / 4
    assert array.radius < height
    nodes, weights = np.polynomial.legendre.leggauss(200)
    q = fibres_field.flux(array, np.column_stack([0.5 * nodes, np.full(200, height)]), (0.0, 1.0))[:, 1]
    assert_allclose(-0.5 * weights @ q, array.conductivity, rtol=1e-9)
