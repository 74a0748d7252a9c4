"""Scenes drawn by seed: spheres, coated, many or few, and layers, in boxes of unlike sides under either kind of load.

What is drawn is coarse enough for the resolution at which suites ask every method: no radius or gap is so small that
particles or voxels of that size would not see it; some layers are about as thick as a particle.
"""

from functools import cache

import numpy as np

from demheat import Layer, Material, Scene, Sphere
from demheat.addition import add_spheres

COUNT = 50
# Sides of a box in its longest: 24 voxels along that are 16, 20 or 24 along each side.
SIDES = (2 / 3, 5 / 6, 1.0)
LOW, HIGH = 20.0, 50.0
GAP, WALL = 0.06, 0.05


@cache
def drawn(seed):
    """A scene: its kind goes round with the seed, and so does its load."""
    rng = np.random.default_rng([seed, 20])
    periodic, make = bool(seed // len(KINDS) % 2), KINDS[kind(seed)]
    size = rng.permutation([1.0, *rng.choice(SIDES, 2)])
    if kind(seed) == "one" and seed % 4 < 2:
        size = np.ones(3)
    matrix = Material(10 ** rng.uniform(-1, 1))
    inclusions = make(rng, size, periodic, matrix.conductivity)
    # As many of either load of each kind.
    return Scene(size, matrix, inclusions, **(_gradient(rng) if periodic else _walls(rng)))


def kind(seed):
    """Name of the kind of scene that a seed draws."""
    return tuple(KINDS)[seed % len(KINDS)]


def _gradient(rng):
    vector = rng.normal(size=3)
    return {"gradient": tuple(vector / np.linalg.norm(vector))}


def _walls(rng):
    axis = "xyz"[rng.integers(3)]
    return {"walls": {axis + "-": LOW, axis + "+": HIGH}}


def _other(rng, matrix):
    """A material of a conductivity a hundredth to a hundred times that of the matrix."""
    return Material(matrix * 10 ** rng.uniform(-2, 2))


def _apart(rng, radii, size, periodic):
    """Centres and radii of spheres that keep a gap, smaller ones where there is no room; between walls all inside."""
    radii = np.asarray(radii)
    while True:
        margin = 0.0 if periodic else radii + WALL
        try:
            return add_spheres(radii + GAP / 2, size, rng, periodic=periodic, margin=margin), radii
        except RuntimeError:
            radii = 0.9 * radii


def _one(rng, size, periodic, matrix):
    """In the middle of a cube, which has an exact solution; or anywhere, where a wall may cut it."""
    if min(size) == 1.0:
        return [Sphere((0.5, 0.5, 0.5), rng.uniform(0.2, 0.42), _other(rng, matrix))]
    radius = rng.uniform(0.15, 0.27)
    (center,), _ = _apart(rng, [radius], size, periodic)
    if not periodic:
        center[rng.integers(3)] = 0.4 * radius
    return [Sphere(center, radius, _other(rng, matrix))]


def _several(rng, size, periodic, matrix):
    """Unequal, each of its own material."""
    radii = np.sort(rng.uniform(0.11, 0.22, rng.integers(2, 5)))[::-1]
    return [Sphere(*each, _other(rng, matrix)) for each in zip(*_apart(rng, radii, size, periodic), strict=True)]


def _coated(rng, size, periodic, matrix):
    """One or two spheres in coats a third as thick as their radius."""
    found = []
    radii = np.sort(rng.uniform(0.16, 0.24, rng.integers(1, 3)))[::-1]
    for center, radius in zip(*_apart(rng, radii, size, periodic), strict=True):
        coat, core = _other(rng, matrix), _other(rng, matrix)
        found += [Sphere(center, radius, coat), Sphere(center, radius * 2 / 3, core)]
    return found


def _layers(rng, size, periodic, matrix):
    """One to three across an axis, with matrix between them or none."""
    axis, count = int(rng.integers(3)), rng.integers(1, 4)
    ends = np.cumsum(rng.uniform(1, 2, 2 * count + 1))
    ends *= size[axis] / ends[-1]
    keep = rng.random(count) < 0.7
    starts = np.where(keep, ends[:-1:2], np.append(0.5 * ends[0], ends[1:-2:2]))
    return [Layer(axis, *pair, _other(rng, matrix)) for pair in zip(starts, ends[1::2], strict=True)]


def _polydisperse(rng, size, periodic, matrix):
    """Seven spheres of one material, the largest twice as large as the smallest."""
    radii = np.linspace(0.18, 0.09, 7) * np.cbrt(np.prod(size))
    other = _other(rng, matrix)
    return [Sphere(*each, other) for each in zip(*_apart(rng, radii, size, periodic), strict=True)]


KINDS = {"one": _one, "several": _several, "coated": _coated, "layers": _layers, "polydisperse": _polydisperse}
