"""Scenes as tables of JSON, and back: all numbers in SI, every inclusion by its own, the matrix the first material."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, fields

import numpy as np

from demheat.io.images import read_image
from demheat.io.scenes.scene_table import AXES, LOADS, SHAPES
from demheat.scene import Image, Material, Scene, UniformSource
from demheat.scene.rotations import IDENTITY


@dataclass(frozen=True)
class Sine:
    """A temperature that swings: amplitude times sin(2 pi time / period)."""

    amplitude: float  # K or degrees Celsius
    period: float  # s

    def __call__(self, time):
        """Temperature at a time."""
        return self.amplitude * math.sin(2 * math.pi * time / self.period)


def scene_of(table: dict, *, image=None) -> Scene:
    """The scene of a table."""
    given = table["scene"]
    materials = [_material(each) for each in given["materials"]]
    load = {name: given[name] for name in ("gradient", "initial", "domain") if name in given}
    if "walls" in given:
        load["walls"] = {name: _load(each) for name, each in given["walls"].items()}
    if "sources" in given:
        load["sources"] = [UniformSource(each["power_density"]) for each in given["sources"]]
    if "voxels" in given:
        return Scene.of_image(_image(table, materials, image), **load)
    inclusions = [_shape(each, materials) for each in given["inclusions"]]
    return Scene(given["size"], materials[0], inclusions, **load)


def _material(table):
    return Material(**{name: value for name, value in table.items() if name != "label"})


def _load(table):
    if set(table) == {"temperature"}:
        return table["temperature"]
    if "sine" in table:
        return Sine(**table["sine"])
    kind = next(LOADS[each][0] for each in LOADS if each in table)
    return kind(table["flux"]) if "flux" in table else kind(**table)


def _shape(table, materials):
    values = {name: value for name, value in table.items() if name not in ("shape", "material")}
    if values.get("axis") in AXES:
        values["axis"] = AXES.index(values["axis"])
    return SHAPES[table["shape"]](**values, material=materials[table["material"]])


def _image(table, materials, path):
    given = table["scene"]["voxels"]
    if path is None:
        raise ValueError(f"image of {table['name']!r}: not shipped; give the path of its labels: {given['where']}")
    labels = {each["label"]: material for each, material in zip(table["scene"]["materials"], materials, strict=True)}
    found = read_image(path, materials=labels, voxel=given["voxel"])
    digest = label_digest(found.labels)
    if list(found.shape) != given["shape"] or digest != given["sha256"]:
        raise ValueError(
            f"image = {str(path)!r}: shape {found.shape} and SHA-256 {digest} of its labels; must be "
            f"{tuple(given['shape'])} and {given['sha256']}"
        )
    return found


def label_digest(labels) -> str:
    """SHA-256 of labels as bytes, the last index fastest."""
    return hashlib.sha256(np.ascontiguousarray(labels, dtype=np.uint8).tobytes()).hexdigest()


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
