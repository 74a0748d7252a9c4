"""Scenes written as TOML: what is read back is the same scene to the last bit."""

import hashlib
import re
from dataclasses import fields

import numpy as np

from demheat.io.scenes.scene_table import AXES, LOADS, SHAPES, SOURCES
from demheat.io.surfaces import write_surface
from demheat.runtime.paths import checked_path, replaced
from demheat.scene import Scene, SurfaceMesh, check_scene

BARE = re.compile(r"[A-Za-z0-9_-]+")


def write(scene: Scene, path) -> None:
    """Write a scene as a TOML file, in SI; an interrupted write leaves no file, and an old one as it was.

    The labels of an image go into a file of the same name that ends in .npy, beside it; the triangles of surface meshes
    into files that end in -0.obj, -1.obj, ..., the numbers of the inclusions.

    Parameters
    ----------
    scene : Scene
        Without functions of time or place, which a file cannot hold.
    path : path

    Raises
    ------
    ValueError
        If the scene holds what a file cannot.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from demheat import gallery
    >>> from demheat.io import scenes
    >>> scene = gallery.sphere_in_cube(5.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "scene.toml")
    ...     scenes.write(scene, path)
    ...     scenes.read(path) == scene
    True
    """
    path = checked_path(path)
    check_scene(scene)
    text = text_of_scene(scene, stem=path.stem)
    if scene.image is not None:
        with replaced(path.with_suffix(".npy")) as part:
            np.save(part, scene.image.labels)
    for number, shape in enumerate(scene.inclusions):
        if isinstance(shape, SurfaceMesh):
            write_surface(shape, path.with_name(_surface_file(path.stem, number)))
    with replaced(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")


def text_of_scene(scene: Scene, *, stem: str | None = None) -> str:
    """Text of the file of a scene; files beside it begin with `stem`, without which what they hold is a digest."""
    check_scene(scene)
    names = _names(scene)
    blocks = [_head(scene, names)]
    if scene.image is not None:
        blocks += _image(scene.image, stem)
    else:
        blocks += [_block(f"[materials.{name}]", _material(material)) for material, name in names.items()]
    blocks += [_block("[[inclusions]]", _inclusion(k, shape, names, stem)) for k, shape in enumerate(scene.inclusions)]
    if scene.walls:
        loads = {name: _load(scene, name, load) for name, load in scene.walls.items()}
        blocks.append(_block("[walls]", loads))
    blocks += [_block("[[sources]]", _source(each)) for each in scene.sources]
    return "\n".join(blocks)


def _image(image, stem):
    """Blocks of an image and of the materials of its labels."""
    where = {"digest": image.digest} if stem is None else {"file": f"{stem}.npy"}
    blocks = [_block("[image]", where | {"voxel": image.voxel})]
    return blocks + [_block(f"[materials.{label}]", _plain(each)) for label, each in image.materials.items()]


def _names(scene):
    """Names of the materials, the matrix first."""
    names = {}
    for material in scene.materials:
        names.setdefault(material, f"material-{len(names)}" if names else "matrix")
    return names


def _head(scene, names):
    values = {"size": scene.size, "matrix": names[scene.matrix]} if scene.image is None else {}
    if scene.domain != "box":
        values["domain"] = scene.domain
    if scene.gradient is not None:
        values["gradient"] = scene.gradient
    if callable(scene.initial):
        raise ValueError("Scene.initial: a file cannot hold a function; must be a number or None")
    if scene.initial is not None:
        values["initial"] = _warmth(scene, float(scene.initial))
    return _block("", values)


def _plain(part, **changed):
    """Fields of a material, shape or source that are not None."""
    values = {field.name: changed.get(field.name, getattr(part, field.name)) for field in fields(part)}
    return {name: value for name, value in values.items() if value is not None}


def _material(material):
    return _plain(material, dependence=material.dependence and material.dependence.points)


def _inclusion(number, shape, names, stem=None):
    own = {"material": names[shape.material], "resistance": shape.resistance or None}
    if isinstance(shape, SurfaceMesh):
        where = {"digest": _digest(shape)} if stem is None else {"file": _surface_file(stem, number)}
        return {name: value for name, value in ({"shape": shape.kind} | where | own).items() if value is not None}
    if SHAPES.get(shape.kind) is not type(shape):
        known = ", ".join([*SHAPES, SurfaceMesh.kind])
        raise ValueError(f"Scene.inclusions[{number}] = {shape!r}: must be one of {known} in a file")
    changed = _axis(shape) | own
    if "members" in shape.stored.values():
        # Of its material, without resistances: neither stands there again.
        changed["shapes"] = tuple(_inclusion(number, each, {each.material: None}) for each in shape.shapes)
    return {"shape": shape.kind, **_plain(shape, **changed)}


def _surface_file(stem, number):
    return f"{stem}-{number}.obj"


def _digest(mesh):
    """What tells one surface from another."""
    return hashlib.sha256(mesh.vertices.tobytes() + mesh.triangles.tobytes()).hexdigest()


def _source(source):
    kind = next(name for name, known in SOURCES.items() if type(source) is known)
    return {"kind": kind, **_plain(source, **_axis(source))}


def _axis(part):
    """An axis of the box by its letter; directions are numbers."""
    return {"axis": AXES[part.axis]} if isinstance(getattr(part, "axis", None), int) else {}


def _load(scene, name, load):
    kind = next((each for each in LOADS if type(load) is LOADS[each][0]), None)
    values = {"flux": load.value} if kind == "flux" else _plain(load) if kind else {"": load}
    if any(map(callable, values.values())):
        raise ValueError(f"Scene.walls[{name!r}]: a file cannot hold a function of time; must be a number or a Flux")
    if not kind:
        return _warmth(scene, float(load))
    numbers = {key: float(value) for key, value in values.items()}
    return {key: _warmth(scene, value) if key == "temperature" else value for key, value in numbers.items()}


def _warmth(scene, value):
    """A temperature; where a wall radiates it is one in kelvin, which files are to say."""
    return f"{value!r} K" if scene.radiates else value


def _block(header, values):
    lines = [f"{name if BARE.fullmatch(name) else _text(name)} = {_value(value)}" for name, value in values.items()]
    return "".join(f"{line}\n" for line in ([header] if header else []) + lines)


def _value(value):
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{name} = {_value(part)}" for name, part in value.items()) + "}"
    if isinstance(value, tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    # The shortest text that reads back to the same bits.
    return _text(value) if isinstance(value, str) else repr(float(value))


def _text(word):
    return '"' + word.replace("\\", "\\\\").replace('"', '\\"') + '"'
