"""The scenes of the frontier: steady ones of every kind, and as many that no constant was ever found on."""

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from demheat import gallery
from demheat.addition import add_spheres
from demheat.gallery import EDGE, HADDAD, loaded, scaled
from demheat.powers import cube_root
from demheat.scene import Box, Cylinder, Ellipsoid, Image, LevelSet, Material, Scene, Sphere, Union
from studies.common.searches.in_time import IN_TIME
from studies.common.steady_scenes import STEADY, STEADY_TITLES, TUNED  # noqa: F401 (known from here, too)

# Of what is placed at random here; scenes of other studies have other seeds.
SEED = 4040
# And of those that laws are fitted to.
LAWS = 5050
# Least gap between two bodies, over the smaller one's width.
GAP = 0.1
# Of the gyroid: half of the width in the function's own unit, of which 1.5 is the most.
SHEET = 0.6


def _balls(count, fraction, size, *, periodic, seed=SEED, least=1.0):
    """Centres and radii of spheres at random that fill a fraction of a box, the smallest `least` of the largest."""
    rng, size = np.random.default_rng(seed), np.asarray(size, float)
    radii = np.linspace(1.0, least, count)
    radii *= cube_root(fraction * size.prod() / (4 / 3 * math.pi * float(np.sum(radii**3))))
    apart = radii * (1 + GAP)
    centers = add_spheres(apart, size, rng, periodic=periodic, margin=0.0 if periodic else apart)
    return centers, radii


def _ellipsoids():
    """Of three unlike axes, turned at random, apart from each other."""
    size, rng = (EDGE,) * 3, np.random.default_rng(SEED)
    centers, radii = _balls(8, 0.15, size, periodic=False)
    material = scaled(HADDAD, 10.0)
    bodies = [
        Ellipsoid(center, radius * np.array([1.0, 0.7, 0.45]), material, rotation=rng.normal(size=3))
        for center, radius in zip(centers, radii, strict=True)
    ]
    return Scene(size, HADDAD, bodies, **loaded(size))


def _fibre():
    """Square array of fibres across, contrast 50, on half of the area."""
    size, radius = (EDGE, EDGE, 0.3 * EDGE), EDGE * math.sqrt(0.5 / math.pi)
    middle = (0.53 * EDGE, 0.46 * EDGE, 0.1 * EDGE)
    fibre = Cylinder(middle, radius, (0, 0, 1), scaled(HADDAD, 50.0))
    return Scene(size, HADDAD, [fibre], **loaded(size, periodic=True, axis=0))


def _square_rod():
    """Square rods on a quarter of the area, across; walls are planes of symmetry."""
    size = (EDGE, EDGE, 0.25 * EDGE)
    rod = Box(tuple(side / 2 for side in size), (EDGE / 2, EDGE / 2, EDGE), scaled(HADDAD, 10.0))
    return Scene(size, HADDAD, [rod], **loaded(size, axis=0))


def _unions():
    """Pairs of balls that overlap, along directions at random."""
    size, rng, material = (EDGE,) * 3, np.random.default_rng(SEED + 1), scaled(HADDAD, 10.0)
    centers, radii = _balls(6, 0.12, size, periodic=False, seed=SEED + 1)
    bodies = []
    for center, radius in zip(centers, radii, strict=True):
        way = rng.normal(size=3)
        way *= 0.4 * radius / np.linalg.norm(way)
        bodies.append(Union([Sphere(center + end * way, 0.6 * radius, material) for end in (-1, 1)], material))
    return Scene(size, HADDAD, bodies, **loaded(size))


def _gyroid():
    """A sheet about a gyroid, without end."""
    size, turn = (EDGE,) * 3, 2 * math.pi / EDGE

    def sheet(points):
        x, y, z = turn * points.T
        value = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
        return value**2 - SHEET**2

    body = LevelSet(sheet, ((0.0,) * 3, size), scaled(HADDAD, 10.0), periodic=True)
    return Scene(size, HADDAD, [body], **loaded(size, periodic=True))


