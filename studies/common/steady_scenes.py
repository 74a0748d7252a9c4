"""Steady scenes of every kind that methods are compared on, and which of them constants of the DEM were found on."""

import numpy as np

from demheat import gallery
from demheat.gallery import HADDAD, scaled, sphere_in_cube
from demheat.scene import Layer, Scene
from studies.harness import methods

CONTRAST = 10.0
# Materials are finite: so high a contrast stands in for an infinite one, within 1e-5 of it for these spheres.
INFINITE = 1e6
INCLUSION = scaled(HADDAD, CONTRAST)


def _coated():
    # A shell of a tenth of the core's conductivity, 0.016 L thick.
    return gallery.coated_sphere(core=165.0, shell=16.5, radius=0.3, core_fraction=0.85)


def _polydisperse():
    # Radii from 0.07 to 0.21 L.
    return gallery.dispersion(24, fraction=0.3, ratio=3.0, gap=0.05, matrix=HADDAD, inclusion=INCLUSION)


def _laminate():
    """Layers across the load that no grid of these studies meets."""
    edges = np.array([0.1234, 0.3141, 0.5772, 0.8319]) * gallery.EDGE
    layers = [Layer(gallery.AXIS, *pair, INCLUSION) for pair in edges.reshape(2, 2)]
    return Scene((gallery.EDGE,) * 3, HADDAD, layers, **gallery.loaded((gallery.EDGE,) * 3))


STEADY = {
    "third": lambda: sphere_in_cube(CONTRAST, fraction=methods.THIRD),
    "third at 0.01": lambda: sphere_in_cube(0.01, fraction=methods.THIRD),
    "third at 1000": lambda: sphere_in_cube(1e3, fraction=methods.THIRD),
    "third at infinity": lambda: sphere_in_cube(INFINITE, fraction=methods.THIRD),
    "half": lambda: sphere_in_cube(CONTRAST, fraction=methods.HALF),
    "half at 100": lambda: sphere_in_cube(100.0, fraction=methods.HALF),
    "thin shell": _coated,
    "polydisperse": _polydisperse,
    "83 spheres": lambda: gallery.random_dispersion(fraction=0.2, matrix=HADDAD, inclusion=INCLUSION),
    "1000 spheres": lambda: gallery.dispersion(1000, fraction=0.2, gap=0.05, matrix=HADDAD, inclusion=INCLUSION),
    "laminate": _laminate,
}
# Bodies, some at other contrasts, on which constants of the DEM were found (docs/decisions/twins.md).
TUNED = (
    *("third", "third at 0.01", "third at 1000", "third at infinity", "half", "half at 100"),
    *("polydisperse", "83 spheres"),
)
STEADY_TITLES = {
    "third": "sphere, f = .155, contrast 10",
    "third at 0.01": "the same, contrast .01",
    "third at 1000": "the same, contrast 1000",
    "third at infinity": "the same, contrast 1e6",
    "half": "sphere, f = .5, contrast 10",
    "half at 100": "the same, contrast 100",
    "thin shell": "sphere in a thin shell",
    "polydisperse": "24 spheres, radii 1 to 3",
    "83 spheres": "83 spheres, f = .2",
    "1000 spheres": "1000 spheres, f = .2",
    "laminate": "laminate off the grid",
}
