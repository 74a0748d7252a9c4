"""Figure of the study of fields among many spheres."""

from __future__ import annotations

import numpy as np

from demheat import referee
from studies.fig18_fields.errors import BOUNDARIES, error_pictures, with_errors, witness
from studies.fig18_fields.rows import POINTS
from studies.fig18_fields.tables import COMPARED, label
from studies.harness.cells import picture
from studies.harness.figures import BLACK, LOOK
from studies.harness.methods import resolution
from studies.harness.pick import pick

LOGARITHMIC = {"temperature": (1e-3, 1.0), "flux": (0.1, 100.0)}


def draw(df, paper):
    """Pictures of the plane, one line of errors of the temperature and one of the flux; errors at points and by size.

    Parameters
    ----------
    df : data frame
        Rows that are ok.
    paper : dict
        Printed numbers.
    """
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=(13, 12.5))
    top, bottom = figure.subfigures(2, 1, height_ratios=[1.75, 1.0])
    _pictures(top, df)
    found = with_errors(df)
    axes = bottom.subplots(1, 3)
    _points(axes[0], found, paper)
    _by_size(axes[1], found, "worst_q", "Flux at A to D, worst point", "error, % of the local flux")
    _by_size(axes[2], found, "flux_rms", "Flux over the plane, away from interfaces", "rms error, % of the mean flux")
    handles, names = axes[1].get_legend_handles_labels()
    bottom.legend(handles, names, loc="outside lower center", ncols=3, fontsize=8)
    return figure


def _pictures(figure, df):
    from matplotlib.colors import LogNorm

    boundary = "walls" if witness(df, "walls") is not None else "gradient"
    truth, rows = witness(df, boundary), pick(df, boundary=boundary)
    others = [pick(rows, name=name) for name in COMPARED]
    others = [group.loc[group["unknowns"].idxmax()] for group in others if len(group)]
    others = [row for row in others if row["case"] != truth["case"]]
    axes = figure.subplots(2, len(others) + 1, squeeze=False)
    look = {"origin": "lower", "extent": (0, 1, 0, 1), "interpolation": "nearest"}
    speed = np.sqrt(sum(picture(truth[f"slice_{axis}"]) ** 2 for axis in "xyz")) / truth["mean_flux"]
    fields = {"temperature": picture(truth["slice_temperature"]), "flux": 100 * speed}
    words_of = {"temperature": "(T - 25 C)/10 K, %", "flux": "|flux|/mean flux, %"}
    errors = {"temperature": "|error|, % of the span", "flux": "|error|, % of the mean flux"}
    for line, (kind, values) in enumerate(fields.items()):
        drawn = axes[line][0].imshow(values, **look, cmap="inferno" if kind == "temperature" else "viridis")
        figure.colorbar(drawn, ax=axes[line][0], shrink=0.8, label=words_of[kind], location="left")
        low, high = LOGARITHMIC[kind]
        for axis, row in zip(axes[line][1:], others, strict=True):
            error = np.abs(error_pictures(row, truth)[line])
            shown = axis.imshow(np.maximum(error, low), **look, norm=LogNorm(low, high), cmap="magma")
            axis.set_xlabel(f"rms {referee.rms(error):.2g} %, largest {error.max():.2g} %", fontsize=9)
            axis.set_title(f"{label(row)},\n{resolution(row)}", fontsize=9)
        if others:
            figure.colorbar(shown, ax=axes[line], shrink=0.8, label=errors[kind])
        _dress(axes[line], df)
        axes[line][0].set_title(f"{kind}: {label(truth)}, {resolution(truth)}\n({BOUNDARIES[boundary]})", fontsize=9)
    _mark(axes[0][0])


def _dress(axes, df):
    """No ticks; outlines of the spheres; the load goes from left to right."""
    gap = picture(pick(df, name="arrangement").iloc[0]["slice_gap"])
    middle = (np.arange(len(gap)) + 0.5) / len(gap)
    for axis in axes:
        axis.set(xticks=[], yticks=[])
        axis.grid(False)
        axis.contour(middle, middle, gap, levels=[0.0], colors="white", linewidths=0.7)
    axes[0].set_xlabel("y: 25 C at the left, 35 C at the right", fontsize=9)
    axes[0].set_ylabel("z, on the plane x = L/2", fontsize=9)


def _mark(axis):
    for letter, place in POINTS.items():
        axis.plot(*place[1:], "o", color="white", markeredgecolor="black", markersize=5)
        axis.annotate(letter, place[1:], xytext=(5, 4), textcoords="offset points", color="white", fontweight="bold")


def _points(axis, found, paper):
    """Errors of the flux at the points, of the finest row of each method and load, and what the paper prints."""
    series = []
    for boundary, full in (("walls", True), ("gradient", False)):
        for name in COMPARED:
            rows = pick(found, name=name, boundary=boundary)
            rows = rows[rows["worst_q"] > 0]
            if len(rows):
                row = rows.loc[rows["unknowns"].idxmax()]
                _, colour, marker, _ = LOOK[name]
                values = [abs(row[f"q_{x}_error"]) for x in POINTS]
                style = {"color": colour, "marker": marker, "mfc": colour if full else "white"}
                series.append((f"{name.upper()}, {boundary}", values, style))
    printed = [100 * abs(referee.value_error(paper[f"q_{x}_de"], paper[f"q_{x}_fe"])) for x in POINTS]
    # 0 at C: printed to three digits, both are 20.3.
    series.append(("printed DE against printed FE", printed, {"color": BLACK, "marker": "P"}))
    for number, (name, values, style) in enumerate(series):
        place = np.arange(len(POINTS)) + 0.7 * ((number + 0.5) / len(series) - 0.5)
        axis.plot(place, np.maximum(values, 1e-2), ls="", label=name, **style)
    axis.axhline(1.0, color=BLACK, linewidth=0.8, linestyle="--")
    axis.set(xticks=range(len(POINTS)), xticklabels=list(POINTS), yscale="log", ylabel="|error|, % of the local flux")
    axis.set_title("Flux at Table 3's points, finest rows")
    axis.yaxis.set_major_formatter("{x:g}")
    axis.set_ylim(8e-3, 12)
    axis.legend(fontsize=7, ncols=2, loc="upper left")


def _by_size(axis, found, column, title, unit):
    for boundary, full in (("walls", True), ("gradient", False)):
        for name in (*COMPARED, "fem-p1"):
            rows = pick(found, name=name, boundary=boundary).sort_values("unknowns")
            rows = rows[rows[column] > 0]
            if len(rows):
                text, colour, marker, style = LOOK[name]
                face = colour if full else "white"
                line = {"color": colour, "marker": marker, "mfc": face, "ls": style if full else ":"}
                axis.plot(rows["unknowns"], rows[column], **line, label=f"{text}, {boundary}")
    values = found[column][found[column] > 0]
    axis.set(xscale="log", yscale="log", xlabel="unknowns", ylabel=unit, title=title)
    axis.set_ylim(10 ** np.floor(np.log10(values.min())), 10 ** np.ceil(np.log10(values.max())))
    axis.set_xlim(1e4, 10 ** np.ceil(np.log10(found["unknowns"].max())))
    axis.yaxis.set_major_formatter("{x:g}")
