"""Only here: what a method cannot do of a scene, named without what it can or who takes it."""

import numpy as np
import pytest

from demheat import Convection, Dependence, Flux, Image, Layer, Material, Scene, Sphere, orthotropic

A, B = Material(1.0), Material(2.0)
BOX = (1.0, 1.0, 1.0)
STEEL = Material(33.0, density=7800.0, heat_capacity=0.9)


def scene(*inclusions, **load):
    return Scene(BOX, A, inclusions, **(load or {"walls": {"y-": 0.0, "y+": 1.0}}))


def ball(x, y, z, radius, material=B):
    return Sphere((x, y, z), radius, material)


def transient(**more):
    return Scene(**({"size": (1.0, 2.0, 1.0), "matrix": STEEL, "initial": 25.0} | more))


NESTED = (ball(0.5, 0.5, 0.5, 0.3), ball(0.5, 0.5, 0.4, 0.1))


@pytest.mark.parametrize(
    ("given", "needs", "what"),
    [
        (scene(), {"walls": "none"}, r"Scene.walls = \{'y-': 0.0, 'y\+': 1.0\}"),
        (scene(walls={"y-": 0.0, "y+": Flux(1.0)}), {"walls": "one isothermal pair"}, "Scene.walls = .*"),
        (scene(walls={"y-": 0.0, "x+": 1.0}), {"walls": "one isothermal pair"}, "Scene.walls = .*"),
        (scene(walls={"y-": 0.0, "x+": 1.0}), {"walls": "isothermal ones apart"}, "Scene.walls = .*"),
        (transient(size=BOX, domain="cylinder-z", walls={"round": 1.0}), {"walls": "flat"}, "Scene.walls = .*"),
        (transient(size=BOX, domain="sphere"), {"walls": "flat"}, r"Scene.walls = \{\}"),
        (transient(size=BOX, domain="sphere"), {"domain": "box"}, "a sphere"),
        (scene(Layer(0, 0.8, 0.9, B), *NESTED), {"shapes": (Layer,)}, r"a sphere, Scene.inclusions\[1\]"),
        (scene(*NESTED), {"shapes": ()}, "inclusions in a box"),
        (scene(*NESTED), {"nested": False}, r"Scene.inclusions\[1\], nested in \[0\]"),
        (scene(ball(0.5, 0.5, 0.5, 0.3, Material(0.0))), {"pores": False}, "a conductivity is 0"),
    ],
)
def test_what_a_method_cannot_do_is_named_with_what_it_can(given, needs, what):
    given.require("it can all")
    with pytest.raises(NotImplementedError, match=f"^{what}: it knows better$"):
        given.require("it knows better", **needs)


LABELS = np.zeros((2, 2, 2), dtype=int)
OTHER = {"size": BOX, "walls": {"x-": 0.0, "x+": 1.0}}
RISING = Dependence(((0.0, 1.0), (1.0, 2.0)))
FEW = {
    "image": (Scene.of_image(Image(LABELS, 1.0, {0: STEEL}), gradient=(1, 0, 0)), "Scene.image", "images are for"),
    "exchange": (
        Scene(size=BOX, matrix=STEEL, walls={"x-": 0.0, "x+": Convection(2.0, 5.0)}),
        r"Scene.walls\['x\+'\] = Convection\(.*\)",
        "heat exchanged with surroundings is for the DEM",
    ),
    "tensor": (
        Scene(matrix=Material(orthotropic(1.0, 2.0, 3.0)), **OTHER),
        "Material.conductivity in phase 0 is a tensor",
        "tensors are for steady states of finite elements",
    ),
    "dependence": (
        Scene(matrix=Material(1.0, dependence=RISING), **OTHER),
        "Material.dependence in phase 0, a conductivity that follows the temperature",
        "that is for steady states of the DEM and finite elements",
    ),
}


@pytest.mark.parametrize("name", FEW)
def test_what_few_methods_take_is_named_before_the_reason_and_who_takes_it(name):
    given, what, others = FEW[name]
    with pytest.raises(NotImplementedError, match=f"^{what}: it knows better; {others}"):
        given.require("it knows better")
    with pytest.raises(NotImplementedError, match=f"^{what}: {others}"):
        given.require()
    # Its own remedy is enough.
    with pytest.raises(NotImplementedError, match=f"^{what}: it knows better; use another knob$"):
        given.require("it knows better; use another knob")


def test_what_a_method_can_do_is_not_refused():
    needs = {"shapes": (Sphere, Layer), "nested": False, "pores": False, "domain": "box"}
    for walls in ("one isothermal pair", "isothermal ones apart", "flat"):
        scene(ball(0.5, 0.5, 0.5, 0.3), Layer(0, 0.8, 0.9, B)).require("it knows", steady=True, walls=walls, **needs)
    scene(ball(0.5, 0.5, 0.5, 0.3), gradient=(0, 1, 0)).require("it knows", steady=True, walls="none", **needs)
    transient(size=BOX, domain="cylinder-z", walls={"z-": 1.0}).require("it knows", steady=False, walls="flat")
