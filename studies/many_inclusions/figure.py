"""Figure of many_inclusions."""

from __future__ import annotations

import numpy as np

from studies.common.paper_variants import PACKED
from studies.harness import methods
from studies.harness.figures import BLACK, GREY, PINK, look

FLOOR = 1e-4  # per cent; smaller errors are drawn there
COSTS = {"cpu_s": ("CPU time", "s", 1), "peak_mib": ("peak memory", "GiB", 1024)}


def draw(df, network, paper):
    """Error against CPU time and memory, and, where they are counted, against elements per inclusion."""
    from matplotlib import pyplot

    df = df[df["error_percent"].notna()].assign(off=lambda d: d["error_percent"].abs().clip(lower=FLOOR))
    counted = df["per_inclusion"].notna().any()
    panels = 2 + bool(counted) + bool(network)
    figure, axes = pyplot.subplots(1, panels, figsize=(5.3 * panels, 6), squeeze=False)
    axes = axes[0]
    for ax, (cost, (name, unit, size)) in zip(axes, COSTS.items(), strict=False):
        _by_cost(ax, df, cost, size)
        ax.set(xscale="log", yscale="log", xlabel=f"{name}, {unit}", ylabel="|error| of k, %")
        ax.set_title(f"83 spheres: error against {name}")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9)
    if counted:
        _per_inclusion(axes[2], df, paper)
    if network:
        _network(axes[-1], network, paper)
    return figure


def _by_cost(ax, df, cost, unit):
    double = df[df["precision"].isna()] if "precision" in df else df
    for method in methods.compared("dem-calibrated", "fem-p1"):
        rows = double[double["name"] == method.name].sort_values(cost)
        if len(rows):
            ax.plot(rows[cost] / unit, rows["off"], **look(method.name))
    # The highest degree is what the others are held against.
    spheres = df[df["name"] == "multipole"].sort_values("degree")
    spheres = spheres[spheres["degree"] < spheres["degree"].max()]
    ax.plot(spheres[cost] / unit, spheres["off"], **look("multipole"))


def _per_inclusion(ax, df, paper):
    for method in ("dem", "dem-calibrated"):
        rows = df[df["name"] == method].sort_values("per_inclusion")
        if len(rows):
            ax.plot(rows["per_inclusion"], rows["off"], **look(method))
    ax.axvline(paper["per_inclusion"], color=BLACK, linestyle=":", label="enough, says the paper")
    ax.axhline(paper["dem_fft"], color=GREY, linestyle="--", label="DEM against FFT in the paper")
    ax.set(xscale="log", yscale="log", xlabel="elements in an inclusion, twins among them", ylabel="|error| of k, %")
    ax.set_title("How many elements an inclusion needs")
    ax.legend(fontsize=8, loc="lower left")


def _network(ax, network, paper):
    """Signed errors of the network by packing, with intervals, side by side."""
    numbers = sorted({number for _, number in network})
    for packing, face, aside in (("lsa", PINK, 0.95), ("relaxed", "white", 1.05)):
        found = {number: each["spheres"] for (variant, number), each in network.items() if variant.packing == packing}
        mean, half = ([getattr(each, name) for each in found.values()] for name in ("mean", "half"))
        style = {"color": PINK, "marker": "o", "markerfacecolor": face, "capsize": 3, "linewidth": 1}
        places = aside * np.array(list(found))
        ax.errorbar(places, mean, np.nan_to_num(half), label=f"{PACKED[packing]} packings", **style)
    ax.axhspan(-paper["dem_fft"], paper["dem_fft"], color=GREY, alpha=0.15, label="DEM against FFT in the paper")
    ax.axhline(0.0, color=BLACK, linewidth=0.8)
    ax.set(xscale="log", xlabel="particles", ylabel="error of k, %", title="The paper's network, periodic cell")
    ax.set_xticks(numbers, [f"{number:.3g}" for number in numbers])
    ax.minorticks_off()
    ax.set_xlim(0.7 * numbers[0], 1.5 * numbers[-1])
    ax.legend(fontsize=8)
