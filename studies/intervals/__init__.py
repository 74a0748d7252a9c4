"""Intervals of 440 drawn scenes of every kind, half of them for judging only: how often each method's own holds.

Each method answers by its defaults, at a resolution drawn by the scene's seed, and its interval is what `Field.error`
gives by itself. Kinds: cubic arrays up to nearly touching, specks, copies in boxes up to 1:20, coats and layers down to
a thousandth and less, fibres, rods, checkerboards, plates, rods of any sides, unions, level sets told in eight ways,
images, spheres at random, needles and discs up to 1:20, half-spaces, bodies without a closed form, and large spheres
with small satellites; contrasts from 1e-6 to 1e6. What is true is a closed form of the scene, or of one that must
conduct alike, Keller's duality, Maxwell's estimate of what is small and far apart, multipoles, finer ones, or finer
elements, each with its own doubt.

An interval holds if it has a point in common with what is true; how many hold by that doubt alone, and not with its
middle, is said. Scenes of odd seeds are for judging only: nothing is ever changed because of them (of particles and
finite elements the first eleven were looked at; theirs are later ones; of images and level sets all were, as nine
intervals missed that were new, and none of theirs judges: docs/decisions/estimates.md). Limits were set before any
value was seen, the median by half of the interval, as in study `estimates`. A method that refuses, or has no interval,
counts neither way; finite elements are not asked where a mesh would be dear.
What methods close in on (`Field.extrapolated`) has an interval of its own, which 95 % are to hold, on smooth bodies of
seeds that nothing was changed because of.
"""

from demheat.runtime.lazy import lazy_names
from studies.intervals.scenes import KINDS

__getattr__, __dir__ = lazy_names(
    __name__, {"studies.intervals.means": ("table",), "studies.intervals.figure": ("plot",)}
)

EACH = 22  # Scenes of a kind
# Methods that cost more are asked for the first of each kind.
FIRST = {"dem": 11, "fem": 11, "fft-em": 11}
# Thin ones have elements as fine as they are thin.
DEAR = {("fem", "needles, discs"): 5}
# Misses of these among the first odd seeds were looked at: they are judged by later ones.
LOOKED_AT = ("dem", "fem")
# And of these kinds by these methods, all of them.
SEEN = {"image": ("dem", "fem", "fft-em"), "level set": ("dem", "fem")}
SHOWN = ("array", "layers", "half-space")
# Single spheres in a cell, whose truth is not theirs, and what finer ones judge.
BY_MULTIPOLES = ("array", "speck", "copies", "satellites")
LEAST, WIDE = 0.98, 5.0
MANY = 20  # Scenes from which on shares are judged
# Methods whose wide intervals are counted, and what half of such an interval is more than, over what is true.
TAILS, BEYOND = ("dem", "fft"), (0.1, 0.5)
# What the same methods close in on (`Field.extrapolated`), with an interval of its own: smooth bodies, each by itself.
# Orders and safeties were found on seeds below the first of these, so that all of them are for judging only.
LIMITS = {"dem-limit": "dem", "fem-limit": "fem", "fft-limit": "fft"}
SMOOTH, OF_LIMITS = (
    ("array", "copies", "fibre", "union", "level set", "spheres", "spheres, walls", "polydisperse"),
    range(18, 30),
)
# Elements are not known of what a function tells in walls, and dear about many.
BY_ELEMENTS = ("array", "fibre", "union", "spheres, walls", "spheres")
LIMITS_LEAST = 0.95
# Limits from elsewhere: asked of intervals before there were any.
ELSEWHERE = ("share of", "same of scenes", "interval over the error")
MODULES = {"truth": "studies.intervals.truth", "fft-em": "references.fft"} | {
    name: {"dem": "demheat.dem"}.get(module, f"references.{module}") for name, module in LIMITS.items()
}
# Kinds that a method solves exactly do not tell what has moved on others.
BY_ITSELF = ("scene",)
# Why claims on the stored rows fail.
FAILS = {
    "DEM, extrapolated: half of the interval": (
        "coarser runs are fewer and coarser than those of `error`, whose interval is narrower, and nothing is taken off"
    ),
    "FEM, extrapolated: half of the interval": (
        "on meshes as coarse as these runs turn or differ little where errors cancel, and the interval counts on that"
    ),
    "multipoles: half of the interval": (
        "4.6 when degrees rose until changes were small; they rise until this is narrow now, two or so farther, where "
        "changes of arrays fall faster than the worst that gaps allow, on which the interval counts"
    ),
    "DEM: half of the interval": (
        "half of the scenes have specks and needles, whose intervals reach to what leaving them out changes, coats, or "
        "spheres whose errors fell to a tenth by tiles and twins, changes between runs by less; an order of 2.5 made "
        "it 4.8 on even seeds, but intervals of few particles ended before the truth (study estimates)"
    ),
}
TIMEOUT = 600.0


def _methods(kind, seed):
    yield from ("truth", "fft")
    yield from (name for name, number in FIRST.items() if _asked(name, seed, DEAR.get((name, kind), number)))
    yield from ("multipole",) * (kind in BY_MULTIPOLES)


def _asked(name, seed, number):
    """Whether a method is asked of a seed: the first, or even ones of these and as many later odd ones."""
    first = number if name in LOOKED_AT and seed % 2 else 0
    return first <= seed < first + number


