"""Scenes with an exact conductivity: drawn by seed, and the three that are looked at closely."""

from demheat import gallery
from demheat.scene import Material
from references import exact, multipole
from studies.common import drawn

# Edges of elements in a drawn scene: the box over this.
DRAWN = 10
KINDS = drawn.KINDS[:5]
CLOSELY = {
    "sphere": lambda: gallery.sphere_in_cube(10.0),
    "83 spheres": lambda: gallery.random_dispersion(fraction=0.2),
    "40 spheres": lambda: gallery.random_dispersion(
        40, matrix=Material(0.2), inclusion=Material(30.0), periodic=False, diameter=1 / 6
    ),
}


def scene_of(name, seed=None):
    """A scene by its name."""
    if name in CLOSELY:
        return CLOSELY[name]()
    return drawn.scene_of(name, seed)


def exact_of(name, scene):
    """Exact conductivity along the load, W/(m K); multipoles' where there is no closed form."""
    if name == "sphere":
        return exact.solve(scene).conductivity
    if name in CLOSELY:
        return multipole.solve(scene, accuracy=drawn.ACCURACY).conductivity
    return drawn.exact_field(name, scene).conductivity
