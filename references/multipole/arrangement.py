"""From a scene to the spheres of a periodic cell: its own, and between walls their mirror images.

In a box with two isothermal and four insulated walls all goes on beyond a wall as in a mirror: across an insulated one
with the same temperature, across an isothermal one with its difference from the wall's reversed. So the box is a part,
an eighth at most, of a periodic cell of its mirror images under a mean gradient.
"""

import math
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from demheat.scene import Sphere
from demheat.scene.perfect import INFINITE, touching_spheres
from references.multipole.translations import Spheres, unmirrored

# Of the box: rounding of coordinates that users type or work out.
SAME = 1e-12


class Arrangement(NamedTuple):
    """What is solved, in its own unit of length."""

    spheres: Spheres  # The scene's, in its order, then their mirror images
    gradient: np.ndarray  # (3,) float array, K/unit: The mean one
    level: float  # K: Temperature at the origin: that of the wall there; 0 in a periodic cell
    unit: float  # m: The largest diameter


def arrange(scene, *, any_matrix=False) -> Arrangement:
    """Read a scene."""
    gradient, level = _load(scene)
    scene.require("multipole knows disjoint spheres", shapes=(Sphere,), nested=False, takes=("resistance", "perfect"))
    _check_perfect(scene)
    k = scene.matrix.conductivity
    if k == 0 and not any_matrix:
        raise NotImplementedError("multipole: a matrix of no conductivity; disjoint spheres then carry no heat")
    centers = np.array([sphere.center for sphere in scene.inclusions]).reshape(-1, 3)
    radii = np.array([sphere.radius for sphere in scene.inclusions]).reshape(-1)
    contrasts = np.array([sphere.material.conductivity for sphere in scene.inclusions]) / (k if k > 0 else 1.0)
    resistances = scene.resistances[1:] * k / radii
    spheres = unmirrored(centers, radii, contrasts, np.array(scene.size), resistances)
    if not scene.periodic:
        spheres = _with_images(spheres)
    unit = 2 * float(radii.max()) if len(radii) else max(scene.size) / 2
    spheres = spheres._replace(centers=spheres.centers / unit, radii=spheres.radii / unit, size=spheres.size / unit)
    return Arrangement(spheres, gradient * unit, level, unit)


def smallest_gap(spheres) -> float:
    """Least distance between two surfaces, images included, in the spheres' unit of length; infinite without any."""
    if not len(spheres.radii):
        return math.inf
    radii, largest = spheres.radii, float(spheres.radii.max())
    gap = float(np.min(spheres.size)) - 2 * largest
    if len(radii) == 1:
        return gap
    centers = wrapped(spheres.centers, spheres.size)
    tree = cKDTree(centers, boxsize=spheres.size)
    own = np.arange(spheres.count)
    # The nearest centre bounds the gap; what beats it has its centre within the gap, the own and the largest radius.
    _, nearest = tree.query(centers[own], k=2)
    other = np.where(nearest[:, 0] == own, nearest[:, 1], nearest[:, 0])
    gap = min(gap, float(np.min(_gaps(spheres, own, other))))
    if radii.min() < largest:
        beside = tree.query_ball_point(centers[own], np.maximum(radii[own] + largest + gap, 0.0))
        one, two = np.repeat(own, [len(each) for each in beside]), np.concatenate(beside).astype(np.int64)
        gap = min(gap, float(np.min(_gaps(spheres, one[one != two], two[one != two]), initial=math.inf)))
    return gap


def _gaps(spheres, one, two):
    apart = spheres.centers[one] - spheres.centers[two]
    apart -= spheres.size * np.round(apart / spheres.size)
    return np.linalg.norm(apart, axis=1) - spheres.radii[one] - spheres.radii[two]


class Pairs(NamedTuple):
    """Each sphere that counts, beside others or their images that are near."""

    here: np.ndarray  # (k,) int array: The sphere
    there: np.ndarray  # (k,) int array: The other
    way: np.ndarray  # (k, 3) float array, length: From the one's centre to the image of the other's


def near(spheres, reach) -> Pairs:
    """Pairs whose centres are no farther apart than the first one's reach, (count,) float array."""
    if not spheres.count:
        return Pairs(*np.empty((2, 0), dtype=np.int64), np.empty((0, 3)))
    size, centers = spheres.size, wrapped(spheres.centers, spheres.size)
    spans = [np.arange(-k, k + 1) for k in np.ceil(reach.max() / size).astype(int)]
    cells = np.stack(np.meshgrid(*spans, indexing="ij"), axis=-1).reshape(-1, 3) * size
    places = (centers[None] + cells[:, None]).reshape(-1, 3)
    found = cKDTree(places).query_ball_point(centers[: spheres.count], reach, return_sorted=True)
    here = np.repeat(np.arange(spheres.count), [len(each) for each in found])
    other = np.concatenate(found).astype(np.int64)
    there, way = other % len(centers), places[other] - centers[here]
    apart = np.any(way != 0, axis=1)
    return Pairs(here[apart], there[apart], way[apart])


