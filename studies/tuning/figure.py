"""Errors of unseen scenes against the factor of each constant; where the error comes from against the particle size."""

from __future__ import annotations

import numpy as np

from studies.harness.figures import BLACK, BLUE, GREEN, GREY, ORANGE, PINK, RED, SKY
from studies.harness.pick import pick
from studies.tuning import means
from studies.tuning.cases import BENT, MAIN, SPHERE

COLOURS = dict(zip(MAIN, (RED, BLUE, GREEN, ORANGE, PINK), strict=True))
MARKS = {2_000: "o", 8_000: "s"}
PARTS = {
    "error": ("o", BLACK, "error of the conductivity"),
    "quadrature": ("^", BLUE, "exact temperature's power, too large by"),
    "misfit": ("v", RED, "power lost by temperatures off the exact ones"),
    "error_scatter": (".", GREY, "scatter of one packing's error"),
}


def draw(df):
    """Three panels.

    Parameters
    ----------
    df : DataFrame
    """
    from matplotlib import pyplot

    figure, (left, middle, right) = pyplot.subplots(1, 3, figsize=(15, 4.8))
    _factors(left, means.summed(means.errors(df, "unseen")))
    _parts(middle, means.parts(df, **SPHERE), "One sphere, as shipped: third order, one sign")
    _parts(right, means.parts(df, **BENT), "Twins nearer where it is curved: both parts cancel")
    right.sharey(middle)
    figure.suptitle("On scenes that no constant was chosen on, hardly any other value is better than the one shipped")
    return figure


def _factors(axes, sums):
    for particles, mark in MARKS.items():
        rows = pick(sums, particles=particles)
        shipped = pick(rows, constant="")
        if shipped.empty:
            continue
        own = shipped["median"].iloc[0]
        axes.axhline(own, color=GREY, linewidth=0.8)
        axes.annotate(f"{particles} particles", (2.0, own), fontsize=8, color=GREY, ha="right", va="bottom")
        for constant, colour in COLOURS.items():
            mine = pick(rows, constant=constant)
            at = np.append(mine["factor"], 1.0)
            order = np.argsort(at)
            label = constant if particles == min(MARKS) else None
            axes.plot(at[order], np.append(mine["median"], own)[order], color=colour, marker=mark, label=label)
    axes.set(yscale="log", xlabel="constant over its shipped value", ylabel="median |error|, %")
    axes.set_title("One constant at a time")
    axes.legend()


def _parts(axes, table, title):
    axes.set_title(title)
    axes.set(xscale="log", yscale="log", xlabel="particles", ylabel="share of the conductivity, %")
    if table.empty:
        return
    for name, (mark, colour, label) in PARTS.items():
        sem = table.get(f"{name}_sem")
        axes.errorbar(table["particles"], table[name].abs(), sem, color=colour, marker=mark, label=label)
    first, last = table.iloc[0], table.iloc[-1]
    for power in (2, 3):
        line = first["misfit"] * np.array([1.0, (last["particles"] / first["particles"]) ** (-power / 3)])
        axes.plot([first["particles"], last["particles"]], line, color=SKY, linewidth=0.8, linestyle=(0, (1, 2)))
        axes.annotate(f"order {power}", (last["particles"], line[1]), fontsize=8, color=SKY, ha="right", va="bottom")
    axes.legend()
