"""Groups of zarr that hold an image in several sizes, as OME writes them: the finest, its axes and the voxel it tells.

Goldberg et al., OME-Zarr 0.4 and 0.5 (ngff.openmicroscopy.org): `multiscales` in the attributes of a group.
"""

import json
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

# Bytes of a file of attributes that are read.
LONGEST = 2**20
UNITS = {"meter": 1.0, "centimeter": 1e-2, "millimeter": 1e-3, "micrometer": 1e-6, "nanometer": 1e-9, "angstrom": 1e-10}
SPACE = ("x", "y", "z")


class Finest(NamedTuple):
    """The array of a group that has the smallest voxels."""

    path: Path
    axes: tuple[str, ...]  # As the array has them, such as ("c", "z", "y", "x")
    voxel: tuple[float, float, float] | None  # (3,) float, m: Along x, y, z; None without a unit of each


class Turned:
    """An array whose axes are x, y and z; others have one entry each."""

    def __init__(self, array, axes):
        self.array, self.axes = array, axes
        self.order = [axes.index(axis) for axis in SPACE]
        self.shape, self.dtype, self.ndim = tuple(array.shape[place] for place in self.order), array.dtype, 3

    def __getitem__(self, part):
        part = part if isinstance(part, tuple) else (part,)
        parts = dict(zip(SPACE, (*part, *[slice(None)] * (3 - len(part))), strict=True))
        found = self.array[tuple(parts.get(axis, 0) for axis in self.axes)]
        kept = [axis for axis in self.axes if axis in SPACE]
        return np.ascontiguousarray(np.transpose(found, [kept.index(axis) for axis in SPACE]))


def finest(path: Path) -> Finest | None:
    """What a folder tells of the image that it holds in several sizes; None if it is no such group."""
    told = _attributes(path)
    if "multiscales" not in told:
        return None
    image = told["multiscales"][0]
    axes = tuple(str(axis["name"] if isinstance(axis, dict) else axis) for axis in image.get("axes", "tczyx"))
    if sorted(set(axes) & set(SPACE)) != list(SPACE):
        raise ValueError(f"{path}: axes {', '.join(axes)}; must have x, y and z")
    first, *_ = image["datasets"]
    own = path / str(first["path"])
    if not own.resolve().is_relative_to(path.resolve()):
        raise ValueError(f"{path}: its first array, {first['path']!r}, lies outside; must be in this folder")
    return Finest(own, axes, _voxel(image, first, axes))


def as_body(path: Path, array, axes):
    """The array with axes x, y and z; ValueError where another axis has several entries."""
    if len(array.shape) != len(axes):
        raise ValueError(f"{path}: an array of {len(array.shape)} axes, {len(axes)} are told of: {', '.join(axes)}")
    for axis, n in zip(axes, array.shape, strict=True):
        if axis not in SPACE and n > 1:
            raise ValueError(f"{path}: has {n} entries along {axis!r}; must be one image of one channel")
    return Turned(array, axes)


def _attributes(path):
    """Attributes of a group; in version 3 those of OME."""
    new, old = path / "zarr.json", path / ".zattrs"
    file = new if new.is_file() else old
    if not file.is_file():
        return {}
    with file.open(encoding="utf-8") as stream:
        told = json.loads(stream.read(LONGEST))
    return told.get("attributes", {}).get("ome", {}) if file == new else told


def _voxel(image, dataset, axes):
    """Edges along x, y and z, the scales of the array and of all of the group multiplied."""
    scale = np.ones(len(axes))
    for each in (*dataset.get("coordinateTransformations", ()), *image.get("coordinateTransformations", ())):
        if each["type"] == "scale":
            scale = scale * np.array(each["scale"], dtype=float)
    units = {each["name"]: UNITS.get(each.get("unit"), 0.0) for each in image.get("axes", ()) if isinstance(each, dict)}
    edges = [float(scale[axes.index(axis)]) * units.get(axis, 0.0) for axis in SPACE]
    return tuple(edges) if all(0 < edge < math.inf for edge in edges) else None
