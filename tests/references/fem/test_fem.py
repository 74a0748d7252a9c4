"""What no suite asks of elements: walls with a flux, edges that walls share, pores at walls, rounding, gaps, bits."""

import warnings

import numpy as np
import pytest
from fem_scenes import COARSE, ball, scene
from numpy.testing import assert_allclose

from demheat.scene import Flux, Layer, LevelSet, Material, Scene, Sphere
from references import exact, fem
from references.fem import components, good

TIGHT = 1e-12  # solver tolerance of the exact cases: their errors are then below 1e-10


# ---------------------------------------------------------------- exact solutions


def test_imposed_flux_on_one_wall_is_exact_and_gives_its_mean_temperature():
    walls = {"x-": 20.0, "x+": Flux(50.0)}
    layers = [Layer(0, 0.5, 2.0, Material(5.0))]
    field = fem.solve(scene(*layers, size=(2.0, 1.0, 1.0), walls=walls), size=0.4, tolerance=TIGHT)
    rise = 50 * (0.5 / 1 + 1.5 / 5)
    assert_allclose(field.wall_temperature["x+"], 20 + rise, rtol=1e-10)
    assert field.wall_temperature["x-"] == 20.0
    assert_allclose([field.wall_heat["x+"], field.wall_heat["x-"]], [50.0, -50.0], rtol=1e-10)
    assert_allclose(field.conductivity, 50 * 2 / rise, rtol=1e-10)
    assert_allclose(field.temperature_at([[0.5, 0.3, 0.7]]), [45.0], rtol=1e-10)


# ---------------------------------------------------------------- accuracy


PERIODIC, WALLED = {"gradient": (0.0, 1.0, 0.0)}, {"walls": {"y-": 0.0, "y+": 1.0}}


POOR = Layer(1, 0.3, 0.6, Material(1e-12))


def test_contrasts_that_rounding_drowned():
    """Good conductors are unknowns of their own: 2e-3 of the mesh, and what the tolerance leaves."""
    for k in (1e12, 1e16):
        field = fem.solve(scene(ball(k, radius=0.3), **PERIODIC), size=0.25)
        assert_allclose(field.conductivity, 1.38295, rtol=0.01)
    along = Layer(0, 0.3, 0.6, Material(1e-20))
    assert_allclose(fem.solve(scene(along, **WALLED), size=0.25).conductivity, 0.7, rtol=1e-8)
    assert_allclose(fem.solve(scene(POOR, **WALLED), size=0.25).conductivity, 1e-12 / 0.3, rtol=1e-7)


def test_a_flux_that_rounding_drowns_is_no_answer(monkeypatch):
    """Without that it is any number in a sphere of 1e16, behind a layer of 1e-12 what the tolerance leaves."""
    monkeypatch.setattr(good, "find", lambda scene, mesh: None)
    for inclusion, load in ((ball(1e16, radius=0.3), PERIODIC), (POOR, WALLED)):
        with pytest.raises(RuntimeError, match=r"^fem.solve: the flux is off by .* at a contrast of 1.0e\+1[26]"):
            fem.solve(scene(inclusion, **load), size=0.25)


# ---------------------------------------------------------------- what any linear conductor owes


def test_isothermal_walls_share_their_common_edge():
    walls = {"x-": 300.0, "x+": 301.0, "y+": 303.0}
    field = fem.solve(scene(walls=walls), size=0.3, tolerance=TIGHT)
    assert_allclose(field.temperature_at([(1.0, 1.0, 0.4), (0.0, 1.0, 0.7)]), [302.0, 301.5], rtol=1e-12)
    assert abs(sum(field.wall_heat.values())) < 1e-10 * max(field.wall_heat.values())


# ---------------------------------------------------------------- pores


def test_loads_that_pores_make_impossible():
    pore = Layer(0, 0.4, 0.6, Material(0.0))
    with pytest.raises(ValueError, match="flux enters a part.*no temperature reaches"):
        fem.solve(scene(pore, walls={"x-": 0.0, "x+": Flux(1.0)}), size=0.3)
    end = Layer(0, 0.4, 1.0, Material(0.0))
    with pytest.raises(ValueError, match=r"walls\['x\+'\].*conducts somewhere"):
        fem.solve(scene(end, walls={"x-": 0.0, "x+": Flux(1.0)}), size=0.3)


