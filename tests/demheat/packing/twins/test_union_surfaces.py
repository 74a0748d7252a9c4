"""Only here: twins on unions that lie inside a member, on a crease, or have no mirror image."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial import cKDTree
from solid_shapes import MATRIX, OTHER, TURN

from demheat import Scene, Sphere, solve
from demheat.packing.relax import relax
from demheat.packing.twins.conforming import conform
from demheat.packing.twins.interfaces import surfaces_of
from demheat.scene import Box, Cylinder, Union
from demheat.scene.shapes.samples import surface_points

SPACING = 0.08
TWO = Union([Sphere((x, 0.5, 0.5), 0.25, OTHER) for x in (0.35, 0.65)], OTHER)
CREASE = math.sqrt(0.25**2 - 0.15**2)
SHAPES = {
    "two balls": TWO,
    "two rods": Union([Cylinder((0.5, 0.5, z), 0.2, (0, 0, 1), OTHER, length=0.4) for z in (0.4, 0.55)], OTHER),
    "ball and rod": Union(
        [Sphere((0.4, 0.5, 0.5), 0.25, OTHER), Cylinder((0.6, 0.5, 0.5), 0.12, (1, 0.2, 0.1), OTHER, length=0.6)], OTHER
    ),
    "two boxes": Union(
        [
            Box((0.45, 0.5, 0.5), (0.5, 0.4, 0.3), OTHER, rotation=TURN),
            Box((0.55, 0.5, 0.5), (0.3, 0.3, 0.6), OTHER, rotation=TURN),
        ],
        OTHER,
    ),
}


def scene(shape):
    return Scene((1.0, 1.0, 1.0), MATRIX, [shape], gradient=(1.0, 0.0, 0.0))


def pattern(shape):
    surface = surfaces_of(scene(shape))[0]
    return surface, *surface.pattern(SPACING, np.random.default_rng(0))


@pytest.mark.parametrize("name", SHAPES)
def test_patterns_lie_on_the_surface_and_cover_it(name):
    surface, points, normals = pattern(SHAPES[name])
    assert_allclose(surface.shape.distance(points), 0.0, atol=1e-12)
    assert np.all(surface.shape.bare(points, normals))
    samples, areas = surface_points(SHAPES[name], np.zeros(3), np.ones(3), SPACING / 4)
    away, _ = cKDTree(points).query(samples)
    # As on other solids; twins count on 0.8, see `conforming`.
    assert away.max() < 0.9 * SPACING and np.quantile(away, 0.99) < 0.75 * SPACING
    assert_allclose(len(points), areas.sum() / (math.sqrt(0.75) * SPACING**2), rtol=0.1)


def test_patterns_end_half_a_spacing_from_a_crease():
    _, points, _ = pattern(TWO)
    x, y, z = (points - 0.5).T
    away = np.hypot(x, np.hypot(y, z) - CREASE)
    # In the middles of their own parts: a third and more was set for all first, 0.31 is the nearest.
    assert away.min() > SPACING / 4 and abs(np.median(away[away < 0.75 * SPACING]) / SPACING - 0.5) < 0.1
    assert np.sum(away < SPACING) > 0.5 * 2 * 2 * math.pi * CREASE / SPACING


@pytest.mark.parametrize("name", ["two balls", "ball and rod"])
def test_twins_are_mirrored_across_the_surface(name):
    """Of what is as near to the surface as twins are, each has one of its weight where a mirror on it shows it."""
    packing = relax(1500, size=(1.0, 1.0, 1.0), seed=0)
    made, shape = conform(packing, scene(SHAPES[name])), SHAPES[name]
    distance, normal = shape.surface(made.centers)
    # Twins stand half a mean radius away or less, and planes a little inside of bent surfaces; others give way by more.
    mean = packing.radii.mean()
    near = np.flatnonzero(np.abs(distance) < 0.6 * mean)
    assert made.provenance["pairs_left_out"] == 0 and len(near) > 200
    assert abs(len(near) - made.provenance["twins"]) < 0.02 * len(near)
    tree = cKDTree(made.centers[near])
    mirrored = made.centers[near] - 2 * (distance[:, None] * normal)[near]
    away, other = tree.query(mirrored)
    # Beside a crease the nearest point of the surface is not the one where a twin's plane touches.
    alike = (away < 0.15 * mean) & (np.abs(made.radii[near] - made.radii[near][other]) < 1e-9)
    assert alike.mean() > 0.9 and np.all((distance[near] < 0)[alike] != (distance[near][other] < 0)[alike])


@pytest.mark.parametrize("name", ["ball and rod", "two boxes"])
def test_conforming_packings_have_the_right_fraction(name):
    field = solve(scene(SHAPES[name]), particles=1500)
    # As of other solids with edges, which facets follow only roughly.
    assert_allclose(field.fractions[1], SHAPES[name].volume, rtol=1e-2)
