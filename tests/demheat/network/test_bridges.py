"""Only here: what facets carry over gaps in which no twins fit, and which they are."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from spared import slow_but

from demheat import Laguerre, Layer, Material, Scene, Sphere, solve
from demheat.dem import networks
from demheat.dem.networks import network_of
from demheat.network.base import HERE, image_shifts
from demheat.network.bridges import bridged, filled, matter
from demheat.network.gap_links import Facets, across
from demheat.network.narrowest import narrowest
from demheat.packing.tile import tiled
from demheat.scene import Ellipsoid
from references import multipole

UNIT, GOOD, BAD = (1.0, 1.0, 1.0), Material(1000.0), Material(1e-3)
CELL, WALLS = {"gradient": (0, 1, 0)}, {"walls": {"y-": 0.0, "y+": 1.0}}
pytestmark = pytest.mark.filterwarnings("ignore:.*pairs of particles do not fit")


def network(scene, number=1000):
    return network_of(scene, tiled(number, size=scene.size, periodic=scene.periodic), Laguerre())


def rows(net):
    return np.repeat(np.arange(len(net.centers)), np.diff(net.indptr))


@pytest.mark.parametrize("middle", [0.5, 0.1])
@pytest.mark.parametrize("material", [GOOD, BAD])
def test_copies_of_a_sphere_are_parted_where_they_touch(middle, material, monkeypatch):
    # The second one crosses the faces of the cell: links over those are within the sphere.
    scene = Scene(UNIT, Material(2.0), [Sphere((middle,) * 3, 0.5, material)], **CELL)
    monkeypatch.setattr(networks, "bridged", lambda net, *_: net)
    net = network(scene)
    found, row = (bridged if material is GOOD else filled)(net, scene), rows(net)
    changed = np.flatnonzero(found.conductance != net.conductance)
    there = net.centers[net.indices] + image_shifts(net.image, net.size)
    assert len(changed) and np.all(net.phase[row[changed]] == 1) and np.all(net.phase[net.indices[changed]] == 1)
    # From one copy to the next a sphere's middle is nearer to each end: the ends lie on both sides of a touching plane.
    side = [np.floor(ends[changed] - middle + 0.5) for ends in (net.centers[row], there)]
    assert np.all(np.any(side[0] != side[1], axis=1))
    if middle == 0.5:
        assert np.all(net.image[changed] != HERE)
        assert len(changed) == np.sum((net.image != HERE) & (net.phase[row] == 1) & (net.phase[net.indices] == 1))
    # As from one end so from the other; a facet is cut anew from either, and small ones round the more.
    assert_allclose(np.sort(found.conductance[changed])[::2], np.sort(found.conductance[changed])[1::2], rtol=1e-6)
    if material is GOOD:
        assert np.array_equal(np.sort(found.over[0]), changed)
        assert len(found.over[1]) == 0
    else:
        length = np.linalg.norm(there - net.centers[row], axis=1)[changed]
        assert_allclose(found.conductance[changed], 2.0 * net.area[changed] / length, rtol=1e-12)  # rounding


def test_what_lies_in_each_other_or_conducts_little_better_stays():
    nested = [Sphere((0.5, 0.5, 0.5), 0.4, GOOD), Sphere((0.5, 0.5, 0.5), 0.2, Material(1e6))]
    mild = [Sphere((0.5, 0.5, 0.5), 0.5, Material(20.0))]
    for inclusions, matters in ((nested, True), (mild, False), ([Layer(0, 0.2, 0.5, GOOD)], True)):
        scene = Scene(UNIT, Material(1.0), inclusions, **CELL)
        net = network(scene)
        assert matter(scene) == matters
        for change in (bridged, filled):
            assert np.array_equal(change(net, scene).conductance, net.conductance)


# Gap, contrast and load; by multipoles, of which two runs here would take a minute: `references.multipole` at its
# default accuracy, 1e-5.
KNOWN = {
    "touching, walls": (0.0, 1e3, WALLS, 15.86927),
    "walls": (1e-3, 1e4, WALLS, 11.21950),
    "cell": (1e-5, math.inf, CELL, 18.50288),
}


@pytest.mark.parametrize("name", slow_but({"touching, walls", "cell"}, KNOWN))
def test_spheres_in_order_that_touch_or_nearly(name):
    """85.7 and some 1e8 were told of the first and the last."""
    gap, contrast, load, known = KNOWN[name]
    field = solve(
        Scene(UNIT, Material(1.0), [Sphere((0.5,) * 3, 1 / (2 + gap), Material(contrast))], **load), particles=2000
    )
    assert field.error.lower < known < field.error.upper
    # The disc without twins is some five facets wide, and what cells over it conduct is known to a third or so.
    assert_allclose(field.conductivity, known, rtol=0.03)


def spheres(apart, radius):
    """How far points are outside of two spheres one above the other, from the middle between."""
    middles = 0.5 * apart * np.array([[0.0, 0, -1], [0, 0, 1]])

    def between(points):
        ways = [points - middle for middle in middles]
        lengths = [np.linalg.norm(way, axis=1) for way in ways]
        return tuple(each - radius for each in lengths), tuple(
            w / n[:, None] for w, n in zip(ways, lengths, strict=True)
        )

    return between


def test_the_narrowest_place():
    gap = narrowest(spheres(2.01, 1.0), np.array([0.1, -0.05, 0.004]), 0.01)
    assert_allclose(gap.place[:2], 0.0, atol=1e-12)
    assert_allclose(gap.width, 0.01, rtol=1e-12)
    # Of surfaces at rest: 1/1.005 from the middle of the gap.
    assert_allclose(gap.curvatures, 2 / 1.005, rtol=1e-3)
    body, other = Ellipsoid((0, 0, 0), (0.6, 0.3, 0.5), GOOD), Sphere((0.0, 0.0, 0.8), 0.29, GOOD)
    gap = narrowest(
        lambda points: tuple(zip(body.surface(points), other.surface(points), strict=True)), (0.05, 0.05, 0.5), 0.01
    )
    assert_allclose(gap.place[:2], 0.0, atol=1e-9)
    # c/a^2 and c/b^2 of the ellipsoid, 1/R of the sphere; both to the middle of the gap of .01.
    assert_allclose(gap.curvatures, [0.5 / 0.09 + 1 / 0.29, 0.5 / 0.36 + 1 / 0.29], rtol=0.05)


def test_what_a_gap_lets_pass():
    """Ring by ring beside the closed form, of perfect conductors and of what is between parallel faces."""
    rim, count = 0.05, 40
    angle = 2 * math.pi * np.arange(count) / count
    points, area = rim * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1), np.full(count, 1e-6)
    taken, width, medium = np.full((2, count), 1e3), 1e-4, 2.0
    least = width + rim**2
    found, told = across(
        np.full(count, 1e9), Facets(points, area, spheres(2 + width, 1.0), medium, 1e-12, 0.0, taken), least
    )
    r = (np.arange(100_000) + 0.5) / 100_000 * rim
    exact = np.sum(2 * math.pi * r * medium * (1 / (width + r**2) - 1 / least)) * rim / 100_000
    # The parabola of the width is the spheres' to a curvature's worth of the gap, 1e-4, and of the rim's square.
    assert_allclose(found.sum() - medium * area.sum() / least, exact, rtol=3e-3)
    assert_allclose(told, width, rtol=1e-9)

    # What resists is as much of the matrix: a gap as much wider, to the rim.
    found, _ = across(
        np.full(count, 1e9), Facets(points, area, spheres(2 + width, 1.0), medium, 1e-12, 1e-3, taken), least
    )
    exact = np.sum(2 * math.pi * r * medium * (1 / (width + 2e-3 + r**2) - 1 / (least + 2e-3))) * rim / 100_000
    assert_allclose(found.sum() - medium * area.sum() / (least + 2e-3), exact, rtol=3e-3)

    def plates(points):
        up = np.tile([0.0, 0, 1], (len(points), 1))
        return (points[:, 2] + 0.01, 0.02 - points[:, 2]), (up, -up)

    found, told = across(np.full(count, 1e-3), Facets(points, area, plates, medium, 1e-12, 0.0, taken), least)
    assert_allclose(found, 1 / (1 / 1e-3 + 0.03 / (medium * area)), rtol=1e-12)
    assert_allclose(told, 0.03, rtol=1e-12)


@pytest.mark.slow
def test_unlike_spheres_beside_multipoles():
    """Two that nearly touch in a cell, oblique, one of them across its faces."""
    one, two = np.array([0.1, 0.3, 0.4]), np.array([0.45, 0.6, 0.55])
    apart = float(np.linalg.norm(two - one))
    spheres = [Sphere(one, 0.3, Material(1e4)), Sphere(two, apart - 0.3003, Material(300.0))]
    scene = Scene(UNIT, Material(1.0), spheres, gradient=(1, 1, 0))
    told = multipole.solve(scene, accuracy=1e-3)
    field = solve(scene, particles=8000)
    assert told.stats["pairs"] > 0
    assert_allclose(field.conductivity, told.conductivity, rtol=0.02)  # as of two per cent asked for
    assert field.error.lower < told.conductivity < field.error.upper
