"""Scenes on which the suite asks every method the same, what they ask for, and the field or the refusal it answers."""

import re
from dataclasses import replace
from functools import cache
from itertools import combinations
from typing import NamedTuple

import numpy as np
import pytest

from demheat import Layer, Material, Scene, Sphere, gallery
from demheat.scene.volumes import fractions
from studies.harness import methods

METHODS = methods.all_methods()
# Another method but for the sides of elements on balls, of which errors alone tell.
ALIKE = ("fem-straight",)
# A box without any symmetry; spheres cross faces and an edge of the cell, walls cut them.
BOX = (1.0, 1.2, 0.8)
SPHERES = [((0.05, 0.45, 0.4), 0.3, 20.0), ((0.4, 1.0, 0.15), 0.3, 0.2)]
OBLIQUE = (1.0, 2.0, -0.5)
LAYERS = [(0.23, 0.52, 20.0), (0.52, 0.81, 0.5)]
LOW, HIGH = 20.0, 50.0
# Heat of 1 J/(m3 K) settles in these boxes within a second: after so many nothing of the start is left.
SETTLED = 40.0


class Estimated(NamedTuple):
    """What a formula knows of a scene, under the names of a Field."""

    scene: Scene
    conductivity: float
    fractions: np.ndarray


def load(gradient=None, walls=None):
    return {"gradient": gradient, "walls": walls and dict(walls)}


def pair(axis, low=LOW, high=HIGH):
    """Two isothermal walls, as a hashable load."""
    return ((axis + "-", low), (axis + "+", high))


def mixed(*, factor=1.0, turn=0, matrix=2.0, **loaded):
    """A good and a poor sphere; all conductivities times a factor; axes turned cyclically."""
    spheres = [Sphere(np.roll(center, turn), radius, Material(k * factor)) for center, radius, k in SPHERES]
    return Scene(np.roll(BOX, turn), Material(matrix * factor), spheres, **load(**loaded))


def uniform(**loaded):
    """One material, but painted twice: methods that conform to interfaces do so."""
    return Scene(BOX, Material(2.0), [Sphere((0.4, 0.7, 0.4), 0.36, Material(2.0))], **load(**loaded))


def layers(**loaded):
    """Three materials across y; no interface lies on a face of voxels."""
    return Scene(BOX, Material(2.0), [Layer(1, *ends, Material(k)) for *ends, k in LAYERS], **load(**loaded))


def crossing(k, *, fraction=0.15, **loaded):
    """The simple cubic array, its cell cut so that the sphere crosses an edge of it."""
    radius = (3 * fraction / (4 * np.pi)) ** (1 / 3)
    return Scene((1, 1, 1), Material(1.0), [Sphere((0.07, 0.45, 0.98), radius, Material(k))], **load(**loaded))


def dispersion(**loaded):
    cell = gallery.random_dispersion(2, fraction=0.18, gap=0.15, edge=1.0, seed=4)
    return Scene(cell.size, cell.matrix, cell.inclusions, **load(**loaded))


def asked(scene):
    """What a scene asks of a method: names of `demheat.method.FEATURES`."""
    spheres = [inclusion for inclusion in scene.inclusions if isinstance(inclusion, Sphere)]
    pairs = [
        np.linalg.norm(np.subtract(a.center, b.center)) < max(a.radius, b.radius) for a, b in combinations(spheres, 2)
    ]
    low, high = (np.array([np.add(s.center, side * s.radius) for s in spheres]) for side in (-1, 1))
    outside = bool(spheres) and (np.any(low < 0) or np.any(high > scene.size))
    names = sorted(scene.walls or {})
    opposite = len(names) == 2 and names[0][0] == names[1][0] and not scene.wall_fluxes
    found = {
        "gradient": scene.periodic,
        "walls": not scene.periodic,
        "flux": not (scene.periodic or opposite),
        "pores": scene.conductivities.min() == 0,
        "layers": len(spheres) < len(scene.inclusions),
        "spheres": bool(spheres),
        "nested": any(pairs),
        "cut": not scene.periodic and outside,
        "unlike": not any(pairs) and len({s.material for s in spheres}) > 1,
        "several": not any(pairs) and len(spheres) > 1,
    }
    return {name for name, is_asked in found.items() if is_asked}


def answered(method, scene, *, capacity=1.0, **other):
    """The Field of a scene at the size of the suite, or with other knobs; of a formula what it knows.

    What settles in time does so with a heat capacity, J/(m3 K), of all materials.
    """
    module = methods.load(method.module)
    if method.call == "estimate":
        return Estimated(scene, module.estimate(scene, **method.knobs), fractions(scene))
    knobs = {**method.knobs, **method.at(method.coarse, max(scene.size)), **method.tight, **other}
    if method.call == "evolve":
        *_, last = module.evolve(resting(scene, capacity), (SETTLED,), **knobs)
        return last
    return module.solve(scene, **knobs)


def resting(scene, capacity=1.0):
    """The scene with heat capacities, J/(m3 K), and at a temperature at time 0."""
    heavy = {"density": 1.0, "heat_capacity": capacity}
    inclusions = [replace(each, material=replace(each.material, **heavy)) for each in scene.inclusions]
    return replace(scene, matrix=replace(scene.matrix, **heavy), inclusions=inclusions, initial=LOW)


@cache
def solved(name, make, *arguments, **knobs):
    """The Field of a scene, made once for all tests; where the method refuses the scene, it must say so."""
    method, scene = METHODS[name], make(*arguments, **knobs)
    refused = asked(scene) & set(method.refuses)
    if not refused:
        return answered(method, scene)
    words = "|".join(re.escape(method.refuses[what]) for what in refused)
    # In transients a mean gradient is no load of the scene itself.
    errors = (NotImplementedError, ValueError) if method.call == "evolve" else NotImplementedError
    with pytest.raises(errors, match=words):
        answered(method, scene)
    pytest.skip(f"{name} refuses {', '.join(sorted(refused))} and says so")


def allowed(name, quantity="conductivity", least=0.0):
    """Declared error of a method, or the least given: all that is left to one that is exact where it goes."""
    errors = METHODS[name].errors
    return max(getattr(errors, quantity), least) if errors else least
