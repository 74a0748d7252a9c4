"""Which rows' costs count: those of this code, of a commit, measured while the machine was quiet."""

from __future__ import annotations

import math
import re
from collections import Counter

from studies.harness.provenance import code_of, guest_case
from studies.harness.quiet import NOISY
from studies.harness.store import case_key, read_rows

STALE, DIRTY, NOISE = FAULTS = ("stale", "dirty", "noisy")
# Columns of costs, by their names: seconds, memory, speeds. A study's own `COSTS` are besides.
COSTS = re.compile(r".+_s|(\w+_)?(mib|gbs)|(\w+_)?us_per_\w+|(\w+_)?particle_steps")


def faults(study, row):
    """What is wrong with a row, in the order of FAULTS.

    - stale: other code than today's made it; a method that is not ours has no code that is known here.
    - dirty: its code was at no commit.
    - noisy: others used more than a tenth of the processors around it, or nobody knows, or it compiled kernels in
      more than a tenth of its time; only rows with costs are.

    Parameters
    ----------
    study : module
    row : mapping
        Of a file or of a data frame.

    Returns
    -------
    tuple of str
    """
    ours = guest_case(study, str(row.get("case"))) is None
    wrong = (
        ours and row.get("code") != code_of(study, row),
        str(row.get("commit")).endswith("+"),
        math.isfinite(_number(row.get("cpu_s"))) and not _quiet(row),
    )
    return tuple(name for name, yes in zip(FAULTS, wrong, strict=True) if yes)


def _quiet(row):
    compiled, wall = _number(row.get("compile_s")), _number(row.get("wall_s"))
    return _number(row.get("noise")) <= NOISY and not compiled > NOISY * wall


def counted(found):
    """How many rows have each fault.

    Parameters
    ----------
    found : iterable of tuple of str
        Of `faults`.

    Returns
    -------
    dict of str to int
    """
    count = Counter(name for each in found for name in each)
    return {name: count[name] for name in FAULTS}


def told(count):
    """Such numbers in words, as "3 stale, 0 dirty, 1 noisy"."""
    return ", ".join(f"{number} {name}" for name, number in count.items())


def checked(study, path):
    """Faults of all rows of a study's present cases in a file.

    Parameters
    ----------
    study : module
    path : path

    Returns
    -------
    dict of str to tuple of str
        By the case; the tuple of a good row is empty.
    """
    cases = {case_key(case) for case in study.CASES}
    rows = read_rows(path).items()
    return {key: faults(study, row) for key, row in rows if key in cases or guest_case(study, key) is not None}


def cost_columns(study, df):
    """Names of a data frame's columns that hold costs.

    Parameters
    ----------
    study : module
    df : data frame
    """
    own = getattr(study, "COSTS", ())
    return [name for name in df if name in own or COSTS.fullmatch(name)]


def _number(value):
    try:
        return float(value)
    except (TypeError, ValueError):
        return math.nan


def total(found):
    """Rows of all chapters of a report, and those whose costs do not count, in words.

    Parameters
    ----------
    found : sequence of report.Chapter
    """
    count = {name: sum(each.count[name] for each in found) for name in FAULTS}
    return f"{sum(each.rows for each in found)} rows: {told(count)}"
