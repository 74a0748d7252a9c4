"""Figures read off rows: what costs scatter by, and what a packing costs."""

import numpy as np

# Costs nearer to each other than this factor are a tie: of solves that were run twice nine in ten are (a claim).
TIE = 1.5


def run_twice(df):
    """Factors between the costs of two solves by the DEM that do the same, one after the other: no packing is made."""
    rows = df[(df["name"] == "dem") & df["scene"].notna() & (df["status"] == "ok")]
    return np.exp(abs(np.log(rows["cached_cpu_s"] / rows["cpu_s"])))


def packing(df):
    """CPU time of the largest packing that was made on the spot, beside its solve: of the paper's network."""
    rows = df[(df["name"] == "dem-calibrated") & df["cached_cpu_s"].notna()]
    row = rows.loc[rows["particles"].idxmax()]
    made, solve = row["cpu_s"] - row["cached_cpu_s"], row["cached_cpu_s"]
    return f"{made:.2g} CPU-seconds, {made / solve:.2g} times the solve"
