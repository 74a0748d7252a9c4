"""Only here: spheres that are told to have a cusp beside them and have none, or the other way round."""

import pytest

from demheat import Ellipsoid, Material, Scene, Sphere
from references.fem.cusps import cusp

GOOD = Material(10.0)


@pytest.mark.parametrize(
    ("bodies", "told"),
    [
        ([Sphere((0.5, 0.5, 0.2), 0.2, GOOD)], True),
        ([Sphere((0.5, 0.5, 0.21), 0.2, GOOD)], False),
        # Cut by the wall at a slant, whose edge is no cusp.
        ([Sphere((0.5, 0.5, 0.1), 0.2, GOOD)], False),
        ([Sphere((0.3, 0.5, 0.5), 0.2, GOOD), Sphere((0.7, 0.5, 0.5), 0.2, GOOD)], True),
        # Of other shapes the mesher says it.
        ([Ellipsoid((0.5, 0.5, 0.2), (0.2, 0.2, 0.2), GOOD)], False),
        ([], False),
    ],
)
def test_what_touches_leaves_a_cusp(bodies, told):
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), bodies, walls={"z-": 0.0, "z+": 1.0})
    assert ("cusp" in cusp(scene)) is told
