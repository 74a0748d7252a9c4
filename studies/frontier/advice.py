"""What `recommend` and `effective` are worth on scenes that none of their laws was fitted to."""

import statistics

from studies.common.searches import means
from studies.common.searches.ways import ASKED_S, WAYS
from studies.frontier import asked

# Set by what was asked of them: a cost within this factor of what was said, and of the cheapest.
SAID, DEAREST = 3.0, 5.0
# Of intervals that hold.
HOLD = 0.95


def there(df):
    """Where it got there by what is no closed form, which costs nothing."""
    return [each for each in asked.all_told(df) if each.method not in ("", "exact")]


def claims(df):
    """What was asked of `recommend`, and that intervals hold."""
    found = there(df)
    if not found:
        return
    text = "recommend: its guess of a cost and what `effective` took, factor between"
    yield f"{text}, median", statistics.median(each.off for each in found), SAID
    yield f"{text}, largest", max(each.off for each in found), SAID
    yield "effective: its cost over that of the cheapest method, largest", max(each.factor for each in found), DEAREST
    # Among searches, whose single solves are known to be right: as it was judged before `effective` was asked.
    searched = list(_of_searches(df))
    yield (
        "recommend: cost of one solve by what it names over the least of the searches, largest",
        max(searched, default=None),
        DEAREST,
    )
    known = [each for each in asked.all_told(df) if each.half == each.half]
    share = sum(each.error <= each.half for each in known) / len(known)
    yield "effective: intervals that hold, share", share, f">= {HOLD}"


def advised(df):
    """What `recommend` is worth."""
    every, found = asked.all_told(df), there(df)
    if not found:
        return "Of none it is known yet."
    closed = sum(each.method == "exact" for each in every)
    late = len(every) - closed - len(found)
    near = sum(each.off <= SAID for each in found)
    offs, beside = [each.off for each in found], [each.other_s / each.took_s for each in found if each.other]
    return (
        f"Of {len(every)} pairs of scene and accuracy {closed} have a closed form; `effective` got there on "
        f"{len(found)} of the others within {ASKED_S:g} wall seconds, where `recommend` had said its cost in CPU "
        f"seconds within a factor of {SAID:g} on {near}, {statistics.median(offs):.2g} in the median and "
        f"{max(offs):.2g} at most; in the same wall time another method got there on {len(beside)} of these"
        f"{f', at {_among(beside)} times its cost' if beside else ''}; it cost "
        f"{statistics.median(_over(df, found)):.2g} times, in the median, what one solve of the right size costs "
        f"whoever knows the truth; on {late} time was over."
    )


def _among(factors):
    """The least and the most of some factors."""
    low, high = (f"{each:.2g}" for each in (min(factors), max(factors)))
    return low if low == high else f"{low} to {high}"


def _of_searches(df):
    """How many times the least the method named costs by itself, where a search found it to get there."""
    for each in asked.all_told(df):
        ways = means.reached(df, each.scene, "conductivity", each.target, any_shape=False)
        own = [way.cpu_s for way in ways if way.family == each.named and WAYS[way.way].own]
        if own:
            yield min(own) / ways[0].cpu_s


def _over(df, found):
    """How many times as much it cost as the cheapest single solve that the searches found."""
    for each in found:
        ways = means.reached(df, each.scene, "conductivity", each.target, any_shape=False)
        if ways:
            yield each.took_s / ways[0].cpu_s
