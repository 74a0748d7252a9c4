"""Solutions that NAFEMS and others print, by their equations: no other code of ours knows them."""

import math

import numpy as np
from numpy.testing import assert_allclose

from references.exact.benchmarks import convecting_plate, radiating_end, swinging_end

STEFAN_BOLTZMANN = 5.670374419e-8


def test_printed_values():
    """The Standard NAFEMS Benchmarks (1990), T2 to T4, to the digits printed."""
    assert abs(radiating_end(0.1, 55.563, 1000.0, 0.98 * STEFAN_BOLTZMANN, 300.0) - 927.0) < 0.05
    diffusivity = 35.0 / (7200.0 * 440.5) / 0.1**2
    found = 100 * swinging_end(np.array([0.8]), 32.0, diffusivity=diffusivity, rate=math.pi / 40)
    assert abs(found[0] - 36.60) < 0.005
    found = 100 * convecting_plate(np.array([0.6]), np.array([0.2]), width=0.6, height=1.0, film=750 / 52)
    assert abs(found[0] - 18.25) < 0.005


def test_the_root_of_the_quartic():
    for hot, around in ((1000.0, 300.0), (0.0, 900.0), (300.0, 300.0), (5.0, 4000.0)):
        T = radiating_end(0.1, 55.563, hot, 5e-8, around)
        # Rounding of the terms.
        terms = 555.63 * (hot - T), 5e-8 * (T**4 - around**4)
        assert abs(terms[0] - terms[1]) <= 1e-13 * (555.63 * (hot + T) + 5e-8 * (T**4 + around**4))


def test_a_swinging_end():
    x, h, dt = np.array([0.3, 0.7]), 1e-3, 1e-4
    knobs = {"diffusivity": 0.3, "rate": 2.0}
    below, here, above = (swinging_end(x, 0.8 + k * dt, **knobs) for k in (-1, 0, 1))
    sides = swinging_end(x - h, 0.8, **knobs) + swinging_end(x + h, 0.8, **knobs)
    # Differences of second order.
    assert_allclose((above - below) / (2 * dt), 0.3 * (sides - 2 * here) / h**2, atol=1e-5)
    assert_allclose(swinging_end([0.0, 1.0], 0.8, **knobs), [0.0, math.sin(1.6)], atol=1e-15)
    # At rest at first, where the wall's change has not come yet.
    assert_allclose(swinging_end(x, 1e-3, **knobs), 0.0, atol=1e-13)


def test_a_convecting_plate():
    x, y, h, knobs = np.array([0.2, 0.5]), np.array([0.3, 0.6]), 1e-3, {"width": 0.6, "height": 1.0, "film": 4.0}

    def at(a, b):
        return convecting_plate(np.asarray(a), np.asarray(b), **knobs)

    laplace = (at(x - h, y) + at(x + h, y) + at(x, y - h) + at(x, y + h) - 4 * at(x, y)) / h**2
    assert_allclose(laplace, 0.0, atol=1e-4)
    # One-sided differences of second order: -dT/dx = film T at the right edge, -dT/dy = film T at the top.
    edge, steps = np.full(2, 0.6), np.array([0.0, 1.0, 2.0]) * h
    right, top = (at(edge - s, y) for s in steps), (at(x, np.ones(2) - s) for s in steps)
    for T, back, further in (tuple(right), tuple(top)):
        assert_allclose((3 * T - 4 * back + further) / (2 * h), -4.0 * T, atol=1e-4)
    # The base: a wide plate with hardly any film is one bar with a film at its end.
    bar = convecting_plate(np.array([0.0]), np.array([0.25]), width=30.0, height=1.0, film=4.0)
    assert_allclose(bar, 1.0 - 0.25 * 4.0 / 5.0, atol=1e-9)
