"""What is made of the rows of scaling: exponents and errors."""

import math

import numpy as np

from demheat import referee
from studies.harness.pick import pick

# Stages of the DEM from the scene to the conductivity, and those of the field at points.
STAGES = ("packing", "twins", "cells", "phases", "network", "equations", "field", "points")
# A stage takes part in a fit where it lasts at least this long: shorter ones are clocks and caches.
LEAST = 0.02
# Rows of so many inclusions or elements and more are fitted: below, what does not grow weighs.
FROM = {"number": 100, "unknowns": 50_000}
MANY = 400_000


def of_stages(df):
    """CPU seconds of every stage of every row: a row for each, with its `stage`."""
    import pandas as pd

    found = [df.assign(stage="all", seconds=df["cpu_s"], wall=df["wall_s"])]
    for stage in (*STAGES, "solve"):
        if f"{stage}_cpu_s" in df:
            here = df[df[f"{stage}_cpu_s"].notna()]
            found.append(here.assign(stage=stage, seconds=here[f"{stage}_cpu_s"], wall=here[f"{stage}_wall_s"]))
    return pd.concat(found, ignore_index=True)


def fitted(df, by):
    """Exponent of the CPU time of every stage of every method."""
    import pandas as pd

    rows = []
    stages = of_stages(df[df["status"] == "ok"])
    for (name, stage), group in stages.groupby(["name", "stage"], sort=False):
        group = group[(group[by] >= FROM[by]) & (group["seconds"] >= LEAST)].sort_values(by)
        if len(group) >= 3:
            exponent, doubt = _slope(group[by].to_numpy(float), group["seconds"].to_numpy(float))
            last = group.iloc[-1]
            rows.append(
                {"name": name, "stage": stage, "exponent": exponent, "doubt": doubt, "rows": len(group)}
                | {"largest": last[by], "seconds": last["seconds"]}
            )
    return pd.DataFrame(rows, columns=["name", "stage", "exponent", "doubt", "rows", "largest", "seconds"])


def _slope(sizes, seconds):
    """Slope of the logarithms by least squares, and its standard error."""
    found, covariance = np.polyfit(np.log(sizes), np.log(seconds), 1, cov=True)
    return float(found[0]), float(np.sqrt(covariance[0, 0]))


def errors(df):
    """The rows with their error against the multipoles' conductivity of the same spheres, %, where that is known."""
    solved = pick(df[df["status"] == "ok"], name="multipole")
    if "accuracy" in solved:
        # Of several the nearest comes last, and counts.
        solved = solved.sort_values("accuracy", ascending=False, kind="stable")
    known = dict(zip(_spheres(solved), solved["k_ratio"], strict=True))
    exact = [known.get(spheres, math.nan) for spheres in _spheres(df)]
    return df.assign(error_percent=100 * referee.value_error(df["k_ratio"], np.array(exact, dtype=float)))


def _spheres(df):
    """What tells the spheres of each row from others; all rows of `elements` have the same."""
    drawn = zip(df["number"], df["kind"], df["fraction"], strict=True)
    parts = df["part"] if "part" in df else [None] * len(df)
    return ["cell" if part == "elements" else one for part, one in zip(parts, drawn, strict=True)]


def on_ranks(df):
    """Rows on one rank and on two, of so many unknowns that what does not grow weighs little."""
    if "ranks" not in df:
        return df[:0]
    return df[df["part"].isin(("strong", "weak")) & (df["status"] == "ok") & (df["unknowns"] >= MANY)]
