"""Lines of the table of damage."""

from __future__ import annotations

import pandas as pd

from studies.damage.means import left, theory
from studies.harness import methods
from studies.harness.pick import pick


def lines(df):
    """One line of each method and resolution, of each number of particles, of each body.

    Parameters
    ----------
    df : data frame
    """
    found = _errors(pick(df, part="debonded"), "share", "spheres that have come off")
    found += _errors(pick(df, part="cracks"), "radius", "discs of radius")
    k = left(pick(df, part="links")) if len(pick(df, part="links")) else pd.Series(dtype=float)
    for (body, number), group in k.groupby(level=["body", "number"]):
        by = {f"{gone:g}": float(value) for (_, _, gone), value in group.items()}
        found.append({"what": f"links gone of a {body} of {number:g}: k left"} | by)
    if len(k):
        gone = sorted(set(k.index.get_level_values("removed")))
        found.append({"what": "effective medium theory, 6 neighbours"} | {f"{q:g}": float(theory(q)) for q in gone})
    return pd.DataFrame(found)


def _errors(rows, by, words):
    found = []
    if not len(rows):
        return found
    rows = rows.assign(words=[methods.resolution(row) for row in rows.to_dict("records")])
    for (name, resolution), group in rows.groupby(["name", "words"], sort=False):
        line = {"what": f"{words}, {methods.found()[name].title}{', ' if resolution else ''}{resolution}: error, %"}
        found.append(line | {f"{row[by]:g}": row["error_percent"] for _, row in group.iterrows()})
    return found
