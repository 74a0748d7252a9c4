"""Named scenes. Every function gives a good default and takes the same knobs of the load, which `loaded` describes."""

from demheat.gallery.cells import (
    AXIS,
    EDGE,
    HADDAD,
    TEMPERATURES,
    body_centred,
    coated_sphere,
    face_centred,
    laminate,
    loaded,
    scaled,
    simple_cubic,
    slab,
    sphere_in_cube,
)
from demheat.gallery.dispersions import EPOXY, SILICA, dispersion, random_dispersion

__all__ = [
    "AXIS",
    "EDGE",
    "EPOXY",
    "HADDAD",
    "SILICA",
    "TEMPERATURES",
    "body_centred",
    "coated_sphere",
    "dispersion",
    "face_centred",
    "laminate",
    "loaded",
    "random_dispersion",
    "scaled",
    "simple_cubic",
    "slab",
    "sphere_in_cube",
]
