"""Random cells of the study of zeta_2 pooled: means, confidence intervals, differences in standard errors."""

import math

import numpy as np

from demheat import referee
from studies.harness.cells import numbers
from studies.harness.pick import pick, student

KEYS = ("placed", "gap", "ratio", "fraction")


def pooled(df):
    """Means over all realisations of each kind of cell."""
    import pandas as pd

    from references.bounds import zeta2_hard_spheres

    rows = []
    for key, group in pick(df, part="cells").groupby(list(KEYS), sort=False):
        values = np.concatenate([numbers(text) for text in group["values"]])
        row = dict(zip(KEYS, key, strict=True)) | {"cells": len(values), "spheres": int(group["spheres"].iloc[0])}
        mean = student(values)
        row |= {"zeta2": mean.mean, "scatter": mean.deviation, "half": mean.half}
        row["se"] = mean.deviation / math.sqrt(mean.number)
        row["polynomial"] = float(zeta2_hard_spheres(row["fraction"]))
        rows.append(row | {"off_percent": 100 * referee.value_error(row["zeta2"], row["polynomial"])})
    return pd.DataFrame(rows, columns=[*rows[0]] if rows else [*KEYS])


def below(means, lower, upper):
    """How far one kind of cells lies below another, at the fractions that both have."""
    both = pick(means, **lower).merge(pick(means, **upper), on="fraction", suffixes=("", "_upper"))
    if not len(both):
        return None, None
    difference = -100 * referee.value_error(both["zeta2"], both["zeta2_upper"])
    variance = (100 * both["se"] / both["zeta2_upper"]) ** 2 + (100 * both["se_upper"] / both["zeta2_upper"]) ** 2
    weight = 1 / variance
    return float((weight * difference).sum() / weight.sum()), float(1 / math.sqrt(weight.sum()))


def with_bounds(df):
    """Rows of conductivities with the bounds and estimates that their own zeta_2 and the polynomial give, W/(m K)."""
    from demheat.gallery import EPOXY, SILICA
    from references import bounds

    rows = pick(df, part="conductivity").copy()
    pair = (EPOXY.conductivity, SILICA.conductivity, rows["fraction"].to_numpy())
    own = rows["zeta2"].to_numpy()
    rows["lower"], rows["upper"] = bounds.third_order(*pair, own)
    rows["hs_lower"], rows["hs_upper"] = bounds.hashin_shtrikman(*pair)
    rows["torquato"] = bounds.torquato(*pair, own)
    rows["torquato_polynomial"] = bounds.torquato(*pair, bounds.zeta2_hard_spheres(pair[2]))
    return rows
