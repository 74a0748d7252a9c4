"""Surfaces without formulas: gyroid, primitive, diamond, random fields, overlapping spheres, a checkerboard, a knot.

The labyrinths of three minimal surfaces, by their nodes, at fractions from .1 to .9; a level cut of twelve random
waves, much like a Gaussian field; spheres at random places that overlap, below and above the fraction .29 at which they
join through; checkerboards in three dimensions as images, in order and at random; a trefoil of triangles. What does not
reach through the cell conducts without bound, too. No exact value is known of any: the DEM, the FFT and finite
elements, are held against each other and against bounds of the fractions that they have (Hashin and Shtrikman's of the
labyrinths, which are cubic, else those of layers), half labyrinths besides against walkers, which have no grid
(`references.walkers`). Both labyrinths of each surface are alike, so a contrast of .01 at a fraction is 100 at the
rest, a hundredth of it. Of half a labyrinth that does not conduct a third is left, as was found of P and D (Torquato,
Hyun and Donev 2002).
"""

import math

import numpy as np

from demheat import referee
from studies.harness import methods
from studies.harness.pick import largest, pick, present
from studies.harness.tolerance import Tolerance

LABYRINTHS = ("primitive", "diamond", "gyroid")
FRACTIONS, HALF = (0.1, 0.3, 0.5, 0.7, 0.9), 0.5
# What the DEM and the FFT are asked of these, who pay for each point of a surface.
OF_ALL = (0.1, 0.5, 0.9)
BAD, GOOD = 0.01, 100.0
# Particles, voxels along an edge, size of elements in edges; elements once more, finer.
SPENT, FINE, FINER = {"dem": 8_000, "fft": 32, "fem": 1 / 12}, 1 / 18, 1 / 24
# Necks of these are thin: of labyrinths of little and of what is left of them, and of spheres that overlap.
THIN = {"diamond": 1 / 32, "gyroid": FINER}
NARROW, NECKED, MANY = (0.1, 0.9), (1 / 40, 1 / 48), 27_000
THINNER = 1 / 40
# What stands apart from its images.
ALONE = (("primitive", 0.1), ("knot", None))
# The knot's tube is a tenth of an edge thick.
ON_KNOT = (1 / 24, 1 / 32)
# Beside pores laminates of voxels do not converge: plain ones, more of them. Beside perfect conductors they do not, or
# are a tenth off: links, which the method takes there by itself.
PLAIN = 64
# Part, contrast and fraction of what all three take.
OTHERS = (
    ("random field", GOOD, 0.3),
    ("overlapping spheres", GOOD, 0.24),
    ("overlapping spheres", GOOD, 0.34),
    ("knot", GOOD, None),
    ("knot", BAD, None),
)
BOARDS, CHECKERED = ("checkerboard", "random checkerboard"), (BAD, 10.0, GOOD)
# Walkers, who have no grid, judge half labyrinths: walks, and radius of balls on surfaces in edges. What conducts a
# hundred times better holds them too long, and points in a surface of triangles are slow to tell.
WALKS, RADIUS = 2000, 0.03
MODULES = {"walkers": "references.walkers"}
# On another processor they go other ways: two means are 1.4 of half an interval of 2 % apart, twice in a hundred times
# as much again, and their lag may be the next.
TOLERANCES = {"walked_ratio": Tolerance(0.06, 0.0), "walked_half_percent": Tolerance(0.8, 0.0)}
# Sizes of bricks, in edges.
BRICKS = (1 / 16, 1 / 32)
# Largest distance from elements, %, over the rows of a part. They were set before rows were seen; known were of the
# gyroid at a half and contrast 10 .03 and .15 %, and at 100 that links of 32 voxels are 5 % below. Links
# beside perfect conductors were added later, with the limits of the FFT, when their first values were known.
APART = {
    "labyrinths": {"dem": 2.0, "fft": 6.0, "fft-links": 6.0, "fft-plain": 4.0},
    "random field": {"dem": 3.0, "fft": 8.0},
    "overlapping spheres": {"dem": 4.0, "fft": 10.0},
    "knot": {"dem": 2.0, "fft": 4.0, "fft-links": 4.0},
}
REASONS = {
    "largest distance from elements": "set before the rows were seen; those of links are the limits of the FFT",
    "largest distance from walkers": "set when primitive ones were known, a fifth of one",
    "contrast .01 beside 100": "set before it was seen that the meshes of both share the symmetry",
}
FAILS = {
    "overlapping spheres, DEM": "particles are wider than the necks by which spheres join; elements and voxels agree",
    "largest change to coarser ones": "of overlapping spheres, whose necks and gaps are of any width",
    "bricks of half the size": "fluxes are without bound at edges where four cells meet, the more the contrast",
}
PAPER = {}
TIMEOUT = 3600.0


