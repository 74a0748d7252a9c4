"""Units as people write them: "33 W/(m K)", "3 mm", "25 degC"; and as ends of keys: `radius_mm`, `conductivity_W_mK`.

A unit is taken apart into base units and powers of metre, kilogram, second and kelvin, so that "W/(m K)", "W m^-1 K^-1"
and "kW/m/K" are all read, and "W/mK" (watts for each millikelvin) is seen to be no conductivity.
"""

import math
import re
from fractions import Fraction
from typing import NamedTuple

# Powers of m, kg, s, K, and how many SI units one is: exactly, so that 33.3 mm are the float that is nearest.
BASES = {
    "m": ((1, 0, 0, 0), Fraction(1)),
    "g": ((0, 1, 0, 0), Fraction(1, 1000)),
    "s": ((0, 0, 1, 0), Fraction(1)),
    "K": ((0, 0, 0, 1), Fraction(1)),
    "W": ((2, 1, -3, 0), Fraction(1)),
    "J": ((2, 1, -2, 0), Fraction(1)),
    "min": ((0, 0, 1, 0), Fraction(60)),
    "h": ((0, 0, 1, 0), Fraction(3600)),
}
PREFIXES = {"n": -9, "u": -6, "\N{MICRO SIGN}": -6, "\N{GREEK SMALL LETTER MU}": -6, "m": -3, "c": -2, "k": 3, "M": 6}
PREFIXED = ("m", "g", "s", "K", "W", "J")
CELSIUS = ("degC", "\N{DEGREE SIGN}C", "C", "celsius")
MADE_OF = "must be made of m, g, s, min, h, K, W, J, as mm or kW/m2"
SUPERSCRIPTS = str.maketrans("\u2070\u00b9\u00b2\u00b3\u2074\u207b", "01234-")
TOKEN = re.compile(r"\s*(?:(?P<name>[^\W\d_]+|\N{DEGREE SIGN}C)(?:\^?(?P<power>-?\d))?|(?P<mark>[/().*\u00b7^]))")
NUMBER = re.compile(r"\s*([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*)", re.DOTALL | re.ASCII)


class Quantity(NamedTuple):
    """What a number is of."""

    unit: str  # SI unit, empty for a plain number
    suffixes: dict[str, str]  # Ends of keys, and the unit each stands for


PLAIN = Quantity("", {})
LENGTH = Quantity("m", {"m": "m", "cm": "cm", "mm": "mm", "um": "um", "nm": "nm"})
TEMPERATURE = Quantity("K", {"K": "K", "C": "degC", "degC": "degC"})
CONDUCTIVITY = Quantity("W/(m K)", {"W_mK": "W/(m K)", "mW_mK": "mW/(m K)"})
DENSITY = Quantity("kg/m3", {"kg_m3": "kg/m3", "g_cm3": "g/cm3"})
HEAT_CAPACITY = Quantity("J/(kg K)", {"J_kgK": "J/(kg K)", "kJ_kgK": "kJ/(kg K)", "J_gK": "J/(g K)"})
GRADIENT = Quantity("K/m", {"K_m": "K/m", "K_cm": "K/cm", "K_mm": "K/mm"})
FLUX = Quantity("W/m2", {"W_m2": "W/m2", "kW_m2": "kW/m2"})
POWER_DENSITY = Quantity("W/m3", {"W_m3": "W/m3", "kW_m3": "kW/m3"})
RESISTANCE = Quantity("m2 K/W", {"m2K_W": "m2 K/W", "mm2K_W": "mm2 K/W"})
COEFFICIENT = Quantity("W/(m2 K)", {"W_m2K": "W/(m2 K)", "kW_m2K": "kW/(m2 K)"})
VELOCITY = Quantity("m/s", {"m_s": "m/s", "mm_s": "mm/s"})


