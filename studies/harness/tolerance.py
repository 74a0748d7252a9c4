"""How near a value that is made again must come to the stored one.

A row's bits depend on its case alone, not on threads, so on the machine and the versions that a row names its values
return but for rounding: libraries choose their kernels by the load of a moment, and sums are then taken in another
order. What an iteration leaves is its tolerance, which a last bit may move it across. On another processor iterations
may end some steps earlier (`BESIDE`, `AWAY`), the mesher may take another turn there, and collisions under other
versions, too (`ELSEWHERE`): such a row is held to less.
"""

import math
import re
from typing import NamedTuple

from demheat.runtime.machine import machine
from studies.harness.provenance import versions
from studies.harness.sound import cost_columns
from studies.harness.store import TAIL

# Columns that end a row and are values all the same.
COUNTED = ("unknowns", "iterations")
# A number in a cell, which may hold one, a curve or a list of verdicts.
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*(?:[eE][-+]?\d+)?|nan|inf)(?![\w.])")
ITERATIONS = r"iterations|.+_iterations"
# What says how a row was made and not what came out of it.
ASIDE = re.compile(r"case|code|packing_cached|(.+_)?(note|version)|remark|warning|solver")


class Tolerance(NamedTuple):
    """A value may differ by `relative` times the larger of both, and by `absolute` in the column's own unit besides."""

    relative: float
    absolute: float


class Moved(NamedTuple):
    """A value that a replay does not give again."""

    study: str
    case: str
    column: str
    stored: str
    found: str
    tolerance: Tolerance

    def __str__(self):
        allowed = f"{self.tolerance.relative:g} relative, {self.tolerance.absolute:g} absolute"
        return (
            f"{self.study} {self.case}: {self.column} stored {_short(self.stored)}, found {_short(self.found)}, "
            f"tolerance {allowed}; if it is meant: python -m studies accept {self.study}"
        )


# By a column's name, the first that fits; a study's own `TOLERANCES`, in the same form, come before.
TOLERANCES = {
    # Solvers stop at 1e-8 of the heat at most; a step more or less is a matter of a last bit.
    ITERATIONS: Tolerance(0.02, 1.0),
    # What is nought but for rounding and solvers: no digit of it need return.
    r"residual|.+_residual|heat_imbalance|imbalance|asymmetry.*|linear_error": Tolerance(0.0, 1e-7),
    # Of a value that solvers leave 1e-9 of, in per cent.
    r".*percent.*|.*error.*|.*_off|.*_half": Tolerance(1e-7, 1e-6),
    r".*": Tolerance(1e-8, 1e-12),
}
# Of a row from another processor. Of 131 of an AMD EPYC that an Intel Xeon made again 128 were as near as above; of
# three, errors in per cent were off by 3e-5 of them and 4e-6 at most.
BESIDE = Tolerance(1e-4, 1e-5)
# Of one of other versions: a guess, as no such row has been seen yet. And of elements on another processor: of 60 rows
# two had 1 to 2 nodes less in a thousand there, and errors in per cent off by 2e-3.
ELSEWHERE = Tolerance(5e-3, 5e-3)
# And by a column's name, of a row from elsewhere: at high contrasts solvers creep up to their tolerance, and what
# another processor's kernels round otherwise moves where they get there. Found from one generation to another of the
# same name: 180 and 192 iterations at a contrast of 1e9, 252 and 243 at 1e6, where conductivities are 2e-6 apart, and
# errors 2e-4 %.
AWAY = {ITERATIONS: Tolerance(0.1, 1.0), r".*percent.*": Tolerance(0.0, 1e-3)}
# Of how wide an interval is, over that and over its ends: where these may differ by ELSEWHERE one of a thousandth could
# be any other. A quarter, as coarser meshes turn elsewhere, too; where nothing is left it is rounding.
WIDE = Tolerance(0.25, 1e-6)


def value_columns(study, case, names):
    """Columns that a replay compares: neither parameters nor costs, nor what says how a row was made."""
    names = [name for name in names if name not in case and not ASIDE.fullmatch(name)]
    costs = set(cost_columns(study, names))
    return [name for name in names if name not in costs and (name not in TAIL or name in COUNTED)]


def tolerance_of(study, column):
    """Tolerance of a column."""
    declared = (*getattr(study, "TOLERANCES", {}).items(), *TOLERANCES.items())
    return next(tolerance for form, tolerance in declared if re.fullmatch(form, column))


def moved(name, study, case, stored, found):
    """Values of a row that was made again which are not those that are stored, and its status."""
    least = _least(case, stored)
    key, status = stored["case"], (stored.get("status"), str(found.get("status")))
    if status[0] != status[1]:
        return [Moved(name, key, "status", status[0], f"{status[1]} ({found.get('note')})", Tolerance(0, 0))]
    columns = value_columns(study, case, dict.fromkeys([*stored, *found]))
    parts, wrong = getattr(study, "COMPARED_AS", {}), []
    for column in columns:
        old, new = (parts.get(column, str)(_text(row.get(column))) for row in (stored, found))
        tolerance = _wider(tolerance_of(study, column), least, column)
        if not _near(old, new, tolerance):
            wrong.append(Moved(name, key, column, old, new, tolerance))
    return wrong or list(_widths(name, key, columns, stored, found))


def _wider(tolerance, least, column):
    """A column's tolerance, of a row from elsewhere at least what such a row may differ by."""
    away = [each for form, each in AWAY.items() if any(least) and re.fullmatch(form, column)]
    return Tolerance(*map(max, zip(tolerance, least, *away, strict=True)))


def _widths(name, key, columns, stored, found):
    """Intervals that are as they were by their ends alone."""
    for low in (each for each in columns if each.endswith("lower") and f"{each[:-5]}upper" in columns):
        high = f"{low[:-5]}upper"
        if not all(_text(row.get(end)) for row in (stored, found) for end in (low, high)):
            continue
        old, new = (float(row[high]) - float(row[low]) for row in (stored, found))
        absolute = WIDE.absolute * abs(float(stored[high]))
        if not _close(old, new, Tolerance(WIDE.relative, absolute)):
            yield Moved(name, key, f"{high} less {low}", str(old), str(new), WIDE)


def _least(case, stored):
    """What a row may differ by, whatever the column, for being from elsewhere."""
    if stored.get("versions") != versions():
        return ELSEWHERE
    # Values that were made anew elsewhere than the costs; before that was noted nobody knows on which processor.
    made = stored.get("values_machine") if stored.get("values_commit") else stored.get("machine")
    if made != machine():
        return ELSEWHERE if case.get("method") == "fem" else BESIDE
    return Tolerance(0.0, 0.0)


def _text(value):
    return "" if value is None or value != value or value == "nan" else str(value)


def _near(old, new, tolerance):
    """Whether two cells are as near as they must be: all numbers in them; what stands between must be the same."""
    if old == new:
        return True
    pairs = zip(NUMBER.findall(old), NUMBER.findall(new), strict=False)
    alike = NUMBER.sub("#", old) == NUMBER.sub("#", new)
    return alike and all(_close(float(one), float(other), tolerance) for one, other in pairs)


def _close(old, new, tolerance):
    if old == new or (math.isnan(old) and math.isnan(new)):
        return True
    return abs(old - new) <= tolerance.absolute + tolerance.relative * max(abs(old), abs(new))


def _short(text, most=40):
    return repr(text if len(text) <= most else f"{text[:most]}...")
