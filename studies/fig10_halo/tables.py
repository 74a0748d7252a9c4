"""The tables of the study of halos."""

import numpy as np

from studies.fig10_halo.statistics import COSTED, PAPER, SHOWN, WEIGHTINGS, long
from studies.harness.cells import numbers
from studies.harness.pick import pick

KEY = ["law", "split", "walls", "particles"]


def factors(rows):
    """How far each weighting of the paper's network is off the printed scatter, by halo."""
    import pandas as pd

    here = pick(rows, law="calibrated", split="half", walls="held")
    here = here[here["particles"] == here["particles"].max()].groupby("ratio")[list(WEIGHTINGS.values())].mean()
    found = {r: here.loc[r] / PAPER[f"cov_{r:g}"] for r in SHOWN}
    return pd.DataFrame(found).set_axis(pd.MultiIndex.from_tuples(WEIGHTINGS))


def table(df):
    """CoV of the flux in per cent, means over packings: over all particles or the bulk, by number and by volume.

    "own" is without halo, "halo 4" and "halo 11" with halos of so many mean radii.
    """
    import pandas as pd

    shown = []
    for names, rows in long(df).fillna({"split": ""}).groupby(KEY, sort=False):
        means = rows.groupby("ratio")[list(WEIGHTINGS.values())].mean()
        for over in ("all", "bulk") if dict(zip(KEY, names, strict=True))["walls"] == "held" else ("all",):
            row = dict(zip(KEY, names, strict=True)) | {"over": over}
            for by in ("number", "volume"):
                column = WEIGHTINGS[over, by]
                row |= {_title(r, by): means.loc[r, column] for r in SHOWN}
            shown.append(row)
    paper = {"law": "paper (weighting not said)", "split": "half", "walls": "held"}
    shown.append(paper | {_title(r, "number"): PAPER[f"cov_{r:g}"] for r in SHOWN})
    names = [*KEY, "over", *(_title(r, by) for by in ("number", "volume") for r in SHOWN)]
    return pd.DataFrame(shown)[names].fillna({"split": "", "walls": "", "over": ""})


def _title(ratio, by):
    return f"{'own' if ratio == 0 else f'halo {ratio:g}'}, {by}"


def extremes(df):
    """Smallest and largest flux of any particle, and what that costs."""
    import pandas as pd

    shown = []
    for names, rows in long(df).fillna({"split": ""}).groupby(KEY, sort=False):
        row = dict(zip(KEY, names, strict=True))
        last = rows[rows["ratio"] == (0.0 if row["law"] == "laguerre" else COSTED)]
        row |= {"halo": "none" if row["law"] == "laguerre" else f"{COSTED:g}"}
        row |= {"least": last["least"].min(), "most": last["most"].max()}
        same = pick(df, law=row["law"], split=row["split"] or None, walls=row["walls"], particles=row["particles"])
        shown.append(row | {"cpu_s": same["cpu_s"].mean(), "peak_mib": same["peak_mib"].mean()})
    return pd.DataFrame(shown)


def in_words(df):
    """What each weighting makes of the printed numbers, and how deep the walls reach, as sentences."""
    found = factors(long(df))
    said = "; ".join(
        f"over {over}, by {by} " + ", ".join(f"{value:.2f}" for value in line)
        for (over, by), line in zip(found.index, found.to_numpy(), strict=True)
    )
    number = pick(df, law="calibrated", split="half", walls="held")["particles"].max()
    yield (
        f"Scatter of the paper's network with {number:.0f} particles over the printed {PAPER['cov_0']:g}, "
        f"{PAPER['cov_4']:g} and {PAPER['cov_11']:g} %, own flux and halos of 4 and 11: {said}. The paper names no "
        "weighting. What it prints does not change from 1e5 to 5e5 elements, as in the bulk, where halos end at no "
        "wall."
    )
    rows = pick(df, law="calibrated", split="half", walls="held", particles=number)
    if "near_11" not in rows or rows["near_11"].isna().all():
        return
    own, wide = (_over_bulk(numbers(rows[f"near_{r}"].iloc[0])) for r in (0, 11))
    yield (
        f"Mean flux below a wall with a temperature, over that of the bulk: within one mean radius of it {own[0]:.2f}, "
        f"since eq. 20 has no links to walls; with halos of 11 {wide[0]:.3f} there, and {wide[8]:.3f} at a depth of 8 "
        "to 9 mean radii, where point C of Table 2 is with 1.5e5 elements: the paper's flux there is 4 % low."
    )


def _over_bulk(means):
    """Means by depth over that of the four deepest layers."""
    return means / np.nanmean(means[-4:])
