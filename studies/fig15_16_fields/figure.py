"""Pictures of fields on a plane, side by side on shared scales, out of the cells of a table.

A cell holds a grid of numbers as text, row by row; rows of the table bring errors, the row "exact" the field itself.
"""

import numpy as np

from demheat import referee
from studies.fig15_16_fields.tables import PRINTED, label
from studies.harness.cells import picture
from studies.harness.figures import LOOK
from studies.harness.methods import resolution
from studies.harness.pick import with_size

# Errors are coloured linearly up to the first, in %, then by decades, and beyond the second in the colour of the end.
REACH = {"temperature": (0.1, 10.0), "flux": (1.0, 100.0)}
UNITS = {"temperature": "(T - 25 C) / 10 K, %", "flux": "flux down the load /\nexact mean flux, %"}
TITLES = {
    "temperature": "Temperature on the plane z = L/2 (the paper's Fig. 15); errors in % of the span of 10 K",
    "flux": "Flux down the load on the plane z = L/2 (the paper's Fig. 16); errors in % of the exact mean flux",
}


def draw(df, paper, points):
    """Figure of a study's rows: temperature above, flux below."""
    from matplotlib import pyplot

    exact, others = _pictured(df)
    figure = pyplot.figure(figsize=(2.0 * (len(others) + 1) + 4.4, 10.6))
    for half, name in zip(figure.subfigures(2, 1, hspace=0.05), UNITS, strict=True):
        half.suptitle(TITLES[name], x=0.01, ha="left", fontsize=13, fontweight="bold")
        fields, charts = half.subfigures(1, 2, width_ratios=(2.0 * (len(others) + 1) + 0.8, 3.6))
        # A halo smooths the flux only.
        rows = others if name == "flux" else [row for row in others if not _wide(row)]
        pictures = fields.subplots(2, len(others) + 1, squeeze=False)
        for axes in pictures[:, len(rows) + 1 :].flat:
            axes.set_axis_off()
        _side_by_side(fields, pictures[:, : len(rows) + 1], name, exact, rows)
        upper, lower = charts.subplots(2, 1)
        if name == "flux":
            _mark(pictures[0][0], points)
            _errors_at_points(upper, df, paper, points)
            _errors_by_size(lower, df, "flux_rms", "Flux, rms away from interface\nand insulated faces", "error, %")
        else:
            _errors_by_size(upper, df, "temperature_rms", "Temperature, rms over the plane", "error, %")
            lower.set_axis_off()
            entries = {}
            _errors_at_points(lower, df, paper, points)
            for axis in (upper, lower):
                entries |= {text: handle for handle, text in zip(*axis.get_legend_handles_labels(), strict=True)}
            lower.clear()
            lower.set_axis_off()
            lower.legend(entries.values(), entries.keys(), loc="upper left", fontsize=9)
    return figure


def _wide(row):
    """Whether a row has the wider halo."""
    return row["ratio"] == row["ratio"] and row["ratio"] > 4


def _pictured(df):
    """The exact row, and of every other method the pictured row with most unknowns."""
    df = df.dropna(subset=["slice_flux"])
    exact = df[df["name"] == "exact"].iloc[0]
    groups = df[df["name"] != "exact"].groupby(["name", "ratio"], dropna=False, sort=False)
    return exact, [rows.loc[rows["unknowns"].idxmax()] for _, rows in groups]


def _title(row, *, halo):
    words, name = resolution(row), label(row)
    name = name if halo else name.split(", halo")[0]
    # A column is some 20 letters wide.
    return (name if len(name) < 22 else name.replace(", ", ",\n", 1)) + (f",\n{words}" if words else "")


