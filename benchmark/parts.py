"""Scenes as tables of JSON: all numbers in SI, every inclusion by its own, the matrix the first material."""

from dataclasses import fields

import numpy as np

from demheat.io.known import Sine
from demheat.io.scenes.scene_table import AXES, LOADS
from demheat.scene import Image, Scene
from demheat.scene.rotations import IDENTITY


def table_of(scene: Scene) -> dict:
    """The table of a scene."""
    materials = list(dict.fromkeys(scene.materials))
    table = {"size": scene.size}
    if scene.domain != "box":
        table["domain"] = scene.domain
    table["materials"] = [_plain(each) for each in materials]
    table["inclusions"] = [_inclusion(each, materials) for each in scene.inclusions]
    if scene.periodic:
        table["gradient"] = scene.gradient
    else:
        table["walls"] = {name: _wall(load) for name, load in scene.walls.items()}
    if scene.initial is not None:
        table["initial"] = float(scene.initial)
    if scene.sources:
        table["sources"] = [{"power_density": each.power_density} for each in scene.sources]
    return table


def _plain(part):
    values = {each.name: getattr(part, each.name) for each in fields(part)}
    return {name: value for name, value in values.items() if value is not None}


def _inclusion(shape, materials):
    values = _plain(shape) | {"material": materials.index(shape.material)}
    # What is as usual is left out.
    for name, usual in (("resistance", 0.0), ("rotation", IDENTITY)):
        if values.get(name) == usual:
            del values[name]
    if isinstance(values.get("axis"), int):
        values["axis"] = AXES[values["axis"]]
    return {"shape": shape.kind, **values}


def _wall(load):
    if isinstance(load, int | float):
        return {"temperature": float(load)}
    if isinstance(load, Sine):
        return {"sine": _plain(load)}
    kind = next(name for name, (known, _) in LOADS.items() if type(load) is known)
    return {"flux": load.value} if kind == "flux" else _plain(load)


def labels(scene: Scene, shape) -> np.ndarray:
    """Image of a scene: each voxel has the number of the material of its centre, (nx, ny, nz) uint8 array.

    Materials are numbered as in the table of the scene, the matrix 0.
    """
    middles = [(np.arange(n) + 0.5) * (length / n) for n, length in zip(shape, scene.size, strict=True)]
    points = np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1).reshape(-1, 3)
    return labels_at(scene, points).reshape(tuple(shape))


def labels_at(scene: Scene, points) -> np.ndarray:
    """Number of the material at points, (n,) uint8 array."""
    materials = list(dict.fromkeys(scene.materials))
    number = np.array([materials.index(each) for each in scene.materials], dtype=np.uint8)
    return number[scene.phase_at(points)]


def image_of(scene: Scene, shape) -> Image:
    """The image of `labels`, as an `Image`."""
    materials = dict(enumerate(dict.fromkeys(scene.materials)))
    voxel = tuple(length / n for length, n in zip(scene.size, shape, strict=True))
    return Image(labels(scene, shape), voxel, materials)
