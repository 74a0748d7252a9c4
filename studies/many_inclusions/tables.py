"""The table of many_inclusions."""

import math

from studies.common import silica_epoxy
from studies.harness.figures import LOOK
from studies.harness.pick import pick

SHOWN = ("unknowns", "iterations", "cpu_s")


def lines(df):
    """Table as a data frame, a line for each row."""
    import pandas as pd

    return pd.DataFrame([_line(row) for _, row in df[df["name"] != "steady"].iterrows()] + [*_steady(df)])


def _line(row):
    voxels, degree = row["voxels"], row["degree"]
    line = {"method": LOOK[row["name"]][0], "resolution": _resolution(row)}
    line |= {"error, %": row["error_percent"], "per inclusion": row["per_inclusion"]}
    line |= {name: row[name] for name in SHOWN} | {"GiB": row["peak_mib"] / 1024}
    line["bytes"] = row["peak_mib"] * 2**20 / row["unknowns"]
    per_iteration = row.get("iteration_s", math.nan) / row["iterations"] if voxels == voxels else math.nan
    line |= {
        "s_per_iteration": per_iteration,
        "in_fft": row.get("transform_s", math.nan) / row.get("iteration_s", math.nan),
    }
    return line | {"note": row["note"] if degree != degree else ""}


def _resolution(row):
    words = silica_epoxy.words(row)
    if row.get("elements", math.nan) == row.get("elements", math.nan):
        words += f", {row['elements']:.0f} tetrahedra"
    return words


def _steady(df):
    """Our steady solver and plain pyamg."""
    for _, row in df[df["name"] == "steady"].iterrows():
        for prefix, name in (
            ("", "ours"),
            ("ruge_stuben_", "pyamg, Ruge-Stueben"),
            ("aggregation_", "pyamg, aggregation"),
        ):
            line = {"method": f"steady: {name}", "resolution": f"{row['particles']:.0f} particles"}
            line |= {
                "unknowns": row["unknowns"],
                "iterations": row[f"{prefix}iterations"],
                "cpu_s": row[f"{prefix}cpu_s"],
            }
            peak = row[f"{prefix}peak_mib"]
            yield line | {"GiB": peak / 1024, "bytes": peak * 2**20 / row["unknowns"]}


def told(df, paper):
    """A sentence below the table."""
    most = pick(df, name="fem-p1")["elements"].max() if "elements" in df else math.nan
    if most == most:
        yield f"The finest linear elements are {most:.3g} tetrahedra, the paper's {paper['tetrahedra']:.3g}."
