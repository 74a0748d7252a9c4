"""Scenes that no constant was ever looked at with, drawn by seed, seven families; their conductivities by witnesses.

All lie in a cube, so that they share packings. Where multipoles know the scene they are asked; where a wall cuts a
sphere off its centre, or spheres are nested, quadratic finite elements on two meshes.
"""

import numpy as np

from demheat.addition import add_spheres
from demheat.packing.dispersion import dispersion
from demheat.referee import value_error
from demheat.scene import Material, Scene, Sphere
from references import fem, multipole
from references.richardson import extrapolate

SIZE = (1.0, 1.0, 1.0)
WALLS = {"low": 0.0, "high": 1.0}
# Of the multipoles: a hundredth of the smallest error of the DEM that is averaged.
ACCURACY = 1e-6
# Edges of the elements of two meshes, and the orders between which the error falls: four where the mesh is even, two
# was found where small spheres already ask for shorter edges. The middle of what both extrapolate to is taken.
EDGES, ORDERS = (0.045, 0.032), (2.0, 4.0)


def _material(rng, decades, least=0.0):
    """Conductivity over the matrix's, as likely below as above it, and never closer than so many decades."""
    return Material(10.0 ** (rng.choice([-1, 1]) * rng.uniform(least, decades)))


def _loaded(rng, periodic):
    if periodic:
        along = rng.normal(size=3)
        return {"gradient": tuple(along / np.linalg.norm(along))}
    axis = "xyz"[rng.integers(3)]
    return {"walls": {axis + "-": WALLS["low"], axis + "+": WALLS["high"]}}


def _scattered(rng, radii, *, gap, periodic, materials):
    """Spheres put at random, a gap apart and between walls half of it from them."""
    radii = np.sort(radii)[::-1]
    margin = 0.0 if periodic else radii + gap
    centers = add_spheres(radii + gap / 2, np.array(SIZE), rng, periodic=periodic, margin=margin)
    spheres = [Sphere(c, r, m) for c, r, m in zip(centers, radii, materials, strict=True)]
    return Scene(SIZE, Material(1.0), spheres, **_loaded(rng, periodic))


def _polydisperse(rng):
    """Four to eight spheres in a periodic cell, radii in a ratio of up to three, each of its own material."""
    radii = rng.uniform(0.09, 0.24, rng.integers(4, 9))
    return _scattered(rng, radii, gap=0.04, periodic=True, materials=[_material(rng, 1.5, 0.2) for _ in radii])


def _walled(rng):
    """Two to four spheres off the centre of a box between two isothermal and four insulated walls."""
    radii = rng.uniform(0.1, 0.2, rng.integers(2, 5))
    return _scattered(rng, radii, gap=0.05, periodic=False, materials=[_material(rng, 1.5, 0.2) for _ in radii])


def _cut(rng):
    """Two spheres, each cut by a wall beside its centre; one in three by two walls."""
    axes = rng.permutation(3)
    spheres = []
    for number, radius in enumerate(rng.uniform(0.15, 0.22, 2)):
        # In opposite corners of the box: apart, and off the walls that do not cut them.
        center = np.where([number, number, number], 0.72, 0.28) + rng.uniform(-0.04, 0.04, 3)
        cut_by = axes[: 2 if rng.random() < 1 / 3 else 1] if number else axes[2:]
        inwards = radius * rng.uniform(0.3, 0.7)
        center[cut_by] = 1 - inwards if number else inwards
        spheres.append(Sphere(center, radius, _material(rng, 1.3, 0.3)))
    return Scene(SIZE, Material(1.0), spheres, **_loaded(rng, False))


def _nested(rng):
    """Two coated spheres in a periodic cell, their cores off the centre of the coat."""
    outer = rng.uniform(0.2, 0.28, 2)
    scene = _scattered(rng, outer, gap=0.05, periodic=True, materials=[_material(rng, 1.3, 0.3) for _ in outer])
    spheres = []
    for coat in scene.inclusions:
        core = coat.radius * rng.uniform(0.5, 0.75)
        off = rng.normal(size=3)
        off *= 0.4 * (coat.radius - core) / np.linalg.norm(off)
        spheres += [coat, Sphere(np.array(coat.center) + off, core, _material(rng, 1.3, 0.3))]
    return Scene(SIZE, Material(1.0), spheres, gradient=scene.gradient)


def _close(rng):
    """Two pairs of spheres in a periodic cell, of gaps from .015 to .05, contrasts of ten or a tenth."""
    radii = rng.uniform(0.13, 0.19, 2)
    gaps = rng.uniform(0.015, 0.05, 2)
    middles = add_spheres(2 * radii + gaps / 2 + 0.01, np.array(SIZE), rng, periodic=True)
    material = Material(10.0 ** rng.choice([-1, 1]))
    spheres = []
    for middle, radius, gap in zip(middles, radii, gaps, strict=True):
        along = rng.normal(size=3)
        along *= (radius + gap / 2) / np.linalg.norm(along)
        spheres += [Sphere((middle + side * along) % 1.0, radius, material) for side in (-1, 1)]
    return Scene(SIZE, Material(1.0), spheres, **_loaded(rng, True))


def _strong(rng):
    """Two to four spheres in a periodic cell, of contrasts from 100 to 10 000 or their inverses."""
    radii = rng.uniform(0.13, 0.25, rng.integers(2, 5))
    return _scattered(rng, radii, gap=0.06, periodic=True, materials=[_material(rng, 4.0, 2.0) for _ in radii])


def _dense(rng):
    """Twelve to twenty spheres in a periodic cell that fill .3 to .42 of it, of one material, a 20th apart or less."""
    number, fraction, gap = int(rng.integers(12, 21)), rng.uniform(0.3, 0.42), rng.uniform(0.02, 0.05)
    centers, radii = dispersion(number, fraction=fraction, gap=gap, seed=int(rng.integers(2**31)))
    material = _material(rng, 1.5, 0.5)
    return Scene(
        SIZE, Material(1.0), [Sphere(c, r, material) for c, r in zip(centers, radii, strict=True)], **_loaded(rng, True)
    )


DRAW = {
    "polydisperse": _polydisperse,
    "walled": _walled,
    "cut": _cut,
    "nested": _nested,
    "close": _close,
    "strong": _strong,
    "dense": _dense,
}
FAMILIES = tuple(DRAW)
MESHED = ("cut", "nested")


def scene_of(family, seed):
    """A scene."""
    return DRAW[family](np.random.default_rng([seed, FAMILIES.index(family), 1789]))


def reference(family, seed):
    """Conductivity of a scene along its load by a witness, W/(m K), and how far off it may be, relative."""
    scene = scene_of(family, seed)
    if family not in MESHED:
        return multipole.solve(scene, accuracy=ACCURACY).conductivity, ACCURACY
    values = [fem.solve(scene, size=edge).conductivity for edge in EDGES]
    low, high = (extrapolate(values, EDGES, order=order) for order in ORDERS)
    return 0.5 * (low + high), 0.5 * abs(value_error(low, high))
