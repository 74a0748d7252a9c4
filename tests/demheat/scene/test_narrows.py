"""Only here: narrow gaps between good conductors, bad ones, images or walls that are not seen."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from demheat import Box, Ellipsoid, Flux, Layer, Material, Scene, Sphere
from demheat.scene.narrows import narrows

METAL, GOOD, BAD, LIKE = (Material(k) for k in (1.0, 10.0, 0.1, 9.0))
PORE = Material(0.0)
CELL = {"size": (1.0, 1.0, 1.0), "matrix": METAL, "gradient": (1.0, 0.0, 0.0)}
WALLS = {"size": (1.0, 1.0, 1.0), "matrix": METAL, "walls": {"x-": 0.0, "x+": 1.0}}
# Surfaces .02 apart, the third sphere .1 from the second.
PLACES = (0.15, 0.37, 0.67)


def near(reach, *inclusions, **scene):
    return np.flatnonzero(narrows(Scene(inclusions=inclusions, **(scene or CELL)), reach)).tolist()


def balls(*materials):
    return [Sphere((x, 0.5, 0.5), 0.1, each) for x, each in zip(PLACES, materials, strict=False)]


@pytest.mark.parametrize(
    ("materials", "found"),
    [
        ((GOOD, GOOD, GOOD), [0, 1]),
        ((BAD, BAD, BAD), [0, 1]),
        ((PORE, BAD), [0, 1]),
        ((GOOD, BAD, GOOD), []),
        ((LIKE, LIKE, LIKE), []),
        ((LIKE, GOOD), []),
    ],
)
def test_spheres_that_are_alike(materials, found):
    assert near(0.03, *balls(*materials)) == found


def test_how_strong_matters():
    scene = Scene(inclusions=balls(LIKE, LIKE), **CELL)
    assert [np.flatnonzero(narrows(scene, 0.03, strong)).tolist() for strong in (9.5, 8.5)] == [[], [0, 1]]


def test_how_far_is_near():
    assert [near(reach, *balls(GOOD, GOOD, GOOD)) for reach in (0.01, 0.03, 0.11)] == [[], [0, 1], [0, 1, 2]]


def test_images_and_walls():
    ends = [Sphere((x, 0.5, 0.5), 0.1, GOOD) for x in (0.11, 0.89)]
    assert near(0.03, *ends) == [0, 1]
    assert near(0.03, *ends, **WALLS) == [0, 1]
    # Bad ones are no short cut from a held wall, insulated walls no sources, and what a wall cuts leaves no gap.
    assert near(0.03, *(Sphere(s.center, s.radius, BAD) for s in ends), **WALLS) == []
    assert near(0.03, Sphere((0.5, 0.11, 0.5), 0.1, GOOD), Sphere((0.05, 0.5, 0.5), 0.1, GOOD), **WALLS) == []
    # An insulated wall mirrors a bad one, which a way between two is narrow for; a flux through it does not.
    assert near(0.03, Sphere((0.5, 0.11, 0.5), 0.1, BAD), Sphere((0.5, 0.5, 0.5), 0.1, BAD), **WALLS) == [0]
    fluxes = WALLS | {"walls": {"x-": 0.0, "x+": 1.0, "y-": Flux(1.0)}}
    assert near(0.03, Sphere((0.5, 0.11, 0.5), 0.1, BAD), **fluxes) == []
    large = Sphere((0.5, 0.5, 0.5), 0.49, GOOD)
    assert near(0.03, large) == [0] and near(0.01, large) == []


def test_layers():
    layers = [Layer(0, *ends, GOOD) for ends in ((0.6, 0.9), (0.01, 0.3), (0.32, 0.5), (0.5, 0.55))]
    assert near(0.03, *layers) == [1, 2]
    assert near(0.06, *layers) == [0, 1, 2, 3]
    # The last and the first are .11 apart through the face; between walls the first is .01 from one.
    assert near(0.12, layers[0], layers[1]) == [0, 1]
    assert near(0.03, *layers[:2], **WALLS) == [1]


def test_within_another():
    """What is around decides: in a coat that conducts as well they are no short cut."""
    pair = balls(GOOD, GOOD)
    assert near(0.03, Sphere((0.3, 0.5, 0.5), 0.45, GOOD), *pair) == []
    assert near(0.03, Sphere((0.3, 0.5, 0.5), 0.45, LIKE), *pair) == []
    assert near(0.03, Sphere((0.3, 0.5, 0.5), 0.45, BAD), *pair) == [1, 2]


def test_by_all_pairs():
    rng = np.random.default_rng(0)
    centers = rng.random((60, 3))
    spheres = [Sphere(c, 0.02 + 0.01 * (n % 2), GOOD) for n, c in enumerate(centers)]
    kept = []
    for one in spheres:
        if all(np.linalg.norm(_apart(one, each)) > one.radius + each.radius for each in kept):
            kept.append(one)
    gaps = [
        min(np.linalg.norm(_apart(one, each)) - one.radius - each.radius for each in kept if each is not one)
        for one in kept
    ]
    assert_array_equal(narrows(Scene(inclusions=kept, **CELL), 0.06), np.array(gaps) < 0.06)
    assert 0 < np.sum(np.array(gaps) < 0.06) < len(kept)


def _apart(one, other):
    offset = np.subtract(one.center, other.center)
    return offset - np.round(offset)


def others(kind, *, gap, periodic=True):
    """Two bodies of good conductors, so far from each other, from their images or from the walls at the load's ends."""
    shapes = {
        "images": [Ellipsoid((0.5, 0.5, 0.5), (0.5 - gap / 2, 0.2, 0.3), GOOD)],
        "pair": [
            Ellipsoid((0.5 - 0.2 - gap / 2, 0.5, 0.5), (0.2, 0.1, 0.1), GOOD),
            Ellipsoid((0.5 + 0.2 + gap / 2, 0.5, 0.5), (0.2, 0.15, 0.1), GOOD),
        ],
        "boxes": [Box((0.25, 0.5, 0.5), (0.3, 0.4, 0.4), GOOD), Box((0.55 + gap, 0.5, 0.5), (0.3, 0.2, 0.2), GOOD)],
        "wall": [Ellipsoid((0.3 + gap, 0.5, 0.5), (0.3, 0.2, 0.2), GOOD)],
    }[kind]
    load = {"gradient": (1, 0, 0)} if periodic and kind != "wall" else {"walls": {"x-": 0.0, "x+": 1.0}}
    return Scene((1.0, 1.0, 1.0), Material(1.0), shapes, **load)


@pytest.mark.parametrize("kind", ["images", "pair", "boxes", "wall"])
def test_gaps_beside_other_shapes_are_seen(kind):
    scene = others(kind, gap=0.02)
    assert narrows(scene, 0.03).all() and not narrows(scene, 0.01).any()


def test_boxes_that_touch_leave_no_gap():
    halves = [Box((0.25, y, 0.5), (0.5, 0.5, 1.0), GOOD) for y in (0.25, 0.75)]
    assert not narrows(Scene((1.0, 1.0, 1.0), Material(1.0), halves, gradient=(1, 0, 0)), 0.1).any()
