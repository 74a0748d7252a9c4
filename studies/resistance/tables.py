"""Lines of the table of interfaces that resist."""

import pandas as pd

from studies.harness import methods
from studies.harness.figures import LOOK
from studies.harness.pick import pick
from studies.resistance.cases import FRACTIONS, GAP, KNOWING, NEUTRAL
from studies.resistance.means import curve, explaining, foreseen, radius_of


def table(df):
    """Errors of k at each Kapitza length (over the radius); neutral spheres; silica in epoxy.

    Of the silica: k over the matrix's at each length, the mean of the realisations; the length at which it is 7 % less
    than with perfect interfaces, beside Hasselman and Johnson's (J. Compos. Mater. 21 (1987) 508); and R for spheres of
    a micrometre's radius.
    """
    found = []
    for name in KNOWING:
        rows = pick(df, part="array", name=name)
        rows = rows.assign(words=[methods.resolution(row) for row in rows.to_dict("records")])
        for words, group in rows.groupby("words", sort=False):
            errors = {f"l = {row['kapitza']:g}": row["error_percent"] for _, row in group.iterrows()}
            found.append({"what": f"{LOOK[name][0]}, {words}: error, %"} | errors)
    for spheres in NEUTRAL:
        for _, row in pick(df, part="neutral", spheres=spheres).iterrows():
            text = f"{spheres} neutral spheres, {LOOK[row['name']][0]}: error of k and of T outside, %"
            found.append(
                {"what": text, "l = (s - 1)/s": f"{row['error_percent']:.2g}, {row['temperature_percent']:.2g}"}
            )
    rows = pick(df, part="silica")
    found += [_silica(rows, fraction) for fraction in FRACTIONS if (rows["fraction"] == fraction).any()]
    return pd.DataFrame(found)


def _silica(rows, fraction):
    line = {"what": f"silica in epoxy, f = {fraction:g}: k over the matrix's"}
    line |= {f"l = {length:g}": float(k) for length, k in curve(rows, fraction).items()}
    length = explaining(rows, fraction, GAP)
    if length is not None:
        line |= {f"l for {GAP:.0%}": length, "by Hasselman and Johnson": foreseen(fraction, GAP)}
        line |= {"R at 1 um, m2 K/W": f"{1e-6 / radius_of(length, 1.0):.2g}"}
    return line
