"""A scene from the tables of a file: keys are the arguments of `Scene`, `Material`, `Sphere`, ... and their units.

Shapes say what of them is stored (`Shape.stored`); a new source adds a line to its table here.
"""

from dataclasses import MISSING, fields
from functools import partial

from demheat.io.scenes.image_table import image_of
from demheat.io.scenes.materials import made_material
from demheat.io.scenes.placed import Placed, placed_error
from demheat.io.scenes.shape_names import meant
from demheat.io.scenes.source import Source
from demheat.io.scenes.spheres import spheres_of
from demheat.io.scenes.table import Table
from demheat.io.scenes.units import (
    COEFFICIENT,
    FLUX,
    GRADIENT,
    LENGTH,
    PLAIN,
    POWER_DENSITY,
    RESISTANCE,
    TEMPERATURE,
    VELOCITY,
)
from demheat.io.surfaces import UNITS, read_surface
from demheat.io.words import as_toml, nearest
from demheat.scene import (
    ROUND_AXES,
    WALLS,
    Convection,
    Flux,
    MovingCylinder,
    Radiation,
    Scene,
    SurfaceMesh,
    UniformSource,
    shapes,
)
from demheat.scene.shapes.union import may_join

AXES = ("x", "y", "z")
# What numbers of a field are, by the words of `Shape.stored` and of sources.
FIELDS = {
    "length": (LENGTH, 1),
    "point": (LENGTH, 3),
    "lengths": (LENGTH, 3),
    "place": (LENGTH, 2),
    "velocity": (VELOCITY, 2),
    "power density": (POWER_DENSITY, 1),
    "resistance": (RESISTANCE, 1),
    "direction": (PLAIN, 3),
    # No numbers: a letter, three rows, true or false, tables of members.
    "axis": None,
    "rotation": None,
    "flag": None,
    "members": None,
}
# Shapes by their names in files, those that a file can hold; which of them may be members of a union.
SHAPES = {kind.kind: kind for kind in (getattr(shapes, name) for name in shapes.__all__) if kind.stored}
MEMBERS = {name: kind for name, kind in SHAPES.items() if may_join(kind)}
SOURCES = {"uniform": UniformSource, "moving-cylinder": MovingCylinder}
# Of each, as of shapes in `Shape.stored`.
STORED = {
    UniformSource: {"power_density": "power density"},
    MovingCylinder: {
        "axis": "axis",
        "diameter": "length",
        "power_density": "power density",
        "start": "place",
        "velocity": "velocity",
        "clip": "flag",
    },
}
# Loads of walls that are no temperatures: known by the first of their keys.
LOADS = {
    "flux": (Flux, {"flux": FLUX}),
    "coefficient": (Convection, {"coefficient": COEFFICIENT, "temperature": TEMPERATURE}),
    "emissivity": (Radiation, {"emissivity": PLAIN, "temperature": TEMPERATURE}),
}
# Keys of a file.
KEYS = {"size": LENGTH, "gradient": GRADIENT, "initial": TEMPERATURE} | dict.fromkeys(
    ("matrix", "materials", "inclusions", "walls", "sources", "domain", "image", "solve", "accuracy"), PLAIN
)
# What an image is itself.
IMAGED = ("size", "matrix", "inclusions", "domain")


def scene_of(source: Source, table: Table) -> Scene:
    """The scene of a file."""
    table.only(KEYS)
    materials = _materials(table)
    if "image" in table.values:
        return _imaged(table, materials)
    size = table.vector("size", LENGTH, ...)
    if len(size) != 3 or not min(size) > 0:
        key = table.keys["size"]
        raise table.error(key, f" = {as_toml(table.values[key])}: all three lengths must be > 0 m")
    matrix = _material(table, "matrix", materials)
    placed = _inclusions(table, materials, size)
    load = _loaded(table) | {"domain": table.text("domain", "box", among=tuple(ROUND_AXES))}
    return _made_scene(table, placed, partial(Scene, size, matrix, [each.shape for each in placed], **load))


def _loaded(table):
    """Loads of a scene."""
    walls, gradient = _walls(table), table.vector("gradient", GRADIENT)
    initial = table.number("initial", TEMPERATURE)
    sources = [_parts(each, "kind", SOURCES, {}) for each in table.tables("sources")]
    return {"walls": walls, "gradient": gradient, "initial": initial, "sources": sources}


def _made_scene(table, placed, make):
    try:
        return make()
    except ValueError as error:
        if "walls" in table.values and table.keys["gradient"] is not None:
            raise table.error(table.keys["gradient"], f": {error}") from None
        raise placed_error(table, placed, error) from None


def _imaged(table, materials):
    """The scene of an image, whose labels are the names of the materials."""
    for name in IMAGED:
        key = table.key(name, KEYS.get(name, PLAIN))
        if key is not None:
            raise table.error(key, ": with an image, which has it itself; must be left out")
    image = image_of(table, materials)
    return _made_scene(table, [], partial(Scene.of_image, image, **_loaded(table)))


def _materials(table):
    """Materials by their names."""
    known = table.table("materials", {})
    return {name: made_material(known.table(name)) for name in known.values}


def _material(table, key, known, default=...):
    """A material by its name in the file, or a table of its own."""
    found = table.needed(key) if default is ... else table.key(key)
    if found is None:
        return default
    value = table.values[found]
    if isinstance(value, dict):
        return made_material(table.table(key))
    if not isinstance(value, str) or value not in known:
        named = ", ".join(map(repr, known)) or "none yet"
        near = nearest(value, known) if isinstance(value, str) else ""
        raise table.error(key, f" = {as_toml(value)}: must be the name of one of [materials], {named}{near}")
    return known[value]


