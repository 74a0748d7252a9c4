"""Only here: what facets carry over gaps in which no twins fit, and intervals that know nothing of it."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Laguerre, Layer, Material, Scene, Sphere, solve
from demheat.dem.networks import network_of
from demheat.network.base import HERE, image_shifts
from demheat.network.bridges import filled, matter
from demheat.packing.tile import tiled
from references import multipole

UNIT, GOOD = (1.0, 1.0, 1.0), Material(1000.0)
TOUCHING = Sphere((0.5, 0.5, 0.5), 0.5, GOOD)
pytestmark = pytest.mark.filterwarnings("ignore:.*pairs of particles do not fit")


def network(scene, number=1000):
    return network_of(scene, tiled(number, size=scene.size, periodic=scene.periodic), Laguerre())


def rows(net):
    return np.repeat(np.arange(len(net.centers)), np.diff(net.indptr))


@pytest.mark.parametrize("middle", [0.5, 0.1])
def test_copies_of_a_sphere_are_parted_where_they_touch(middle):
    # The second one crosses the faces of the cell: links over those are within the sphere.
    scene = Scene(UNIT, Material(2.0), [Sphere((middle,) * 3, 0.5, GOOD)], gradient=(0, 1, 0))
    net = network(scene)
    found, row = filled(net, scene), rows(net)
    changed = np.flatnonzero(found.conductance != net.conductance)
    there = net.centers[net.indices] + image_shifts(net.image, net.size)
    assert len(changed) and np.all(net.phase[row[changed]] == 1) and np.all(net.phase[net.indices[changed]] == 1)
    # From one copy to the next a sphere's middle is nearer to each end: the ends lie on both sides of a touching plane.
    side = [np.floor(ends[changed] - middle + 0.5) for ends in (net.centers[row], there)]
    assert np.all(np.any(side[0] != side[1], axis=1))
    if middle == 0.5:
        assert np.all(net.image[changed] != HERE)
        assert len(changed) == np.sum((net.image != HERE) & (net.phase[row] == 1) & (net.phase[net.indices] == 1))
    length = np.linalg.norm(there - net.centers[row], axis=1)[changed]
    assert_allclose(found.conductance[changed], 2.0 * net.area[changed] / length, rtol=1e-12)  # rounding
    # As from one end so from the other; a facet is cut anew from either, and small ones round the more.
    assert_allclose(np.sort(found.conductance[changed])[::2], np.sort(found.conductance[changed])[1::2], rtol=1e-9)


def test_what_lies_in_each_other_or_conducts_little_better_stays():
    nested = [Sphere((0.5, 0.5, 0.5), 0.4, GOOD), Sphere((0.5, 0.5, 0.5), 0.2, Material(1e6))]
    mild = [Sphere((0.5, 0.5, 0.5), 0.5, Material(20.0))]
    for inclusions, matters in ((nested, True), (mild, False), ([Layer(0, 0.2, 0.5, GOOD)], True)):
        scene = Scene(UNIT, Material(1.0), inclusions, gradient=(0, 1, 0))
        net = network(scene)
        assert matter(scene) == matters
        assert np.array_equal(filled(net, scene).conductance, net.conductance)


@pytest.mark.parametrize("load", [{"walls": {"y-": 0.0, "y+": 1.0}}, {"gradient": (0, 1, 0)}])
def test_intervals_of_touching_spheres_reach_down_to_what_series_say(load):
    # Of a sphere that touches both walls 2000 particles had 85.7 [72.8, 98.5]: series say 20 at most.
    told = multipole.solve(Scene(UNIT, Material(1.0), [TOUCHING], gradient=(0, 1, 0)), order=20).error
    field = solve(Scene(UNIT, Material(1.0), [TOUCHING], **load), particles=2000)
    assert told.upper < 20 < field.conductivity
    assert field.error.lower < told.upper and field.error.upper > field.conductivity
    assert field.error.temperature > 0
