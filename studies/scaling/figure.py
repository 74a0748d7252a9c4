"""The figure of scaling: CPU time against inclusions, stages of the DEM against particles, threads and memory."""

from __future__ import annotations

import numpy as np

from studies.harness import methods
from studies.harness.figures import BLACK, BLUE, GREEN, GREY, LOOK, ORANGE, PINK, RED, SKY, look
from studies.harness.pick import pick
from studies.scaling.means import STAGES, efficiencies, fitted, of_stages

COLOUR = dict(zip(STAGES, (GREY, ORANGE, BLUE, PINK, GREEN, RED, SKY, BLACK), strict=True))


def draw(df):
    """Four panels."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(2, 2, figsize=(13, 10))
    _inclusions(axes[0, 0], df)
    _stages(axes[0, 1], pick(df, part="inclusions", name="dem"), "number", "inclusions, 50 particles each")
    threaded = pick(df, part="elements", name="dem")
    _stages(axes[1, 0], threaded[threaded["cores"] == threaded["cores"].max()], "unknowns", "unknowns, 83 spheres")
    _threads(axes[1, 1], df)
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
    _slope(ax)
    ax.legend()


def _slope(ax):
    """A line of slope one through the middle of the panel."""
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    x = np.array([left, right])
    ax.plot(x, np.sqrt(low * high) * x / np.sqrt(left * right), color=GREY, linewidth=0.8, linestyle=":", zorder=0)
    ax.set(xlim=(left, right), ylim=(low, high))
    ax.text(right, np.sqrt(low * high) * np.sqrt(right / left), "linear ", color=GREY, ha="right", va="bottom")


def _stages(ax, rows, by, label):
    every = of_stages(rows)
    for stage in STAGES:
        group = every[every["stage"] == stage].sort_values(by)
        if len(group):
            ax.plot(group[by], group["seconds"], marker="o", markersize=4, color=COLOUR[stage], label=stage)
    ax.set(xscale="log", yscale="log", xlabel=label, ylabel="CPU time, s", title="Stages of the DEM")
    _slope(ax)
    ax.legend(ncols=2)


def _threads(ax, df):
    found = efficiencies(df)
    if not len(found):
        ax.set_axis_off()
        return
    finest = found[found["resolution"] == found.groupby("name")["resolution"].transform("max")]
    finest = finest[finest["wall"] >= 0.05]
    words = [f"{methods.found()[row['name']].title}: {row['stage']}" for _, row in finest.iterrows()]
    ax.barh(words, finest["efficiency"], color=[LOOK[name][1] for name in finest["name"]])
    ax.axvline(0.8, color=GREY, linestyle=":")
    ax.set(xlabel="wall time of one thread over two, halved", title="Two threads, finest cell of both", xlim=(0, 1.1))
    ax.invert_yaxis()
