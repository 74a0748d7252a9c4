"""The page on scenes: who takes what. Every entry of its table is asked for, at sizes that cost next to nothing."""

import re
import warnings
from contextlib import contextmanager

import numpy as np
import pytest
from blocks import DOCS
from surface_bodies import ring

from demheat import Convection, Image, Layer, Material, Radiation, Scene, Sphere, evolve, gallery, orthotropic, solve
from demheat.scene import Box, Cylinder, Ellipsoid, HalfSpace, LevelSet, SurfaceMesh, Torus, Union
from references import bracket, exact, fem, fft, multipole, series

(TABLE,) = re.findall(
    r"<!-- who takes what -->\n\n(.*?)\n\n<!-- end -->", (DOCS / "scenes.md").read_text(encoding="utf-8"), re.DOTALL
)
LINES = [[cell.strip() for cell in line.strip("|").split("|")] for line in TABLE.splitlines()]
HEAD, ROWS = LINES[0], {row[0]: row for row in LINES[2:]}
HEAVY = {"density": 1.0, "heat_capacity": 1.0}
M, G = Material(1.0, **HEAVY), Material(4.0, **HEAVY)
MIDDLE = (0.5, 0.5, 0.5)
PAIR = {"x-": 0.0, "x+": 1.0}


def body(*inclusions, matrix=M, walls=PAIR):
    return Scene((1.0, 1.0, 1.0), matrix, list(inclusions), walls=walls, initial=0.0)


def ball(points):
    return np.linalg.norm(points - 0.5, axis=1) - 0.3


SCENES = {
    "spheres": body(Sphere(MIDDLE, 0.3, G)),
    "nested": body(Sphere(MIDDLE, 0.4, G), Sphere(MIDDLE, 0.2, M)),
    "touching": body(*(Sphere((x, 0.5, 0.5), 0.25, G) for x in (0.25, 0.75))),
    "layers": body(Layer(0, 0.3, 0.7, G)),
    "cylinders": body(Cylinder(MIDDLE, 0.25, (0, 1, 1), G, length=0.4)),
    "ellipsoids": body(Ellipsoid(MIDDLE, (0.4, 0.3, 0.3), G, rotation=(0.0, 0.0, 0.5))),
    "boxes": body(Box(MIDDLE, (0.5, 0.4, 0.4), G, rotation=(0.0, 0.0, 0.5))),
    "tori": body(Torus(MIDDLE, 0.25, 0.15, (0.0, 1.0, 1.0), G)),
    "half-spaces": body(HalfSpace(MIDDLE, (1.0, 0.5, 0.0), G)),
    "level sets": body(LevelSet(ball, ((0.1,) * 3, (0.9,) * 3), G)),
    "surface meshes": body(SurfaceMesh(*ring(0.25, 0.2), G)),
    "unions": body(Union([Sphere((0.4, 0.5, 0.5), 0.25, G), Box((0.65, 0.5, 0.5), (0.4, 0.3, 0.3), G)], G)),
    "images": Scene.of_image(Image(np.indices((4, 4, 4)).sum(0) % 2, 0.25, {0: M, 1: G}), walls=PAIR, initial=0.0),
    "pores": body(Sphere(MIDDLE, 0.3, Material(0.0, **HEAVY))),
    "perfect conductors": body(Sphere(MIDDLE, 0.3, Material(np.inf, **HEAVY))),
    "resistances": body(Sphere(MIDDLE, 0.3, G, resistance=0.1)),
    "tensors": body(Layer(0, 0.3, 0.7, Material(orthotropic(1.0, 2.0, 3.0), **HEAVY))),
    "k(T)": body(Layer(0, 0.3, 0.7, Material(4.0, dependence=[(0.0, 1.0), (1.0, 2.0)], **HEAVY))),
    "convection": body(walls={"x-": 0.0, "x+": Convection(1.0, 1.0)}),
    "radiation": body(walls={"x-": 1.0, "x+": Radiation(1.0, 300.0)}),
}
TENSOR = body(Sphere(MIDDLE, 0.3, Material(orthotropic(1.0, 2.0, 3.0), **HEAVY)))
DEPENDENT = body(Sphere(MIDDLE, 0.3, Material(4.0, dependence=[(0.0, 1.0), (1.0, 2.0)], **HEAVY)))
ASIDE = (0.5, 0.5, 0.4)
# Where a word other than yes stands: a scene that has what it says, if the row's has not, and one that has not.
WITH = {("nested", "exact"): gallery.coated_sphere(5.0)}
WITHOUT = {
    ("spheres", "exact"): body(Sphere(ASIDE, 0.3, G)),
    ("nested", "exact"): SCENES["nested"],
    ("pores", "exact"): body(Sphere(ASIDE, 0.3, Material(0.0))),
    ("perfect conductors", "exact"): body(Sphere(ASIDE, 0.3, Material(np.inf))),
    ("resistances", "exact"): body(Sphere(ASIDE, 0.3, G, resistance=0.1)),
    ("tensors", "exact"): TENSOR,
    ("k(T)", "exact"): DEPENDENT,
}
# Of layers multipoles know nothing anyway: the same of spheres must be refused, too.
AGAIN = {"tensors": TENSOR, "k(T)": DEPENDENT}
METHODS = {
    "DEM": lambda scene: solve(scene, particles=200),
    "FEM": lambda scene: fem.solve(scene, order=1, size=0.5),
    "FFT": lambda scene: fft.solve(scene, **({} if scene.image else {"voxels": 8})),
    "multipoles": lambda scene: multipole.solve(scene, accuracy=0.01),
    "exact": exact.solve,
    "bracket": lambda scene: bracket.solve(scene, size=0.5, tolerance=1e-2),
    "on voxels": lambda scene: bracket.voxels.solve(scene, **({} if scene.image else {"voxels": 8})),
}
IN_TIME = {
    "DEM": lambda scene: list(evolve(scene, [1e-3], particles=200)),
    "FEM": lambda scene: list(fem.evolve(scene, [1e-3], accuracy=0.1, **_elements(scene))),
    "series": lambda scene: list(series.evolve(scene, [0.1])),
}


