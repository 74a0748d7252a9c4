"""Lines of the table of tuning."""

import pandas as pd

from studies.harness.pick import pick
from studies.tuning import means
from studies.tuning.cases import OLD
from studies.tuning.constants import CONSTANTS

KEYS = ["shape", "contrast", "constant", "factor"]


def table(df):
    """Errors on unseen scenes with each constant as shipped or times a factor; the parts of the error on a sphere.

    Of |errors| in per cent the median and 90th percentile, of signed ones the mean and its standard error. "order" is
    that in the particle size, of the mean of all packings, with its standard error; "scatter" is of one packing. The
    error itself is fitted with two powers of h, the cube root of the volume of the box for each particle.
    """
    return pd.DataFrame([*_values(means.summed(means.errors(df, "unseen"))), *_series(df)])


def _values(sums):
    for _, row in sums.iterrows():
        yield {
            "what": _what(row),
            "factor": row["factor"],
            "particles": f"{row['particles']:.0f}",
            "scenes": row["scenes"],
            "median, %": float(f"{row['median']:.2g}"),
            "90th, %": float(f"{row['high']:.2g}"),
            "mean, %": f"{row['mean']:+.4f} +- {row['sem']:.4f}",
            "unknowns": round(row["unknowns"]),
        }


def _what(row):
    constant = row["constant"]
    if constant in OLD:
        return CONSTANTS[constant].meaning
    return f"{constant} = {row['factor'] * CONSTANTS[constant].unit:.3g}" if constant else "as shipped"


def _series(df):
    rows = pick(df, part="order")
    for values, _ in rows.assign(constant=means.named(rows["constant"])).groupby(KEYS, sort=False):
        where = dict(zip(KEYS, values, strict=True))
        table = means.parts(df, **where | {"constant": where["constant"] or None})
        changed = f", {where['constant']} x {where['factor']:g}" if where["constant"] else ""
        first, last = table.iloc[0], table.iloc[-1]
        for name in ("error", "quadrature", "misfit", "misfit_beside", "error_scatter"):
            yield {
                "what": f"{where['shape']}, contrast {where['contrast']:g}{changed}: {name.replace('_', ' ')}",
                "particles": f"{first['particles']:.0f} to {last['particles']:.0f}",
                "coarsest, %": float(f"{first[name]:.3g}"),
                "finest, %": float(f"{last[name]:.3g}"),
                "order": _order(table, name),
            }


def _order(table, name):
    if len(table) < 2 or abs(table[name]).min() < 1e-9:
        return ""
    if name == "error" and len(table) > 2:
        (two, three), doubts = means.two_powers(table)
        return f"{two:.3g} +- {doubts[0]:.2g} h^2, {three:.3g} +- {doubts[1]:.2g} h^3"
    found, doubt = means.fitted(table, name)
    return f"{found:.2f} +- {doubt:.2f}" if doubt == doubt else ""
