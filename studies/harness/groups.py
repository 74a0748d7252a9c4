"""Groups of a study's rows that stand or fall together, and whose rows are looked at for those of others."""

from __future__ import annotations

import math

from studies.harness.store import MADE, case_key

# Parameters of a case that say which code makes its row, and not how much of it.
KINDS = ("part", "name", "method", "law", "integrator", "scheme", "rule", "packing", "held", "family")
# Those of them that say so in every study.
CODE = ("method", "law", "integrator", "scheme", "rule", "packing")


def group_of(study, case):
    """What a row stands or falls with, in its study: `KINDS`, and what a study names besides in `BY_ITSELF`."""
    kinds = (*KINDS, *getattr(study, "BY_ITSELF", ()))
    return tuple((kind, case[kind]) for kind in kinds if case.get(kind) is not None)


def cheapest(study, rows, cases):
    """Of each group the case whose stored row took least; one that was refused tells of no number."""

    def order(case):
        row = rows.get(case_key(case), {})
        return row.get("status") != "ok", cost(row)

    found = {}
    for case in sorted(cases, key=order):
        found.setdefault(group_of(study, case), case)
    return found


def cost(row):
    """Seconds that a stored row took; infinite if nobody knows."""
    try:
        return float(row.get("wall_s") or row.get(MADE) or math.inf)
    except ValueError:
        return math.inf


def followed(costs, dear):
    """Of each group whose cheapest row takes more than `dear` seconds those whose rows are looked at for it.

    Groups are pairs of a study's name and what `group_of` gives. A dear one follows all that the same code makes, of
    its study or, if it has none, of others; where there are none either, its own row is looked at.
    """
    looked, found = {}, {}
    for each in sorted(costs, key=costs.get):
        alike = looked.setdefault(_code(each[1]), [])
        leaders = [other for other in alike if other[0] == each[0]] or alike
        if leaders and costs[each] > dear:
            found[each] = leaders
        else:
            alike.append(each)
    return found


def _code(group):
    """What says in every study which code it is, and what its own study names."""
    return tuple(pair for pair in group if pair[0] in CODE or pair[0] not in KINDS)