def _case(name, part, contrast, fraction, value=None):
    value = (SPENT | {"fft-plain": PLAIN, "fft-links": SPENT["fft"]})[name] if value is None else value
    where = {"part": part, "contrast": contrast} | ({} if fraction is None else {"fraction": fraction})
    return methods.case(name, **where, **methods.at(methods.all_methods()[name], value))


def _finest(name, part, fraction):
    """What is spent on a scene where it is not the usual."""
    narrow = part in THIN and fraction in NARROW
    if name == "fem":
        return THIN[part] if narrow else None
    return MANY if name == "dem" and (narrow or part == "overlapping spheres") else None


def _cases():
    for part in LABYRINTHS:
        for fraction in FRACTIONS:
            for contrast in (0.0, BAD, GOOD):
                yield _case("fem", part, contrast, fraction, _finest("fem", part, fraction))
            for name in ("dem", "fft") if fraction in OF_ALL else ():
                yield _case(name, part, GOOD, fraction, _finest(name, part, fraction))
        for name in ("dem", "fft-plain"):
            yield _case(name, part, 0.0, HALF)
        yield _case("fem", part, GOOD, HALF, FINE)
    yield _case("fem", "diamond", GOOD, NARROW[0], THINNER)
    for other in OTHERS:
        for name in ("dem", "fft"):
            yield _case(name, *other, _finest(name, other[0], None))
        sizes = {"knot": ON_KNOT, "overlapping spheres": NECKED, "random field": (FINE, FINER)}
        for size in sizes[other[0]]:
            yield _case("fem", *other, size)
    for part, fraction in ALONE:
        for name in ("dem", "fft-links"):
            yield _case(name, part, math.inf, fraction)
        yield _case("fem", part, math.inf, fraction, ON_KNOT[-1])
    for part in BOARDS:
        for contrast in CHECKERED:
            for size in BRICKS:
                yield _case("fem-p1", part, contrast, None, size)
    for part in LABYRINTHS:
        for contrast in (0.0, BAD):
            where = {"part": part, "contrast": contrast, "fraction": HALF}
            yield {"name": "walkers", **where, "method": "walkers", "walks": WALKS, "radius": RADIUS}


CASES = list(_cases())


def QUICK(case):
    """Half labyrinths of the primitive surface, and the knot by elements."""
    return (
        case["part"] == "primitive" and case.get("fraction") == HALF and case["name"] not in ("dem", "walkers")
    ) or (case["part"] == "knot" and case["name"] == "fem")


def VALUES(case):
    """All: nobody asks what they cost."""
    return True


def run(name, part, contrast, method, fraction=None, **knobs):
    """Solve one scene; conductivity and bounds over the matrix's, the latter of the fractions that the method has."""
    from references import bounds
    from studies.formless import scenes

    scene = scenes.made(part, contrast, fraction)
    if name == "walkers":
        return _walked(scene, **knobs)
    field = methods.load(method).solve(scene, **knobs)
    own = float(sum(field.fractions[1:]))
    if contrast == math.inf:
        low, high = 1 + 3 * own / (1 - own) if part in LABYRINTHS else 1 / (1 - own), contrast
    elif part in LABYRINTHS:
        low, high = bounds.hashin_shtrikman(1.0, contrast, own)
    else:
        low, high = (mean([1.0, contrast], [1 - own, own]) for mean in (bounds.reuss, bounds.voigt))
    found = {"k_ratio": field.conductivity / methods.MATRIX, "inclusion": own}
    known = {name: field.stats.get(name) for name in ("unknowns", "iterations", "residual")}
    return found | {"lower_ratio": float(low), "upper_ratio": float(high)} | known


def _walked(scene, walks, radius):
    """What walkers find, and half of the interval that holds it 95 times of 100."""
    from references import walkers

    found = walkers.solve(scene, walks=walks, radius=radius * max(scene.size))
    half = 50 * (found.upper - found.lower) / found.conductivity
    return {"walked_ratio": found.conductivity / methods.MATRIX, "walked_half_percent": half}


