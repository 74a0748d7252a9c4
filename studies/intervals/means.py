"""Intervals of rows beside what is true, and shares of them."""

import numpy as np
import pandas as pd

from demheat.referee import value_error
from studies.harness import methods

# An error is known well that is so many times what is true may be off, and more than so much of the conductivity.
CLEAR, NOTHING = 5.0, 1e-7


def answers(df):
    """Rows with an interval and something to hold it against, `low` to `high`."""
    keys = ["scene", "seed"]
    # Of few scenes no row may have another's interval.
    df = df.reindex(columns=df.columns.union(("dual_lower", "dual_upper"), sort=False))
    right = df[df["method"] == "truth"].set_index(keys)
    found = df[(df["method"] != "truth") & df["lower"].notna()].copy()
    index = pd.MultiIndex.from_frame(found[keys])
    for end, name in (("low", "lower"), ("high", "upper")):
        known = right[f"true_{name}"].reindex(index).to_numpy()
        found[end] = np.where(np.isnan(known), found[f"dual_{name}"], known)
    return found[found["low"].notna()]


def held(each):
    """Whether an interval and what is true have a point in common."""
    return (each["lower"] <= each["high"]) & (each["upper"] >= each["low"])


def strictly(each):
    """Whether an interval holds the middle of what is true; of a dual's interval, any of it."""
    middle = 0.5 * (each["low"] + each["high"])
    return held(each) & (((each["lower"] <= middle) & (each["upper"] >= middle)) | each["dual_lower"].notna())


def off(each):
    """Error over what is true, signed."""
    return value_error(each["conductivity"], 0.5 * (each["low"] + each["high"]))


def half(each):
    """Half of the interval over what is true."""
    return (each["upper"] - each["lower"]) / (each["low"] + each["high"])


def clear(each):
    """Rows whose error is known well."""
    doubt = (each["high"] - each["low"]) / (each["low"] + each["high"])
    return each[(off(each).abs() > np.maximum(CLEAR * doubt, NOTHING)) & each["dual_lower"].isna()]


def over(each):
    """Half of the interval over the error, where that is known well."""
    each = clear(each)
    return half(each) / off(each).abs()


def over_plain(each):
    """Half of the interval about a limit over the error of the answer that it was made of."""
    middle = 0.5 * (each["low"] + each["high"])
    before = each.assign(conductivity=each["plain"])
    found = clear(before)
    return half(found) / (value_error(found["plain"], middle[found.index])).abs()


def gain(each):
    """Error of a limit over that of the answer that it was made of, where that is known well."""
    before = clear(each.assign(conductivity=each["plain"]))
    return off(each).abs()[before.index] / off(before).abs()


def title(name):
    """What a method is called in tables."""
    plain, _, limit = name.partition("-limit")
    if limit or name.endswith("-limit"):
        return f"{title(plain)}, extrapolated"
    return methods.all_methods()[name].title if name != "fft" else "FFT, scalar, by itself"


def in_words(each):
    """How many hold, and how wide they are, of each method, as a part of a sentence."""
    said = [
        f"{held(rows).sum()} of {len(rows)} ({title(name)}, {over(rows).median():.2g} times the error in the median)"
        for name, rows in each.groupby("method", sort=False)
    ]
    return ", ".join(said) + "; medians are over errors that are known well and more than rounding"


def table(df):
    """Intervals that hold, of all that there are, by kind of scene and method."""
    each = answers(df)
    found = []
    for kind in [*dict.fromkeys(df["scene"]), "all"]:
        rows = each if kind == "all" else each[each["scene"] == kind]
        cells = {title(name): _cell(rows[rows["method"] == name]) for name in dict.fromkeys(each["method"])}
        found.append({"scene": kind, **cells})
    return pd.DataFrame(found)


def _cell(rows):
    return f"{int(held(rows).sum())} of {len(rows)}" if len(rows) else ""
