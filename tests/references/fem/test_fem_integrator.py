"""What finite elements step in time with: linear solvers, loads at nodes, TR-BDF2 and its weights, separation."""

import math

import numpy as np
from fem_scenes import cube, last
from numpy.testing import assert_allclose

from demheat.scene import Material, Scene, Sphere, UniformSource
from references.fem import bricks, implicit, loads, separable, trbdf2


def test_multigrid_and_factors_agree(monkeypatch):
    ball = Sphere((0.5, 0.5, 0.5), 0.3, Material(9.0, 2.0, 1.0))
    of, knobs = cube(walls={"x-": 1.0}, inclusions=(ball,)), {"size": 0.34, "order": 1}
    field = last(of, [0.05], step=0.01, **knobs)
    monkeypatch.setattr("references.fem.implicit.DIRECT", 0)
    other = last(of, [0.05], step=0.01, **knobs)
    # Residuals of 1e-9 times the condition number of the equations, at most some hundreds.
    assert_allclose(other.samples.temperature, field.samples.temperature, atol=1e-6)
    assert other.stats["iterations"] > field.stats["iterations"]


def test_weights_of_the_integrator():
    """Second and third order conditions of the two sets of weights (Hosea and Shampine 1996)."""
    places = np.array([0, trbdf2.GAMMA, 1])
    for weights, order in ((trbdf2.WEIGHTS, 2), (trbdf2.THIRD, 3)):
        for power in range(order):
            assert_allclose(weights @ places**power, 1 / (power + 1), rtol=1e-14)
    assert abs(trbdf2.WEIGHTS @ places**2 - 1 / 3) > 0.01


def test_rates_at_the_start():
    of = cube(walls={"y-": lambda t: math.sin(5 * t)}, sources=(UniformSource(2.0),))
    on = bricks.hexahedra(of, 0.34)
    driven = loads.Loads(of, on, level=0.0)
    free = np.setdiff1d(np.arange(len(on.points)), driven.held)
    solver = implicit.Shifted(*(m[free][:, free] for m in (on.mass, on.stiffness)), None, 1e-12)
    state = trbdf2.begin(trbdf2.Problem(driven, solver, free), np.zeros(len(on.points)), 0.0, 1e-3)
    # Slope of the sine by differences of 1 ms, off by 2/3 of the third derivative times the square of that.
    assert_allclose(state.rate[driven.held], 5, atol=125 * 1e-6)
    assert_allclose(state.entering[free], 0, atol=1e-12)
    assert_allclose(on.mass @ state.rate - state.entering, 2 * on.volumes, atol=1e-12)


def test_where_held_walls_meet_nodes_take_the_mean_and_the_walls_share_the_heat():
    knobs = {"elements": "hexahedra", "size": 0.25, "accuracy": 1e-3}
    field = last(cube(walls={"x-": 1.0, "y-": 3.0}), [0.0, 0.1], **knobs)
    assert_allclose(field.temperature_at(np.array([[0.0, 0.0, 0.3]])), 2.0, rtol=1e-12)
    assert field.wall_temperature == {"x-": 1.0, "y-": 3.0}
    heat = field.stats["heat_in"]
    assert_allclose(heat["x-"] + heat["y-"], field.stats["heat_change"], rtol=1e-8)
    even = last(cube(walls={"x-": 2.0, "y-": 2.0}), [0.1], **knobs).stats["heat_in"]
    assert_allclose(even["x-"], even["y-"], rtol=1e-8)  # by symmetry, to the linear tolerance


def test_separation_inverts_the_equations_of_a_grid():
    of = Scene((1.0, 0.7, 0.5), Material(3.0, 2.0, 5.0), walls={"x-": 0.0, "z-": 0.0, "z+": 0.0}, initial=0.0)
    on, uneven = bricks.hexahedra(of, 0.13), np.array([0.0, 0.1, 0.35, 0.5])
    free = np.setdiff1d(np.arange(len(on.points)), np.concatenate([on.walls[name].nodes for name in of.walls]))
    solution = np.random.default_rng(1).random(len(free))
    for tau in (1e-3, 0.1, 1e3):
        A = (on.mass / tau + on.stiffness)[free][:, free]
        assert_allclose(on.separable(free)(tau, A @ solution), solution, rtol=1e-9)
    # On an uneven grid a solve undoes the products of the matrices of its axes.
    mass, stiffness = (
        sum(np.pad(block * w, (i, 2 - i)) for i, w in enumerate(widths))
        for block, widths in ((separable.MASS, np.diff(uneven)), (separable.STIFFNESS, 1 / np.diff(uneven)))
    )
    M = np.kron(np.kron(mass, mass), mass)
    K = sum(
        np.kron(np.kron(*(stiffness if i == a else mass for i in (0, 1))), stiffness if a == 2 else mass)
        for a in range(3)
    )
    x = np.random.default_rng(2).random(64)
    solve = separable.separable((uneven,) * 3, 3.0, 10.0, np.arange(64))
    assert_allclose(solve(0.1, (10.0 / 0.1 * M + 3.0 * K) @ x), x, rtol=1e-9)
