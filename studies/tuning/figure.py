"""Errors of unseen scenes against the factor of each constant; where the error comes from against the particle size."""

import numpy as np

from studies.harness.figures import BLACK, BLUE, GREEN, GREY, ORANGE, PINK, RED, SKY
from studies.harness.pick import pick
from studies.tuning import means
from studies.tuning.cases import MAIN, NEARER, OTHER_SIGN, SPHERE, UNBENT

COLOURS = dict(zip(MAIN, (RED, BLUE, GREEN, ORANGE, PINK), strict=True))
MARKS = {2_000: "o", 8_000: "s", 30_000: "^"}
SERIES = (
    ("as shipped", BLACK, SPHERE),
    ("OFFSET x 0.7", RED, SPHERE | NEARER),
    ("MARGIN x 0.372", ORANGE, SPHERE | OTHER_SIGN),
    ("BEND x 0", BLUE, UNBENT),
)
PARTS = {
    "error": ("o", BLACK, "error of the conductivity"),
    "quadrature": ("^", BLUE, "exact temperature's power, too large by"),
    "misfit": ("v", RED, "power lost by temperatures off the exact ones"),
    "error_scatter": (".", GREY, "scatter of one packing's error"),
}


def plot(df):
    """Errors against the factors; parts of the error against the particle size."""
    from matplotlib import pyplot

    figure, (left, middle, right) = pyplot.subplots(1, 3, figsize=(15, 4.8))
    _factors(left, means.summed(means.errors(df, "unseen")))
    _parts(middle, means.parts(df, **SPHERE))
    _powers(right, df)
    figure.suptitle("On unseen scenes no other value of a constant gains much")
    return figure


def _factors(axes, sums):
    for particles, mark in MARKS.items():
        rows = pick(sums, particles=particles)
        shipped = pick(rows, constant="")
        if shipped.empty:
            continue
        own = shipped["median"].iloc[0]
        axes.axhline(own, color=GREY, linewidth=0.8)
        where = {"xy": (0.99, own), "xycoords": axes.get_yaxis_transform(), "ha": "right", "va": "bottom"}
        axes.annotate(f"{particles} particles, as shipped", **where, fontsize=8, color=GREY)
        for constant, colour in COLOURS.items():
            mine = pick(rows, constant=constant)
            at = np.append(mine["factor"], 1.0)
            order = np.argsort(at)
            label = constant if particles == min(MARKS) else None
            axes.plot(at[order], np.append(mine["median"], own)[order], color=colour, marker=mark, label=label)
    axes.set(yscale="log", xlabel="constant over its shipped value", ylabel="median |error| of unseen scenes, %")
    axes.set_title("One constant at a time")
    axes.legend()


def _powers(axes, df):
    """Error over h^2: a line whose height at h = 0 is of second order, whose slope of third."""
    for label, colour, probe in SERIES:
        table = means.parts(df, **probe)
        if table.empty:
            continue
        h = table["particles"].to_numpy(float) ** (-1 / 3)
        axes.errorbar(
            h, table["error"] / h**2, table["error_sem"] / h**2, color=colour, marker="o", linestyle="", label=label
        )
        if len(table) > 2:
            (two, three), _ = means.two_powers(table)
            ends = np.array([0.0, h.max()])
            axes.plot(ends, two + three * ends, color=colour, linewidth=0.8)
    axes.axhline(0.0, color=BLACK, linewidth=0.8)
    axes.set(xlabel="h = particles^(-1/3)", ylabel="error / h^2, %", xlim=(0.0, 0.105))
    axes.set_title("BEND takes the third order away, the others move the second")
    axes.legend()


def _parts(axes, table):
    axes.set_title("One sphere as shipped: two parts of opposite sign")
    axes.set(xscale="log", yscale="log", xlim=(700, 140_000), xlabel="particles", ylabel="share of the conductivity, %")
    if table.empty:
        return
    for name, (mark, colour, label) in PARTS.items():
        sem = table.get(f"{name}_sem")
        axes.errorbar(table["particles"], table[name].abs(), sem, color=colour, marker=mark, label=label)
    axes.legend()
    if len(table) < 2:
        return
    first, last = table.iloc[0], table.iloc[-1]
    for power in (2, 3):
        line = first["misfit"] * np.array([1.0, (last["particles"] / first["particles"]) ** (-power / 3)])
        axes.plot([first["particles"], last["particles"]], line, color=SKY, linewidth=0.8, linestyle=(0, (1, 2)))
        axes.annotate(f"order {power}", (last["particles"], line[1]), fontsize=8, color=SKY, ha="right", va="bottom")
