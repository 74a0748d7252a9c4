"""Groups of a study's rows that stand or fall together, and whose rows are looked at for those of others."""

import math

from studies.harness.store import MADE, case_key

# Parameters of a case that say in every study which code makes its row.
CODE = ("method", "law", "integrator", "scheme", "rule", "packing")
# Numbers that are other code by each of their values; and those that are at their ends.
COUNTED, ENDED = ("order",), ("contrast",)


def group_of(study, case):
    """What a row stands or falls with, in its study: what its case says in words, and what stands by itself there.

    Numbers say how much of a thing there is, words which thing it is; so do yes and no, the degree of elements, and
    contrasts of pores and perfect conductors.
    """
    named = (*by_itself(study), *COUNTED)
    kinds = {name: value for name, value in case.items() if isinstance(value, str | bool) or name in named}
    kinds |= {name: case[name] for name in ENDED if case.get(name) in (0.0, math.inf)}
    return tuple((name, value) for name, value in kinds.items() if value is not None)


def by_itself(study):
    """Parameters of which no value's rows are borne out by another's, however long these take."""
    return getattr(study, "BY_ITSELF", ())


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


def followed(costs, dear, apart=None):
    """Of each group whose cheapest row takes more than `dear` seconds those whose rows are looked at for it.

    Groups are pairs of a study's name and what `group_of` gives. A dear one follows all that the same code makes, of
    its study or, if it has none, of others; where there are none either, its own row is looked at. What is `by_itself`
    in a study, `apart`, is code of its own.
    """
    looked, found, apart = {}, {}, apart or {}
    for each in sorted(costs, key=costs.get):
        alike = looked.setdefault(_code(each[1], apart.get(each[0], ())), [])
        leaders = [other for other in alike if other[0] == each[0]] or alike
        if leaders and costs[each] > dear:
            found[each] = leaders
        else:
            alike.append(each)
    return found


def _code(group, apart):
    """What says in every study which code it is, and what its own study names."""
    return tuple(pair for pair in group if pair[0] in (*CODE, *apart))