def test_only_bodies_that_climb_the_gradient_carry_heat():
    """One piece that meets itself across x, and two that meet within the cell and once more across y."""
    seams, boxes = np.array([[0, 0], [1, 2], [1, 2]]), np.array([[1, 0, 0], [0, 0, 0], [0, 1, 0]])
    for jump, climbing in (((0.0, 1.0, 0.0), [False, True]), ((2.0, 0.0, 0.0), [True, False])):
        body, _, climbs = components._joined(seams, boxes, 3, np.array(jump))
        assert body.tolist() == [0, 1, 1] and climbs.tolist() == climbing


def test_a_flux_wall_with_a_pore_takes_heat_where_it_conducts():
    pore = Layer(1, 0.0, 0.25, Material(0.0))
    field = fem.solve(scene(pore, walls={"x-": 0.0, "x+": Flux(2.0)}), size=0.3, tolerance=TIGHT)
    assert_allclose([field.wall_heat["x+"], field.wall_heat["x-"]], [1.5, -1.5], rtol=1e-10)
    assert_allclose(field.wall_temperature["x+"], 2.0, rtol=1e-10)


# ---------------------------------------------------------------- bad input, no convergence, statistics


def test_a_solve_that_does_not_converge_raises():
    with pytest.raises(
        RuntimeError, match="residual .* > tolerance 1.00e-19 after [0-9]+ iterations on [0-9]+ unknowns"
    ):
        fem.solve(scene(ball()), size=COARSE, tolerance=1e-19)


def test_stats_and_the_callers_random_numbers():
    np.random.seed(3)  # noqa: NPY002
    expected = np.random.rand()  # noqa: NPY002
    np.random.seed(3)  # noqa: NPY002
    field = fem.solve(scene(ball()), size=COARSE)
    assert np.random.rand() == expected  # noqa: NPY002
    names = "unknowns elements iterations residual mesh_s assembly_s solve_s jacobian straightened size"
    assert set(names.split()) <= set(field.stats)
    assert 0 < field.stats["residual"] <= 1e-9 and 0 < field.stats["iterations"] < 40
    again = fem.solve(scene(ball()), size=COARSE)
    assert again.conductivity == field.conductivity  # the same bits each time


@pytest.mark.parametrize(
    ("contrast", "size", "order", "told"),
    [
        (30.0, 0.25, 1, True),
        (30.0, 0.06, 1, False),
        (10.0, 0.25, 1, False),
        (30.0, 0.25, 2, False),
    ],
)
def test_linear_elements_in_gaps_are_told(contrast, size, order, told):
    """A sphere a tenth from two walls: what is over the 5 % allowed to a hard case is told."""
    ball = Sphere((0.5, 0.5, 0.5), 0.4, Material(contrast))
    scene = Scene((1, 1, 1), Material(1.0), [ball], walls={"x-": 0.0, "x+": 1.0})
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = fem.solve(scene, order=order, size=size).conductivity
    assert ["gaps beside inclusions [0] have an element or so" in str(each.message) for each in caught] == [True] * told
    off = found / exact.solve(scene).conductivity - 1
    assert 0.05 < off < 0.1 if told else abs(off) < 0.05


def test_a_level_set_that_loses_volume_is_told_of():
    """Elements lacked a third of this one; of another one a quarter, and the interval missed."""

    def inside(points):
        return np.sum((points - 0.5) ** 2, axis=1) - 0.12**2

    body = LevelSet(inside, ((0.25,) * 3, (0.75,) * 3), Material(0.2))
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), [body], gradient=(1.0, 0.0, 0.0))
    with pytest.warns(
        UserWarning, match="inclusion 0: its elements have another volume .* by [1-9][0-9]%: the conduct"
    ):
        fem.solve(scene, size=0.2)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fem.solve(scene, size=0.04)