def _elements(scene):
    return {"elements": "hexahedra"} if scene.image else {"order": 1, "size": 0.5}


@contextmanager
def refused():
    with pytest.raises(NotImplementedError) as caught:
        yield
    assert "\n" not in str(caught.value)


@pytest.fixture(autouse=True)
def coarse():
    """Grids and packings are far too coarse here, and say so."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        yield


def test_every_row_has_a_scene():
    assert list(ROWS) == list(SCENES) and HEAD[1:] == [*list(METHODS)[:-1], "in time"]


@pytest.mark.parametrize("column", HEAD[1:-1])
@pytest.mark.parametrize("row", ROWS)
def test_who_takes_what(row, column):
    said, scene = ROWS[row][HEAD.index(column)], SCENES[row]
    if said in ("no", "on voxels"):
        with refused():
            METHODS[column](scene)
    if said == "on voxels":
        METHODS[said](scene)
    elif said != "no":
        METHODS[column](WITH.get((row, column), scene))
    assert (said in ("yes", "no", "on voxels")) == ((row, column) not in WITHOUT)
    if (row, column) in WITHOUT:
        with refused():
            METHODS[column](WITHOUT[row, column])
    elif row in AGAIN and said == "no":
        with refused():
            METHODS[column](AGAIN[row])


@pytest.mark.parametrize("method", IN_TIME)
@pytest.mark.parametrize("row", ROWS)
def test_who_takes_it_in_time(row, method):
    said = ROWS[row][-1]
    assert set(said.split(", ")) <= {*IN_TIME, "no"}
    if method in said.split(", "):
        IN_TIME[method](SCENES[row])
    else:
        with refused():
            IN_TIME[method](SCENES[row])
