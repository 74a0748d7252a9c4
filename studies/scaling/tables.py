"""The table of scaling."""

from __future__ import annotations

from studies.harness.figures import LOOK
from studies.harness.pick import pick
from studies.scaling.means import STAGES, billion, efficiencies, errors, fitted


def lines(df):
    """Table as a data frame: rows with their costs, then fits."""
    import pandas as pd

    df = df.reindex(columns=[*dict.fromkeys([*df.columns, *COLUMNS])])
    solved = errors(df[df["part"].isin(("inclusions", "kinds", "goal", "elements"))])
    return pd.DataFrame([_line(row) for _, row in solved.iterrows()] + [*_fits(df)])


COLUMNS = ("number", "spheres", "kind", "fraction", "particles", "voxels", "cores", "k_ratio", "unknowns", "peak_mib")


def _line(row):
    scene = f"{row['spheres']:.0f} spheres" if row["spheres"] == row["spheres"] else f"{row['number']:.0f} spheres"
    if row["kind"] == "polydisperse":
        scene += ", sizes to 10"
    if row["fraction"] == row["fraction"]:
        scene += f", f = {row['fraction']:g}"
    line = {"what": row["part"], "method": LOOK[row["name"]][0], "of": scene}
    line |= {"unknowns": row["unknowns"], "threads": row["cores"], "CPU, s": row["cpu_s"], "wall, s": row["wall_s"]}
    line |= {"GiB": row["peak_mib"] / 1024, "bytes each": row["peak_mib"] * 2**20 / row["unknowns"]}
    costs = {name: row.get(f"{name}_cpu_s") for name in STAGES}
    line["stages, CPU s"] = ", ".join(f"{k} {v:.2g}" for k, v in costs.items() if v is not None and v == v)
    return line | {"error, %": row["error_percent"], "note": row["note"] if row["status"] != "ok" else ""}


def _fits(df):
    for part, by in (("inclusions", "number"), ("elements", "unknowns")):
        for _, fit in fitted(pick(df, part=part), by).iterrows():
            text = f"CPU time ~ {by}^{fit['exponent']:.2f}, {fit['rows']:.0f} rows"
            yield {"what": f"fit, {part}", "method": LOOK[fit["name"]][0], "of": fit["stage"], "note": text}
    for _, row in efficiencies(df).iterrows():
        text = f"efficiency of two threads {row['efficiency']:.2f}"
        scene = f"{row['stage']}, {row['resolution']:.0f}"
        yield {"what": "threads", "method": LOOK[row["name"]][0], "of": scene, "wall, s": row["wall"], "note": text}
    for row in billion(df):
        text = f"from {row['from']:.3g} unknowns with exponent {max(1.0, row['exponent']):.2f}"
        line = {"what": "1e9, extrapolated", "method": LOOK[row["name"]][0], "unknowns": row["unknowns"]}
        yield line | {"CPU, s": 3600 * row["hours"], "GiB": 1024 * row["tib"], "note": text}