def claims(df):
    """Distances between methods, bounds, fractions, and what symmetry says."""
    yield from present(_claims(df))


def _claims(df):
    rows = _with_elements(df)
    for group, limits in APART.items():
        mine = rows[rows["group"] == group]
        for name, limit in limits.items():
            text = f"{group}, {methods.all_methods()[name].title}: largest distance from elements, %"
            yield text, largest(pick(mine, name=name), "apart_percent"), limit
    fine = rows[rows["finer_percent"].notna()]
    yield "finite elements: largest change to coarser ones, %", largest(fine, "finer_percent"), 0.5
    text = "half labyrinths, finite elements: largest distance from walkers, in halves of their intervals"
    yield text, largest(_walked_apart(df), "apart_halves"), 2.0
    yield "least distance from a bound, % of it", _room(df), ">= 0"
    yield "labyrinths, finite elements: fractions off by, % of the cell", largest(_off(df), "off_percent"), 0.1
    yield "labyrinths, finite elements: contrast .01 beside 100 of the rest, %", _dual(df), 0.5
    yield "checkerboards: largest change to bricks of half the size, %", _halved(df), 10.0
    yield "checkerboard in order: contrast .01 beside 100, %", _swapped(df), 0.01
    third = pick(df, name="fem", contrast=0.0, fraction=HALF)
    third = third.assign(
        third_percent=100 * referee.value_error(third["k_ratio"].to_numpy(), np.full(len(third), 1 / 3))
    )
    yield "half labyrinths that do not conduct, finite elements: off a third, %", largest(third, "third_percent"), 1.5


def _with_elements(df):
    """Rows with their group, and how far they are from the finest elements of the same scene, %."""
    df = df.reset_index(drop=True)
    group = df["part"].where(~df["part"].isin(LABYRINTHS), "labyrinths")
    apart, finer = [], []
    for row in df.to_dict("records"):
        where = {key: _none(row.get(key)) for key in ("part", "contrast", "fraction")}
        elements = pick(df, name="fem", **where)
        best = elements[elements["size"] == elements["size"].min()]["k_ratio"] if len(elements) else ()
        off = (
            100 * referee.value_error(row["k_ratio"], float(best.iloc[0]))
            if len(best) and float(best.iloc[0])
            else float("nan")
        )
        apart.append(off if row["name"] != "fem" else float("nan"))
        finer.append(off if row["name"] == "fem" and row["size"] > elements["size"].min() else float("nan"))
    return df.assign(group=group, apart_percent=apart, finer_percent=finer)


def _walked_apart(df):
    """Rows of walkers, with how far the finest elements are from them, in halves of their intervals, and by what."""
    lines = []
    for row in pick(df, name="walkers").to_dict("records"):
        elements = pick(df, name="fem", **{key: row[key] for key in ("part", "contrast", "fraction")})
        if len(elements):
            off = referee.value_error(float(elements.sort_values("size")["k_ratio"].iloc[0]), row["walked_ratio"])
            lines.append(row | {"apart_halves": 100 * off / row["walked_half_percent"], "apart_percent": 100 * off})
    return df.iloc[:0].assign(apart_halves=[]) if not lines else type(df)(lines)


def _none(value):
    return None if value is None or value != value else value


def _room(df):
    """Least distance from a bound, % of the upper one, of perfect conductors the lower; negative outside of them."""
    df = df[df["name"] != "walkers"]
    if not len(df):
        return None
    scale = df["upper_ratio"].where(df["upper_ratio"] < math.inf, df["lower_ratio"])
    low = (df["k_ratio"] - df["lower_ratio"]) / scale
    return float(100 * low.combine((df["upper_ratio"] - df["k_ratio"]) / scale, min).min(skipna=False))


def _off(df):
    rows = pick(df, name="fem")
    rows = rows[rows["part"].isin(LABYRINTHS)]
    return rows.assign(off_percent=100 * (rows["inclusion"] - rows["fraction"]))


def _dual(df):
    """Largest distance of a bad labyrinth from the good one that it is beside, %."""
    worst = None
    for part in LABYRINTHS:
        for fraction in FRACTIONS:
            one = pick(df, name="fem", part=part, contrast=BAD, fraction=fraction)["k_ratio"]
            other = pick(df, name="fem", part=part, contrast=GOOD)
            other = other[(other["fraction"] - (1 - fraction)).abs() < 1e-9].sort_values("size")["k_ratio"]
            if len(one) and len(other):
                off = abs(100 * referee.value_error(float(one.iloc[0]), BAD * float(other.iloc[-1])))
                worst = off if worst is None else max(worst, off)
    return worst


