"""Widths of brackets against what they cost, and where the exact values are in them."""

import numpy as np

from demheat.referee import value_error
from studies.brackets.means import place
from studies.harness.figures import BLACK, GREY
from studies.harness.pick import pick


def plot(df):
    """Width against cost; the drawn scenes with the exact value between their bounds."""
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11, 4.8))
    _widths(left, pick(df, part="refined"), pick(df, part="voxels"))
    _places(right, pick(df, part="drawn"))
    figure.suptitle("The true conductivity is certain to a fraction of a per cent within seconds to minutes")
    return figure


def _widths(axes, rows, grids):
    axes.plot(rows["cpu_s"], rows["width_percent"], "C0-o", label="one sphere, contrast 10")
    axes.plot(grids["cpu_s"], grids["width_percent"], "C0:o", fillstyle="none", label="the sphere on voxels")
    axes.set(xscale="log", yscale="log", xlabel="CPU seconds", ylabel="upper over lower bound less 1, %")
    axes.set_title("What a narrower bracket costs")
    if len(rows) + len(grids):
        axes.legend()


def _places(axes, rows):
    """Each drawn scene as a bar from lower to upper bound, in per cent of the exact value."""
    off = {name: 100 * value_error(rows[bound], rows["exact"]) for name, bound in (("low", "lower"), ("high", "upper"))}
    rows = rows.assign(**off)
    rows = rows.sort_values("width_percent")
    at = np.arange(len(rows))
    axes.vlines(at, rows["low"], rows["high"], color="C0", linewidth=2)
    axes.axhline(0, color=BLACK, linewidth=0.8)
    outside = ~place(rows).between(0, 1)
    axes.plot(at[outside], np.zeros(outside.sum()), "x", color="C3")
    axes.set_yscale("symlog", linthresh=0.01)
    axes.set(xlabel="scene, by width", ylabel="bounds less exact value, %")
    axes.set_title(f"{len(rows) - int(outside.sum())} of {len(rows)} brackets hold the exact value (line)")
    axes.grid(axis="y", color=GREY, linewidth=0.3)
