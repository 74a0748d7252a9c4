"""Only here: twins off the surface of a solid, uneven on it, or of another volume than its own."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial import cKDTree
from solid_shapes import MATRIX, OTHER, RING, SOLIDS

from demheat import Scene, Sphere, solve
from demheat.packing.relax import relax
from demheat.packing.twins.conforming import conform
from demheat.packing.twins.gaps import Interfaces
from demheat.packing.twins.interfaces import surfaces_of
from demheat.packing.twins.patterns import SPACING as USUAL
from demheat.packing.twins.patterns import Tally, patterns
from demheat.scene import Cylinder, Ellipsoid, HalfSpace, Union
from demheat.scene.shapes.samples import surface_points

SPACING = 0.08
MIDDLE = (0.5, 0.5, 0.5)
SHAPES = {name: each.placed(MIDDLE) for name, each in SOLIDS.items()}
SHAPES |= {"half": HalfSpace(MIDDLE, (1, 2, 3), OTHER), "ring": RING}


def scene(shape):
    load = {"walls": {"x-": 0.0, "x+": 1.0}} if isinstance(shape, HalfSpace) else {"gradient": (1.0, 0.0, 0.0)}
    return Scene((1.0, 1.0, 1.0), MATRIX, [shape], **load)


def pattern(name):
    surface = surfaces_of(scene(SHAPES[name]))[0]
    points, normals = surface.pattern(SPACING, np.random.default_rng(0))
    return surface, points, normals


@pytest.mark.parametrize("name", SHAPES)
def test_patterns_lie_on_the_surface_and_cover_it(name):
    surface, points, normals = pattern(name)
    assert_allclose(surface.shape.distance(points), 0.0, atol=1e-9)
    assert_allclose(surface.shape.normal(points), normals, atol=1e-5)
    samples, areas = surface_points(SHAPES[name], np.zeros(3), np.ones(3), SPACING / 4)
    away, _ = cKDTree(points).query(samples)
    # A triangular pattern needs 0.58 spacings, a square one 0.66; twins count on 0.8, see `conforming`.
    assert away.max() < 0.85 * SPACING and np.quantile(away, 0.99) < 0.75 * SPACING
    inside = np.all((points >= 0) & (points <= 1), axis=1)
    assert_allclose(inside.sum(), areas.sum() / (math.sqrt(0.75) * SPACING**2), rtol=0.15)  # whole rows and rings


@pytest.mark.parametrize("name", ["fibre", "egg", "hoop"])
def test_planes_keep_the_volume(name):
    """By rays from inside along normals: what planes hold beyond the surface less what they leave, over the area."""
    surface, points, normals = pattern(name)
    moved = surface.touched(points, normals)
    samples, areas = surface_points(SHAPES[name], np.zeros(3), np.ones(3), SPACING / 6)
    _, nearest = cKDTree(points).query(samples)

    def excess(planes):
        cosine = np.einsum("ij,ij->i", normals[nearest], SHAPES[name].normal(samples))
        height = np.einsum("ij,ij->i", planes[nearest] - samples, normals[nearest]) / cosine
        return float(areas @ height)

    # Planes as they touch hold too much, of second order in the spacing over the radius of curvature.
    assert excess(points) / SHAPES[name].volume_in((1, 1, 1), periodic=True) > 3e-3
    assert abs(excess(moved)) < 0.05 * excess(points)


def test_a_fibre_s_planes_are_a_prism_of_its_volume():
    surface, points, normals = pattern("fibre")
    inner = np.linalg.norm((surface.touched(points, normals) - MIDDLE)[:, :2], axis=1)
    sides = len(np.unique(np.round(np.arctan2(normals[:, 1], normals[:, 0]), 9)))
    # Of a regular prism; by 40 directions for each point.
    assert_allclose(inner, 0.3 * math.sqrt(math.pi / sides / math.tan(math.pi / sides)), rtol=1e-4)
    assert len(points) % sides == 0 and len(points) > sides


@pytest.mark.parametrize("name", ["rod", "egg", "brick"])
def test_conforming_packings_have_the_right_fraction(name):
    """Cells of particles by their phases: facets lie on the surface."""
    whole = scene(SHAPES[name])
    field = solve(whole, particles=1500)
    share = SHAPES[name].volume_in((1, 1, 1), periodic=True)
    # A tenth of the cells of a body so small are at its surface; edges of bricks and rods are not followed.
    assert_allclose(field.fractions[1], share, rtol=5e-3)


@pytest.mark.parametrize("length", [None, 1.6])
def test_planes_of_a_cylinder_that_walls_cut_obliquely_keep_its_volume(length):
    """Between walls there are no points beyond them: planes that count on some there hold .3 % too little."""
    rod = Cylinder((0.5,) * 3, 0.18, (0.35, 1.0, 0.2), OTHER, length=length)
    body = Scene((1.0, 1.0, 1.0), MATRIX, [rod], walls={"y-": 0.0, "y+": 1.0})
    # Of cells at walls, which their surface crosses: 1.4e-4 is found.
    assert_allclose(solve(body, particles=4000).fractions[1], rod.volume_in(body.size, periodic=False), rtol=5e-4)


def test_gaps_between_fibres_have_more_twins():
    wide, close = (
        Scene(
            (1.0, 1.0, 0.5),
            MATRIX,
            [
                Cylinder((0.5 - d, 0.5, 0.5), 0.2, (0, 0, 1), OTHER),
                Cylinder((0.5 + d, 0.5, 0.5), 0.2, (0, 0, 1), OTHER),
            ],
            gradient=(1.0, 0.0, 0.0),
        )
        for d in (0.25, 0.21)
    )
    packing = relax(1500, size=(1.0, 1.0, 0.5), seed=0)
    found = [conform(packing, each).provenance for each in (wide, close)]
    assert found[1]["twins"] > 1.1 * found[1]["even_twins"] and found[0]["twins"] < 1.05 * found[0]["even_twins"]
    assert found[0]["pairs_left_out"] == found[1]["pairs_left_out"] == 0


def test_points_on_what_is_thin_for_their_spacing_are_apart():
    """Fewer samples than points would be the same ones several times, and a pitch of nothing: it never ended."""
    needle = Ellipsoid(MIDDLE, (0.02, 0.02, 0.1), OTHER)
    (surface,) = surfaces_of(scene(needle))
    for seed in range(5):
        points, _ = surface.pattern(0.6, np.random.default_rng(seed))
        away, _ = cKDTree(points).query(points, k=2)
        assert away[:, 1].min() > 1e-3


def two_eggs():
    """A gap of .012 between two ellipsoids that stand side by side, one of them turned."""
    eggs = [
        Ellipsoid((x, 0.5, 0.5), (0.2, 0.3, 0.25), OTHER, rotation=(turn, 0, 0)) for x, turn in ((0.294, 0), (0.706, 1))
    ]
    return Scene((1.0, 1.0, 1.0), MATRIX, eggs, gradient=(1.0, 0.0, 0.0))


def two_unions():
    """Two dumb-bells side by side, a gap of .012 between them."""
    bells = []
    for x in (0.294, 0.706):
        balls = [Ellipsoid((x, y, 0.5), (0.2, 0.2, 0.2), OTHER) for y in (0.35, 0.65)]
        bells.append(Union(balls, OTHER))
    return Scene((1.0, 1.0, 1.0), MATRIX, bells, gradient=(1.0, 0.0, 0.0))


@pytest.mark.parametrize("scene", [two_eggs(), two_unions()], ids=["eggs", "unions"])
def test_points_of_narrow_gaps_are_as_close_as_they_ask_and_even(scene):
    """Every place lies within so many of its own spacings of a point, and no two are nearer than what is thinned to."""
    radius, gap_spacing = 0.06, 0.85
    interfaces = Interfaces(scene, 4.0 * radius)
    found = list(patterns(interfaces, radius, 0, Tally(), gap_spacing))
    for number, (points, _, own) in enumerate(found):
        shape = scene.inclusions[number]
        assert np.all(own == number)
        assert_allclose(shape.distance(points), 0.0, atol=1e-9)
        samples, _ = surface_points(shape, np.zeros(3), np.ones(3), 0.15 * radius)
        spacing = np.clip(
            gap_spacing * interfaces.gap(samples, np.full(len(samples), number)), 0.2 * radius, USUAL * radius
        )
        away, _ = cKDTree(points).query(samples)
        narrow = spacing < 1.5 * radius
        assert np.count_nonzero(narrow) > 100
        # As an even pattern: .85 at most, .75 in all but a hundredth.
        assert np.quantile(away[narrow] / spacing[narrow], 0.99) < 0.8 and np.max(away[narrow] / spacing[narrow]) < 1.0
        # What is chosen first, the closest, keeps .75 of its own spacing.
        own_spacing = np.clip(gap_spacing * interfaces.gap(points, own), 0.2 * radius, USUAL * radius)
        away, pair = cKDTree(points).query(points, k=2)
        asked = np.min(own_spacing[pair], axis=1)
        assert np.min((away[:, 1] / asked)[asked < 1.5 * radius]) > 0.74


def test_a_ball_that_no_gap_is_near_has_the_usual_spacing():
    """Each point stands for a facet of the area that those of a triangular pattern have, 1.6 mean radii apart."""
    radius, tally = 0.03, Tally()
    interfaces = Interfaces(scene(Sphere(MIDDLE, 0.3, OTHER)), 4.0 * radius)
    ((points, _, _),) = patterns(interfaces, radius, 0, tally, 0.85)
    # One facet at most, of 567.
    assert_allclose(len(points), 4 * math.pi * 0.3**2 / (math.sqrt(0.75) * (1.6 * radius) ** 2), rtol=0.005)
    assert tally.twins == tally.even == 2 * len(points)


def test_points_to_choose_from_are_sought_in_gaps_alone(monkeypatch):
    """Points of which feet on these two are sought: of a close pattern all over, spread out, there were millions."""
    seen = []
    keep = Ellipsoid._feet
    monkeypatch.setattr(Ellipsoid, "_feet", lambda self, offsets: seen.append(len(offsets)) or keep(self, offsets))
    for _ in patterns(Interfaces(two_eggs(), 0.12), 0.03, 0, Tally(), 0.85):
        pass
    assert sum(seen) < 1_200_000  # found 860 000
