"""Lines of the table of brackets."""

import pandas as pd

from studies.brackets.means import place
from studies.harness.figures import LOOK
from studies.harness.pick import pick


def lines(df):
    """One line of each kind of drawn scenes, of each refined mesh, and of each answer."""
    rows = [_kind(kind, group) for kind, group in pick(df, part="drawn").groupby("scene", sort=False)]
    rows += [_mesh(row) for _, row in pick(df, part="refined").iterrows()]
    rows += [_mesh(row) for _, row in pick(df, part="voxels").iterrows()]
    judge = pick(df, part="judged", method="bracket")
    rows += [_mesh(row) for _, row in judge.iterrows()]
    rows += [_answer(row, judge) for _, row in df[df["part"].eq("judged") & df["method"].ne("bracket")].iterrows()]
    return pd.DataFrame(rows)


def _cost(rows):
    unknowns = rows["temperatures"] + rows["fluxes"]
    return {"elements": rows["elements"], "unknowns": unknowns, "CPU, s": rows["cpu_s"], "GiB": rows["peak_mib"] / 1024}


def _kind(kind, group):
    at = place(group)
    means = {name: float(column.mean()) for name, column in _cost(group).items()}
    means |= {name: round(means[name]) for name in ("elements", "unknowns")}
    return {
        "scene": f"{kind}, {len(group)} drawn",
        "width, %": f"{group['width_percent'].min():.2g} to {group['width_percent'].max():.2g}",
        "exact in": f"{at.min():.2f} to {at.max():.2f}",
        **means,
    }


def _mesh(row):
    parts = f"voxels of 1/{row['voxels']:.0f}" if row["part"] == "voxels" else f"edges of 1/{row['parts']:.0f}"
    return {
        "scene": f"{row['scene']}, {parts}",
        "lower": row["lower"],
        "upper": row["upper"],
        "width, %": f"{row['width_percent']:.2g}",
        "exact in": f"{place(row):.2f}",
        **_cost(row),
    }


def _answer(row, judge):
    found = {"scene": f"{row['scene']}, {LOOK[row['name']][0]} by default", "k": row["k"]}
    if len(judge):
        first = judge.iloc[0]
        found["exact in"] = f"{(row['k'] - first['lower']) / (first['upper'] - first['lower']):.2f}"
    return found | {"CPU, s": row["cpu_s"], "GiB": row["peak_mib"] / 1024}
