"""Only here: a value that no such body can have, printed without a word."""

from demheat.terminal.commands.bounds import Bound
from demheat.terminal.commands.compare import table

NUMBERS = dict.fromkeys(("lower", "upper", "wall_s", "cpu_s", "interval_cpu_s", "unknowns", "note"), "")
BOUNDS = [
    Bound("Reuss, Voigt", 1.0, 4.0, "all bodies"),
    Bound("Hashin-Shtrikman", 1.8, 2.2, "isotropic bodies of two phases"),
    Bound("voxels, certain", 1.5, 2.5, "this image"),
]


def said(value):
    row = NUMBERS | {"method": "dem", "status": "ok", "conductivity": str(value)}
    return [line for line in table([row], BOUNDS).splitlines() if "certain (" in line]


def test_inside_of_what_is_certain():
    # Outside of Hashin and Shtrikman, which hold for isotropic bodies alone; beyond a bound by rounding.
    assert said(1.7) == said(2.4) == said(1.5 * (1 - 1e-8)) == []


def test_outside():
    assert said(1.4) == ["dem: 1.4 is below 1.5, which is certain (voxels, certain): its error is no less than that"]
    assert len(said(4.1)) == 2 and "above 4" in said(4.1)[0]
