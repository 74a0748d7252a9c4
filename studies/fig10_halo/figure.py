"""Figure of the study of halos."""

import numpy as np

from studies.fig10_halo.statistics import BINS, DENSITIES, DEPTHS, PAPER, SHOWN, WEIGHTINGS, long
from studies.harness.cells import numbers
from studies.harness.figures import BLACK, BLUE, GREEN, GREY, ORANGE, RED
from studies.harness.pick import pick

# Numbers of particles, few to many.
COLOURS = (ORANGE, GREEN, BLUE, RED)
HALOS = {0.0: ("no halo", RED), 4.0: ("halo of 4", BLUE), 11.0: ("halo of 11", GREY)}


def plot(df):
    """CoV against the halo's radius by all four weightings; density functions; the flux near a wall."""
    from matplotlib import pyplot

    rows = long(df)
    figure = pyplot.figure(figsize=(14, 8.2))
    left, right = figure.subfigures(1, 2, width_ratios=(1.9, 1.0))
    panels = left.subplots(2, 2, sharex=True, sharey=True)
    for axes, ((over, by), column) in zip(panels.flat, WEIGHTINGS.items(), strict=True):
        _cov(axes, rows, column)
        axes.set_title(f"Over {'the bulk' if over == 'bulk' else 'all particles'}, by {by}")
    for axes in panels[1]:
        axes.set_xlabel("halo radius, mean radii")
    for axes in panels[:, 0]:
        axes.set_ylabel("CoV of the flux, %")
    left.suptitle("Scatter of the particles' flux in a homogeneous block", fontsize=12)
    left.legend(*_entries(panels.flat), loc="outside lower center", ncols=4)
    wall, raw, halos = right.subplots(3, 1)
    _near_wall(wall, df)
    _densities((raw, halos), df)
    return figure


def _entries(panels):
    """Handles and labels of all panels, each once."""
    found = {}
    for axes in panels:
        found |= {name: handle for handle, name in zip(*axes.get_legend_handles_labels(), strict=True)}
    return list(found.values()), list(found)


def _cov(axes, rows, column):
    """One weighting: the paper's network by number of particles, in the periodic cell, and with own parts of links."""
    half = pick(rows, law="calibrated", split="half")
    for number, colour in zip(sorted(rows["particles"].unique()), COLOURS, strict=False):
        for walls, style in (("held", "o-"), ("periodic", "x--")):
            # In a cell all is bulk.
            means = pick(half, walls=walls, particles=number).groupby("ratio")[column].mean().dropna()
            if len(means) and (walls == "held" or column.startswith("bulk")):
                label = f"{number} particles" if walls == "held" else None
                axes.plot(means.index, means, style, color=colour, markersize=4, linewidth=1.2, label=label)
        own = pick(rows, law="calibrated", split="radii", walls="held", ratio=0.0, particles=number)[column].mean()
        axes.plot([0.0], [own], "^", color=colour, fillstyle="none")
    axes.plot([], [], "x--", color=GREY, label="periodic cell")
    axes.plot([], [], "^", color=GREY, fillstyle="none", label="weights R_p / (R_p + R_q)")
    axes.plot(SHOWN, [PAPER[f"cov_{r:g}"] for r in SHOWN], "*", color=BLACK, markersize=12, zorder=3, label="printed")
    axes.set(yscale="log", ylim=(0.5, 90))
    ticks = (0.5, 1, 2, 5, 10, 20, 50)
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()


def _near_wall(axes, df):
    """Mean flux by depth below a wall with a temperature."""
    rows = _largest(df, split="half")
    middle = (DEPTHS[1:] + DEPTHS[:-1]) / 2
    for ratio, (label, colour) in HALOS.items():
        for text in rows[f"near_{ratio:g}"].dropna() if f"near_{ratio:g}" in rows else ():
            axes.plot(middle, numbers(text), "o-", color=colour, markersize=3, label=label)
    axes.axhline(1.0, color=BLACK, linewidth=0.8)
    axes.set(xlabel="depth below the wall, mean radii", ylabel="mean flux / 3300 W/m2")
    axes.set_title("Flux below a wall with a temperature")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower right")


def _largest(df, **where):
    """Rows of the paper's network between walls, first packing, most particles."""
    rows = pick(df, law="calibrated", walls="held", seed=0, **where)
    return rows[rows["particles"] == rows["particles"].max()]


def _densities(panels, df):
    """Density functions without halo and with halos, over the bulk (solid) and all particles (dotted)."""
    rows = _largest(df)
    for ratio, (label, colour) in HALOS.items():
        axes = panels[0 if ratio == 0 else 1]
        for split, shade in (("half", colour), *([("radii", ORANGE)] if ratio == 0 else [])):
            _density(axes, pick(rows, split=split), ratio, shade, f"{label}, weights {split}" if ratio == 0 else label)
    number = int(rows["particles"].max())
    panels[0].set_title(f"{number} particles; dotted: all, solid: bulk")
    for axes in panels:
        axes.set(xlabel="flux / 3300 W/m2", ylabel="density")
        axes.set_ylim(bottom=0.0)
        axes.legend(fontsize=8, loc="upper right")


def _density(axes, rows, ratio, colour, label):
    low, high = DENSITIES[ratio]
    middle = low + (np.arange(BINS) + 0.5) * (high - low) / BINS
    for part, style in (("bulk_", "-"), ("", ":")):
        for cell in rows[f"{part}density_{ratio:g}"].dropna():
            axes.plot(middle, numbers(cell) * BINS / (high - low), style, color=colour, label=label)
            label = None