def _inclusions(table, materials, size):
    placed = []
    for each in table.tables("inclusions"):
        place = each.error(None, "").args[0]
        if each.values.get("shape") == SurfaceMesh.kind:
            placed.append(Placed(_surface(each, materials), place))
        elif "file" in each.values:
            default = _material(each, "material", materials, None)
            spheres = spheres_of(each, materials, default, size)
            factor = each.values.get("radius_factor", 1.0)
            placed += [Placed(sphere, f"{place}, {where}", factor) for sphere, where in spheres]
        else:
            placed.append(Placed(_parts(each, "shape", SHAPES, materials), place))
    return placed


def _surface(table, materials):
    """A body by the file of its surface."""
    keys = dict.fromkeys(("shape", "file", "unit", "material"), PLAIN)
    table.only(keys | {"offset": LENGTH, "resistance": RESISTANCE})
    material, path = _material(table, "material", materials), table.source.path.parent / table.text("file", ...)
    unit, offset = table.text("unit", "m", among=tuple(UNITS)), table.vector("offset", LENGTH, (0.0, 0.0, 0.0))
    resistance = table.number("resistance", RESISTANCE, 0.0)
    try:
        return read_surface(path, material, unit=unit, offset=offset, resistance=resistance)
    except ValueError as error:
        key = next((name for name in ("offset", "resistance") if f"{name} = " in str(error)), "file")
        raise table.error(table.keys[key], f" = {as_toml(table.values[table.keys[key]])}: {error}") from None


def _parts(table, key, kinds, materials, material=None):
    """A shape or a source of a table: its kind, then what that is made of; of a union members of its own material."""
    kind = kinds[_kind(table, key, kinds)]
    words = STORED[kind] if kinds is SOURCES else {**kind.stored, "resistance": "resistance"}
    names = {name: (FIELDS[word] or (PLAIN,))[0] for name, word in words.items()}
    table.only({key: PLAIN, **names} | ({"material": PLAIN} if kinds is SHAPES else {}))
    if kinds is SHAPES:
        material = _material(table, "material", materials)
    optional = {each.name for each in fields(kind) if each.default is not MISSING}
    values = {} if kinds is SOURCES else {"material": material}
    for name, word in words.items():
        values[name] = _read(table, name, word, None if name in optional else ..., material)
    return table.made(kind, values)


def _kind(table, key, kinds):
    """The name of a shape or a source; of shapes a body by the file of its surface is one, too."""
    known = tuple(kinds) if kinds is not SHAPES else (*kinds, SurfaceMesh.kind)
    if key not in table.values:
        listed = ", ".join(map(repr, known))
        also = ", or file, of a table of spheres" if kinds is SHAPES else ""
        raise table.error(None, f": {key} is missing; must be one of {listed}{also}")
    return table.text(key, ..., among=known, hint=meant if kinds is not SOURCES else nearest)


def _read(table, name, word, default, material):
    """A field of a shape or a source."""
    if word == "axis":
        return _axis(table, name)
    if word == "rotation":
        return table.value(name, list, "three rows of three numbers", default)
    if word == "members":
        return [_parts(each, "shape", MEMBERS, {}, material) for each in table.tables(name)]
    if word == "flag":
        return table.value(name, bool, "true or false", default)
    quantity, length = FIELDS[word]
    return (table.number if length == 1 else table.vector)(name, quantity, default)


def _axis(table, name):
    """An axis by its letter or number."""
    value = table.values[table.needed(name)]
    if value in AXES:
        return AXES.index(value)
    if isinstance(value, bool) or value not in (0, 1, 2) or not isinstance(value, int):
        raise table.error(name, f' = {as_toml(value)}: must be "x", "y" or "z"')
    return value


def _walls(table):
    """Loads of walls by their names: temperatures, or tables of what else a wall may have."""
    walls = table.table("walls")
    if walls is None:
        return None
    names, found = (*WALLS, "round"), {}
    walls.only(dict.fromkeys(names, TEMPERATURE))
    for name in names:
        own = isinstance(walls.values.get(name), dict)
        found[name] = _load(walls.table(name)) if own else walls.number(name, TEMPERATURE)
    return {name: load for name, load in found.items() if load is not None}


def _load(table):
    table.only({name: quantity for _, keys in LOADS.values() for name, quantity in keys.items()})
    first = next((name for name, (_, keys) in LOADS.items() if table.key(name, keys[name])), None)
    if first is None:
        raise table.error(None, f": must have one of {', '.join(LOADS)}")
    kind, keys = LOADS[first]
    table.only(keys)
    values = {name: table.number(name, quantity, ...) for name, quantity in keys.items()}
    if kind is Flux:
        return _flux(table, values["flux"])
    if kind is Radiation:
        _check_kelvin(table)
    return table.made(kind, values)


def _check_kelvin(table):
    """Raise ValueError where a wall radiates and temperatures are not said to be in kelvin: fourth powers need it."""
    if "degC" in table.source.scales:
        line = table.source.line(table.source.scales["degC"])
        raise table.error("emissivity", f": with it all temperatures are in kelvin, and that in line {line} in degC")
    if "" in table.source.scales:
        line = table.source.line(table.source.scales[""])
        told = f'and that in line {line} has no unit; must say so, as temperature_K = 300 or "300 K"'
        raise table.error("emissivity", f": with it all temperatures are in kelvin, {told}")


def _flux(table, value):
    try:
        return Flux(value)
    except ValueError as error:
        key = table.keys["flux"]
        raise table.error(key, f" = {as_toml(table.values[key])}: {str(error).partition(': ')[2]}") from None
