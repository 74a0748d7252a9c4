"""Lines of the table of brackets."""

import pandas as pd

from studies.brackets.means import place
from studies.harness.figures import LOOK
from studies.harness.pick import pick


def table(df):
    """Bounds of k over the matrix's, widths and costs.

    "exact in" says where between the bounds the exact value is, 0 the lower and 1 the upper; of drawn scenes the least
    and the greatest of each kind. Elements, unknowns of temperature and flux, CPU seconds and memory are of one
    bracket, or the mean of a kind; with a method those of its solve, and its answer's place between the bounds; of the
    DEM with its packing, unless that was kept.
    """
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
