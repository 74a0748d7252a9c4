"""What an accuracy of fluxes and temperatures at points costs, by every method at its best.

Searches as those of `frontier`, on its scenes whose fields are known, in closed form or by multipoles. Errors are root
mean squares at 200 random points: of the flux over its mean, of the temperature over its span. A solve counts with the
asking at points. Rules are those by which a method's fields are its best or its default; what is extrapolated has no
fields of its own, and of Eyre and Milton's scheme, whose temperatures ring, nothing is fitted.

Costs are those of a quiet machine, or none are stored: `python -m studies run fluxes --out results --force`.
"""

from studies.common.searches.scenes import ONLY_SPHERES, SCENES
from studies.common.searches.ways import WAYS

# Of the steady scenes those whose fields nothing tells exactly.
UNKNOWN = ("ellipsoids", "square rod", "unions", "gyroid", "image")
RULES = ("dem", "fem", "fem-p1", "fft", "fft-loose", "fft-laminate", "fft-links", "multipole")
# Processor seconds of a search; of a scene that is named; of elements among many bodies.
USUAL, BUDGET, MESHED_S = 15.0, {"1000 spheres": 50.0, "5000 spheres": 80.0, "laminate": 4.0, "thin shell": 10.0}, 60.0
# Scenes with many bodies, around which elements begin where other methods end.
MESHED = ("83 spheres", "polydisperse", "unequal, f = .5", "30 at 0.001", "resistance", "box of 1:1:4")
# Where a rule says nothing, or nothing else than another (`frontier.cases`).
LEFT_OUT = {
    "laminate": ("fft-laminate", "fft-links", "multipole"),
    "infinite": ("fft-laminate", "fft-links"),
    "resistance": ("fft-links",),
    "1000 spheres": ("fem", "fft-laminate"),
    "5000 spheres": ("fem", "fft-laminate", "fft-links"),
}
# Linear elements, whose fluxes are constant in each, where they were once near the first.
LINEAR = ("thin shell",)
QUICK_SECONDS, QUICK_WAYS = 4.0, ("dem", "fem", "fft-loose")


def _cases():
    """Short searches of one scene, and all others."""
    yield from (_case("third", way, QUICK_SECONDS) for way in QUICK_WAYS)
    for scene in SCENES:
        if scene in UNKNOWN:
            continue
        for way in RULES:
            if way in LEFT_OUT.get(scene, ()) or (WAYS[way].spheres and scene not in ONLY_SPHERES):
                continue
            if way == "fem-p1" and scene not in LINEAR:
                continue
            meshed = way == "fem" and scene in MESHED
            yield _case(scene, way, MESHED_S if meshed else BUDGET.get(scene, USUAL))


def _case(scene, way, seconds):
    return {"scene": scene, "way": way, "seconds": seconds, "method": WAYS[way].method}


CASES = list(_cases())
# Limits from elsewhere: guessed before there were rows.
ELSEWHERE = ("Scenes on which",)
TIMEOUT = 900.0
# A search repeats what decides by itself.
REPEATS = 1
BY_ITSELF = ("way", "scene")
COSTS = ("true_k", "true_off", "true_by", "trail", "temperature", "flux", "ended", "tried")


def QUICK(case):
    """The short searches."""
    return case["seconds"] == QUICK_SECONDS


def run(scene, way, seconds, method):
    """Search, and find again what stands for the row."""
    from studies.common.searches import rows

    return again(scene, way, seconds, method) | rows.searched(scene, way, seconds, rows.FIELDS)


def again(scene, way, seconds, method):
    """What of a row is no matter of costs: errors at one value of the knob."""
    from studies.common.searches import rows

    return rows.fields_at_point(scene, way)


def warm_up(scene, way, seconds, method):
    """Load and compile the solver, work out what is true, and load what asks at points."""
    from studies.common.searches import rows

    rows.warm_up(scene, way)
    rows.fields_at_point("third", way)


def claims(df):
    """Who was expected to win; errors at the points that stand for rows.

    The guess was set before any search. Limits on errors only tell what changes: two were set when errors of single
    spheres were known, that of elements was drawn nearer when its value was.
    """
    from studies.common.searches import guesses, means

    each = means.longest(df)
    wide = each.pivot(index="scene", columns="way", values="point_flux")
    for way, name, limit in (("dem", "DEM", 3.0), ("fft", "FFT", 12.0), ("fem", "FEM, degree 2", 8.0)):
        if way in wide:
            yield f"{name} at its point: error of the flux, median over scenes, %", float(wide[way].median()), limit
    if each["scene"].nunique() > 1:
        yield from guesses.guess(each, "flux")


def table(df):
    """The cheapest way for any shape to each accuracy of the flux, in processor seconds, and the next method."""
    return _lines(df, "flux", (3.0, 1.0, 0.3, 0.1))


def temperatures(df):
    """The same of temperatures."""
    return _lines(df, "temperature", (1.0, 0.3, 0.1, 0.03))


def _lines(df, quantity, targets):
    from studies.common.searches import tables

    found = tables.lines(df, quantity, targets)
    return found[~found.drop(columns="scene").isin(["-", "?"]).all(axis=1)]


def notes(df):
    """Who wins, in words made of the rows."""
    from studies.common.searches import means

    if not means.searched(df):
        yield "No search has been run on a quiet machine yet: rows hold errors at one value each, and no costs."
        return
    for quantity, target in (("flux", 3.0), ("flux", 1.0), ("temperature", 0.1)):
        yield means.in_words(df, quantity, target)


def verdict(df):
    """In numbers."""
    from studies.common.searches import means

    return " ".join(means.counted(df, "flux", target) for target in (3.0, 1.0))


def winners(df):
    """The same as a table."""
    from studies.common.searches import tables

    return tables.winners(df, "flux", (3.0, 1.0))


def plot(df):
    """Cost over error, a panel for each scene."""
    from studies.common.searches import figure

    return figure.plot(df, "flux", told=(3.0, 1.0, 0.3, 0.1))