def _boards(df, part):
    """Conductivities of a checkerboard by contrasts, down, and sizes of bricks, across."""
    return (
        pick(df, part=part, name="fem-p1").pivot(index="contrast", columns="size", values="k_ratio").sort_index(axis=1)
    )


def _halved(df):
    """Largest change of a checkerboard's conductivity when its bricks are halved, %."""
    both = [each for each in (_boards(df, part) for part in BOARDS) if each.shape[1] == len(BRICKS)]
    return max(
        (
            float(abs(100 * referee.value_error(each.iloc[:, 1].to_numpy(), each.iloc[:, 0].to_numpy())).max())
            for each in both
        ),
        default=None,
    )


def _swapped(df):
    """Both materials of a checkerboard in order lie alike, %."""
    each = _boards(df, BOARDS[0])
    if not {BAD, GOOD} <= set(each.index):
        return None
    return float(abs(100 * referee.value_error(each.loc[BAD].to_numpy(), BAD * each.loc[GOOD].to_numpy())).max())


def table(df):
    """Conductivity over the matrix's by the finest elements, the others' distance from it, %, and the bounds.

    Of walkers half of their interval besides.
    """
    import pandas as pd

    rows, lines = _with_elements(df), []
    for (part, contrast, fraction), group in rows.groupby(["part", "contrast", "fraction"], sort=False, dropna=False):
        finest = group[group["size"] == group["size"].min()] if group["size"].notna().any() else group
        first = finest.iloc[0]
        line = {"part": part, "contrast": contrast, "fraction": fraction, "elements": first["k_ratio"]}
        for title, names in (("DEM", ("dem",)), ("FFT", ("fft", "fft-plain", "fft-links"))):
            apart = group[group["name"].isin(names)]["apart_percent"]
            line[title] = float(apart.iloc[0]) if len(apart) else float("nan")
        walked = _walked_apart(group)
        for title, column in (("walkers", "apart_percent"), ("walkers +-", "walked_half_percent")):
            # Elements are off the walkers' by what these are off the elements', turned, to first order.
            line[title] = (
                float((-1 if title == "walkers" else 1) * walked[column].iloc[0]) if len(walked) else float("nan")
            )
        lines.append(line | {"at least": first["lower_ratio"], "at most": first["upper_ratio"]})
    return pd.DataFrame(lines)


def plot(df):
    """Conductivity of labyrinths against their fraction, between bounds, and how far methods are apart."""
    import matplotlib.pyplot as plt

    figure, (one, other) = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
    marks = {"fem": "o", "dem": "s", "fft": "^"}
    for colour, part in zip(("C0", "C1", "C2"), LABYRINTHS, strict=True):
        for name, mark in marks.items():
            rows = pick(df, part=part, name=name, contrast=GOOD).sort_values("fraction")
            fill = colour if name == "fem" else "none"
            label = f"{part}, {methods.all_methods()[name].title}"
            one.plot(rows["fraction"], rows["k_ratio"], mark, color=colour, mfc=fill, label=label)
    rows = pick(df, name="fem", part=LABYRINTHS[0], contrast=GOOD).sort_values("fraction")
    one.fill_between(rows["fraction"], rows["lower_ratio"], rows["upper_ratio"], color="0.9", label="bounds")
    one.set(xlabel="fraction", ylabel="conductivity over the matrix's", yscale="log", title="contrast 100")
    one.legend(fontsize=7)
    rows = _with_elements(df)
    rows = rows[rows["apart_percent"].notna()]
    names = [f"{r.part}, {r.contrast:g}" for r in rows.itertuples()]
    places = {name: k for k, name in enumerate(dict.fromkeys(names))}
    marks |= {"fft-plain": "v", "fft-links": "<"}
    for name in ("dem", "fft", "fft-plain", "fft-links"):
        mine = (rows["name"] == name).to_numpy()
        where = [places[each] for each, take in zip(names, mine, strict=True) if take]
        other.plot(rows["apart_percent"][mine], where, marks[name], label=methods.all_methods()[name].title)
    other.axvline(0.0, color="0.6", lw=0.8)
    other.set(yticks=range(len(places)), yticklabels=list(places), xlabel="distance from finite elements, %")
    other.legend(fontsize=8)
    return figure
