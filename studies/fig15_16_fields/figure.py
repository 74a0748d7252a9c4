"""Pictures of fields on a plane, side by side on shared scales, out of the cells of a table.

A cell holds a grid of numbers as text, row by row; rows of the table bring errors, the row "exact" the field itself.
"""

from __future__ import annotations

import numpy as np

from demheat import referee
from studies.fig15_16_fields.tables import PRINTED, label
from studies.harness.cells import picture
from studies.harness.figures import LOOK
from studies.harness.methods import resolution
from studies.harness.pick import with_size

# Errors are coloured linearly up to the first, in %, then by decades, and beyond the second in the colour of the end.
REACH = {"temperature": (0.1, 10.0), "flux": (1.0, 100.0)}
UNITS = {"temperature": "(T - 25 C) / 10 K, %", "flux": "flux down the load / exact mean flux, %"}


def draw(df, paper, points):
    """Figure of a study's rows.

    Parameters
    ----------
    df : data frame
        With columns `slice_temperature` and `slice_flux`, cells of pictures in %, where a row is pictured.
    paper : dict
        Printed numbers.
    points : dict of str to (3,) tuple
        Points that are marked, in edges of the box.
    """
    from matplotlib import pyplot

    exact, others = _pictured(df)
    figure = pyplot.figure(figsize=(2.35 * (len(others) + 1) + 0.6, 14.2))
    figure.get_layout_engine().set(h_pad=0.1)  # inches: titles of one line of pictures stay clear of the next
    top, bottom = figure.subfigures(2, 1, height_ratios=[2.75, 1.0])
    axes = top.subplots(4, len(others) + 1, squeeze=False)
    for pair, name in zip((axes[:2], axes[2:]), UNITS, strict=True):
        _side_by_side(top, pair, name, exact, others)
    for column, row in enumerate((exact, *others)):
        for axis in axes[::2, column]:
            axis.set_title(_title(label(row), row), fontsize=9)
        if column > 1 and row["slice_temperature"] == others[column - 2]["slice_temperature"]:
            _hide_repeated(axes[:2, column])
    _mark(axes[2][0], points)
    left, middle, right = bottom.subplots(1, 3, gridspec_kw={"width_ratios": [1.15, 1.0, 1.0]})
    _errors_at_points(left, df, paper, points)
    _errors_by_size(middle, df, "flux_rms", "flux, rms away from interface and insulated faces")
    _errors_by_size(right, df, "temperature_rms", "temperature, rms over the plane")
    middle.set_ylabel("error, % of the mean flux")
    right.set_ylabel("error, % of the span")
    entries = {}
    for axis in (left, middle):
        entries |= {name: handle for handle, name in zip(*axis.get_legend_handles_labels(), strict=True)}
    bottom.legend(entries.values(), entries.keys(), loc="outside lower center", ncols=4, fontsize=8)
    return figure


def _pictured(df):
    """The exact row, and of every other method the pictured row with most unknowns."""
    df = df.dropna(subset=["slice_flux"])
    exact = df[df["name"] == "exact"].iloc[0]
    groups = df[df["name"] != "exact"].groupby(["name", "ratio"], dropna=False, sort=False)
    return exact, [rows.loc[rows["unknowns"].idxmax()] for _, rows in groups]


def _title(name, row):
    words = resolution(row)
    # A column is some 25 letters wide.
    return (name if len(name) < 25 else name.replace(", ", ",\n", 1)) + (f",\n{words}" if words else "")


