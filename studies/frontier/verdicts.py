"""Claims on the rows of the frontier."""

from __future__ import annotations

import math
import statistics

from studies.frontier import advice, means

# Set before any search: the DEM the cheapest for any shape, on so many scenes.
GUESSES = (("conductivity", 0.1, 8), ("flux", 1.0, 8))
# Per cent, of half of the scenes, at the points that stand for rows: ways from the reference, degree 2.
APART = {"dem": 0.4, "fft": 0.8, "fem-p1": 4.0}
NAMES = {"dem": "DEM", "fft": "FFT", "fem-p1": "FEM, degree 1"}
# Scenes from which on shares are judged.
MANY = 10


def all_claims(df):
    """All claims whose rows are there."""
    each = means.longest(df)
    wide = each.pivot(index="scene", columns="way", values="point_k")
    for way, limit in APART.items():
        if way in wide and "fem" in wide:
            apart = 100 * (wide[way] / wide["fem"] - 1).abs()
            text = f"{NAMES[way]} and FEM of degree 2 at their points: difference of conductivities, median, %"
            yield text, apart.median(), limit
    if each["scene"].nunique() < MANY:
        return
    closer = (each["point_limit_k"] / each["point_k"] - 1).abs()[each["way"].eq("fem")]
    yield "FEM at its point: what extrapolation changes, median over scenes, %", 100 * closer.median(), 0.12
    for quantity, target, least in GUESSES:
        column = f"{quantity}_{target:g}_s"
        if column in each and each[column].notna().any():
            count = len(means.wins(df, quantity, target, means.scenes_of(df)).get("dem", ()))
            text = f"Scenes on which the DEM is the cheapest for any shape, or ties, to {target:g} % of the {quantity}"
            yield text, count, f">= {least}"
    if means.searched(df):
        yield from _advised(df)


def _advised(df):
    """How good `recommend` is on scenes that none of its laws was fitted to; limits set before."""
    found = list(advice.advices(df))
    there = [each for each in found if each.found < math.inf]
    yield "recommend: scenes and accuracies where what it names was not found to get there", len(found) - len(there), 3
    yield "recommend: cost of what it names over the least, largest", max((e.factor for e in there), default=None), 5.0
    off = sorted(each.off for each in there)
    yield "recommend: its guess of a cost and what was found, factor between, median", statistics.median(off), 3.0
