"""Only here: walls that exchange heat taken by who does not know them, and temperatures that are no kelvin."""

from dataclasses import replace

import numpy as np
import pytest

from demheat import Convection, Flux, Material, Radiation, Scene, Sphere, effective, recommend, referee
from demheat.scene.functions import initial_at, load_at
from demheat.scene.narrows import narrows
from demheat.scene.needs import EXCHANGE
from demheat.scene.negligible import negligible
from demheat.scene.symmetry import reduced
from demheat.tensor import axis_loads
from references import bracket, exact, multipole
from studies.harness import methods

METAL = Material(2.0, 3.0, 4.0)
BOX = (1.0, 1.0, 1.0)
OUT = {"x-": 50.0, "x+": Convection(7.0, 20.0)}
HOT = {"x-": 500.0, "x+": Radiation(0.5, 300.0)}


def scene(walls, **parts):
    return Scene(BOX, METAL, walls=walls, **parts)


def test_what_a_scene_says_of_its_walls():
    made = scene(OUT | {"y-": Flux(3.0), "y+": Convection(2.0, 30.0)})
    assert made.wall_temperatures == {"x-": 50.0} and made.wall_fluxes == {"y-": 3.0}
    assert made.wall_exchanges == {"x+": Convection(7.0, 20.0), "y+": Convection(2.0, 30.0)}
    assert made.imposed_temperatures == {"x-": 50.0, "x+": 20.0, "y+": 30.0}
    assert not made.radiates and scene(HOT).radiates
    assert referee.span(made) == 30.0


def test_loads_in_time():
    made = scene({"x-": Convection(7.0, lambda t: 20.0 + t), "x+": Radiation(1.0, lambda t: 300.0 + t)}, initial=300.0)
    assert made.at(2.0).walls == {"x-": Convection(7.0, 22.0), "x+": Radiation(1.0, 302.0)}
    with pytest.raises(ValueError, match=r"\['x-', 'x\+'\] depend on time"):
        made.require(steady=True, takes=("exchange",))
    with pytest.raises(ValueError, match=r"Scene.walls\['x\+'\] at 1.0 s = -1.0: must be a finite temperature >= 0 K"):
        load_at("x+", Radiation(1.0, lambda t: -t), 1.0)


@pytest.mark.parametrize(
    ("walls", "initial", "what"),
    [
        ({"x-": -5.0, "x+": Radiation(0.5, 300.0)}, None, r"Scene.walls\['x-'\], with a wall that radiates, = -5.0"),
        ({"x-": Convection(1.0, -5.0), "x+": Radiation(0.5, 300.0)}, None, r"Scene.walls\['x-'\].* = -5.0"),
        (HOT, -5.0, "Scene.initial, with a wall that radiates, = -5.0"),
    ],
)
def test_where_a_wall_radiates_all_is_kelvin(walls, initial, what):
    with pytest.raises(ValueError, match=what):
        scene(walls, initial=initial)
    scene(
        {name: load for name, load in walls.items() if not isinstance(load, Radiation)} | {"y-": 1.0}, initial=initial
    )


def test_initial_temperatures_by_a_function_are_kelvin_too():
    points = np.full((3, 3), 0.5)
    with pytest.raises(ValueError, match="Scene.initial = -0.5 .* 0 K"):
        initial_at(scene(HOT, initial=lambda x: -x[:, 0]), points)
    assert initial_at(scene(OUT, initial=lambda x: -x[:, 0]), points)[0] == -0.5


def test_a_steady_state_needs_a_temperature_somewhere():
    for load in (Convection(7.0, 20.0), Radiation(0.5, 300.0)):
        scene({"x-": Flux(3.0), "x+": load}).require(steady=True, takes=("exchange",))
    with pytest.raises(ValueError, match="its own or that of surroundings"):
        scene({"x-": Flux(3.0)}).require(steady=True, takes=("exchange",))


KNOWING = {"dem", "dem-plain", "dem-mean", "fem", "fem-straight", "fem-p1", "fem-bricks"}


@pytest.mark.parametrize("name", [name for name in methods.all_methods() if name not in KNOWING])
@pytest.mark.parametrize("walls", [OUT, HOT])
def test_methods_that_do_not_know_them_say_so(name, walls):
    method = methods.all_methods()[name]
    # Who knows them, or the method's own remedy.
    with pytest.raises(NotImplementedError, match=rf"^Scene.walls\['x.'\] = \w+\(.*\): .*({EXCHANGE}|; use wall ')"):
        getattr(methods.load(method.module), method.call)(scene(walls), **method.knobs)


@pytest.mark.parametrize(
    "call",
    [
        exact.solve,
        multipole.solve,
        multipole.solve_axes,
        bracket.solve_tensor,
        axis_loads,
        reduced,
        effective,
        recommend,
        lambda made: negligible(made, 0.1),
    ],
)
@pytest.mark.parametrize("walls", [OUT, HOT])
def test_what_else_does_not_know_them(call, walls):
    with pytest.raises(NotImplementedError, match=EXCHANGE):
        call(scene(walls))


def test_a_good_conductor_near_such_a_wall_is_near():
    ball = Sphere((0.5, 0.5, 0.5), 0.45, Material(200.0))
    found = [
        narrows(scene(walls, inclusions=[ball]), 0.06)[0] for walls in ({"y-": Convection(1.0, 1.0)}, {"y-": Flux(1.0)})
    ]
    assert found == [True, False]
    assert replace(scene(OUT), walls={"x-": 1.0}).wall_exchanges == {}
