"""Packings of spheres: how they are made, kept and searched."""

from demheat.packing.base import Packing, make_packing
from demheat.packing.cache import cached, relaxed
from demheat.packing.neighbours import contacts, neighbours
from demheat.packing.radii import Bidisperse, Gaussian, Listed, Lognormal, Uniform
from demheat.packing.relax import relax, settle

__all__ = [
    "Bidisperse",
    "Gaussian",
    "Listed",
    "Lognormal",
    "Packing",
    "Uniform",
    "cached",
    "contacts",
    "make_packing",
    "neighbours",
    "relax",
    "relaxed",
    "settle",
]
