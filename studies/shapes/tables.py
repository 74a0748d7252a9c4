"""Errors of the shapes, worst of each part, and lines of the table."""

import pandas as pd

from demheat.referee import value_error
from studies.harness import methods
from studies.harness.pick import finest, pick
from studies.shapes.cases import PARTS, SPENT


def compared(df):
    """The rows with an `error_percent` of capped rods, which is their distance from the finest elements, %.

    That of these elements itself stays empty.
    """
    rods = pick(df, part="capped rod")
    witness = finest(pick(rods, name="fem"))
    if not len(witness):
        return df
    others = rods.drop(witness.index)
    away = 100 * value_error(others["k_ratio"].to_numpy(), float(witness["k_ratio"].iloc[0]))
    return df.assign(error_percent=df["error_percent"].fillna(pd.Series(away, others.index, dtype=float)))


def table(df):
    """Largest error at any contrast and fraction, %: of the conductivity, of the ellipsoid's tensor over the matrix.

    Of the capped rod it is the distance from the finest elements, and no error. `interval` is half the width of the
    method's own, % of its value. CPU seconds of the DEM are without its packing, but for the first row that needs one.
    """
    found, all_rows = [], compared(df)
    for part in ("fibres", *PARTS):
        for name in SPENT:
            rows = pick(all_rows, part=part, name=name)
            rows = rows.assign(words=[methods.resolution(row) for row in rows.to_dict("records")])
            for words, group in rows.groupby("words", sort=False):
                line = {"part": part, "method": methods.all_methods()[name].title, "resolution": words}
                line |= {"error": _worst(group, "error_percent"), "temperature": _worst(group, "temperature_percent")}
                line |= {"of what is added": _worst(group, "added_percent"), "interval": _interval(group)}
                found.append(line)
    return pd.DataFrame(found)


def _worst(rows, column):
    """The largest, with its sign if it is the only one; not-a-number if none has one."""
    values = rows[column].dropna() if column in rows else []
    return float("nan") if not len(values) else float(values.loc[values.abs().idxmax()])


def _interval(rows):
    if "lower_ratio" not in rows or rows["lower_ratio"].isna().all():
        return float("nan")
    return float((50 * (rows["upper_ratio"] - rows["lower_ratio"]) / rows["k_ratio"]).max())