def _side_by_side(figure, axes, name, exact, others):
    """Fields above, their errors below with those that stand in the table; one colour bar for each line of pictures."""
    from matplotlib.colors import SymLogNorm

    truth = picture(exact[f"slice_{name}"])
    errors = [picture(row[f"slice_{name}"]) for row in others]
    look = {"origin": "lower", "extent": (0, 1, 0, 1), "interpolation": "nearest"}
    scale = {"vmin": np.nanmin(truth), "vmax": np.nanmax(truth)}
    scale["cmap"] = "inferno" if name == "temperature" else "viridis"
    linear, most = REACH[name]
    signed = SymLogNorm(linear, vmin=-most, vmax=most)
    for axis, row, error in zip(axes[0], (exact, *others), (0.0, *errors), strict=True):
        fields = axis.imshow(_like(truth, error) + error, **look, **scale)
        axis.set_title(_title(row, halo=name == "flux"), fontsize=9)
    for axis, row, error in zip(axes[1][1:], others, errors, strict=True):
        misses = axis.imshow(error, **look, norm=signed, cmap="RdBu_r")
        axis.set_xlabel(_said(row, name), fontsize=8)
    for axis in axes.ravel():
        axis.set(xticks=[], yticks=[])
        axis.grid(False)
    axes[1][0].set_axis_off()
    axes[1][0].text(1.0, 0.5, "error:", ha="right", va="center", fontsize=10, transform=axes[1][0].transAxes)
    figure.colorbar(fields, ax=axes[0], shrink=0.85, label=UNITS[name], pad=0.01)
    bar = figure.colorbar(misses, ax=axes[1], shrink=0.85, label="error, %", pad=0.01, extend="both")
    ticks = [linear * 10**k for k in range(round(np.log10(most / linear)) + 1)]
    bar.set_ticks([-tick for tick in ticks[::-1]] + [0.0, *ticks], minor=False)
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.minorticks_off()


def _like(truth, error):
    """The exact picture with as many pixels as one of errors, which may have fewer."""
    side = len(np.atleast_1d(error))
    if side in (1, len(truth)):
        return truth
    places = ((np.arange(side) + 0.5) / side * len(truth)).astype(int)
    return truth[np.ix_(places, places)]


def _said(row, name):
    """The errors of the table below a picture."""
    if name == "temperature":
        return f"rms {row['temperature_rms']:.2g} %, largest {row['temperature_max']:.3g} %"
    band = max(row["flux_max"], row["flux_max_band"])
    away, beside = row["flux_rms"], row["flux_rms_band"]
    return f"rms away {away:.2g} %,\nin the band {beside:.2g} %,\nlargest {band:.3g} %"


def _mark(axis, points):
    for letter, place in points.items():
        axis.plot(*place[:2], "o", color="white", markeredgecolor="black", markersize=4)
        axis.annotate(letter, place[:2], xytext=(4, 3), textcoords="offset points", color="white", fontsize=9)


def _looks(row):
    """Colour, marker and line of a method, halos told apart."""
    _, colour, marker, style = LOOK[row["name"]]
    if _wide(row):
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
    axis.set(xticks=range(len(points)), xticklabels=list(points), yscale="log", ylabel="|error|, %")
    axis.set_title("Flux at the points of Table 2")
    axis.grid(False, axis="x")


def _errors_by_size(axis, df, column, title, unit):
    rows = df[(df["name"] != "exact") & (df["ratio"].isna() | df["ratio"].isin((4.0, 11.0)))]
    for _, group in rows.groupby(["name", "ratio"], dropna=False, sort=False):
        means = with_size(group).groupby("h", dropna=False)[["unknowns", column]].mean()
        means = means.sort_values("unknowns")
        axis.plot(means["unknowns"], means[column], **_looks(group.iloc[0]), label=label(group.iloc[0]))
    _whole_decades(axis.set_xlim, rows["unknowns"])
    _whole_decades(axis.set_ylim, rows[column])
    axis.set(xscale="log", yscale="log", xlabel="unknowns", ylabel=unit)
    axis.set_title(title)


def _whole_decades(limit, values):
    """A logarithmic axis over whole decades, so that its ticks are powers of ten."""
    limit(10 ** np.floor(np.log10(values.min())), 10 ** np.ceil(np.log10(values.max())))
