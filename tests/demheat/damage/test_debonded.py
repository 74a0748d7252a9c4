"""Only here: inclusions that have come off drawn anew by a larger share, or leaking heat."""

from functools import cache

import pytest
from numpy.testing import assert_allclose

import demheat
from demheat import Layer, Material, Scene, Sphere, gallery
from demheat.damage import debonded
from references import exact, multipole


@cache
def cell():
    return gallery.random_dispersion(8, fraction=0.15, gap=0.2, edge=1.0, seed=3)


def off(scene):
    return {number for number, each in enumerate(scene.inclusions) if each.material.conductivity == 0}


def test_a_larger_share_is_the_same_draw_and_more():
    draws = [off(debonded(cell(), share, seed=5)) for share in (0.0, 0.25, 0.5, 1.0)]
    assert [len(each) for each in draws] == [0, 2, 4, 8]
    assert draws[0] < draws[1] < draws[2] < draws[3]
    assert off(debonded(cell(), 0.5, seed=6)) != draws[2]
    assert debonded(cell(), 0.0, seed=5) == cell()


def test_what_lies_in_an_inclusion_comes_off_with_it():
    shell, core = Sphere((0.5, 0.5, 0.5), 0.3, Material(5.0)), Sphere((0.5, 0.5, 0.5), 0.2, Material(9.0))
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), [shell, core], gradient=(1.0, 0.0, 0.0))
    assert off(debonded(scene, 1.0, seed=0)) == {0, 1}
    # Only surfaces towards the matrix are looked at.
    found = debonded(scene, 1.0, seed=0, resistance=0.1).resistances
    assert found.tolist() == [0.0, 0.1, 0.0]
    assert debonded(debonded(scene, 1.0, seed=0, resistance=0.1), 1.0, seed=0, resistance=0.05).resistances[1] == 0.1


def test_a_resistance_without_bound_is_a_pore():
    """Multipoles know both exactly; what is left falls as the inverse of the resistance."""
    pores = multipole.solve(debonded(cell(), 0.5, seed=1)).conductivity
    k = cell().matrix.conductivity
    found = [
        multipole.solve(debonded(cell(), 0.5, seed=1, resistance=r / k)).conductivity / pores - 1 for r in (1e3, 1e6)
    ]
    # Multipoles are cut where they have some seven digits.
    assert 0 < found[0] < 1e-3 and abs(found[1]) < 2e-6


@pytest.mark.parametrize("R", [1e6, 1e40])
def test_large_resistances_are_solved_right(R):
    """As pores of the same shape, up to the largest: by pairs of twins, and the closed form."""
    sphere = Sphere((0.5, 0.5, 0.5), 0.3, Material(10.0))
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), [sphere], walls={"x-": 0.0, "x+": 1.0})
    pore, loose = debonded(scene, 1.0, seed=0), debonded(scene, 1.0, seed=0, resistance=R)
    assert_allclose(exact.solve(loose).conductivity, exact.solve(pore).conductivity, rtol=2 / R + 1e-12)
    few = {"particles": 1000}
    # The solver's tolerance, 1e-8 of the heat that passes.
    found = demheat.solve(loose, **few).conductivity
    assert_allclose(found, demheat.solve(pore, **few).conductivity, rtol=2 / R + 1e-6)


def test_a_layer_that_has_come_off_stops_the_heat():
    layer = Layer(0, 0.2, 0.4, Material(7.0))
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), [layer], gradient=(1.0, 0.0, 0.0))
    assert exact.solve(debonded(scene, 1.0, seed=0)).conductivity == 0.0
    assert_allclose(exact.solve(debonded(scene, 1.0, seed=0, resistance=1e9)).conductivity, 0.0, atol=1e-9)
