"""A material from a table of a file: its conductivity a number, three principal ones, or a tensor; how it depends."""

import math

from demheat.io.scenes.table import Table
from demheat.io.scenes.units import CONDUCTIVITY, DENSITY, HEAT_CAPACITY, PLAIN, TEMPERATURE
from demheat.io.words import as_toml
from demheat.scene import Material, orthotropic

# Keys, and of what their numbers are; those of a dependence are temperatures and factors.
MATERIAL = {
    "conductivity": CONDUCTIVITY,
    "density": DENSITY,
    "heat_capacity": HEAT_CAPACITY,
    "rotation_deg": PLAIN,
    "dependence": TEMPERATURE,
    "conductivity_at": TEMPERATURE,
}
PAIRS = "pairs [temperature, factor], as [[20, 1], [100, 0.8]]"
VALUES = "pairs [temperature, conductivity], as [[20, 45], [400, 38]], with conductivities > 0"


def made_material(table: Table) -> Material:
    """The material of a table."""
    table.only(MATERIAL)
    at = table.rows("conductivity_at", (TEMPERATURE, CONDUCTIVITY), VALUES)
    if at is not None:
        conductivity, dependence = _followed(table, at)
    else:
        conductivity = _conductivity(table)
        dependence = table.rows("dependence", (TEMPERATURE, PLAIN), PAIRS)
    numbers = {name: table.number(name, MATERIAL[name]) for name in ("density", "heat_capacity")}
    return table.made(Material, {"conductivity": conductivity, "dependence": dependence} | numbers)


def _followed(table, at):
    """Conductivity at the first temperature, and factors of it, of a table of conductivities."""
    key = table.keys["conductivity_at"]
    for name in ("conductivity", "dependence", "rotation_deg"):
        other = table.key(name, MATERIAL[name])
        if other is not None:
            raise table.error(other, f": {key} tells it; must be left out")
    if not at or not all(0 < k < math.inf for _, k in at):
        raise table.error(key, f" = {as_toml(table.values[key])}: must be {VALUES}")
    first = at[0][1]
    return first, tuple((temperature, k / first) for temperature, k in at)


def _conductivity(table):
    key = table.needed("conductivity", CONDUCTIVITY)
    value, turned = table.values[key], table.key("rotation_deg")
    principal = isinstance(value, list) and not any(isinstance(part, list) for part in value)
    if turned is not None and not principal:
        raise table.error(turned, ": turns three principal conductivities, as conductivity = [1, 1, 5]; there are none")
    if not isinstance(value, list):
        return table.number("conductivity", CONDUCTIVITY, ...)
    if not principal:
        what = "a number, three of them, or three arrays of three"
        return table.rows("conductivity", (CONDUCTIVITY,) * 3, what)
    numbers, rotation = table.vector("conductivity", CONDUCTIVITY), table.vector("rotation_deg", PLAIN)
    if len(numbers) != 3:
        raise table.error(key, f" = {as_toml(value)}: must be a number, three of them, or three arrays of three")
    try:
        return orthotropic(*numbers, rotation=rotation and [math.radians(part) for part in rotation])
    except ValueError as error:
        # Of what the file has, not of the argument.
        name = turned if str(error).startswith("rotation") else key
        what = "three finite numbers, degrees" if name == turned else str(error).partition(": must be ")[2] + " each"
        raise table.error(name, f" = {as_toml(table.values[name])}: must be {what}") from None
