"""Only here: twins whose facets leave their interface, whose phases lack volume, or that meet in a gap."""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Laguerre, Layer, Material, Scene, Sphere
from demheat.network.base import branches, row_numbers
from demheat.network.laguerre import laguerre
from demheat.packing.cache import relaxed
from demheat.packing.tile import tiled
from demheat.packing.twins import conforming
from demheat.packing.twins.conforming import GAP_SPACING, conform
from demheat.packing.twins.interfaces import fibonacci_sphere
from demheat.packing.twins.patterns import Tally

MATRIX, OTHER = Material(1.0), Material(10.0)


def scene(*inclusions, periodic=True):
    load = {"gradient": (0, 1, 0)} if periodic else {"walls": {"y-": 0.0, "y+": 1.0}}
    return Scene(size=(1, 1, 1), matrix=MATRIX, inclusions=inclusions, **load)


def conformed(given, number=3000):
    packing = conform(relaxed(number, periodic=given.periodic, seed=1), given, seed=1)
    return packing, laguerre(packing.centers, packing.radii**2, packing.size, periodic=packing.periodic)


def interface_links(given, packing, facets):
    """Touch point offsets of links that join two phases: midpoint of the link, unit vector, facet's place on it."""
    phase = given.phase_at(packing.centers)
    row = row_numbers(facets.indptr)
    # Facets that rounding makes where four or more twins meet in one point are left out.
    cross = (phase[row] != phase[facets.indices]) & (facets.area > 1e-6 * facets.area.mean())
    branch = branches(packing.centers, packing.size, facets.indptr, facets.indices, facets.image)[cross]
    length = np.linalg.norm(branch, axis=1)
    unit = branch / length[:, None]
    return packing.centers[row[cross]] + facets.distance[cross, None] * unit, unit, facets.distance[cross] / length


@pytest.mark.parametrize("periodic", [True, False])
def test_every_facet_between_phases_lies_on_the_sphere(periodic):
    given = scene(Sphere((0.45, 0.5, 0.55), 1 / 3, OTHER), periodic=periodic)
    packing, facets = conformed(given)
    foot, unit, share = interface_links(given, packing, facets)
    offset = foot - given.inclusions[0].center
    radius = np.linalg.norm(offset, axis=1)
    assert len(share) == packing.provenance["twins"]  # one facet a pair, seen from both sides, and no other
    assert_allclose(share, 0.5, atol=1e-9)  # rounding of box coordinates over a short link
    assert_allclose(np.abs(np.einsum("ij,ij->i", unit, offset)), radius, rtol=1e-9)  # radial links
    assert_allclose(radius, radius[0], rtol=1e-9)  # one polyhedron
    assert 0.99 / 3 < radius[0] < 1 / 3  # inside the sphere, whose volume it has


def test_phase_volumes_are_those_of_the_scene():
    given = scene(Sphere((0.5, 0.5, 0.5), 0.4, OTHER), Sphere((0.5, 0.5, 0.5), 0.2, MATRIX))
    packing, facets = conformed(given)
    volumes = np.bincount(given.phase_at(packing.centers), facets.volumes)
    inner, outer = 4 / 3 * np.pi * 0.2**3, 4 / 3 * np.pi * 0.4**3
    # The polyhedron has the volume of its sphere: rounding of some thousand cells.
    assert_allclose(volumes, [1 - outer, outer - inner, inner], rtol=1e-9)


@pytest.mark.parametrize("center", [(0, 0, 0), (0.95, 0.02, 0.5)])
def test_a_sphere_may_cross_periodic_faces(center):
    given = scene(Sphere(center, 0.3, OTHER))
    packing, facets = conformed(given)
    _, _, share = interface_links(given, packing, facets)
    assert len(share) == packing.provenance["twins"]
    assert_allclose(share, 0.5, atol=1e-9)


