"""The fair frontier: what an accuracy costs, by every method at its best.

Each row is a search: one way (a method with one rule, or by itself) on one scene walks up its knob in steps that cost
about one and a half times as much, halves between neighbours that a target lies between until they are within 1.2 times
in cost, and runs again, in turns, what decides. A value reaches a target if its error and those of all finer values
that were tried, two steps at least, are within it, where sizes that make the same elements are one value; of those that
do the one counts that costs least, run three times where the seconds last. Meshing, painting, packing and the coarser
runs of an extrapolation count. Targets are 3 to .003 % of the conductivity. Fluxes and temperatures at points have a
study of their own (`fluxes`).
Scenes are eleven, marked where constants of the DEM were found on them, and twelve that were held back: no constant and
no law was fitted to them, though faults found on them were mended; three bodies that warm up, whose temperatures count;
some more are there for the laws of error and cost alone, which `python -m studies.frontier.laws` fits to all but those
twelve. What is true is known in closed form, by multipoles, or by two methods that close in on the same; a target is
judged where that is known three times better. A search tries no finer value than its first three once half of its
seconds (a column of the row) are spent, or where the next value would take over two minutes or 8 GiB; the rest is for
halving and repeats. Nobody gives up before, though errors may have stopped to fall.

Costs are those of a quiet machine, or none are stored: `python -m studies run frontier --out results --force`.
"""

from demheat.runtime.lazy import lazy_names
from studies.frontier.cases import QUICK_SECONDS, all_cases, second_cases

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "studies.frontier.verdicts": ("claims",),
        "studies.frontier.second": ("on_a_second_machine", "with_more_ways"),
        "studies.frontier.advice": ("advised",),
        "studies.common.searches.means": ("multipoles", "beside_peers"),
        "studies.common.searches.figure": ("plot",),
    },
)

CASES = list(all_cases())
# That the record does not hold (`second`).
FURTHER = list(second_cases())
# Limits from elsewhere: guessed or asked before there were rows.
ELSEWHERE = ("Scenes on which", "recommend:", "effective:", "Pairs of scene")
MODULES = {"ngsolve": "studies.peers.programs.ngsolve", "effective": "demheat.cheapest"}
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "its cost over that of the cheapest method": "what was asked of it before there were any rows",
    "Pairs of scene and accuracy": "set before rows of the second machine were compared",
}
# Why claims on the stored rows fail.
FAILS = {
    "what `effective` took, factor between, largest": (
        "square rod to .1 %: three rounds, as beside edges intervals fall with the first power of the distance, which "
        "no scene of the laws shows; pairs of balls to .1 % took a quarter of what was said, in one round as foreseen: "
        "the FFT's law of costs says too much there; 40 unequal spheres cost multipoles two to three times what their "
        "law says, at most degrees; others are within 3"
    ),
}
TIMEOUT = 900.0
# A search repeats what decides by itself.
REPEATS = 1
# Rows of one way on one scene tell of no other.
BY_ITSELF = ("way", "scene")
# Which values were tried goes by what they cost, and so does all that is made of them; what is true is no row's own.
COSTS = (
    "true_k",
    "true_off",
    "true_by",
    "trail",
    "conductivity",
    "extrapolated",
    "temperature",
    "ended",
    "tried",
    "pace",
)
# Of `effective` nothing but the conductivity to one per cent.
COSTS += tuple(
    f"asked_{target}_{field}"
    for target in ("1", "0.1", "0.01")
    for field in ("named", "method", "half", "error", "rounds", "why", "other")
)


def QUICK(case):
    """The short searches."""
    return case["seconds"] == QUICK_SECONDS


def run(scene, way, seconds, method):
    """Search, and find again what stands for the row; or ask `effective`."""
    from studies.common.searches import rows, ways
    from studies.frontier import asked

    if way == ways.ASKED:
        return again(scene, way, seconds, method) | asked.row_of(scene)
    return rows.at_point(scene, way) | rows.searched(scene, way, seconds)


def again(scene, way, seconds, method):
    """What of a row is no matter of costs: the conductivity at one value of the knob."""
    from studies.common.searches import rows, ways
    from studies.frontier import asked

    if way == ways.ASKED:
        return {"point": asked.TARGETS[0], "point_k": asked.conductivity(scene)}
    return rows.at_point(scene, way)


def warm_up(scene, way, seconds, method):
    """Load and compile the solver; work out what is true."""
    from studies.common.searches import rows, ways
    from studies.frontier import asked

    if way == ways.ASKED:
        asked.warm_up(scene)
    else:
        rows.warm_up(scene, way)


def table(df):
    """The cheapest way for any shape to each accuracy of the conductivity, in processor seconds, and the next method.

    Methods tie where their runs scatter by as much as their costs differ, or where these are within 1.2 times, as
    values of a knob are tried no nearer. "-": nobody gets there within the seconds of the search; "?": the truth is
    not known three times better. *: constants of the DEM were found on this body, or on it at other contrasts.
    """
    from studies.common.searches import tables

    return tables.lines(df)


def by_accuracy(df):
    """The same to three accuracies."""
    from studies.common.searches import tables

    return tables.lines(df, targets=(1.0, 0.1, 0.01))


def warming(df):
    """The same of temperatures at points in time: the largest error over the times of the papers' figures."""
    from studies.common.searches import tables
    from studies.common.searches.in_time import IN_TIME

    return tables.lines(df, "temperature", (3.0, 1.0, 0.3, 0.1, 0.03), IN_TIME)


def notes(df):
    """Who wins, in words made of the rows."""
    from studies.common.searches import means
    from studies.frontier import second

    if not means.searched(df):
        yield "No search has been run on a quiet machine yet: rows hold a conductivity at one value each, and no costs."
        return
    for target in (1.0, 0.1, 0.01):
        yield means.in_words(df, "conductivity", target)
    yield from filter(None, (second.on_a_second_machine(df), second.with_more_ways(df)))


def verdict(df):
    """In numbers, for the front page."""
    from studies.common.searches import means

    return " ".join(means.counted(df, "conductivity", target) for target in (1.0, 0.1, 0.01))


def winners(df):
    """The same as a table."""
    from studies.common.searches import tables

    return tables.winners(df, "conductivity", (1.0, 0.1, 0.01))


def who_wins(df):
    """With the names of scenes."""
    from studies.common.searches import means

    return " ".join(means.in_words(df, "conductivity", target) for target in (1.0, 0.1, 0.01))