def _side_by_side(figure, axes, name, exact, others):
    """Fields above, their errors below; one colour bar for each line of pictures."""
    from matplotlib.colors import SymLogNorm

    truth = picture(exact[f"slice_{name}"])
    errors = [picture(row[f"slice_{name}"]) for row in others]
    look = {"origin": "lower", "extent": (0, 1, 0, 1), "interpolation": "nearest"}
    scale = {"vmin": np.nanmin(truth), "vmax": np.nanmax(truth)}
    scale["cmap"] = "inferno" if name == "temperature" else "viridis"
    linear, most = REACH[name]
    signed = SymLogNorm(linear, vmin=-most, vmax=most)
    for axis, values in zip(axes[0], (truth, *(truth + error for error in errors)), strict=True):
        fields = axis.imshow(values, **look, **scale)
    for axis, error in zip(axes[1][1:], errors, strict=True):
        misses = axis.imshow(error, **look, norm=signed, cmap="RdBu_r")
        axis.set_xlabel(f"largest {np.nanmax(np.abs(error)):.2g} %", fontsize=8)
    for axis in axes.ravel():
        axis.set(xticks=[], yticks=[])
        axis.grid(False)
    axes[1][0].set_axis_off()
    figure.colorbar(fields, ax=axes[0], shrink=0.85, label=UNITS[name].replace(" / ", " /\n"), pad=0.01)
    bar = figure.colorbar(misses, ax=axes[1], shrink=0.85, label=f"error of the {name}, %", pad=0.01)
    ticks = [linear * 10**k for k in range(round(np.log10(most / linear)) + 1)]
    bar.set_ticks([-tick for tick in ticks[::-1]] + [0.0, *ticks], minor=False)
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.minorticks_off()


def _hide_repeated(axes):
    """Clear the pictures of a temperature that stands beside it already: a halo smooths the flux only."""
    for axis in axes:
        axis.clear()
        axis.set_axis_off()
    axes[0].text(0.5, 0.5, "temperature:\nas on the left", ha="center", va="center", fontsize=9)


def _mark(axis, points):
    for letter, place in points.items():
        axis.plot(*place[:2], "o", color="white", markeredgecolor="black", markersize=4)
        axis.annotate(letter, place[:2], xytext=(4, 3), textcoords="offset points", color="white", fontsize=9)


def _looks(row):
    """Colour, marker and line of a method, halos told apart."""
    _, colour, marker, style = LOOK[row["name"]]
    if row["ratio"] == row["ratio"] and row["ratio"] > 4:
        marker, style = "v", ":"
    return {"color": colour, "marker": marker, "linestyle": style}


def _errors_at_points(axis, df, paper, points):
    """|error| of the flux at the marked points, of pictured rows and of printed ones."""
    exact, others = _pictured(df)
    bars = [(label(row), [abs(row[f"q_{letter}_error"]) for letter in points], _looks(row)) for row in others]
    for (name, key), marker in zip(PRINTED.items(), "PX*", strict=True):
        off = [referee.value_error(paper[f"q_{letter}_{key}"], exact[f"q_{letter}"]) for letter in points]
        bars.append((f"printed: {name}", 100 * np.abs(off), {"color": "black", "marker": marker}))
    for number, (name, values, look) in enumerate(bars):
        place = np.arange(len(points)) + 0.8 * ((number + 0.5) / len(bars) - 0.5)
        axis.plot(place, values, **look | {"linestyle": ""}, label=name)
    _whole_decades(axis.set_ylim, np.array([value for _, values, _ in bars for value in values]))
    axis.set(xticks=range(len(points)), xticklabels=list(points), yscale="log", ylabel="|error|, % of the exact flux")
    axis.set_title("Flux down the load at the points of Table 2")
    axis.grid(False, axis="x")


def _errors_by_size(axis, df, column, title):
    rows = df[df["name"] != "exact"]
    for _, group in rows.groupby(["name", "ratio"], dropna=False, sort=False):
        means = with_size(group).groupby("h", dropna=False)[["unknowns", column]].mean()
        means = means.sort_values("unknowns")
        axis.plot(means["unknowns"], means[column], **_looks(group.iloc[0]), label=label(group.iloc[0]))
    _whole_decades(axis.set_xlim, rows["unknowns"])
    _whole_decades(axis.set_ylim, rows[column])
    axis.set(xscale="log", yscale="log", xlabel="unknowns")
    axis.set_title(title)


def _whole_decades(limit, values):
    """A logarithmic axis over whole decades, so that its ticks are powers of ten."""
    limit(10 ** np.floor(np.log10(values.min())), 10 ** np.ceil(np.log10(values.max())))
