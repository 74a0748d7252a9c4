"""Bounds of a scene's conductivity by its volume fractions alone."""

from __future__ import annotations

import math
from importlib import import_module
from typing import NamedTuple

import numpy as np

from demheat.scene import Sphere

# Of an image whose voxels are bounded themselves: some ten times as dear as a solution.
MOST_VOXELS = 64**3


class Bound(NamedTuple):
    """Between which values the conductivity of a body lies, W/(m K), and for which bodies that holds."""

    name: str
    lower: float
    upper: float
    holds: str

    @property
    def certain(self) -> bool:
        """Whether it holds of the scene as it is, not of isotropic bodies alone."""
        return self.holds in ("all bodies", "this image")


def bounds_of(scene) -> list[Bound]:
    """Bounds of a scene; empty where its volume fractions are not known in closed form, or its surfaces resist.

    A resistance takes the conductivity below all of them: Reuss's sum of resistances does not know it. Nor are they
    known here of tensors and of what depends on temperature.
    """
    if scene.resistances.any() or scene.anisotropic or scene.varies:
        return []
    formulas = import_module("references.bounds")
    if scene.image is not None:
        return _of_image(scene, formulas)
    try:
        fractions = import_module("references.exact.solver").fractions(scene)
    except NotImplementedError:
        return []
    k = scene.conductivities
    low, high = formulas.reuss(k, fractions), formulas.voigt(k, fractions)
    found = [Bound("Reuss, Voigt", float(low), float(high), "all bodies")]
    kinds = sorted(set(k.tolist()))
    if len(kinds) == 2 and scene.only(Sphere):
        low, high = formulas.hashin_shtrikman(*kinds, min(math.fsum(fractions[k == kinds[1]]), 1.0))
        found.append(Bound("Hashin-Shtrikman", float(low), float(high), "isotropic bodies of two phases"))
    return found


def _of_image(scene, formulas):
    """Those of the fractions of its voxels, and, of an image that is no trouble, those of its voxels themselves."""
    k, fractions = scene.conductivities, scene.image.fractions
    low, high = formulas.reuss(k, fractions), formulas.voigt(k, fractions)
    found = [Bound("Reuss, Voigt", float(low), float(high), "all bodies")]
    if len(k) == 2:
        order = np.argsort(k)
        low, high = formulas.hashin_shtrikman(*k[order], fractions[order][1])
        found.append(Bound("Hashin-Shtrikman", float(low), float(high), "isotropic bodies of two phases"))
    if math.prod(scene.image.shape) <= MOST_VOXELS:
        try:
            bracket = import_module("references.bracket.voxels").solve(scene)
        except (NotImplementedError, ValueError):
            return found
        found.append(Bound("voxels, certain", bracket.lower, bracket.upper, "this image"))
    return found