def part_of(text: str) -> float:
    """A part: a number, or per cent, 0.1 % as the decimal that it is written as; not-a-number of other text."""
    number = text.strip()
    try:
        value = float(number.removesuffix("%"))
    except ValueError:
        return math.nan
    return scaled(value, Fraction(1, 100)) if number.endswith("%") else value


def read_quantity(text: str, quantity: Quantity) -> tuple[float, str]:
    """A number with its unit, in SI, and the scale of a temperature."""
    found = NUMBER.fullmatch(text)
    if not found or not found[2].strip():
        raise ValueError(f"must be a number, or text of a number and a unit such as '3 {quantity.unit}'")
    if re.match(r",\d", found[2]):
        raise ValueError(f"must have a decimal point, as {found[1]}.{found[2][1:]}")
    factor, scale = factor_of(found[2].strip(), quantity)
    return scaled(float(found[1]), factor), scale


def scaled(value: float, factor: Fraction) -> float:
    """A number times a factor, as the decimal that it is written as: 33.3 mm are 0.0333 m to the last bit."""
    try:
        return float(Fraction(repr(float(value))) * factor)
    except (OverflowError, ValueError):
        # Not a number, or beyond floats: refused by those who are to use it.
        return math.nan if value != value else (math.inf if value > 0 else -math.inf)


def factor_of(unit: str, quantity: Quantity) -> tuple[Fraction, str]:
    """How many SI units one of a unit is, and the scale of a temperature."""
    if quantity == TEMPERATURE:
        # Zero of one scale is not that of the other: numbers keep theirs.
        if unit in CELSIUS:
            return Fraction(1), "degC"
        if unit == "K":
            return Fraction(1), "K"
        raise ValueError(f"unit {unit!r} is none of a temperature; must be K or degC")
    powers, factor = _parsed(unit)
    wanted, scale = _parsed(quantity.unit)
    if powers != wanted:
        raise ValueError(f"unit {unit!r} does not fit; must be one like {quantity.unit}")
    return factor / scale, ""


def _parsed(unit):
    """Powers of the base units, and the factor, of a product of units that is read from left to right."""
    unit, at = unit.translate(SUPERSCRIPTS).strip(), 0
    tokens = []
    while at < len(unit):
        token = TOKEN.match(unit, at)
        if token is None:
            raise ValueError(f"unit {unit!r} is not known at {unit[at:].strip()!r}; {MADE_OF}")
        tokens.append(token)
        at = token.end()
    powers, factor = _product(iter(tokens), unit, inner=False)
    return tuple(powers), factor


def _product(tokens, unit, *, inner):
    """Of the tokens up to the bracket that closes, or all."""
    powers, factor, sign, some = [0, 0, 0, 0], Fraction(1), 1, False
    for token in tokens:
        mark = token["mark"]
        if mark == ")" and inner and some and sign == 1:
            return powers, factor
        if mark == "/" and some and sign == 1:
            sign = -1
        elif mark in (None, "("):
            own, value = _symbol(token["name"], unit) if mark is None else _product(tokens, unit, inner=True)
            exponent = sign * int(token["power"] or 1)
            powers = [a + exponent * b for a, b in zip(powers, own, strict=True)]
            factor, sign, some = factor * value**exponent, 1, True
        elif mark not in (".", "*", "\u00b7") or not some:
            raise ValueError(f"unit {unit!r} cannot be read at {mark!r}; must be like W/(m K) or kg/m3")
    if inner or sign == -1 or not some:
        raise ValueError(f"unit {unit!r} is not finished; must be like W/(m K) or kg/m3")
    return powers, factor


def _symbol(name, unit):
    """Powers and size of one symbol, such as "kW"."""
    if name in BASES:
        return BASES[name]
    if name in CELSIUS:
        return BASES["K"]
    if name[0] in PREFIXES and name[1:] in PREFIXED:
        powers, value = BASES[name[1:]]
        return powers, value * Fraction(10) ** PREFIXES[name[0]]
    raise ValueError(f"unit {unit!r} is not known at {name!r}; {MADE_OF}")
