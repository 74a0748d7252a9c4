"""NGSolve: what it is given, and where it is installed two bodies that are known."""

import pytest

from demheat import Cylinder, Material, Scene
from studies.peers import given
from studies.peers.programs import ngsolve

here = pytest.mark.skipif(ngsolve.missing() is not None, reason=str(ngsolve.missing()))


def test_a_body_becomes_parts_from_the_matrix_inwards():
    asked = ngsolve.asked_for(given.scene("coated"))
    assert [part["kind"] for part in asked["parts"]] == ["box", "sphere", "sphere"]
    assert asked["parts"][1]["radius"] == 0.4 > asked["parts"][2]["radius"]
    assert asked["parts"][2]["conductivity"] == 10.0 and asked["walls"] == {"x-": 1.0, "x+": 0.0}
    layer = ngsolve.asked_for(given.scene("layers off the grid"))["parts"][1]
    assert layer == {"kind": "layer", "axis": 0, "start": 0.0, "stop": given.OFF, "conductivity": 10.0}


def test_other_shapes_are_refused():
    cylinder = Cylinder((0.5, 0.5, 0.5), 0.2, (0, 0, 1), Material(2.0))
    scene = Scene(given.SIZE, given.MATRIX, [cylinder], walls=given.WALLS)
    with pytest.raises(NotImplementedError, match="only spheres and layers"):
        ngsolve.asked_for(scene)


@here
def test_layers_are_exact():
    found = ngsolve.solve(given.scene("layers off the grid"), size=0.5, order=3)
    # Conjugate gradients stop at 1e-10.
    assert found.conductivity == pytest.approx(given.known("layers off the grid"), rel=1e-9)
    assert found.cost["cpu_s"] < found.cost["wall_s"] + 0.1 and " 0 folded" in found.note


@here
def test_order_five_is_seven_digits_of_a_sphere():
    found = ngsolve.solve(given.scene("sphere 10"), size=0.2, order=5)
    # Found 2.3e-7; the exact value has seven digits or more.
    assert found.conductivity == pytest.approx(given.known("sphere 10"), rel=1e-6)
