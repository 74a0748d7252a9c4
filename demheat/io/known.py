"""Scenes with known answers, as `benchmark/` has them: files of JSON that need no Python, read."""

import hashlib
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from demheat.io.images import read_image
from demheat.io.scenes.scene_table import AXES, LOADS, SHAPES
from demheat.scene import Material, Scene, UniformSource


class Known(NamedTuple):
    """What is known of a scene."""

    by: str  # "closed form", "series", "multipoles", "certain bounds" or "published"
    conductivity: float | None  # W/(m K): Effective, along the load; None where no single number is asked for
    error: float | None  # W/(m K): The true one is no farther away
    error_is: str  # What that rests on: "certain", "rounding" or "estimate"
    positions: np.ndarray  # (n, 3) float array, m
    times: np.ndarray | None  # (n,) float array, s; None in a steady state
    # (n,) float array, K or degrees Celsius: There; of a periodic cell less that of the first point
    temperature: np.ndarray
    flux: np.ndarray | None  # (n, 3) float array, W/m2
    temperature_error: float | None  # K: As `error`
    flux_error: float | None  # W/m2: As `error`; None without fluxes


def known_of(table: dict) -> Known:
    """What the file of a scene says is known of it."""
    known = table["known"]
    number = known.get("conductivity", {"value": None, "error": None, "error_is": ""})
    fields = known.get("fields", {"points": (), "temperature_error": None})
    points = fields["points"]
    timed, flowing = points and "time" in points[0], points and "flux" in points[0]
    return Known(
        by=known["by"],
        conductivity=number["value"],
        error=number["error"],
        error_is=number["error_is"],
        positions=np.array([each["position"] for each in points]).reshape(-1, 3),
        times=np.array([each["time"] for each in points]) if timed else None,
        temperature=np.array([each["temperature"] for each in points]),
        flux=np.array([each["flux"] for each in points]) if flowing else None,
        temperature_error=fields["temperature_error"],
        flux_error=fields.get("flux_error"),
    )


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
