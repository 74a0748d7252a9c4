"""What a method may need of a scene, and what it is told that the scene has instead: behind `Scene.require`."""

from collections.abc import Iterator

import numpy as np

from demheat.scene.checks import check_differences
from demheat.scene.edges import SLOWEST, edge_order
from demheat.scene.parts import driver


def _one_pair(scene):
    names = sorted(scene.walls)
    held = len(scene.wall_temperatures) == len(names)
    return held and len(names) == 2 and names[0][0] == names[1][0]


# Walls that a method can be limited to, for scenes that have walls.
WALLS = {
    "none": lambda scene: False,
    "one isothermal pair": _one_pair,
    # All that have a temperature are on one axis: none of them meet.
    "isothermal ones apart": lambda scene: len({name[0] for name in scene.wall_temperatures}) <= 1,
    "flat": lambda scene: scene.domain != "sphere" and "round" not in scene.walls,
    "flat or a sphere's": lambda scene: scene.domain == "sphere" or "round" not in scene.walls,
}


# Who takes what few do, for the end of a message.
EXCHANGE = "heat exchanged with surroundings is for the DEM and finite elements, in time also for series of slabs"
IMAGE = "images are for FFT, finite elements, the DEM and bounds on voxels"
TENSOR = "tensors are for steady states of finite elements and of voxels"
PERFECT = "perfect conductors are for steady states of the DEM, finite elements, FFT, multipoles and exact forms"
DEPENDENCE = "that is for steady states of the DEM and finite elements"


def _tensors(scene):
    if scene.anisotropic:
        number = next(n for n, material in enumerate(scene.materials) if not material.isotropic)
        yield f"Material.conductivity in phase {number} is a tensor", TENSOR


def _dependences(scene):
    if scene.varies:
        number = next(n for n, material in enumerate(scene.materials) if material.dependence is not None)
        yield f"Material.dependence in phase {number}, a conductivity that follows the temperature", DEPENDENCE


def _perfect(scene):
    if scene.perfect:
        number = next(n for n, material in enumerate(scene.materials) if material.perfect)
        yield f"Material.conductivity in phase {number} is infinite", PERFECT


# What few methods take of materials.
MATERIALS = {"anisotropy": _tensors, "dependence": _dependences, "perfect": _perfect}


def check_steady(scene) -> None:
    """Raise unless a Scene has a steady state under loads that do not depend on time."""
    if scene.sources or scene.domain != "box":
        what = "heat sources" if scene.sources else f"a {scene.domain}"
        raise NotImplementedError(f"{what}: only transients take them, by `evolve`, which is in Python alone")
    changing = [name for name, load in (scene.walls or {}).items() if callable(driver(load))]
    if changing:
        raise ValueError(f"Scene.walls: {changing} depend on time; must be numbers for a steady solution")
    check_differences(scene.walls or {})
    if not scene.periodic and not scene.imposed_temperatures:
        raise ValueError(
            f"Scene.walls = {dict(scene.walls)}: a steady solution needs at least one wall with a temperature, its own "
            "or that of surroundings"
        )
    order = edge_order(scene)
    if order < SLOWEST:
        raise NotImplementedError(
            "edges of boxes meet where good and bad conductors alternate: errors of any elements go with their size to "
            f"the power {order:.2g} there, so that no number of them is enough (see demheat.scene.edges); must be "
            "boxes that keep apart or share a face, or contrasts below 25"
        )


def check_transient(scene) -> None:
    """Raise ValueError unless a Scene has all that a transient needs: walls, initial temperature, heat capacities."""
    if scene.periodic:
        raise ValueError("Scene.gradient: a transient needs walls instead, or insulation all round")
    if scene.initial is None:
        raise ValueError("Scene.initial = None: a transient needs the temperature at time 0")
    for phase, material in enumerate(scene.materials):
        for name in ("density", "heat_capacity"):
            if getattr(material, name) is None:
                raise ValueError(f"Material.{name} = None in phase {phase}: a transient needs it; must be > 0")


def refusal(found: str, knows: str, others: str) -> str:
    """One sentence: what is in a Scene, what a method knows instead, and who can."""
    # A remedy of the method's own goes before those of others; perfect conductors have none.
    reasons = [others] if others == PERFECT else [knows] if "; use " in knows else [knows, others]
    return ": ".join(filter(None, (found, "; ".join(filter(None, reasons)))))


def refusals(scene, *, walls, domain, shapes, nested, pores, takes) -> Iterator[tuple[str, str]]:
    """What in a Scene a method cannot do, one after the other, and who can where only few do."""
    if scene.image is not None and "image" not in takes:
        yield "Scene.image", IMAGE
    for name, load in scene.wall_exchanges.items() if "exchange" not in takes else ():
        yield f"Scene.walls[{name!r}] = {load}", EXCHANGE
    for name in MATERIALS:
        if name not in takes:
            yield from MATERIALS[name](scene)
    if walls is not None and not scene.periodic and not WALLS[walls](scene):
        yield f"Scene.walls = {dict(scene.walls)}", ""
    if domain is not None and scene.domain != domain:
        yield f"a {scene.domain}", ""
    if shapes == () and scene.inclusions:
        yield f"inclusions in a {scene.domain}", ""
    known = shapes if callable(shapes) else lambda shape: shapes is None or isinstance(shape, shapes)
    if not all(map(known, scene.inclusions)):
        number = next(i for i, shape in enumerate(scene.inclusions) if not known(shape))
        kind = scene.inclusions[number].kind
        yield f"{'an' if kind[0] in 'aeio' else 'a'} {kind}, Scene.inclusions[{number}]", ""
    parents = np.zeros(1) if nested else scene.parents()
    if np.any(parents):
        number = int(np.flatnonzero(parents)[0])
        yield f"Scene.inclusions[{number - 1}], nested in [{parents[number] - 1}]", ""
    if not pores and np.any(scene.mean_conductivities == 0):
        yield "a conductivity is 0", ""
    resisting = () if "resistance" in takes else np.flatnonzero(scene.resistances)
    if len(resisting):
        number = int(resisting[0]) - 1
        yield (
            f"Scene.inclusions[{number}].resistance = {scene.inclusions[number].resistance:g} m2 K/W, where only "
            "perfect interfaces, 0, are known",
            "",
        )
