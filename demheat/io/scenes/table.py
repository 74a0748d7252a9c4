"""A table of a TOML file, key by key: numbers with their units, words, vectors; and nothing that nobody asked for."""

from __future__ import annotations

import re
from collections.abc import Mapping

from demheat.io.scenes.source import Source
from demheat.io.scenes.units import PLAIN, TEMPERATURE, Quantity, factor_of, read_quantity, scaled
from demheat.io.words import as_toml, nearest

# What Scene, Sphere, ... say: "Sphere.radius = -1: must be ..."; mappings hold colons themselves.
SAID = re.compile(r"\w+\.(?P<field>\w+)(?P<part>\[[^\]]*\])?(?: = (?:\{.*?\}|.*?))?: (?P<what>.*)", re.DOTALL)


# Keys as others call them; keys of a file, which are read as of the table above them.
ALSO = {"diameter": "radius", "position": "center", "k": "conductivity", "lambda": "conductivity", "rho": "density"}
ALSO |= {"cp": "heat_capacity"}
TOP = ("size", "gradient", "matrix", "initial", "accuracy", "domain")


class Table:
    """A table of a file."""

    def __init__(self, source: Source, path: tuple, values: dict):
        self.source, self.path, self.values = source, path, values
        # What was asked for, and its key in the file or None.
        self.keys: dict[str, str | None] = {}

    def key(self, name: str, quantity: Quantity = PLAIN) -> str | None:
        """Key of the file for a name, which may end in a unit; None if there is none."""
        found = [name + end for end in ("", *_ends(quantity)) if name + end in self.values]
        if len(found) > 1:
            first, *_, last = sorted(found, key=lambda each: self.source.line((*self.path, each)))
            raise self.error(last, f": is {first} once more; must be one of them")
        self.keys[name] = found[0] if found else None
        return self.keys[name]

    def needed(self, name: str, quantity: Quantity = PLAIN) -> str:
        """Key of the file for a name that must be there."""
        key = self.key(name, quantity)
        if key is None:
            raise self.error(None, f": {name} is missing" if self.path else f"{name} is missing")
        return key

    def number(self, name: str, quantity: Quantity, default=None) -> float | None:
        """A number in SI."""
        key = self.needed(name, quantity) if default is ... else self.key(name, quantity)
        return default if key is None else self._converted((key,), self.values[key], name, quantity)

    def vector(self, name: str, quantity: Quantity, default=None) -> tuple | None:
        """Numbers in SI as a tuple."""
        key = self.needed(name, quantity) if default is ... else self.key(name, quantity)
        if key is None:
            return default
        value = self.values[key]
        if not isinstance(value, list):
            raise self.error(key, f" = {as_toml(value)}: must be an array of numbers, such as [1, 2, 3]")
        return tuple(self._converted((key, k), part, name, quantity) for k, part in enumerate(value))

    def rows(self, name: str, quantities: tuple, what: str) -> tuple | None:
        """Rows of numbers in SI as a tuple of tuples, None if there are none."""
        key = self.key(name, quantities[0])
        if key is None:
            return None
        value, found = self.values[key], []
        if not isinstance(value, list):
            raise self.error(key, f" = {as_toml(value)}: must be {what}")
        for i, row in enumerate(value):
            if not isinstance(row, list) or len(row) != len(quantities):
                raise self.error((key, i), f" = {as_toml(row)}: must be {what}")
            named = [name if quantity == quantities[0] else key for quantity in quantities]
            cells = enumerate(zip(row, named, quantities, strict=True))
            found.append(tuple(self._converted((key, i, j), *cell) for j, cell in cells))
        return tuple(found)

    def text(self, name: str, default=None, *, among=None, hint=nearest) -> str | None:
        """A text; `hint` says what may have been meant by one that is none of those it must be among."""
        key = self.needed(name) if default is ... else self.key(name)
        if key is None:
            return default
        value = self.values[key]
        if not isinstance(value, str):
            raise self.error(key, f" = {as_toml(value)}: must be text in quotes")
        if among is not None and value not in among:
            listed = ", ".join(map(repr, among))
            raise self.error(key, f" = {as_toml(value)}: must be one of {listed}{hint(value, among)}")
        return value

    def value(self, name: str, kind: type, words: str, default=None):
        """A value of a type, such as a table or an array of them."""
        key = self.needed(name) if default is ... else self.key(name)
        if key is None:
            return default
        value = self.values[key]
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            raise self.error(key, f" = {as_toml(value)}: must be {words}")
        return value

    def table(self, name: str, default=None) -> Table | None:
        """A table within."""
        values = self.value(name, dict, f"a table, [{name}]", default)
        return None if values is None else Table(self.source, (*self.path, name), values)

    def tables(self, name: str) -> list[Table]:
        """An array of tables; empty if there is none."""
        rows = self.value(name, list, f"an array of tables, [[{name}]]", [])
        for k, row in enumerate(rows):
            if not isinstance(row, dict):
                raise self.error((name, k), f" = {as_toml(row)}: must be a table")
        return [Table(self.source, (*self.path, name, k), row) for k, row in enumerate(rows)]

    def only(self, names: Mapping[str, Quantity]) -> None:
        """Raise ValueError if the table has other keys than these, with units or without."""
        known = [f"{name}{end}" for name, quantity in names.items() for end in ("", *_ends(quantity))]
        for key in self.values:
            if key not in known:
                raise self.error(key, f": no such key here{self._meant(key, known, names)}")

    def _meant(self, key, known, names):
        """What may have been meant by a key that is none of the table."""
        name, _, end = key.partition("_")
        other = ALSO.get(name, "")
        if other in names:
            there = f"{other}_{end}" if f"{other}_{end}" in known else other
            return f"; did you mean {there!r}{', half of it' if name == 'diameter' else ''}?"
        if self.path and name in TOP:
            return "; a key of the file itself must stand above its first table, [...]"
        return nearest(key, known) or f"; must be one of {', '.join(names)}"

    def error(self, key, what: str) -> ValueError:
        """The error to raise about a key, a path below the table, or (None) the table."""
        below = () if key is None else key if isinstance(key, tuple) else (key,)
        return self.source.error((*self.path, *below), what)

    def made(self, kind, arguments: Mapping):
        """Make an object by its keywords that were read; what it refuses is said of the key that it comes from."""
        try:
            return kind(**{name: value for name, value in arguments.items() if value is not None})
        except ValueError as error:
            raise self.blamed(error) from None

    def blamed(self, error: ValueError) -> ValueError:
        """An error of an object as one of the key that it comes from."""
        found = SAID.fullmatch(str(error))
        key = self.keys.get(found["field"]) if found else None
        if key is None:
            return self.error(None, f": {error}" if self.path else str(error))
        part = (found["part"] or "").strip("[]'\"")
        value = self.values[key]
        if part and isinstance(value, dict) and part in value:
            return self.error((key, part), f" = {as_toml(value[part])}: {found['what']}")
        return self.error(key, f" = {as_toml(value)}: {found['what']}")

    def _converted(self, below, value, name, quantity):
        """A number, or text of a number and a unit, in SI."""
        suffix = below[0].removeprefix(name).removeprefix("_")
        if isinstance(value, str) and not suffix and quantity.unit:
            try:
                number, scale = read_quantity(value, quantity)
            except ValueError as error:
                raise self.error(below, f" = {as_toml(value)}: {error}") from None
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            factor, scale = factor_of(quantity.suffixes[suffix], quantity) if suffix else (1, "")
            number = scaled(value, factor) if suffix else value
        else:
            text = f", or text with a unit such as '3 {quantity.unit}'" if quantity.unit and not suffix else ""
            raise self.error(below, f" = {as_toml(value)}: must be a number{text}")
        if quantity == TEMPERATURE:
            self._check_scale((*self.path, *below), scale)
        return number

    def _check_scale(self, path, scale):
        """Raise ValueError where temperatures of one file are of two scales, or of one and of none."""
        scales = self.source.scales
        scales.setdefault(scale, path)
        other = next((each for each in scales if each != scale), None)
        if other is not None:
            line = self.source.line(scales[other])
            told = f"is {_scaled(scale)}, and that in line {line} {_scaled(other)}"
            raise self.source.error(path, f": {told}; all temperatures of a file must be of one scale")


def _ends(quantity):
    """What a key may end in."""
    return [f"_{suffix}" for suffix in quantity.suffixes]


def _scaled(scale):
    return f"in {scale}" if scale else "without a unit"
