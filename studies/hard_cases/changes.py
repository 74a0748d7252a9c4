"""What must not change when a scene is turned, mirrored, moved or measured in other units; swapped phases and duality.

Grids go with a scene that is turned or mirrored; packings do not, and are held to what both answers may be off.
"""

from dataclasses import replace

import numpy as np

from demheat.method import DEGREE
from demheat.referee import value_error
from demheat.scene import Layer, Material, Scene, Sphere
from studies.common.answers import answer
from studies.hard_cases.scenes import in_units
from studies.hard_cases.verdicts import RIGHT, half_interval
from studies.harness import methods

ASKED = ("dem", "fft", "multipole")
# What is exact but for the solver: a tolerance of 1e-5 to 1e-9, and rounding at contrasts of 1e6.
SOLVED = 1e-3
# Of elements that go with the scene: tolerances of the solvers, and rounding at contrasts of 1e6.
SAME = 1e-4
EXACT = {"units": 1e-4, "turned": SAME, "mirrored": SAME}


def relations(scene: Scene, found, rng: np.random.Generator) -> dict:
    """How many relations were tried on a scene, how many are broken, and which."""
    tried, broken = 0, []
    for way in (each for each in found if each.name in ASKED):
        first = _answered(way, scene, scene)
        for name, other, right in images(scene, rng) if first and first.conductivity else ():
            second = _answered(way, other, scene)
            if second is None:
                continue
            tried += 1
            off = float(value_error(second.conductivity, right(first.conductivity)))
            if not holds(name, off, way, first, second):
                broken.append(f"{way.name}, {name}: {100 * off:+.3g} %")
    return {"relations": tried, "broken": len(broken), "broken_words": "; ".join(broken)}


def holds(name: str, off: float, way, first, second) -> bool:
    """Whether a relation between two fields holds that is off by so much, relative."""
    # Schulgasser's inequality: swapped phases conduct at least so much.
    return (-off if name == "swapped" else abs(off)) <= limit(name, way, first, second)


def limit(name: str, way, first, second) -> float:
    """Largest difference that keeps a relation."""
    turns = "rotation" not in way.method.exceptions
    if way.method.resolution == DEGREE or name == "dual":
        return SOLVED
    if name in EXACT and (turns or name == "units"):
        return EXACT[name]
    return sum(max(RIGHT, half_interval(each, 1.0), half_interval(each, -1.0)) for each in (first, second))


def images(scene: Scene, rng: np.random.Generator):
    """Names, changed scenes, and what the first one's conductivity makes of theirs."""
    metre, watt = 10.0 ** rng.choice([-9, 9, rng.uniform(-9, 9)], 2)
    yield "units", in_units(scene, metre, watt), lambda k: k * watt
    yield "turned", turned(scene), lambda k: k
    yield "mirrored", mirrored(scene, int(rng.integers(3))), lambda k: k
    if scene.periodic and scene.only(Sphere):
        yield "moved", moved(scene, rng.random(3)), lambda k: k
    k = scene.conductivities
    if scene.only(Layer) and k.min() > 0:
        yield "dual", dual(scene), lambda found: 1 / found
    if scene.periodic and _is_cubic_array(scene) and k.min() > 0:
        yield "swapped", swapped(scene), lambda found: k[0] * k[1] / found


def turned(scene: Scene) -> Scene:
    """Axes x, y, z become y, z, x."""
    order = (2, 0, 1)
    size = [scene.size[axis] for axis in order]
    inclusions = [each.turned(order) for each in scene.inclusions]
    if scene.periodic:
        return replace(scene, size=size, inclusions=inclusions, gradient=tuple(scene.gradient[axis] for axis in order))
    walls = {"yzx"["xyz".index(name[0])] + name[1]: value for name, value in scene.walls.items()}
    return replace(scene, size=size, inclusions=inclusions, walls=walls)


def mirrored(scene: Scene, axis: int) -> Scene:
    """The scene in a mirror across an axis."""
    inclusions = [_mirrored(each, axis, scene.size[axis]) for each in scene.inclusions]
    if scene.periodic:
        flip = np.where(np.arange(3) == axis, -1.0, 1.0)
        return replace(scene, inclusions=inclusions, gradient=tuple(flip * scene.gradient))
    swap = {"xyz"[axis] + "-": "xyz"[axis] + "+", "xyz"[axis] + "+": "xyz"[axis] + "-"}
    return replace(scene, inclusions=inclusions, walls={swap.get(name, name): v for name, v in scene.walls.items()})


def _mirrored(shape, axis, length):
    if isinstance(shape, Layer):
        return replace(shape, start=length - shape.stop, stop=length - shape.start) if shape.axis == axis else shape
    center = np.array(shape.center)
    center[axis] = length - center[axis]
    return replace(shape, center=center)


def moved(scene: Scene, shift) -> Scene:
    """The spheres of a periodic cell moved by parts of its sides."""
    size = np.array(scene.size)
    return replace(
        scene, inclusions=[replace(each, center=(each.center + shift * size) % size) for each in scene.inclusions]
    )


def dual(scene: Scene) -> Scene:
    """Reciprocal conductivities and the load turned by a right angle: conducts 1 / k (Keller 1964)."""
    inclusions = [replace(each, material=_reciprocal(each.material)) for each in scene.inclusions]
    normal = scene.inclusions[0].axis
    along = int(np.argmax(np.abs(scene.gradient))) if scene.periodic else scene.axis
    other = (normal + 1) % 3 if along == normal else normal
    same = {"size": scene.size, "matrix": _reciprocal(scene.matrix), "inclusions": inclusions}
    if scene.periodic:
        return Scene(**same, gradient=tuple(np.eye(3)[other]))
    return Scene(**same, walls={"xyz"[other] + "-": 20.0, "xyz"[other] + "+": 50.0})


def _reciprocal(material):
    return Material(1 / material.conductivity)


def swapped(scene: Scene) -> Scene:
    """Matrix of the spheres' material, and they of its."""
    inside, outside = scene.inclusions[0].material, scene.matrix
    return replace(scene, matrix=inside, inclusions=[replace(each, material=outside) for each in scene.inclusions])


def _is_cubic_array(scene):
    from references import exact

    try:
        return exact.solve(scene).stats["form"].endswith("array")
    except NotImplementedError:
        return False


def _answered(way, scene, first):
    """A field by a method in double precision, on elements as in the first scene; None if it refuses, or warns."""
    knobs = {name: value for name, value in way.knobs.items() if name != "precision"}
    if "voxels" in knobs:
        spacing = way.element * (scene.volume / first.volume) ** (1 / 3)
        knobs["voxels"] = tuple(max(1, round(side / spacing)) for side in scene.size)
    field, said, refusal = answer(lambda: methods.load(way.method.module).solve(scene, **knobs))
    return None if refusal is not None or said else field
