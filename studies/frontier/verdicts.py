"""Claims on the rows of the frontier."""

import numpy as np

from demheat import referee
from studies.common.searches import guesses, means
from studies.common.searches.scenes import SCENES
from studies.frontier import advice, second

# Per cent, of half of the scenes, at the points that stand for rows: ways from the reference, degree 2.
APART = {"dem": 0.4, "fft": 0.8, "fem-p1": 4.0}
NAMES = {"dem": "DEM", "fft": "FFT", "fem-p1": "FEM, degree 1"}
# Scenes from which on shares are judged.
MANY = 10


def claims(df):
    """Who was expected to win, and how far ways differ at one value of their knobs.

    The guesses were set before any search, and what half of the scenes may differ by once errors at these values had
    been looked at on some of them.
    """
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
    yield from guesses.guess(each, "conductivity")
    yield from advice.claims(df)
    yield from second.claims(df)