def wrapped(points, size):
    """Points moved into a periodic cell, as trees want them: from 0 to below its size."""
    inside = points - size * np.floor(points / size)
    return np.where(inside < size, inside, 0.0)


def _check_perfect(scene):
    """Raise unless perfect conductors are apart, and none of them is the matrix, which is one body."""
    if not scene.perfect:
        return
    if scene.matrix.perfect:
        raise ValueError(INFINITE)
    found = touching_spheres(scene)
    if found is not None:
        one, other = (f"Scene.inclusions[{number}]" for number in found)
        raise NotImplementedError(
            f"multipole: perfect conductors touch, {one} and {'a wall or its image' if one == other else other}: their "
            "series has no end; must be apart, or resist"
        )


def _load(scene):
    """Mean gradient, (3,) float array in K/m, and temperature at the origin."""
    if scene.periodic:
        return np.array(scene.gradient), 0.0
    held = scene.wall_temperatures
    flows = [name for name, flux in scene.wall_fluxes.items() if flux != 0]
    axes = {"xyz".index(name[0]) for name in held}
    if flows or len(held) != 2 or len(axes) != 1:
        raise NotImplementedError(
            f"multipole: walls {sorted(scene.walls)}; only two opposite isothermal ones, the others insulated, make a "
            "periodic cell of mirror images"
        )
    axis = axes.pop()
    low, high = (held["xyz"[axis] + side] for side in "-+")
    return (high - low) / scene.size[axis] * np.eye(3)[axis], low


def _with_images(spheres):
    """The spheres of a box and those mirrored in its walls, in metres."""
    size, centers = spheres.size, spheres.centers
    slack = SAME * size.max()
    centred = _centred_on_walls(spheres, slack)
    # Where the arrangement mirrors itself, walls included, its images repeat it: it is periodic as it stands.
    axes = [not _symmetric(spheres, axis, slack) or bool(centred[:, axis].any()) for axis in range(3)]
    parts = []
    for flip in product(*((False, True) if mirrored else (False,) for mirrored in axes)):
        # A sphere centred on a mirror is its own image there.
        kept = np.flatnonzero(~np.any(centred & flip, axis=1))
        image = np.where(flip, 2 * size - centers[kept], centers[kept])
        same = (column[kept] for column in (spheres.radii, spheres.contrasts, spheres.resistances))
        parts.append((image, *same, kept, np.tile(flip, (len(kept), 1))))
    *columns, original, flips = (np.concatenate(part) for part in zip(*parts, strict=True))
    return Spheres(*columns, size * np.where(axes, 2, 1), original, flips)


def _centred_on_walls(spheres, slack):
    """Axes along which a sphere's centre lies on a wall, (n, 3) bool array; other cut spheres are refused."""
    radii, centred = spheres.radii[:, None], np.zeros((len(spheres.radii), 3), dtype=bool)
    for inward in (spheres.centers, spheres.size - spheres.centers):
        on = np.abs(inward) <= slack
        cut = np.any((inward < radii - slack) & ~on, axis=1)
        if cut.any():
            raise NotImplementedError(
                f"multipole: inclusions[{np.argmax(cut)}] is cut by a wall, not through its centre; only whole or half "
                "spheres and their mirror images are disjoint spheres"
            )
        centred |= on
    return centred


def _symmetric(spheres, axis, slack):
    """Whether the spheres of a box are their own mirror image in its middle across an axis."""
    mirrored = spheres.centers.copy()
    mirrored[:, axis] = spheres.size[axis] - mirrored[:, axis]
    tree, far = cKDTree(spheres.centers), 4.0 * slack
    for i, near in enumerate(tree.query_ball_point(mirrored, far)):
        same = np.abs(mirrored[i] - spheres.centers[near]).max(axis=1, initial=0.0) <= slack
        same &= np.abs(spheres.radii[i] - spheres.radii[near]) <= slack
        same &= spheres.contrasts[i] == spheres.contrasts[near]
        same &= np.abs(spheres.resistances[i] - spheres.resistances[near]) <= SAME * spheres.resistances[i]
        if not same.any():
            return False
    return True
