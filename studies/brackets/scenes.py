"""Scenes with an exact conductivity: drawn by seed, and the three that are looked at closely."""

from __future__ import annotations

import math

import numpy as np

from demheat import gallery
from demheat.addition import add_spheres
from demheat.scene import Layer, Material, Scene, Sphere
from references import exact, multipole

# Edges of elements in a drawn scene: the box over this.
DRAWN = 10
# Relative error that multipoles are asked for: far below any bracket's width.
ACCURACY = 1e-7
# Contrasts are drawn from 1e-3 to 1e3, one in ten is a pore.
DECADES, PORES = 3.0, 0.1
# Largest part of a cubic array's densest fraction.
CLOSE = 0.8
ARRAYS = {"simple_cubic": math.pi / 6, "body_centred": math.pi * 3**0.5 / 8, "face_centred": math.pi * 2**0.5 / 6}


def _contrast(rng):
    return 0.0 if rng.random() < PORES else 10.0 ** rng.uniform(-DECADES, DECADES)


def _array(rng):
    name = rng.choice(list(ARRAYS))
    return getattr(gallery, name)(_contrast(rng), fraction=ARRAYS[name] * rng.uniform(0.1, CLOSE))


def _coated(rng):
    core, shell = 10.0 ** rng.uniform(-2, 2, 2)
    load = {"periodic": bool(rng.random() < 0.5), "axis": int(rng.integers(3))}
    return gallery.coated_sphere(
        core, shell, radius=rng.uniform(0.2, 0.45), core_fraction=rng.uniform(0.2, 0.7), **load
    )


def _laminate(rng):
    size, axis = rng.uniform(0.5, 2.0, 3), int(rng.integers(3))
    planes = np.sort(rng.uniform(0, size[axis], 2 * int(rng.integers(1, 4))))
    # Planes no closer to each other or to a face than a thirtieth of the box: elements are as small as layers are thin.
    planes = (planes + 0.05 * size[axis] * np.arange(1, len(planes) + 1)) / (1 + 0.05 * (len(planes) + 1))
    layers = [Layer(axis, a, b, Material(10.0 ** rng.uniform(-2, 2))) for a, b in planes.reshape(-1, 2)]
    along = int(rng.integers(3))
    return Scene(size, Material(1.0), layers, **gallery.loaded(size, axis=along, periodic=bool(rng.random() < 0.5)))


def _random(rng, *, walls):
    """Spheres of several sizes and materials at random, a tenth of the smallest diameter apart at least."""
    size, number = rng.uniform(0.8, 1.25, 3), int(rng.integers(2, 9))
    radii = np.sort(rng.uniform(0.5, 1.0, number))[::-1]
    radii *= (rng.uniform(0.05, 0.12 if walls else 0.2) * size.prod() / (4 / 3 * math.pi * np.sum(radii**3))) ** (1 / 3)
    apart = radii + 0.1 * radii.min()
    centers = add_spheres(apart, size, rng, periodic=not walls, margin=apart if walls else 0.0)
    if not walls:
        centers = _off_faces(centers, radii, size)
    spheres = [Sphere(c, r, Material(_contrast(rng))) for c, r in zip(centers, radii, strict=True)]
    return Scene(size, Material(1.0), spheres, **gallery.loaded(size, axis=int(rng.integers(3)), periodic=not walls))


def _off_faces(centers, radii, size):
    """The same periodic cell, moved so that no sphere just touches a face: elements there would be slivers."""
    shifts = np.linspace(0, 1, 200, endpoint=False)
    moved = centers.copy()
    for axis in range(3):
        at = (centers[:, axis] + shifts[:, None] * size[axis]) % size[axis]
        gap = np.minimum(np.abs(at - radii), np.abs(size[axis] - at - radii)).min(axis=1)
        moved[:, axis] = at[np.argmax(gap)]
    return moved


DRAW = {
    "cubic array": _array,
    "coated sphere": _coated,
    "laminate": _laminate,
    "spheres, periodic": lambda rng: _random(rng, walls=False),
    "spheres, walls": lambda rng: _random(rng, walls=True),
}
KINDS = tuple(DRAW)
CLOSELY = {
    "sphere": lambda: gallery.sphere_in_cube(10.0),
    "83 spheres": lambda: gallery.random_dispersion(fraction=0.2),
    "40 spheres": lambda: gallery.random_dispersion(
        40, matrix=Material(0.2), inclusion=Material(30.0), periodic=False, diameter=1 / 6
    ),
}


def scene_of(name, seed=None):
    """A scene by its name.

    Parameters
    ----------
    name : str
        Of a kind, or of a scene that is looked at closely.
    seed : int, optional
        Of a drawn scene.
    """
    if name in CLOSELY:
        return CLOSELY[name]()
    return DRAW[name](np.random.default_rng([seed, KINDS.index(name)]))


def exact_of(name, scene):
    """Exact conductivity along the load, W/(m K); multipoles' where there is no closed form.

    Parameters
    ----------
    name : str
        Of the scene.
    scene : Scene
    """
    if name in ("cubic array", "coated sphere", "laminate", "sphere"):
        return exact.solve(scene).conductivity
    return multipole.solve(scene, accuracy=ACCURACY).conductivity
