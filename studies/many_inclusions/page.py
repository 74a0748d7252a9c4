"""Table and figure of many_inclusions."""

from __future__ import annotations

import math

from studies.common import silica_epoxy
from studies.harness import methods
from studies.harness.figures import BLACK, GREY, LOOK, look

FLOOR = 1e-4  # per cent; smaller errors are drawn there
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
    words = silica_epoxy.words(row) + (" float32" if row.get("precision") == "float32" else "")
    if row.get("elements", math.nan) == row.get("elements", math.nan):
        words += f", {row['elements']:.0f} tetrahedra"
    return words + (f", least gap {row['gap']:g} D" if row.get("gap", math.nan) == row.get("gap", math.nan) else "")


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


def draw(df, paper):
    """Three panels; the last shows what the paper prints."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, 3, figsize=(15, 5))
    df = df[df["error_percent"].notna()].assign(off=lambda d: d["error_percent"].abs().clip(lower=FLOOR))
    double = df[df["precision"].isna()] if "precision" in df else df
    spheres = df[df["name"] == "multipole"].sort_values("degree")
    spheres = spheres[spheres["degree"] < spheres["degree"].max()]
    for ax, cost, name in ((axes[0], "cpu_s", "CPU time, s"), (axes[1], "peak_mib", "peak memory, GiB")):
        unit = 1024 if cost == "peak_mib" else 1
        for method in methods.compared("dem-calibrated", "fem-p1"):
            rows = double[double["name"] == method.name].sort_values(cost)
            if len(rows):
                ax.plot(rows[cost] / unit, rows["off"], **look(method.name))
        ax.plot(spheres[cost] / unit, spheres["off"], **look("multipole"))
        ax.set(xscale="log", yscale="log", xlabel=name, ylabel="|error| of k, %")
    axes[0].set_title("83 spheres: error against CPU time")
    axes[1].set_title("and against memory")
    axes[0].legend(fontsize=7)
    _per_inclusion(axes[2], df, paper)
    return figure


def _per_inclusion(ax, df, paper):
    for method in ("dem", "dem-calibrated"):
        rows = df[df["name"] == method].sort_values("per_inclusion")
        if len(rows):
            ax.plot(rows["per_inclusion"], rows["off"], **look(method))
    ax.axvline(paper["per_inclusion"], color=BLACK, linestyle=":", label="enough, says the paper")
    ax.axhline(paper["dem_fft"], color=GREY, linestyle="--", label="DEM - FFT in the paper")
    ax.set(xscale="log", yscale="log", xlabel="elements per inclusion", ylabel="|error| of k, %")
    ax.set_title("How many elements an inclusion needs")
    ax.legend(fontsize=8)
