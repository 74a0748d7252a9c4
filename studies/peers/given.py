"""What every program is given: bodies between two walls whose conductivities are known, and images of them.

All are cubes of 1 m between walls across x at 1 and 0 K, insulated elsewhere, in a matrix of 1 W/(m K) but for the
coated sphere. A program gets the body itself, a mesh that follows its interfaces, or an image of it.
"""

import math
from functools import cache, partial

import numpy as np

from demheat import Image, Layer, Material, Scene, Sphere
from demheat.declared import load
from demheat.gallery import coated_sphere, random_dispersion, scaled
from references.voxels.paint import voxelise
from studies.peers.beds import BEDS
from studies.peers.beds import known as known_bed

MATRIX = Material(1.0)
WALLS = {"x-": 1.0, "x+": 0.0}
SIZE = (1.0, 1.0, 1.0)
# An interface that lies on no face of a voxel.
OFF = 0.3137
# Radii: of a sphere as in Haddad et al. 2021, and of one that fills half of the cube.
THIRD, HALF = 1 / 3, (3 / (8 * math.pi)) ** (1 / 3)
# Of multipoles: far below what any program reaches on these bodies.
ACCURACY = 1e-6


def _layers(axis, stop, contrast):
    return Scene(SIZE, MATRIX, [Layer(axis, 0.0, stop, scaled(MATRIX, contrast))] if stop else [], walls=WALLS)


def _sphere(radius, contrast):
    return Scene(SIZE, MATRIX, [Sphere((0.5, 0.5, 0.5), radius, scaled(MATRIX, contrast))], walls=WALLS)


def _coated():
    """A core ten times its shell in the matrix that does not notice it."""
    drawn = coated_sphere(10.0, 1.0, radius=0.4, edge=1.0)
    return Scene(SIZE, drawn.matrix, drawn.inclusions, walls=WALLS)


def _dispersion(contrast):
    drawn = random_dispersion(
        12, fraction=0.15, seed=2026, edge=1.0, matrix=MATRIX, inclusion=scaled(MATRIX, contrast), periodic=False
    )
    return Scene(SIZE, MATRIX, drawn.inclusions, walls=WALLS)


# Name: how it is drawn, and the module that knows its conductivity.
SCENES = {
    "homogeneous": (partial(_layers, 0, 0.0, 1.0), "exact"),
    "layers across": (partial(_layers, 0, 0.5, 10.0), "exact"),
    "layers off the grid": (partial(_layers, 0, OFF, 10.0), "exact"),
    "layers along": (partial(_layers, 2, 0.5, 10.0), "exact"),
    "sphere 10": (partial(_sphere, THIRD, 10.0), "exact"),
    "sphere 1000": (partial(_sphere, THIRD, 1000.0), "exact"),
    "sphere 0.01": (partial(_sphere, THIRD, 0.01), "exact"),
    "pore": (partial(_sphere, THIRD, 0.0), "exact"),
    "half 10": (partial(_sphere, HALF, 10.0), "exact"),
    "coated": (_coated, "exact"),
    "dispersion 10": (partial(_dispersion, 10.0), "multipole"),
    "dispersion 0.1": (partial(_dispersion, 0.1), "multipole"),
}


# One dispersion is enough for programs of others.
SAME = "dispersion 0.1"


def bodies(*less: str) -> tuple[str, ...]:
    """Names of the bodies that programs of others are given, less some."""
    return tuple(name for name in SCENES if name not in (SAME, *less))


def scene(name: str) -> Scene:
    """A body."""
    return BEDS[name] if name in BEDS else SCENES[name][0]()


@cache
def known(name: str) -> float:
    """Effective conductivity of a body between its walls, W/(m K), by what knows it to seven digits or more."""
    if name in BEDS:
        return known_bed(name)
    draw, witness = SCENES[name]
    knobs = {"accuracy": ACCURACY} if witness == "multipole" else {}
    return load(witness).solve(draw(), **knobs).conductivity


def image(body: Scene, n: int) -> Image:
    """Image of a body, n^3 voxels, each of the material of its centre; labels are 0, 1, ... by rising conductivity."""
    phase = voxelise(body, (n, n, n), laminate=False).phase
    values, label = np.unique(body.conductivities, return_inverse=True)
    return Image(label[phase].astype(np.uint8), 1.0 / n, {i: Material(float(k)) for i, k in enumerate(values)})