def test_twins_of_two_interfaces_share_the_gap():
    """Each stands a quarter of the gap off its own, so that those of one face are apart from those of the other."""
    low, width = 0.4, 0.08
    packing, _ = conformed(scene(Layer(2, low, low + width, OTHER)))
    assert width < 2 * packing.radii.mean()
    x = packing.centers[:, 2]
    within = x[(x > low) & (x < low + width)]
    off = np.minimum(within - low, low + width - within)
    # The nearest to a face are twins; a few particles are left in the middle. Rounding of places.
    assert_allclose(off.min(), width / 4, rtol=1e-9)
    assert np.mean(off < width / 4 * (1 + 1e-9)) > 0.8


def test_a_wall_cuts_a_sphere():
    given = scene(Sphere((0.5, 0.0, 0.5), 0.3, OTHER), periodic=False)
    packing, facets = conformed(given)
    assert packing.centers.min() > 0 and packing.centers.max() < 1
    volumes = np.bincount(given.phase_at(packing.centers), facets.volumes)
    # Pairs that would stick out of the wall are left out, their neighbours' planes reach farther: first order there.
    assert_allclose(volumes[1], 2 / 3 * np.pi * 0.3**3, rtol=5e-3)


@pytest.mark.parametrize("periodic", [False, True])
def test_twins_keep_off_walls(periodic):
    """A pair that has a side nearer to a wall than three tenths of its offset is left out."""
    given, offset = scene(Layer(0, 0.2, 0.5, OTHER), periodic=periodic), 0.1
    y = np.array([0.29, 0.31]) * offset
    points = np.array([(0.5, at, 0.5) for at in (*y, *(1 - y))])
    twins = conforming._Twins(points, np.tile([1.0, 0.0, 0.0], (4, 1)), *np.full((3, 4, 2), offset), np.full(4, offset))
    assert conforming._in_place(twins, given).tolist() == [periodic, True] * 2


@pytest.mark.parametrize(
    "inclusions",
    [
        (Layer(0, 0.5, 0.515, OTHER),),
        (Sphere((0.5,) * 3, 0.4, OTHER), Sphere((0.5,) * 3, 0.385, MATRIX)),
        (Sphere((0.3, 0.5, 0.5), 0.195, OTHER), Sphere((0.7, 0.5, 0.5), 0.195, OTHER)),
    ],
)
def test_twins_are_known_before_they_are_made(inclusions, monkeypatch):
    made = []
    monkeypatch.setattr(conforming, "Tally", lambda: made.append(Tally()) or made[0])
    packing = relaxed(3000, periodic=True, seed=1)
    twins = conform(packing, scene(*inclusions), seed=1).provenance["twins"]
    # Points are thinned in order along a surface, so a little closer than they need be: found .95 to 1.26.
    assert 0.8 < twins / made[0].twins < 1.4, twins / made[0].twins


@pytest.mark.parametrize("gap, crowded", [(0.3, False), (0.1, True)])
def test_pairs_that_do_not_fit_are_counted(gap, crowded):
    """A fifth of a mean radius between two spheres, a tenth to a wall, is the least that twins need."""
    base = relaxed(3000, periodic=False, seed=1)
    width = gap * base.radii.mean()
    two = scene(Sphere((0.3, 0.5, 0.5), 0.2, OTHER), Sphere((0.7 + width, 0.5, 0.5), 0.2, OTHER), periodic=False)
    wall = scene(Sphere((0.5, 0.2 + 0.5 * width, 0.5), 0.2, OTHER), periodic=False)
    for given in (two, wall):
        assert (conform(base, given).provenance["pairs_left_out"] > 0) == crowded


@pytest.mark.parametrize(("off", "periodic"), [(-3e-16, True), (3e-16, False)])
def test_faces_that_only_rounding_tells_apart_are_one(off, periodic):
    """Layers moved or measured in other units touch but for rounding: no twins fit into such a gap."""

    def packed(off):
        ends = ((0.0 + max(off, 0.0), 0.3), (0.3 + off, 0.6), (0.6 + off, 1.0 + min(off, 0.0)))
        layers = [Layer(0, *each, Material(k)) for each, k in zip(ends, (2.0, 3.0, 4.0), strict=True)]
        return conform(relaxed(1000, periodic=periodic, seed=1), scene(*layers, periodic=periodic), seed=1)

    found, right = packed(off), packed(0.0)
    assert found.provenance["pairs_left_out"] == 0 and found.provenance["twins"] == right.provenance["twins"] > 100
    assert_allclose(found.centers, right.centers, atol=1e-14)


