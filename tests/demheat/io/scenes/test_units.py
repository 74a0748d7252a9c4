"""Only here: units taken for others, and decimals that change in the last bit."""

from fractions import Fraction

import numpy as np
import pytest

from demheat.io.scenes import units
from demheat.io.scenes.units import factor_of, read_quantity, scaled

# Each way to write the same.
SAME = [
    (
        units.CONDUCTIVITY,
        1.0,
        ["W/(m K)", "W/m/K", "W m^-1 K^-1", "W\u00b7m\u207b\u00b9\u00b7K\u207b\u00b9", "W/(m*K)", "J/(s m degC)"],
    ),
    (units.CONDUCTIVITY, 1000.0, ["kW/(m K)", "W/(mm K)", "W/mm/K"]),
    (units.LENGTH, 1e-3, ["mm", " mm "]),
    (units.LENGTH, 1e-6, ["um", "\u00b5m", "\u03bcm"]),
    (units.DENSITY, 1000.0, ["g/cm3", "g/cm^3", "g cm-3", "g/cm\u00b3"]),
    (units.HEAT_CAPACITY, 1000.0, ["kJ/(kg K)", "J/(g K)", "J/g/K"]),
    (units.FLUX, 10.0, ["mW/cm2"]),
    (units.GRADIENT, 1000.0, ["K/mm", "degC/mm", "kK/m"]),
    (units.VELOCITY, 1 / 3600, ["m/h"]),
    (units.VELOCITY, 1 / 60, ["m/min", "m min^-1"]),
    (units.POWER_DENSITY, 1e6, ["W/cm3", "MW/m3"]),
]


@pytest.mark.parametrize(("quantity", "factor", "texts"), SAME)
def test_ways_to_write_one_unit(quantity, factor, texts):
    for text in texts:
        assert float(factor_of(text.strip(), quantity)[0]) == factor, text
        assert read_quantity(f"2{text}", quantity)[0] == scaled(2.0, factor_of(text.strip(), quantity)[0])


@pytest.mark.parametrize("name", [name for name, each in vars(units).items() if isinstance(each, units.Quantity)])
def test_ends_of_keys_are_units_of_their_quantity(name):
    quantity = getattr(units, name)
    for suffix, unit in quantity.suffixes.items():
        assert factor_of(unit, quantity)[0] > 0, suffix


def test_what_is_written_is_what_is_read():
    """33.3 mm are the float 0.0333: products of floats are not."""
    assert 33.3 * 1e-3 != 0.0333
    for value in np.random.default_rng(3).random(200):
        text = f"{100 * value:.3f}"
        assert scaled(float(text), Fraction(1, 1000)) == float(f"{text}e-3")


def test_temperatures_keep_their_scale():
    assert read_quantity("25 degC", units.TEMPERATURE) == (25.0, "degC")
    assert read_quantity("-5 \u00b0C", units.TEMPERATURE) == (-5.0, "degC")
    assert read_quantity("298.15 K", units.TEMPERATURE) == (298.15, "K")


@pytest.mark.parametrize(
    "text", ["3", "mm", "", "3 m/", "3 /m", "3 m)", "3 (m", "3 ()", "3 m^", "3 %", "3 m..s", "0x3 m"]
)
def test_what_is_no_length(text):
    with pytest.raises(ValueError, match="must be"):
        read_quantity(text, units.LENGTH)
