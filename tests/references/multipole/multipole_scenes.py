"""Arrangements of spheres on which multipoles are tried."""

from functools import cache

import numpy as np

from demheat import Material, Scene, Sphere, gallery
from references import multipole

# A box without any symmetry, two materials, three radii; the smallest gap, 0.104, is a third of the smallest diameter.
SIZE = (1.0, 1.2, 0.9)
PARTS = [((0.05, 0.4, 0.3), 0.25, 20.0), ((0.55, 0.9, 0.2), 0.2, 20.0), ((0.5, 0.45, 0.75), 0.15, 0.1)]
CUBIC = {"sc": gallery.simple_cubic, "bcc": gallery.body_centred, "fcc": gallery.face_centred}


def box(gradient=(0.0, 0.0, 1.0), shift=(0.0, 0.0, 0.0), parts=PARTS, size=SIZE):
    spheres = [Sphere(np.add(center, shift), radius, Material(k)) for center, radius, k in parts]
    return Scene(size, Material(1.0), spheres, gradient=gradient)


@cache
def solved(order=14):
    return multipole.solve(box((0.5, -1.0, 2.0)), order=order, points_per_axis=20)
