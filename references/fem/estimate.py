"""How far a finite element solution is off, by coarser meshes of the same scene, and by linear elements on its own.

Runs on coarser meshes may hardly differ by luck: coarse elements lose as much volume of a body as they are too stiff.
Linear elements tell how stiff elements are. What quadratic ones lack goes with the square of what linear ones do, where
surfaces are smooth; beside edges of boxes both fall alike and keep their ratio. Around coats, where errors cancel and
inclusions may make nothing of the conductivity, the temperature tells instead.
"""

import math

import numpy as np

from demheat.error import Refinement, beside, by_refinement, conductivity_of, quietly
from demheat.extrapolation import Limit, by_extrapolation
from demheat.scene.edges import SMOOTH, edge_order
from references.mesh.lattice import CUBE, FEWEST

# Meshes follow features: all their edges are made so many times longer, not the largest alone.
RATIO = 1.4
# Cubes of a lattice along an edge of the box below which coarser ones would be no coarser, as it has a fewest.
CUBES = math.ceil(RATIO**2 * FEWEST)
# Errors of the conductivity are found to fall with the power 3 between such meshes, as features keep their elements:
# a fifth of them is left (even seeds). Where runs turn, or differ less the coarser they are, elements are too stiff for
# as much as they lose in volume, and the interval counts on half of that power.
LIMIT = Limit("coarser meshes, extrapolated", 1.6, 3.0, 3.0, 1.5, last=1.5)
# Of quadratic elements on curved surfaces, the same on straight ones, linear ones and bricks.
RULES = {
    "curved": Refinement("coarser meshes", RATIO, 2.0, 2.0, 1.2, coats=1.0),
    "straight": Refinement("coarser meshes", RATIO, 2.0, 2.5, 1.2),
    "linear": Refinement("coarser meshes", RATIO, 2.0, 4.5, 2.0),
}
# Quadratic elements lack of the conductivity such a part of what they differ by from linear ones beside edges, and of
# smooth bodies so many times that part squared, of what inclusions make of the conductivity. Found on scenes of study
# `intervals`, even seeds, are .15 to .34, and .2 to .8 of that squared.
BESIDE_EDGES, ROUND = 0.4, 1.0


def estimated(field, again, kind, *, steps=0.0):
    """Estimate of a field; `again` makes it of other knobs of its mesh."""
    if field.stats.get("cubes", CUBES) < CUBES:
        finer = min(field.scene.size) / (CUBE * CUBES)
        return beside(field, quietly(lambda size: again(size=size), finer), "a finer mesh")
    least = _by_linear(field, again) if kind == "curved" else 0.0

    def coarser(level):
        yield again(coarser=RATIO**level)

    return by_refinement(field, coarser, RULES[kind], least=least, residual=field.stats["residual"] + steps)


def _by_linear(field, again):
    """What quadratic elements lack of the conductivity, by what linear ones of the same lengths do, W/(m K)."""
    k, scene = conductivity_of(field), field.scene
    if not k or not math.isfinite(k) or not scene.inclusions or np.any(scene.parents()):
        return 0.0
    try:
        apart = abs(conductivity_of(quietly(lambda order: again(order=order, curved=False), 1)) - k)
    except (ValueError, RuntimeError, NotImplementedError):
        return 0.0
    if edge_order(scene) < SMOOTH:
        return BESIDE_EDGES * apart
    made = abs(k - float(scene.mean_conductivities[0]))
    return min(ROUND * apart**2 / made, apart) if made else 0.0


def extrapolated(field, again, kind):
    """What a field closes in on, by coarser meshes."""
    if field.stats.get("cubes", math.inf) < LIMIT.ratio**2 * FEWEST:
        raise NotImplementedError("Field.extrapolated: no lattice is so coarse; Field.error has an interval")
    if kind != "curved":
        raise NotImplementedError("Field.extrapolated: of finite elements only curved quadratic ones have a limit")

    def coarser(level):
        yield again(coarser=LIMIT.ratio**level)

    return by_extrapolation(field, coarser, LIMIT, residual=field.stats["residual"])
