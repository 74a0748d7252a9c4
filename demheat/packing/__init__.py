"""Packings of spheres: how they are made, kept and searched.

`relax`, `lsa` and `neighbours` are modules here; their functions are imported from them.
"""

import demheat.runtime.compiled  # noqa: F401 (where compiled kernels are kept)
from demheat.packing.base import Packing, make_packing
from demheat.packing.cache import grown, relaxed
from demheat.packing.domain import cut, replicate
from demheat.packing.kept import cached
from demheat.packing.neighbours import contacts
from demheat.packing.radii import Bidisperse, Gaussian, Listed, Lognormal, Uniform
from demheat.packing.relax import settle

__all__ = [
    "Bidisperse",
    "Gaussian",
    "Listed",
    "Lognormal",
    "Packing",
    "Uniform",
    "cached",
    "contacts",
    "cut",
    "grown",
    "make_packing",
    "relaxed",
    "replicate",
    "settle",
]
