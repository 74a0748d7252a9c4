"""Scenes with an exact solution, drawn by seed: for claims over many scenes that nothing was tuned on."""

import math

import numpy as np

from demheat import gallery
from demheat.addition import add_spheres
from demheat.scene import Layer, Material, Scene, Sphere
from references import exact, multipole

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


def _neutral(rng):
    """One to four coated spheres, each of its own materials, that the matrix does not notice."""
    size, number = rng.uniform(0.8, 1.25, 3), int(rng.integers(1, 5))
    walls = bool(rng.random() < 0.5)
    radii, apart = _radii(rng, size, number, fraction=rng.uniform(0.05, 0.15))
    centers = add_spheres(apart, size, rng, periodic=not walls, margin=apart if walls else 0.0)
    spheres = []
    for center, radius in zip(centers if walls else _off_faces(centers, radii, size), radii, strict=True):
        share, above = rng.uniform(0.2, 0.7), 10.0 ** rng.uniform(0.1, 2.0)
        coat, core = _unnoticed(share, above if rng.random() < 0.5 else 1 / above)
        spheres += [Sphere(center, radius, Material(coat)), Sphere(center, radius * share ** (1 / 3), Material(core))]
    return Scene(size, Material(1.0), spheres, **gallery.loaded(size, axis=int(rng.integers(3)), periodic=not walls))


def _unnoticed(share, ratio):
    """Conductivities of coat and core, core so many times the coat's, of a sphere that conducts 1 as a whole."""
    whole = (ratio + 2 + 2 * (ratio - 1) * share) / (ratio + 2 - (ratio - 1) * share)
    return 1 / whole, ratio / whole


def _halves(rng):
    """Spheres cut in halves by a wall with a temperature or by an insulated one, and one or two whole ones."""
    size, number = rng.uniform(0.8, 1.25, 3), int(rng.integers(2, 5))
    radii, apart = _radii(rng, size, number, fraction=rng.uniform(0.05, 0.12))
    while True:
        centers = add_spheres(apart, size, rng, periodic=False, margin=apart)
        for at in range((number + 1) // 2):
            axis, side = int(rng.integers(3)), int(rng.integers(2))
            centers[at, axis] = side * size[axis]
        distance = np.linalg.norm(centers[:, None] - centers, axis=2) + 10 * np.eye(number)
        if np.all(distance > apart[:, None] + apart):
            break
    spheres = [Sphere(c, r, Material(_contrast(rng))) for c, r in zip(centers, radii, strict=True)]
    return Scene(size, Material(1.0), spheres, **gallery.loaded(size, axis=int(rng.integers(3)), periodic=False))


def _polydisperse(rng):
    """A dozen or two of one material, the largest up to four times as large as the smallest."""
    size, number = rng.uniform(0.8, 1.25, 3), int(rng.integers(12, 25))
    radii, apart = _radii(rng, size, number, fraction=rng.uniform(0.1, 0.25), least=rng.uniform(0.25, 0.5))
    centers = _off_faces(add_spheres(apart, size, rng, periodic=True, margin=0.0), radii, size)
    other = Material(_contrast(rng))
    spheres = [Sphere(c, r, other) for c, r in zip(centers, radii, strict=True)]
    return Scene(size, Material(1.0), spheres, **gallery.loaded(size, axis=int(rng.integers(3)), periodic=True))


def _radii(rng, size, number, *, fraction, least=0.5):
    """Radii that fill a fraction of the box, largest first, and these with half of the least gap."""
    radii = np.sort(rng.uniform(least, 1.0, number))[::-1]
    radii *= (fraction * size.prod() / (4 / 3 * math.pi * np.sum(radii**3))) ** (1 / 3)
    return radii, radii + 0.1 * radii.min()


DRAW = {
    "cubic array": _array,
    "coated sphere": _coated,
    "laminate": _laminate,
    "spheres, periodic": lambda rng: _random(rng, walls=False),
    "spheres, walls": lambda rng: _random(rng, walls=True),
    "neutral spheres": _neutral,
    "halves at walls": _halves,
    "polydisperse": _polydisperse,
}
KINDS = tuple(DRAW)
CLOSED = ("cubic array", "coated sphere", "laminate", "neutral spheres")


def scene_of(kind, seed):
    """A drawn scene."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    while True:
        try:
            return DRAW[kind](rng)
        except RuntimeError:
            # No room for the last sphere: drawn anew.
            continue


def exact_field(kind, scene):
    """Exact solution of a scene; multipoles' where there is no closed form."""
    return exact.solve(scene) if kind in CLOSED else multipole.solve(scene, accuracy=ACCURACY)
