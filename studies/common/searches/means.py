"""Who gets to an accuracy at least cost, read off the rows; what the scatter of costs cannot tell apart is a tie."""

import json
from collections.abc import Mapping
from functools import partial
from typing import NamedTuple

from studies.common.searches.in_time import IN_TIME
from studies.common.searches.scenes import HELD_BACK, SCENES, STEADY, TUNED
from studies.common.searches.search import TARGETS
from studies.common.searches.trails import borne_out
from studies.common.searches.ways import NEAR, WAYS

# Accuracies that multipoles are counted at, %.
MULTIPOLES = (1.0, 0.1, 0.01)
# Scatter of what ran once: of what ran three times nine of ten scatter by less.
ALONE = 0.26
# Of a row that is there, by what is compared; an extrapolated conductivity is a conductivity.
COLUMNS = {"conductivity": ("conductivity", "extrapolated"), "temperature": ("temperature",), "flux": ("flux",)}


class Reached(NamedTuple):
    """One way to one target of one scene."""

    way: str
    extrapolated: bool
    cpu_s: float
    spread: float
    value: float
    error: float

    @property
    def family(self):
        """The method, whatever its rule."""
        return WAYS[self.way].method

    @property
    def title(self):
        """Of tables."""
        return f"{WAYS[self.way].title}{', extrapolated' if self.extrapolated else ''}"


class Best(NamedTuple):
    """The cheapest way to a target, what ties with it, and the next method that does not."""

    first: Reached
    tied: tuple
    next: Reached | None


def searched(df) -> bool:
    """Whether rows hold more than what a replay makes again."""
    return "trail" in df and bool(df["trail"].notna().any())


def longest(df):
    """Of each scene and way the search that was given most."""
    df = df[df["way"].isin(WAYS)]
    if "seconds" not in df or not len(df):
        return df
    return df.sort_values("seconds", kind="stable").groupby(["scene", "way"], sort=False).tail(1)


def reached(df, scene, quantity, target, *, any_shape=True, peers=False):
    """All ways that get to a target, the cheapest first; ours, or those of others."""
    return reaching(searches_of(df, scene, quantity), quantity, target, any_shape=any_shape, peers=peers)


def searches_of(df, scene, quantity):
    """Of each way the longest search on a scene, a dict each; a record is wide, and this is asked for every target."""
    wanted = [name for name in ("scene", "way", "seconds", "trail", *COLUMNS[quantity]) if name in df]
    return longest(df.loc[df["scene"] == scene, wanted]).to_dict("records")


def reaching(rows, quantity, target, *, any_shape=True, peers=False):
    """The same of searches on one scene."""
    found = []
    for row in rows:
        how = WAYS[row["way"]]
        if (any_shape and how.spheres) or how.peer is not peers:
            continue
        for column in COLUMNS[quantity]:
            if (there := _cheapest(row, column, target)) is not None:
                found.append(there)
    return sorted(found, key=lambda each: each.cpu_s)


def _cheapest(row, column, target):
    """Of all values that get to a target the cheapest, or None: what gets farther gets there, too."""
    told = json.loads(row[column]) if isinstance(row.get(column), str) else {}
    found = {float(name): each for name, each in told.items() if isinstance(each, list)}
    there = [each for at, each in found.items() if at <= target and borne_out(row, column, at, each[0])]
    if not there:
        return None
    value, cpu_s, _, _, error, spread, _ = min(there, key=lambda each: each[1])
    return Reached(row["way"], column == "extrapolated", cpu_s, ALONE if spread is None else spread, value, error)


def best(df, scene, quantity, target, *, any_shape=True):
    """Who is the cheapest; None where nobody gets there."""
    ways = reached(df, scene, quantity, target, any_shape=any_shape)
    return best_of(ways) if ways else None


def best_of(ways):
    """The same of ways that are known."""
    tied = tuple(each for each in _by_family(ways) if alike(ways[0], each))
    names = {each.family for each in tied}
    others = [each for each in ways if each.family not in names]
    return Best(ways[0], tied, others[0] if others else None)


def _by_family(ways):
    """Of each method its cheapest rule."""
    found: dict = {}
    for each in ways:
        found.setdefault(each.family, each)
    return list(found.values())


def alike(one: Reached, other: Reached) -> bool:
    """Whether runs scatter by as much as two costs differ; values of a knob are tried no nearer than NEAR anyway."""
    return other.cpu_s <= one.cpu_s * max(NEAR, (1 + one.spread) * (1 + other.spread))


def wins(df, quantity, target, scenes) -> Mapping[str, list[str]]:
    """Scenes that each method is the cheapest on, by its name; of ties both, and those of nobody by an empty one."""
    found: dict = {}
    for scene in scenes:
        who = best(df, scene, quantity, target)
        for name in [""] if who is None else [each.family for each in who.tied]:
            found.setdefault(name, []).append(scene)
    return found


def scenes_of(df, among=SCENES):
    """Scenes of the rows, in order."""
    there = set(df["scene"])
    return [scene for scene in among if scene in there]


def judged(df, quantity, target):
    """Scenes of which the truth is known so well that a target can be judged, in order."""
    column = df.get(quantity)
    told = {} if column is None else column.dropna().map(json.loads)
    there = {df.at[at, "scene"] for at, each in dict(told).items() if f"{target:g}" in each}
    return [scene for scene in scenes_of(df, (*SCENES, *IN_TIME)) if scene in there]


def starred(scene):
    """A star stands at scenes on which constants of the DEM were found, or on their body at another contrast."""
    return f"{scene} *" if scene in TUNED else scene


