"""One bracket, or one method's answer, as a row."""

import math

from references import bracket
from references.bracket import voxels as on_grid
from studies.brackets.scenes import exact_of, scene_of
from studies.harness import methods
from studies.harness.cost import measured


def bounded(name, seed, parts):
    """Bounds of a scene's conductivity beside the exact one."""
    scene = scene_of(name, seed)
    found, cost = measured(bracket.solve, scene, size=max(scene.size) / parts)
    return _row(name, scene, found, found.stats["elements"]) | cost


def on_voxels(name, *, voxels):
    """Bounds of a scene's conductivity by fields on voxels, beside the exact one."""
    scene = scene_of(name)
    found, cost = measured(on_grid.solve, scene, voxels=voxels)
    return _row(name, scene, found, math.prod(found.stats["voxels"])) | cost


def _row(name, scene, found, elements):
    stats, known = found.stats, exact_of(name, scene)
    unit = scene.matrix.conductivity or max(scene.conductivities)
    return {
        "lower": found.lower / unit,
        "upper": found.upper / unit,
        "exact": known / unit,
        "inside": bool(found.lower <= known <= found.upper),
        "width_percent": 100 * found.width,
        "inclusions": len(scene.inclusions),
        "elements": elements,
        "temperatures": stats["temperatures"]["unknowns"],
        "fluxes": stats["fluxes"].get("unknowns", 0),
        "unbalanced": stats["unbalanced"],
    }


def answered(name, *, method, **knobs):
    """A method's answer by default, or with the knobs that its name stands for."""
    scene = scene_of(name)
    field, cost = measured(methods.load(method).solve, scene, **knobs)
    return {"k": field.conductivity / scene.matrix.conductivity, **cost}
