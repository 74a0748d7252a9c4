"""An image from the tables of a file: where it is, what is made of it, which material each label is."""

import re

from demheat.io.images import read_image
from demheat.io.scenes.table import Table
from demheat.io.scenes.units import LENGTH, PLAIN
from demheat.io.words import as_toml, nearest
from demheat.runtime.paths import checked_path
from demheat.scene import Image

# What is made of an image's file, see `demheat.io.images.read_image`.
CHANGES = ("crop", "coarsen", "threshold")
LABEL = re.compile(r"-?\d+")


def image_of(table: Table, materials: dict) -> Image:
    """The image of a file of a scene."""
    own = table.table("image")
    own.only({"file": PLAIN, "voxel": LENGTH, "labels": PLAIN, **dict.fromkeys(CHANGES, PLAIN)})
    path = checked_path(table.source.path.parent / own.text("file", ...))
    labels, voxel = _labelled(table, own, materials), _voxel(own)
    changes = {name: own.values[name] for name in CHANGES if own.key(name) is not None}
    try:
        return read_image(path, materials=labels, voxel=voxel, **changes)
    except (ValueError, ImportError) as error:
        told = str(error).removeprefix(f"{path}: ").removeprefix("Image.")
        key = next((name for name in ("voxel", *CHANGES) if told.startswith(f"{name} =")), "file")
        told = told.partition(": ")[2] if key in CHANGES else told
        raise type(error)(str(own.error(own.keys[key], f" = {as_toml(own.values[own.keys[key]])}: {told}"))) from None


def _labelled(table, own, materials):
    """Materials of labels: by their names, or by the table of labels of each name."""
    labels, named = {}, own.table("labels")
    if named is None:
        for name, material in materials.items():
            if not LABEL.fullmatch(name):
                raise table.error(
                    ("materials", name), ": must be a label of the image, a whole number, or in its labels"
                )
            labels[int(name)] = material
        return labels
    for name, value in named.values.items():
        if name not in materials:
            raise named.error(name, f": must be the name of one of [materials]{nearest(name, materials)}")
        for label in value if isinstance(value, list) else [value]:
            if isinstance(label, bool) or not isinstance(label, int):
                raise named.error(name, f" = {as_toml(value)}: must be a label, a whole number, or an array of them")
            if label in labels:
                raise named.error(name, f" = {as_toml(value)}: label {label} has a material already")
            labels[label] = materials[name]
    return labels


def _voxel(table):
    """Edges of a voxel: one length or three, or None."""
    key = table.key("voxel", LENGTH)
    if key is None or not isinstance(table.values[key], list):
        return table.number("voxel", LENGTH)
    return table.vector("voxel", LENGTH)
