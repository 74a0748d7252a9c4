"""How long rows take: those of a full record before they are made, by those that are stored."""

import math
from datetime import datetime

from studies.harness.replay import WORKERS
from studies.harness.sound import uncosted
from studies.harness.store import MADE, case_key, number_of, read_rows

# A row takes so long besides, s: its process, a warm-up and a look at what others do; and where values alone count.
START, ALONE = 1.0, 0.3


def seconds(study, path, cases):
    """What each of some cases takes, s, of two processors: those whose values alone count are made side by side.

    Of a row that says so what it took, less what others took of it. Else its wall time and `START`; where values alone
    count its CPU time, as it has one thread.
    """
    rows, alone = read_rows(path), uncosted(study)
    own, found = _own(rows), {}
    for key in map(case_key, cases):
        row = rows.get(key, {})
        if key in alone:
            one = _first(_made(row), _first(number_of(row, "cpu_s"), own.get(key, math.nan)) + ALONE)
            found[key] = one / WORKERS
        else:
            found[key] = _first(number_of(row, MADE), own.get(key, math.nan) + START)
    return found


def _made(row):
    """What a row for its values would have taken, s, beside one other alone: they are made whatever others do.

    Each of so many threads as want a processor (the load) has the same share of two.
    """
    return number_of(row, MADE) * WORKERS / max(_first(number_of(row, "load"), 0.0), WORKERS)


def time_in_words(lasting):
    """How many rows take how long, in words."""
    minutes = math.fsum(filter(math.isfinite, lasting)) / 60
    unknown = sum(not math.isfinite(each) for each in lasting)
    more = f", and {unknown} of which nobody knows" if unknown else ""
    return f"{len(lasting)} rows in about {duration(minutes)}{more}"


def duration(minutes):
    """Minutes in words, as "1 h 52 min"."""
    whole = math.ceil(minutes)
    return f"{whole // 60} h {whole % 60:02} min" if whole >= 60 else f"{whole} min"


def _own(rows):
    """What rows took themselves, s, by the case: a cost may be extrapolated, and then less time went by."""
    found, before = {}, -math.inf
    for now, key in sorted((_moment(row), key) for key, row in rows.items()):
        wall = _first(number_of(rows[key], "wall_s"), 0.0) * _first(number_of(rows[key], "repeats"), 1.0)
        found[key], before = min(wall, _first(now - before, math.inf)), now
    return found


def _moment(row):
    """When a row ended, s; minus infinity if it does not say."""
    try:
        return datetime.fromisoformat(row.get("when") or "").timestamp()
    except ValueError:
        return -math.inf


def _first(*values):
    """The first that is a number."""
    return next((value for value in values if math.isfinite(value)), math.nan)
