"""Figure of the sphere's centre: its temperature and errors in time, errors by unknowns, the network's variants."""

import numpy as np

from studies.common import sphere_in_time
from studies.common.paper_looks import draw_variants
from studies.common.paper_variants import parted
from studies.common.sphere_in_time import CENTER_TIMES as TIMES
from studies.common.sphere_looks import LOOKS
from studies.fig07_sphere.means import PAPER, network_errors, plain
from studies.harness.cells import numbers
from studies.harness.figures import BLACK


def plot(df):
    """The centre in time, its error in time, errors against unknowns, and the paper's network's variants."""
    from matplotlib import pyplot

    network, others = parted(df)
    df, made = plain(others), network_errors(network)
    across = 3 if made else 2
    figure, axes = pyplot.subplots(2, across, figsize=(5.6 * across, 9.5))
    _in_time(axes[0, 0], df)
    _errors(axes[0, 1], df)
    _by_unknowns(axes[1, 0], df, "at_10s", "Error of the centre at 10 s, means over packings")
    _by_unknowns(axes[1, 1], df, "worst", "Its largest error in time")
    axes[1, 0].plot(PAPER["particles"], PAPER["centre_10s"], "*", color=BLACK, markersize=11, label="DEM of the paper")
    axes[1, 0].legend(fontsize=8, loc="lower left")
    if made:
        draw_variants(axes[0, 2], made, ["error_10s"], PAPER["centre_10s"], "K")
        axes[0, 2].set(
            ylabel="error of the centre at 10 s, K", title="The paper's network: packings, walls, calibrations"
        )
        axes[0, 2].set_xticks([])
        axes[1, 2].remove()
    return figure


def _in_time(ax, df):
    """The exact curve, finely, and the finest row of each method at the study's times."""
    from references import series

    curve = np.linspace(0.0, TIMES[-1], 121)
    exact = [f.temperature_at(sphere_in_time.CENTER)[0] for f in series.evolve(sphere_in_time.sphere(), curve)]
    ax.plot(curve, exact, color=BLACK, linewidth=0.8, label="exact")
    for name, row in _finest(df):
        colour, marker = LOOKS[name]
        there = np.interp(TIMES, curve, exact) + numbers(row["errors"])
        ax.plot(TIMES, there, marker, color=colour, markersize=5, fillstyle="none", label=_words(name, row))
    ax.set(xlabel="time, s", ylabel="temperature of the centre, C", title="The centre in time, as the paper draws it")
    ax.legend(fontsize=8, loc="lower right")


def _errors(ax, df):
    for name, row in _finest(df):
        colour, marker = LOOKS[name]
        ax.plot(
            TIMES, np.abs(numbers(row["errors"])), marker=marker, color=colour, markersize=4, label=_words(name, row)
        )
    ax.plot(10.0, PAPER["centre_10s"], "*", color=BLACK, markersize=11, label="DEM of the paper")
    ax.set(xlabel="time, s", ylabel="|error| of the centre, K", yscale="log", ylim=(1e-4, 30.0))
    ax.set_title("Its error, finest row of each")
    ax.legend(fontsize=8, ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.12))


def _finest(df):
    """The row of most unknowns of each method, one packing."""
    for name, rows in df.groupby("name"):
        yield name, rows.loc[rows["unknowns"].idxmax()]


def _words(name, row):
    return f"{name}, {row['unknowns']:.0f}"


def _by_unknowns(ax, df, column, title):
    for name, rows in df.groupby("name"):
        colour, marker = LOOKS[name]
        means = rows.assign(at_10s=rows["error_10s"].abs()).groupby(["particles", "size"], dropna=False)
        means = means[["unknowns", "worst", "at_10s"]].mean().sort_values("unknowns")
        ax.plot(means["unknowns"], means[column], marker=marker, color=colour, label=name)
    ax.set(xlabel="unknowns", ylabel="|error| of the centre, K", xscale="log", yscale="log", title=title)