def _limits(kind, seed):
    """What is true where no other row says so, and the methods."""
    yield from ("truth",) * (seed >= EACH)
    yield from (name for name in LIMITS if name != "fem-limit" or kind in BY_ELEMENTS)


def _cases():
    for seed in range(EACH):
        yield from (_case(kind, seed, method) for kind in KINDS for method in _methods(kind, seed))
    for seed in OF_LIMITS:
        yield from (_case(kind, seed, method) for kind in SMOOTH for method in _limits(kind, seed))


def _case(kind, seed, method):
    return {"scene": kind, "seed": seed, "method": method}


CASES = list(_cases())
VALUES = True


def QUICK(case):
    """A scene of three kinds, and one for what methods close in on."""
    if case["seed"] == OF_LIMITS[0]:
        return case["scene"] == SHOWN[0] and case["method"] in ("truth", *LIMITS)
    return case["seed"] == 0 and case["scene"] in SHOWN


def run(scene, seed, method):
    """What is true of a scene, or what a method says of it."""
    from studies.intervals import rows

    if method in LIMITS:
        found = rows.limited(scene, seed, LIMITS[method])
    else:
        found = rows.known(scene, seed) if method == "truth" else rows.judged(scene, seed, method)
    return {"judging_only": seed % 2 == 1 or method in LIMITS, **found}


def claims(df):
    """Intervals hold, are no blankets, and reach the truth where something is warned of or not seen."""
    from studies.intervals.means import answers, held, over, over_plain, title

    each = answers(df)
    if df["seed"].nunique() < MANY:
        yield "Intervals that miss, of some scenes", int((~held(each)).sum()), "<= 1"
        yield "Intervals there are", len(each), ">= 3"
        return
    for name, rows in each.groupby("method", sort=False):
        if name in LIMITS:
            yield f"{title(name)}: share of intervals that hold", held(rows).mean(), f">= {LIMITS_LEAST}"
            # Of the answer that was extrapolated: how much narrower the interval is than the one about that.
            wide = over_plain(rows)
            yield f"{title(name)}: half of the interval over the error before, median", wide.median(), WIDE
            continue
        yield f"{title(name)}: share of intervals that hold", held(rows).mean(), f">= {LEAST}"
        unseen = rows[rows["judging_only"].eq(True) & ~rows["scene"].isin([k for k in SEEN if name in SEEN[k]])]
        yield f"{title(name)}: the same of scenes for judging only", held(unseen).mean(), f">= {LEAST}"
        yield f"{title(name)}: half of the interval over the error, median", over(rows).median(), WIDE
    warned, lost = each[each["warned"].eq(True)], each[each["unseen"].eq(True)]
    yield f"Intervals that miss, of {len(warned)} beside a warning", _count(~held(warned)), "= 0"
    short = ~held(lost) | ~lost["reached"].eq(True)
    yield f"Intervals that end before the bounds, of {len(lost)} with a part that is not seen", _count(short), "= 0"


def _count(wrong):
    """How many, no number where there are none to look at."""
    return int(wrong.sum()) if len(wrong) else float("nan")


def notes(df):
    """How many there are of each."""
    from studies.intervals.means import answers, held, strictly

    each = answers(df)
    scenes = _scenes(df)
    asked = df[df["method"] != "truth"]
    none = int((asked["conductivity"].notna() & asked["lower"].isna()).sum())
    refused = int((asked["status"] == "unsupported").sum())
    yield f"{scenes} scenes, {len(each)} intervals; {refused} times a method refused, {none} times it had no interval."
    doubtful = int((held(each) & ~strictly(each)).sum())
    yield f"{doubtful} intervals hold a part of what is true within its doubt, not its middle; they count as holding."
    yield f"Extrapolated, on smooth bodies of seeds from {OF_LIMITS[0]} on: {limits(df)}."


def words(df):
    """How many hold, and how wide they are."""
    from studies.intervals.means import answers, in_words

    each = answers(df)
    return f"on {_scenes(df)} scenes of twenty kinds there held {in_words(each[~each['method'].isin(LIMITS)])}"


def widest(df):
    """What share of intervals is wide, of methods that answer on any scene."""
    from studies.intervals.means import answers, half, title

    each = answers(df)
    halves = {name: half(each[each["method"] == name]) for name in TAILS}
    said = []
    for of in BEYOND:
        shares = [f"{100 * (wide > of).mean():.2g} % ({title(name)})" for name, wide in halves.items()]
        said.append(f"more than {100 * of:g} % of the truth on {' and '.join(shares)}")
    return f"half of the interval was {', '.join(said)}"


def limits(df):
    """How many intervals about what methods close in on hold, and what is left of errors."""
    from studies.intervals.means import answers, gain, held, title

    each = answers(df)
    groups = each[each["method"].isin(LIMITS)].groupby("method", sort=False)
    said = [f"{held(rows).sum()} of {len(rows)} ({title(name)}, {gain(rows).median():.2g})" for name, rows in groups]
    return f"intervals that hold, and what is left of the error in the median: {', '.join(said)}"


def _scenes(df):
    """Scenes of which methods answer by themselves."""
    return len(df.loc[~df["method"].isin(LIMITS) & (df["seed"] < EACH), ["scene", "seed"]].drop_duplicates())
