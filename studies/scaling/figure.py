"""The figure of scaling: CPU time against inclusions, stages of the DEM against particles, and memory."""

import numpy as np

from studies.harness.figures import BLACK, BLUE, GREEN, GREY, LOOK, ORANGE, PINK, RED, SKY, look
from studies.harness.pick import pick
from studies.scaling.means import STAGES, fitted, of_stages, on_ranks

COLOUR = dict(zip(STAGES, (GREY, ORANGE, BLUE, PINK, GREEN, RED, SKY, BLACK), strict=True))


def plot(df):
    """Costs of methods and stages as lines of slope one and others; two threads; two ranks."""
    df = df[df["status"] == "ok"]
    from matplotlib import pyplot

    ranked = on_ranks(df)
    panels = [["inclusions", "growing"], ["refined", "memory"], *([["ranks", "ranks"]] if len(ranked) else [])]
    heights = (5, 5, 3.6)[: len(panels)]
    figure, axes = pyplot.subplot_mosaic(panels, figsize=(13, sum(heights)), height_ratios=heights)
    _inclusions(axes["inclusions"], df)
    _stages(axes["growing"], pick(df, part="inclusions", name="dem"), "number", "inclusions, 50 particles each")
    _stages(axes["refined"], pick(df, part="elements", name="dem"), "unknowns", "unknowns, 83 spheres")
    _memory(axes["memory"], df)
    if len(ranked):
        _ranked(axes["ranks"], ranked)
    return figure


def _inclusions(ax, df):
    rows = pick(df, part="inclusions")
    exponents = fitted(rows, "number")
    for name, group in rows.groupby("name", sort=False):
        group = group.sort_values("number")
        fit = pick(exponents, name=name, stage="all")["exponent"]
        label = LOOK[name][0] + (f": exponent {fit.iloc[0]:.2f}" if len(fit) else "")
        ax.plot(group["number"], group["cpu_s"], **look(name, label=label))
    ax.set(xscale="log", yscale="log", xlabel="inclusions", ylabel="CPU time, s", title="From scene to conductivity")
    # Room for the legend above the lines.
    ax.set_ylim(top=10 * ax.get_ylim()[1])
    _slope(ax)
    ax.legend(loc="upper left")


def _slope(ax):
    """A line of slope one through the middle of the panel."""
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    x = np.array([left, right])
    y = np.sqrt(low * high) * x / np.sqrt(left * right)
    ax.plot(x, y, color=GREY, linewidth=0.8, linestyle=":", zorder=0, label="linear")
    ax.set(xlim=(left, right), ylim=(low, high))


def _stages(ax, rows, by, label):
    every = of_stages(rows)
    for stage in STAGES:
        group = every[every["stage"] == stage].sort_values(by)
        if len(group):
            ax.plot(group[by], group["seconds"], marker="o", markersize=4, color=COLOUR[stage], label=stage)
    ax.set(xscale="log", yscale="log", xlabel=label, ylabel="CPU time, s", title="Stages of the DEM")
    # Room for the legend above the lines.
    ax.set_ylim(top=5 * ax.get_ylim()[1])
    _slope(ax)
    ax.legend(ncols=2)


def _memory(ax, df):
    """Peak memory against inclusions."""
    for name, rows in pick(df, part="inclusions").groupby("name", sort=False):
        rows = rows.sort_values("number")
        ax.plot(rows["number"], rows["peak_mib"] / 1024, **look(name))
    ax.set(xscale="log", yscale="log", xlabel="inclusions", ylabel="GiB", title="Peak memory")
    ax.legend(loc="upper left")


def _ranked(ax, rows):
    """Seconds of the slowest rank, stage by stage."""
    rows = rows.sort_values(["part", "unknowns", "ranks"])
    words = [f"{row['part']}, {row['unknowns']:.2g} on {row['ranks']:.0f}" for _, row in rows.iterrows()]
    left = np.zeros(len(rows))
    for stage, colour in zip(("packing", "cells", "solve", "field"), (GREY, BLUE, RED, SKY), strict=True):
        seconds = rows[f"{stage}_wall_s"].to_numpy(float)
        ax.barh(words, seconds, left=left, color=colour, label=stage)
        left += seconds
    ax.set(xlabel="wall time, s", title="demheat.mpi: unknowns on one rank and on two")
    ax.set_axisbelow(True)
    ax.legend(loc="lower right")
    ax.set_xlim(right=1.15 * left.max())
    ax.invert_yaxis()
