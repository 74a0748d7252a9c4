"""Figure of many_inclusions."""

from __future__ import annotations

from studies.harness import methods
from studies.harness.figures import BLACK, GREY, look

FLOOR = 1e-4  # per cent; smaller errors are drawn there


def draw(df, paper):
    """Three panels; the last shows what the paper prints.

    Parameters
    ----------
    df : data frame
        With errors.
    paper : dict
        Printed numbers.
    """
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
