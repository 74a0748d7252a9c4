"""Claims on the rows of the frontier."""

from __future__ import annotations

import numpy as np

from demheat import referee
from studies.frontier import advice, means
from studies.frontier.scenes import SCENES

# Set before any search: the DEM the cheapest for any shape, to so many per cent, on so many scenes.
GUESSES = {"conductivity": (0.1, 8), "flux": (1.0, 8)}
# Per cent, of half of the scenes, at the points that stand for rows: ways from the reference, degree 2.
APART = {"dem": 0.4, "fft": 0.8, "fem-p1": 4.0}
NAMES = {"dem": "DEM", "fft": "FFT", "fem-p1": "FEM, degree 1"}
# Scenes from which on shares are judged.
MANY = 10


def all_claims(df):
    """All claims whose rows are there."""
    each = means.longest(df[df["scene"].isin(SCENES)])
    wide = each.pivot(index="scene", columns="way", values="point_k")
    for way, limit in APART.items():
        if way in wide and "fem" in wide:
            both = wide[[way, "fem"]].dropna().to_numpy()
            apart = np.abs(100 * referee.value_error(both[:, 0], both[:, 1]))
            text = f"{NAMES[way]} and FEM of degree 2 at their points: difference of conductivities, median, %"
            yield text, float(np.median(apart)), limit
    if each["scene"].nunique() < MANY:
        return
    both = each.loc[each["way"].eq("fem"), ["point_limit_k", "point_k"]].dropna().to_numpy()
    closer = np.abs(referee.value_error(both[:, 0], both[:, 1]))
    yield "FEM at its point: what extrapolation changes, median over scenes, %", 100 * float(np.median(closer)), 0.12
    yield from guess(each, "conductivity")
    yield from advice.claims(df)


def guess(df, quantity):
    """Of whom it was guessed, before any search, that it costs least."""
    target, least = GUESSES[quantity]
    column = f"{quantity}_{target:g}_s"
    if column not in df or not df[column].notna().any():
        return
    count = len(means.wins(df, quantity, target, means.scenes_of(df)).get("dem", ()))
    # As it was guessed: ties count, and so does each contrast of a body.
    text = f"Scenes on which the DEM is the cheapest for any shape, or ties, to {target:g} % of the {quantity}"
    yield text, count, f">= {least}"