def _image():
    """Square rods on a quarter of the area as an image, whose voxels are exact."""
    along = np.isin(np.arange(32) // 8, (1, 2))
    labels = np.repeat(np.logical_and.outer(along, along)[:, :, None], 8, axis=2).astype(np.uint8)
    image = Image(labels, EDGE / 32, {0: HADDAD, 1: scaled(HADDAD, 10.0)})
    return Scene.of_image(image, **loaded(image.size, periodic=True, axis=0))


def _unequal():
    return gallery.dispersion(
        40, fraction=0.5, ratio=3.0, gap=0.02, seed=SEED, matrix=HADDAD, inclusion=scaled(HADDAD, 10.0)
    )


def _insulating():
    return gallery.random_dispersion(
        30, fraction=0.25, gap=0.1, seed=SEED, matrix=HADDAD, inclusion=scaled(HADDAD, 1e-3)
    )


def _perfect():
    """Body-centred array of perfect conductors."""
    size, radius = (EDGE,) * 3, EDGE * cube_root(3 * 0.4 / (8 * math.pi))
    perfect = Material(math.inf)
    spheres = [Sphere((at * EDGE,) * 3, radius, perfect) for at in (0.25, 0.75)]
    return Scene(size, HADDAD, spheres, **loaded(size, periodic=True))


def _resisting():
    """Spheres a hundred times as conducting, whose surfaces resist as much as half a radius of the matrix."""
    size = (EDGE,) * 3
    centers, radii = _balls(12, 0.2, size, periodic=True, seed=SEED + 2)
    material, film = scaled(HADDAD, 100.0), 0.5 * radii[0] / HADDAD.conductivity
    spheres = [Sphere(c, r, material, resistance=film) for c, r in zip(centers, radii, strict=True)]
    return Scene(size, HADDAD, spheres, **loaded(size, periodic=True))


def _long():
    """A box of 1:1:4 between walls along its length, thirty spheres."""
    size = (EDGE, EDGE, 4 * EDGE)
    centers, radii = _balls(30, 0.15, size, periodic=False, seed=SEED + 3, least=0.6)
    spheres = [Sphere(c, r, scaled(HADDAD, 10.0)) for c, r in zip(centers, radii, strict=True)]
    return Scene(size, HADDAD, spheres, **loaded(size, axis=2))


def _five_thousand():
    return gallery.dispersion(5000, fraction=0.2, gap=0.05, seed=SEED, matrix=HADDAD, inclusion=scaled(HADDAD, 10.0))


def _hard_ellipsoids():
    size, rng = (EDGE,) * 3, np.random.default_rng(LAWS)
    centers, radii = _balls(5, 0.12, size, periodic=False, seed=LAWS)
    stretched = radii[:, None] * rng.uniform(0.5, 1.0, (5, 3))
    bodies = [
        Ellipsoid(center, axes, scaled(HADDAD, 50.0), rotation=rng.normal(size=3))
        for center, axes in zip(centers, stretched, strict=True)
    ]
    return Scene(size, HADDAD, bodies, **loaded(size))


def _joined():
    """Threes of balls that overlap."""
    size, rng, material = (EDGE,) * 3, np.random.default_rng(LAWS + 1), scaled(HADDAD, 0.1)
    centers, radii = _balls(4, 0.15, size, periodic=False, seed=LAWS + 1)
    bodies = []
    for center, radius in zip(centers, radii, strict=True):
        ways = rng.normal(size=(3, 3))
        ways *= 0.4 * radius / np.linalg.norm(ways, axis=1, keepdims=True)
        bodies.append(Union([Sphere(center + way, 0.6 * radius, material) for way in ways], material))
    return Scene(size, HADDAD, bodies, **loaded(size))


def _primitive():
    """What lies on one side of a primitive surface."""
    size, turn = (EDGE,) * 3, 2 * math.pi / EDGE
    body = LevelSet(
        lambda points: np.cos(turn * points).sum(axis=1), ((0.0,) * 3, size), scaled(HADDAD, 20.0), periodic=True
    )
    return Scene(size, HADDAD, [body], **loaded(size, periodic=True))


def _tall():
    """A box of 1:3:1 between walls along its length, twenty spheres."""
    size = (EDGE, 3 * EDGE, EDGE)
    centers, radii = _balls(20, 0.2, size, periodic=False, seed=LAWS + 2)
    spheres = [Sphere(c, r, scaled(HADDAD, 10.0)) for c, r in zip(centers, radii, strict=True)]
    return Scene(size, HADDAD, spheres, **loaded(size, axis=1))


def _pores():
    return gallery.random_dispersion(10, fraction=0.2, gap=0.1, seed=LAWS, matrix=HADDAD, inclusion=Material(0.0))


def _three_thousand():
    return gallery.dispersion(3000, fraction=0.25, gap=0.05, seed=LAWS, matrix=HADDAD, inclusion=scaled(HADDAD, 30.0))


def _unlike():
    return gallery.dispersion(
        30, fraction=0.35, ratio=4.0, gap=0.05, seed=LAWS, matrix=HADDAD, inclusion=scaled(HADDAD, 30.0)
    )


HELD_BACK: dict[str, Callable[[], Scene]] = {
    "ellipsoids": _ellipsoids,
    "fibre at 50": _fibre,
    "square rod": _square_rod,
    "unions": _unions,
    "gyroid": _gyroid,
    "image": _image,
    "unequal, f = .5": _unequal,
    "30 at 0.001": _insulating,
    "infinite": _perfect,
    "resistance": _resisting,
    "box of 1:1:4": _long,
    "5000 spheres": _five_thousand,
}
# Of what the steady scenes have nothing: laws of cost are fitted to them, and nobody is compared on them.
FOR_LAWS: dict[str, Callable[[], Scene]] = {
    "ellipsoids at 50": _hard_ellipsoids,
    "joined at 0.1": _joined,
    "primitive at 20": _primitive,
    "box of 1:3:1": _tall,
    "10 pores": _pores,
    "3000 spheres": _three_thousand,
    "30 of 1 to 4": _unlike,
}
SCENES = STEADY | HELD_BACK
# Whose bodies are disjoint spheres, as multipoles ask for.
ONLY_SPHERES = (
    *("third", "third at 0.01", "third at 1000", "third at infinity", "half", "half at 100", "polydisperse"),
    *("83 spheres", "1000 spheres", "unequal, f = .5", "30 at 0.001", "infinite", "resistance", "box of 1:1:4"),
    *("5000 spheres", "box of 1:3:1", "10 pores", "3000 spheres", "30 of 1 to 4"),
)
TITLES = STEADY_TITLES | {
    "ellipsoids": "8 ellipsoids",
    "fibre at 50": "fibre, f = .5, contrast 50",
    "square rod": "square rod",
    "unions": "6 pairs of balls",
    "gyroid": "gyroid sheet",
    "image": "image of a rod",
    "unequal, f = .5": "40 unequal spheres, f = .5",
    "30 at 0.001": "30 spheres at .001",
    "infinite": "perfect conductors, f = .4",
    "resistance": "12 spheres that resist",
    "box of 1:1:4": "30 spheres in a box of 1:1:4",
    "5000 spheres": "5000 spheres, f = .2",
    "slab": "slab that warms up",
    "ball": "ball that warms up",
    "beam": "beam that warms up",
}


@lru_cache(2)
def scene_of(name: str) -> Scene:
    """A scene by its name."""
    return (SCENES | FOR_LAWS | IN_TIME)[name]()
