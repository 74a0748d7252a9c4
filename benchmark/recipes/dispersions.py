"""Spheres at random, by multipoles; and bodies between bounds that are certain."""

import math
from dataclasses import replace
from functools import partial

import numpy as np

import benchmark
from benchmark.recipes.entries import CUBE, GRADIENT, MATRIX, WALLS, Entry, fields, number
from demheat.addition import add_spheres
from demheat.gallery import random_dispersion, scaled
from demheat.scene import Layer, Scene, Sphere
from references import bracket, multipole

# Relative, of the mean flux; and how many times what higher degrees would change and the equations leave an error is.
ACCURACY, SAFETY = 1e-9, 10.0
DECIMALS = 6
# The accuracy where spheres are many.
MANY = 1e-7
FIRST, SILICA = "dispersion-20-s10", 1.5 / 0.195
CELL, BOX = {"gradient": GRADIENT}, {"walls": WALLS}
HOW = (
    "multipoles of all spheres at all others in the periodic cell, degrees raised until the mean flux stands to {:g} "
    "(references/multipole); the error is ten times what higher degrees would change, extrapolated, and what the "
    "equations leave"
)
SOURCE = "Rayleigh, Phil. Mag. 34 (1892) 481; Sangani and Acrivos, Proc. R. Soc. A 386 (1983) 263"
WIDTH = 4e-4


def entries():
    """Names, and what makes each."""
    for name, title, spheres, load, accuracy in (
        ("dispersion-20-s10", "20 spheres, f = .2, contrast 10", partial(_equal, 20, 0.2, 1, 10.0), CELL, ACCURACY),
        ("dispersion-20-s100", "the same 20, contrast 100", partial(_as, FIRST, 100.0), CELL, ACCURACY),
        ("dispersion-20-s0.1", "the same 20, contrast .1", partial(_as, FIRST, 0.1), CELL, ACCURACY),
        ("dispersion-20-pores", "the same 20, pores", partial(_as, FIRST, 0.0), CELL, ACCURACY),
        (
            *("dispersion-20-s100-r0.2", "the same 20, contrast 100, surfaces R k_m/a = .2"),
            *(partial(_as, FIRST, 100.0, 0.2), CELL, ACCURACY),
        ),
        ("dispersion-unlike", "24 spheres, radii 1 to 3, contrasts .05 to 50", _unlike, CELL, ACCURACY),
        ("dispersion-walls", "12 spheres between walls, f = .15, contrast 10", _inside, BOX, ACCURACY),
        ("dispersion-83", "83 spheres, f = .2, silica in epoxy", partial(_equal, 83, 0.2, 3, SILICA), CELL, MANY),
        ("dispersion-150", "150 spheres, f = .3, contrast 10", partial(_equal, 150, 0.3, 4, 10.0), CELL, MANY),
    ):
        yield name, partial(_dispersed, name, title, spheres, load, accuracy)
    yield "sphere-in-layer", _between_bounds


def _dispersed(name, title, draw, load, accuracy):
    """Drawn once: another kind of processor or C library, with other last bits, might draw other spheres."""
    stored = name in benchmark.names()
    spheres = benchmark.load(name)[0].inclusions if stored else draw()
    return by_multipoles(name, title, Scene(CUBE, MATRIX, spheres, **load), accuracy)


def by_multipoles(name, title, scene, accuracy=ACCURACY):
    """A scene of spheres, solved."""
    field = multipole.solve(scene, accuracy=accuracy, tolerance=accuracy / 100)
    stats = field.stats
    known = {"by": "multipoles", "how": HOW.format(accuracy) + f"; degree {stats['order']}", "source": SOURCE}
    relative = SAFETY * (stats["truncation"] + stats["residual"])
    known["conductivity"] = number(field.conductivity, relative, "estimate", least=1e-12)
    known["fields"] = fields(field, SAFETY * max(stats["field_truncation"], relative))
    return Entry(name, "dispersions", title, scene, known)


def _equal(count, fraction, seed, contrast):
    """Spheres one after the other; coordinates are rounded, since the file holds them, and not the seed."""
    material = scaled(MATRIX, contrast)
    drawn = random_dispersion(count, fraction=fraction, seed=seed, edge=1.0, matrix=MATRIX, inclusion=material)
    return [_rounded(sphere) for sphere in drawn.inclusions]


def _rounded(sphere):
    center = tuple(round(c, DECIMALS) for c in sphere.center)
    return replace(sphere, center=center, radius=round(sphere.radius, DECIMALS))


def _as(name, contrast, rho=0.0):
    """The spheres of another scene, of a material and with a surface."""
    spheres, material = benchmark.load(name)[0].inclusions, scaled(MATRIX, contrast)
    return [replace(each, material=material, resistance=rho * each.radius) for each in spheres]


def _unlike():
    contrasts = (0.05, 0.5, 5.0, 50.0)
    radii = np.geomspace(0.15, 0.05, 24)
    centers = add_spheres(radii * 1.05, np.ones(3), np.random.default_rng(7), periodic=True, margin=0.0, reuse=True)
    return [
        _rounded(Sphere(tuple(center), float(radius), scaled(MATRIX, contrasts[n % 4])))
        for n, (center, radius) in enumerate(zip(centers, radii, strict=True))
    ]


def _inside():
    knobs = {"fraction": 0.15, "seed": 5, "edge": 1.0, "matrix": MATRIX, "periodic": False}
    drawn = random_dispersion(12, inclusion=scaled(MATRIX, 10.0), **knobs)
    return [_rounded(sphere) for sphere in drawn.inclusions]


def _between_bounds():
    """A sphere in a layer: no closed form, but bounds of two energies."""
    shapes = [Layer(0, 0.0, 0.7, scaled(MATRIX, 3.0)), Sphere((0.35, 0.5, 0.5), 0.25, scaled(MATRIX, 30.0))]
    scene = Scene(CUBE, MATRIX, shapes, walls=WALLS)
    found = bracket.solve(scene, width=WIDTH)
    # A width that elements reach; the same elements on another machine may differ by their rounding.
    value, half = math.sqrt(found.lower * found.upper), (found.upper - found.lower) / 2
    how = (
        "energies of a temperature and of a flux that are both admissible, on one mesh whose interfaces are pushed to "
        "the safe side (references/bracket): the conductivity lies between them; the value is their geometric mean"
    )
    known = {"by": "certain bounds", "how": how, "source": "Dirichlet's and Thomson's principles"}
    known["conductivity"] = number(value, half / value * (1 + 1e-3), "certain")
    return Entry("sphere-in-layer", "certain bounds", "a sphere in a layer, contrasts 30 and 3", scene, known)