@pytest.mark.parametrize("unit", [1e-9, 0.3])  # another number of twins in each without ties broken on purpose
def test_twins_of_a_coat_are_the_same_in_any_unit(unit):
    """Its gap is equally wide all round: which points come first must not hang on rounding."""

    def packed(unit):
        center = np.array([0.637, 0.27, 0.041]) * unit
        shells = [Sphere(center, 0.21 * unit, OTHER), Sphere(center, 0.14 * unit, Material(0.1))]
        given = Scene(np.full(3, unit), MATRIX, shells, gradient=(0, 1 / unit, 0))
        return conform(relaxed(2000, size=given.size, seed=1), given, seed=1)

    found, right = packed(unit), packed(1.0)
    assert found.provenance["twins"] == right.provenance["twins"] > 100
    assert_allclose(found.centers / unit, right.centers, atol=1e-9)


def test_closer_twins_in_gaps_are_asked_of_the_law():
    """Twice as close in a coat of uneven width: four times as many, or a quarter more by thinning."""
    coat = [Sphere((0.5,) * 3, 0.3, Material(2.0)), Sphere((0.501, 0.5, 0.5), 0.27, Material(5.0))]
    base = relaxed(2000, periodic=True, seed=1)
    usual, close = (conform(base, scene(*coat), seed=1, gap_spacing=each) for each in (GAP_SPACING, GAP_SPACING / 2))
    assert 3 < close.provenance["twins"] / usual.provenance["twins"] < 5
    lone = [conform(base, scene(*coat[:1]), seed=1, gap_spacing=each).provenance["twins"] for each in (0.85, 0.4)]
    assert lone[0] == lone[1]
    assert Laguerre().gap_spacing == GAP_SPACING


def test_twins_beyond_the_other_side_are_none():
    """Both would be of the matrix."""
    normals = fibonacci_sphere(20)
    twins = conforming._Twins(0.5 + 0.01 * normals, normals, *np.tile([[0.003], [0.03]], (3, 10, 2)), np.full(20, 0.03))
    assert conforming._in_place(twins, scene(Sphere((0.5, 0.5, 0.5), 0.01, OTHER))).tolist() == [True, False] * 10


def test_twins_on_a_flat_interface_weigh_as_much_as_particles():
    """So do cells on both sides of them: with another weight facets bulge where twins end."""
    base = tiled(2000, size=(1.0, 1.0, 1.0), seed=1)
    packing, radius = conform(base, scene(Layer(2, 0.3, 0.7, OTHER)), seed=1), base.radii[0]
    away = np.minimum(np.abs(packing.centers[:, 2] - 0.3), np.abs(packing.centers[:, 2] - 0.7))
    twins, far = np.abs(away - 0.5 * radius) < 1e-9, away > 4 * radius
    assert np.sum(twins) == packing.provenance["twins"] and np.sum(far) > 100
    # Squares taken and roots drawn: rounding.
    assert_allclose(packing.radii[twins], packing.radii[far][0], rtol=1e-12)


def test_twins_stay_off_what_does_not_face_them():
    """Alone; at a quarter of the way to another surface, half of that to a wall, half of the depth behind them."""
    far = np.full(4, np.inf)
    ways = {name: far.copy() for name in ("width", "gap", "way_to_wall", "depth")} | {"bend": np.zeros(4)}
    ways["gap"][1], ways["way_to_wall"][2], ways["depth"][3] = 0.4, 0.1, 0.12
    interfaces = SimpleNamespace(**{name: lambda *_, each=each: each for name, each in ways.items()})
    found = conforming._offsets(None, None, None, interfaces, 1.0)
    assert_allclose(found, [conforming.OFFSET, 0.1, 0.05, 0.06], rtol=1e-15)
