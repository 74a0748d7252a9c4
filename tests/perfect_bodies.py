"""Bodies of perfect conductors that particles, elements and voxels are asked for: apart, spanning, all there is."""

import math

import numpy as np

from demheat import Cylinder, Flux, Layer, Material, Scene, Sphere

MATRIX, MIDDLE, PERFECT = 2.0, (0.5, 0.5, 0.5), Material(math.inf)
X, Y, CELL = {"walls": {"x-": 20.0, "x+": 30.0}}, {"walls": {"y-": 20.0, "y+": 30.0}}, {"gradient": (10.0, 0.0, 0.0)}
POINTS = np.random.default_rng(0).random((200, 3))


def body(*shapes, matrix=MATRIX, **load):
    return Scene((1.0, 1.0, 1.0), Material(matrix), list(shapes), **load)


def beside_a_pore(k):
    return body(Sphere((0.27, 0.5, 0.5), 0.2, k), Sphere((0.75, 0.5, 0.5), 0.2, Material(0.0)), **X)


BODIES = {
    "sphere": lambda k: body(Sphere(MIDDLE, 0.4, k), **X),
    "across faces": lambda k: body(Sphere((0.1, 0.9, 0.5), 0.4, k), **CELL),
    "half at a wall": lambda k: body(Sphere((0.0, 0.5, 0.5), 0.3, k), **X),
    "half at a flux": lambda k: body(Sphere((1.0, 0.5, 0.5), 0.3, k), walls={"x-": 20.0, "x+": Flux(5.0)}),
    "fibre across": lambda k: body(Cylinder(MIDDLE, 0.2, (0, 0, 1), k), **CELL),
    "shell": lambda k: body(Sphere(MIDDLE, 0.4, k), Sphere(MIDDLE, 0.3, Material(1.0)), **X),
}
# Half of the matrix, and two films: 1/(.5/2 + .2).
FILMS, OF_FILMS = (Layer(0, 0.2, 0.4, PERFECT, resistance=0.1), Layer(0, 0.4, 0.7, PERFECT)), 1 / 0.45
# The conductivity is infinite.
SPANNING = {
    "layer along": body(Layer(0, 0.3, 0.7, PERFECT), **Y),
    "fibre in a cell": body(Cylinder(MIDDLE, 0.2, (1, 0, 0), PERFECT), **CELL),
    "fibre between walls": body(Cylinder(MIDDLE, 0.2, (1, 0, 0), PERFECT), **X),
    "chain": body(*(Sphere((x, 0.5, 0.5), 0.25, PERFECT) for x in (0.25, 0.75)), **X),
}
MATRIX_THAT_SPANS = {"matrix": body(Sphere(MIDDLE, 0.3, Material(1.0)), matrix=math.inf, **X)}
# Scenes with their conductivities.
FROM_ZERO = {
    "sealed": (body(Sphere(MIDDLE, 0.3, PERFECT), matrix=0.0, **X), 0.0),
    "in a pore": (body(Layer(0, 0.0, 0.7, PERFECT), Layer(0, 0.7, 1.0, Material(2.0)), matrix=0.0, **X), 2.0 / 0.3),
    "matrix": (body(Layer(0, 0.3, 0.7, Material(1.0)), matrix=math.inf, **X), 2.5),
    "cut by a pore": (body(Layer(0, 0.3, 0.7, Material(0.0)), matrix=math.inf, **X), 0.0),
}
