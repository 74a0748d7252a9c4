"""Tables of the single inclusion: the methods, what a first reader asks for, and the paper's network's variants."""

import math

from studies.common.paper_variants import best_variant, parted, shown, told_of, variant_errors
from studies.fig14_single_inclusion.means import PAPER, exact_of
from studies.fig14_single_inclusion.scenes import CONTRASTS, WORDS
from studies.harness.figures import LOOK
from studies.harness.methods import resolution
from studies.harness.pick import mean_errors, pick, with_size

COSTS = ("unknowns", "iterations", "cpu_s", "peak_mib")
FIRST = ("dem", "dem-plain", "dem-calibrated", "fem", "fft", "maxwell")
NETWORK = "DEM as in the paper, its best variant"


def lines(df):
    """Table as a data frame, a line for each method and resolution."""
    import pandas as pd

    shown = df[df["periodic"].isna() & df["contrast"].isin(CONTRASTS)]
    rows, order = [], list(shown["name"].unique())
    groups = with_size(shown).groupby(["name", "h"], dropna=False, sort=False)
    # Method by method, the finest last: not every scene has rows of all sizes.
    for (name, _), group in sorted(groups, key=lambda each: (order.index(each[0][0]), -each[0][1])):
        errors = mean_errors(group, scene="third")
        row = {"method": LOOK[name][0], "resolution": resolution(group.iloc[0])}
        row |= {f"{c:g}": float(errors.get(c, math.nan)) for c in CONTRASTS}
        row["f = 0.5"] = float(pick(group, scene="half")["error_percent"].mean())
        cost = pick(group, scene="third", contrast=10.0)
        row["packings"] = float(cost["seed"].nunique()) or math.nan
        row |= {column: float(cost[column].mean()) for column in COSTS}
        made = group[group["packing_cached"].astype(str) == "False"]
        rows.append(row | {"packing_s": float(made["packing_s"].mean())})
    found = pd.DataFrame(rows)
    # Where all packings came from the cache nothing is said of making them.
    return found if found["packing_s"].notna().any() else found.drop(columns="packing_s")


def headline(df):
    """The finest rows of the methods that a first reader asks for, without what they cost besides time."""
    import pandas as pd

    network, others = parted(df)
    shown = lines(others).groupby("method", sort=False).tail(1).set_index("method")
    named = [LOOK[name][0] for name in FIRST if LOOK[name][0] in shown.index]
    columns = ["resolution", *WORDS, "f = 0.5", "cpu_s"]
    found = shown.loc[named, columns].reset_index()
    made = variant_errors(network, exact_of(df))
    first = best_variant(made, WORDS)
    if first is None:
        return found
    means = {name: each.mean for name, each in made[first].items()}
    row = {"method": NETWORK, "resolution": f"{first[1]} particles"} | {word: means[word] for word in WORDS}
    row |= {"f = 0.5": means.get("half", math.nan), "cpu_s": math.nan}
    place = named.index(LOOK["dem-calibrated"][0]) + 1 if LOOK["dem-calibrated"][0] in named else 0
    return pd.concat([found[:place], pd.DataFrame([row]), found[place:]], ignore_index=True)


def notes(df):
    """The variants of the paper's network; what is a choice here, or a property of the scenes."""
    network, others = parted(df)
    made = variant_errors(network, exact_of(df))
    names = {word: word for word in WORDS} | {"half": "f = 0.5"}
    best = "; the best is the one whose largest error at the four contrasts is least"
    said = shown(made, names, "in all its variants: errors, %, by contrast", best, WORDS)
    if made:
        said += [
            told_of(made, WORDS),
            told_of(variant_errors(network, exact_of(df, "maxwell")), WORDS, "difference from Maxwell's formula")
            + f" In this measure the paper prints {PAPER['worst_error']:g} %.",
        ]
    off = abs(pick(others, name="maxwell", scene="half")["error_percent"]).max()
    most = pick(others, name="fem", scene="third")["unknowns"].max()
    return said + [
        f"Maxwell's formula is {off:.2g} % off where the sphere fills half of the cube: that scene tells apart what "
        f"the paper's does not. The finest mesh of quadratic elements of the paper's scene has {most:.0f} unknowns."
    ]
