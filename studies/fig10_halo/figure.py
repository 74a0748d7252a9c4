"""Figure of the study of halos."""

from __future__ import annotations

import numpy as np

from studies.fig10_halo.statistics import BINS, DENSITIES, PAPER, long
from studies.harness.cells import numbers
from studies.harness.figures import BLACK, BLUE, GREEN, GREY, ORANGE, PINK, RED
from studies.harness.pick import pick

# Numbers of particles, few to many.
COLOURS = (ORANGE, GREEN, BLUE, RED)


def draw(df):
    """CoV, and smallest and largest flux, against the halo's radius; density functions; CoV against N."""
    from matplotlib import pyplot

    figure, ((cov, extremes), (raw, halos)) = pyplot.subplots(2, 2, figsize=(12, 9))
    rows = long(df)
    _cov(cov, rows)
    _extremes(extremes, rows)
    _densities(raw, halos, df)
    return figure


def _looks(rows):
    """Colour of each number of particles."""
    return dict(zip(sorted(rows["particles"].unique()), COLOURS, strict=False))


def _cov(axes, rows):
    for number, colour in _looks(rows).items():
        here = pick(rows, law="calibrated", particles=number)
        for split, walls, column, style, what in (
            ("half", "held", "bulk_cov", "o-", "bulk"),
            ("half", "held", "cov", "o:", "all"),
            ("half", "periodic", "cov", "x--", "periodic cell"),
        ):
            means = pick(here, split=split, walls=walls).groupby("ratio")[column].mean().dropna()
            if len(means):
                axes.plot(means.index, means, style, color=colour, markersize=4, label=f"{number}, {what}")
        for split, column, marker in (("radii", "bulk_cov", "^"), ("half", "bulk_cov_volume", "D")):
            mean = pick(here, split=split, walls="held", ratio=0.0)[column].mean()
            axes.plot([0.0], [mean], marker, color=colour, fillstyle="none")
    axes.plot([], [], "^", color=GREY, fillstyle="none", label="R_p/(R_p+R_q), bulk")
    axes.plot([], [], "D", color=GREY, fillstyle="none", label="half, by volume, bulk")
    printed_values = [PAPER["cov_0"], PAPER["cov_4"], PAPER["cov_11"]]
    axes.plot([0.0, 4.0, 11.0], printed_values, "*", color=BLACK, markersize=11, label="paper")
    axes.set(xlabel="halo radius, mean radii", ylabel="CoV by number, %", yscale="log", ylim=(0.4, 130))
    ticks = (0.5, 1, 2, 5, 10, 20, 50, 100)
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    exact = pick(rows, law="laguerre", ratio=0.0)["cov"].max()
    axes.set_title(f"Scatter of the flux (Laguerre, no halo: {exact:.0e} %)")
    axes.legend(ncols=2, fontsize=7.5)


def _extremes(axes, rows):
    for number, colour in _looks(rows).items():
        here = pick(rows, law="calibrated", split="half", walls="held", particles=number)
        for column, style in (("bulk_least", "v-"), ("bulk_mean", "o-"), ("bulk_most", "^-"), ("least", "v:")):
            means = here.groupby("ratio")[column].mean().dropna()
            if len(means):
                label = f"{number} particles" if column == "bulk_mean" else None
                axes.plot(means.index, means, style, color=colour, markersize=4, label=label)
    axes.axhline(1.0, color="black", linewidth=0.8)
    axes.set(xlabel="halo radius, mean radii", ylabel="flux / 3300 W/m2", ylim=(-0.2, 3.0))
    axes.set_title("Smallest, mean and largest flux of the bulk; dotted: smallest of all")
    axes.legend()


def _densities(raw, halos, df):
    rows = pick(df, law="calibrated", walls="held", seed=0)
    if len(rows) == 0:
        return
    rows = rows[rows["particles"] == rows["particles"].max()]
    colours = {
        (0.0, "half"): RED,
        (0.0, "radii"): ORANGE,
        (2.0, "half"): PINK,
        (4.0, "half"): BLUE,
        (11.0, "half"): GREY,
    }
    for (ratio, split), colour in colours.items():
        low, high = DENSITIES[ratio]
        middle = low + (np.arange(BINS) + 0.5) * (high - low) / BINS
        axes = raw if ratio < 4 else halos
        for part, style in (("bulk_", "-"), ("", ":")):
            for cell in pick(rows, split=split)[f"{part}density_{ratio:g}"].dropna():
                label = f"{'no halo' if ratio == 0 else f'halo of {ratio:g}'}, {split}, {part.strip('_') or 'all'}"
                density = numbers(cell) * BINS / (high - low)
                axes.plot(middle, density, style, color=colour, label=label)
    number = int(rows["particles"].max())
    for axes, what in ((raw, "no halo, and a narrow one"), (halos, "halos")):
        axes.set(xlabel="flux / 3300 W/m2", ylabel="density", title=f"Density functions, {number} particles: {what}")
        axes.set_ylim(bottom=0.0)
        axes.legend(fontsize=8)
