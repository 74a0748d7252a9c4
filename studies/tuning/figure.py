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
    "quadrature": (1, "^", BLUE, "exact temperature's power, too large by"),
    "misfit": (-1, "v", RED, "power lost by temperatures off the exact ones"),
    "error": (1, "o", BLACK, "their sum, the error: mean, scatter of one packing"),
}
BELOW = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.13), "fontsize": 9}
# Below, %, the axis of the parts is linear.
LINEAR = 1e-4


def plot(df):
    """Errors against the factors; parts of the error against the particle size."""
    from matplotlib import pyplot

    figure, (left, middle, right) = pyplot.subplots(1, 3, figsize=(16, 6.2))
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
        axes.axhline(own, color=GREY, linewidth=0.8, zorder=1)
        axes.plot([], [], color=GREY, marker=mark, linestyle="", label=f"{particles} particles")
        for constant, colour in COLOURS.items():
            mine = pick(rows, constant=constant)
            at = np.append(mine["factor"], 1.0)
            order = np.argsort(at)
            axes.plot(at[order], np.append(mine["median"], own)[order], color=colour, marker=mark)
    for constant, colour in COLOURS.items():
        axes.plot([], [], color=colour, label=constant)
    axes.plot([], [], color=GREY, linewidth=0.8, label="as shipped")
    axes.set(yscale="log", xlabel="constant over its shipped value", ylabel="median |error| of unseen scenes, %")
    axes.set_title("One constant at a time: least as shipped, or nearly")
    axes.legend(**BELOW, ncols=3)


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
    axes.set_title("BEND acts on the third order, the others on the second")
    axes.legend(**BELOW, ncols=2)


def _parts(axes, table):
    axes.set_title("One sphere as shipped: two parts of opposite sign")
    axes.set(xscale="log", xlim=(700, 140_000), xlabel="particles", ylabel="share of the conductivity, %")
    # Signed: of a mean that crosses nothing a logarithm would look like convergence.
    axes.set_yscale("symlog", linthresh=LINEAR)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    if table.empty:
        return
    for name, (sign, mark, colour, label) in PARTS.items():
        axes.errorbar(
            table["particles"], sign * table[name], table[f"{name}_scatter"], color=colour, marker=mark, label=label,
            markersize=5, capsize=3, elinewidth=1,
        )  # fmt: skip
    if len(table) > 1:
        _orders(axes, table.iloc[0], table.iloc[-1])
    axes.legend(**BELOW)


def _orders(axes, first, last):
    """Second and third order in the particle size from the first lost power on."""
    for power in (2, 3):
        line = -first["misfit"] * np.array([1.0, (last["particles"] / first["particles"]) ** (-power / 3)])
        axes.plot([first["particles"], last["particles"]], line, color=SKY, linewidth=0.8, linestyle=(0, (1, 2)))
        axes.annotate(f"order {power}", (last["particles"], line[1]), fontsize=8, color=SKY, ha="right", va="top")