def in_words(df, quantity, target):
    """Who wins on how many scenes, as a sentence."""
    scenes = judged(df, quantity, target)
    found = wins(df, quantity, target, scenes)
    named = {"dem": "DEM", "fem": "FEM", "fft": "FFT", "": "nobody"}
    parts = [f"{named[name]} on {len(each)} ({', '.join(map(starred, each))})" for name, each in found.items()]
    head = f"{target:g} % of the {quantity} costs least, of {len(scenes)} scenes and with ties counted for both"
    return f"{head}, by {'; '.join(parts)}."


def multipoles(df):
    """On how many scenes of spheres alone multipoles cost least, by accuracy, and how much dearer the next is."""
    parts = "; ".join(map(partial(_theirs, df), MULTIPOLES))
    return f"Of scenes of spheres on which they get there, they cost least {parts}."


def _theirs(df, target):
    """Of one accuracy."""
    every = [reached(df, scene, "conductivity", target, any_shape=False) for scene in scenes_of(df)]
    every = [ways for ways in every if any(WAYS[each.way].spheres for each in ways)]
    won, tied, lost = [], 0, []
    for ways in every:
        found, own = best_of(ways), next(each for each in ways if WAYS[each.way].spheres)
        if own not in found.tied:
            lost.append(own.cpu_s / ways[0].cpu_s)
        elif len(found.tied) > 1:
            tied += 1
        else:
            won.append(found)
    factors = [each.next.cpu_s / each.first.cpu_s for each in won if each.next is not None]
    said = [f"the next costs {between(sorted(factors))} times as much"] if factors else []
    said += [f"on {len(won) - len(factors)} no other gets there"] if len(factors) < len(won) else []
    said += [_ties(tied)] if tied else []
    said += [f"{between(sorted(lost))} times the cheapest on {len(lost)}"] if lost else []
    return f"to {target:g} % on {len(won)} of {len(every)}" + (f" ({'; '.join(said)})" if said else "")


def beside_peers(df):
    """Where a program of others gets to an accuracy at less cost than any of ours for any shape, or at the same."""
    said = "; ".join(filter(None, (_of_peers(df, scene, target) for scene in scenes_of(df) for target in TARGETS)))
    return f"At less cost than ours, or in a tie, get there: {said}." if said else "Nowhere at less cost than ours."


def _of_peers(df, scene, target):
    """The cheapest of theirs beside the cheapest of ours; nothing where ours costs less."""
    theirs = reached(df, scene, "conductivity", target, peers=True)[:1]
    ours = reached(df, scene, "conductivity", target)[:1]
    if not theirs or (ours and ours[0].cpu_s < theirs[0].cpu_s and not alike(ours[0], theirs[0])):
        return ""
    own = f"{ours[0].title} in {ours[0].cpu_s:.2g}" if ours else "none of ours within its search"
    tie = ", a tie" if ours and alike(*sorted((ours[0], theirs[0]), key=lambda each: each.cpu_s)) else ""
    return f"{theirs[0].title} to {target:g} % of {scene} in {theirs[0].cpu_s:.2g} s ({own}{tie})"


TITLES = {"dem": "the DEM", "fem": "finite elements", "fft": "the FFT"}


def counted(df, quantity, target):
    """The same in numbers, by method: of how many scenes, of those held back, and how much dearer the next one is."""
    scenes = judged(df, quantity, target)
    every = {scene: best(df, scene, quantity, target) for scene in scenes}
    found = {scene: each for scene, each in every.items() if each is not None}
    parts = [_alone(name, found) for name in TITLES]
    ties = [scene for scene, each in found.items() if len(each.tied) > 1]
    parts.append(_ties(len(ties)) if ties else "")
    parts.append(f"on {len(every) - len(found)} none gets there" if len(found) < len(every) else "")
    head = f"To {target:g} % of the {quantity}, of {len(scenes)} scenes where it can be judged"
    return f"{head}: {'; '.join(filter(None, parts))}."


def body_of(scene):
    """Of scenes that differ in their contrast alone, the first."""
    first = scene.split(" at ")[0]
    return first if first in STEADY else scene


def won_by(name, found):
    """Scenes that one method wins without a tie, how many are held back, their bodies, and what the next costs more."""
    won = [scene for scene, each in found.items() if len(each.tied) == 1 and each.first.family == name]
    others, bodies = sum(scene in HELD_BACK for scene in won), len({body_of(scene) for scene in won})
    factors = sorted(found[s].next.cpu_s / found[s].first.cpu_s for s in won if found[s].next is not None)
    return won, others, bodies, factors


def _alone(name, found):
    """The same in words."""
    won, others, bodies, factors = won_by(name, found)
    if not won:
        return f"{TITLES[name]} on none"
    once = f" ({bodies} {'body' if bodies == 1 else 'bodies'})" if bodies < len(won) else ""
    each = f"{TITLES[name]} on {len(won)}{once}, {others} of them held back"
    if not factors:
        return f"{each}, where no other gets there"
    return f"{each} (the next costs {between(factors)} times as much{_none(len(won) - len(factors))})"


def between(factors):
    """From the least to the largest of sorted factors."""
    # Two digits, and no power of ten.
    low, high = (f"{float(f'{factor:.2g}'):g}" for factor in (factors[0], factors[-1]))
    return low if low == high else f"{low} to {high}"


def _ties(number):
    return f"a tie on {number}"


def _none(number):
    return f"; on {number} no other gets there" if number else ""


__all__ = [
    "TARGETS",
    "best",
    "best_of",
    "between",
    "counted",
    "in_words",
    "judged",
    "longest",
    "multipoles",
    "reached",
    "scenes_of",
    "starred",
    "wins",
    "won_by",
]
