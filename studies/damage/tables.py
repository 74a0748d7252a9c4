"""The tables of damage."""

import pandas as pd

from studies.damage.means import left, theory
from studies.harness import methods
from studies.harness.pick import pick


def table(df):
    """Spheres that have come off: errors against exact values, %, by the share of them."""
    return _errors(pick(df, part="debonded"), "share")


def of_discs(df):
    """Errors of arrays of discs: a line of each number of particles, a column of each radius."""
    return _errors(pick(df, part="cracks"), "radius")


def of_links(df):
    """What links that are gone leave of the conductivity, beside the theory: a line of each body."""
    links = pick(df, part="links")
    if not len(links):
        return pd.DataFrame()
    k, found = left(links), []
    for (body, number), group in k.groupby(level=["body", "number"]):
        by = {f"{gone:g}": float(value) for (_, _, gone), value in group.items()}
        found.append({"network": f"{body} of {number:g}"} | by)
    gone = sorted(set(k.index.get_level_values("removed")))
    found.append({"network": "theory, 6 neighbours"} | {f"{q:g}": float(theory(q)) for q in gone})
    return pd.DataFrame(found)


def _errors(rows, by):
    found = []
    if not len(rows):
        return pd.DataFrame()
    rows = rows.assign(words=[methods.resolution(row) for row in rows.to_dict("records")])
    for (name, resolution), group in rows.groupby(["name", "words"], sort=False):
        line = {"method": methods.all_methods()[name].title, "resolution": resolution}
        found.append(line | {f"{row[by]:g}": row["error_percent"] for _, row in group.iterrows()})
    return pd.DataFrame(found)
