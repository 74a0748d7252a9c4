"""Bounds of a scene's conductivity by its volume fractions alone."""

import math
from typing import NamedTuple

import numpy as np

from demheat.gate import hashin_shtrikman, wiener
from demheat.scene import Sphere
from references import bounds as formulas
from references.bracket import voxels

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
    # Loads what is heavy.
    from references.exact.solver import fractions as fractions_of

    if scene.image is not None:
        return _of_image(scene)
    try:
        fractions = fractions_of(scene)
    except NotImplementedError:
        return []
    if scene.perfect:
        return _of_perfect(scene, fractions)
    k = scene.conductivities
    low, high = formulas.reuss(k, fractions), formulas.voigt(k, fractions)
    found = [Bound("Reuss, Voigt", float(low), float(high), "all bodies")]
    kinds = sorted(set(k.tolist()))
    if len(kinds) == 2 and scene.only(Sphere):
        low, high = formulas.hashin_shtrikman(*kinds, min(math.fsum(fractions[k == kinds[1]]), 1.0))
        found.append(Bound("Hashin-Shtrikman", float(low), float(high), "isotropic bodies of two phases"))
    return found


def _of_perfect(scene, fractions):
    """Beside perfect conductors the upper ones are infinite."""
    found = [Bound("Reuss, Voigt", wiener(scene, fractions).lower, math.inf, "all bodies")]
    if len(set(scene.conductivities.tolist())) == 2 and scene.only(Sphere):
        low = float(hashin_shtrikman(scene, fractions).lower)
        found.append(Bound("Hashin-Shtrikman", low, math.inf, "isotropic bodies of two phases"))
    return found


def _of_image(scene):
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
            bracket = voxels.solve(scene)
        except (NotImplementedError, ValueError):
            return found
        found.append(Bound("voxels, certain", bracket.lower, bracket.upper, "this image"))
    return found
