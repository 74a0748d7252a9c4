"""What a row of the study is made of: a solve, a walk or a bracket of one scene, over the matrix's conductivity."""

import math

from references import bounds
from studies.formless import scenes
from studies.formless.parts import LABYRINTHS
from studies.harness import methods


def solved(part, contrast, fraction, method, **knobs):
    """Conductivity by a method, and bounds of the fractions that it has."""
    field = methods.load(method).solve(scenes.made(part, contrast, fraction), **knobs)
    own = float(sum(field.fractions[1:]))
    if contrast == math.inf:
        low, high = 1 + 3 * own / (1 - own) if part in LABYRINTHS else 1 / (1 - own), contrast
    elif part in LABYRINTHS:
        low, high = bounds.hashin_shtrikman(1.0, contrast, own)
    else:
        low, high = (mean([1.0, contrast], [1 - own, own]) for mean in (bounds.reuss, bounds.voigt))
    found = {"k_ratio": field.conductivity / methods.MATRIX, "inclusion": own}
    known = {name: field.stats.get(name) for name in ("unknowns", "iterations", "residual")}
    return found | {"lower_ratio": float(low), "upper_ratio": float(high)} | known


def walked(part, contrast, fraction, *, walks, radius):
    """What walkers find, and half of the interval that holds it 95 times of 100."""
    from references import walkers

    scene = scenes.walked(part, contrast, fraction)
    found = walkers.solve(scene, walks=walks, radius=radius * max(scene.size))
    half = 50 * (found.upper - found.lower) / found.conductivity
    return {"walked_ratio": found.conductivity / methods.MATRIX, "walked_half_percent": half}


def bracketed(part, contrast, *, voxels):
    """Bounds by an admissible temperature and an admissible flux."""
    from references.bracket import voxels as on_grid

    found = on_grid.solve(scenes.made(part, contrast, None), voxels=voxels)
    return {"lower_ratio": found.lower / methods.MATRIX, "upper_ratio": found.upper / methods.MATRIX}
