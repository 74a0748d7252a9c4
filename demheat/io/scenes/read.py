"""Scenes read from TOML files, and what else a file asks for."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from demheat.declared import all_methods
from demheat.io.scenes.scene_table import scene_of
from demheat.io.scenes.source import Source, read_source
from demheat.io.scenes.table import Table
from demheat.io.scenes.units import LENGTH, PLAIN, part_of
from demheat.io.words import as_toml, nearest
from demheat.scene import Scene


class SceneFile(NamedTuple):
    """What a file holds."""

    path: Path
    scene: Scene
    methods: Mapping[str, dict]  # Knobs of the methods of [solve], by their names
    accuracy: float | None
    source: Source  # For messages: `source.error(("solve", "fft", "voxels"), ": ...")`


def read(path) -> Scene:
    """Read a scene from a TOML file, see `demheat.io.scenes`.

    Parameters
    ----------
    path : path

    Returns
    -------
    Scene

    Raises
    ------
    ValueError
        One line with file, line and key, what is there and what would be valid.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from demheat.io import scenes
    >>> text = '''size_mm = [1, 1, 1]
    ... matrix = "epoxy"
    ... gradient_K_mm = [0, 1, 0]
    ... [materials.epoxy]
    ... conductivity = 0.195'''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "scene.toml")
    ...     _ = path.write_text(text)
    ...     scene = scenes.read(path)
    >>> scene.size, scene.matrix.conductivity
    ((0.001, 0.001, 0.001), 0.195)
    """
    return read_file(path).scene


def read_file(path) -> SceneFile:
    """Read a scene and what else a TOML file holds.

    Parameters
    ----------
    path : path

    Returns
    -------
    SceneFile

    Raises
    ------
    ValueError
        As `read`.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from demheat import gallery
    >>> from demheat.io import scenes
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "scene.toml")
    ...     scenes.write(gallery.slab(), path)
    ...     found = scenes.read_file(path)
    >>> found.path.name, found.accuracy
    ('scene.toml', None)
    """
    source = read_source(path)
    table = Table(source, (), source.values)
    scene = scene_of(source, table)
    methods = _methods(table)
    return SceneFile(source.path, scene, methods, _accuracy(table), source)


def _accuracy(table):
    """A part, or text of per cent."""
    value = table.values.get("accuracy")
    if isinstance(value, str):
        accuracy = part_of(value) if "%" in value else math.nan
    else:
        accuracy = table.number("accuracy", PLAIN)
    if accuracy is not None and not 1e-9 <= accuracy < 1:
        told = 'must be a number from 1e-9 to below 1, as 0.01, or text of per cent, as "1 %"'
        raise table.error("accuracy", f" = {as_toml(value)}: {told}")
    return accuracy


def _methods(table):
    """Knobs of the methods that [solve] names."""
    solve = table.table("solve", {})
    methods = {}
    for name in solve.values:
        if name in ("method", "methods"):
            raise solve.error(name, ": each method has a table of its own, as [solve.fft]; it may be empty")
        if name not in all_methods():
            near = nearest(name, all_methods()) or f"; must be one of {', '.join(all_methods())}"
            raise solve.error(name, f": no such method{near}")
        own = solve.table(name)
        methods[name] = dict(_knob(own, all_methods()[name], knob) for knob in own.values)
    return methods


def _knob(table, method, knob):
    """A knob and its value; a length may have a unit."""
    name = method.resolution.knob if method.resolution is not None and method.resolution.metric else None
    if name and knob in (name, *(f"{name}_{unit}" for unit in LENGTH.suffixes)):
        return name, table.number(name, LENGTH)
    value = table.values[knob]
    if isinstance(value, dict) or not isinstance(value, (bool, int, float, str, list)):
        raise table.error(knob, f" = {as_toml(value)}: must be a number, text, a flag or an array")
    return knob, value
