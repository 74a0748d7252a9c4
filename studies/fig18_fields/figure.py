"""Figure of the study of fields among many spheres."""

import numpy as np

from demheat import referee
from studies.common.paper_network import NAME
from studies.common.paper_variants import parted
from studies.fig18_fields.errors import BOUNDARIES, error_pictures, network_errors, shown, with_errors, witness
from studies.fig18_fields.rows import POINTS
from studies.fig18_fields.tables import COMPARED, label
from studies.harness.cells import numbers, picture
from studies.harness.figures import BLACK, LOOK, PINK
from studies.harness.methods import resolution
from studies.harness.pick import pick

LOGARITHMIC = {"temperature": (1e-3, 10.0), "flux": (0.1, 100.0)}
WORDS = {"temperature": "(T - 25 C)/10 K, %", "flux": "|flux|/mean flux, %"}
ERRORS = {"temperature": "|error|, % of the span", "flux": "|error|, % of the mean flux"}


def draw(df, paper):
    """Pictures of the plane, a line of errors of temperature, one of flux; errors at points, by size."""
    from matplotlib import pyplot

    network, others = network_errors(df), parted(df)[1]
    figure = pyplot.figure(figsize=(15, 13))
    top, bottom = figure.subfigures(2, 1, height_ratios=[1.35, 1.0])
    _pictures(top, others, network)
    found = with_errors(others)
    axes = bottom.subplots(1, 3)
    _points(axes[0], found, network, paper)
    _by_size(axes[1], found, network, "worst_q", ("Flux at A to D, worst point", "error, % of the local flux"))
    plane = ("Flux over the plane, away from interfaces", "rms error, % of the mean flux")
    _by_size(axes[2], found, network, "flux_rms", plane)
    handles, names = axes[1].get_legend_handles_labels()
    bottom.legend(handles, names, loc="outside lower center", ncols=3, fontsize=8)
    return figure


def _pictures(figure, df, network):
    from matplotlib.colors import LogNorm

    boundary = "walls" if witness(df, "walls") is not None else "gradient"
    truth, others = witness(df, boundary), _drawn(df, network, boundary)
    fine = all(isinstance(row.get("fine_x"), str) for row in (truth, *others))
    axes = figure.subplots(2, len(others) + 1, squeeze=False)
    look = {"origin": "lower", "extent": (0, 1, 0, 1), "interpolation": "nearest"}
    speed = np.sqrt(sum(shown(truth, axis, fine=fine) ** 2 for axis in "xyz")) / truth["mean_flux"]
    fields = {"temperature": shown(truth, "temperature", fine=fine), "flux": 100 * speed}
    for line, (kind, values) in enumerate(fields.items()):
        drawn = axes[line][0].imshow(values, **look, cmap="inferno" if kind == "temperature" else "viridis")
        figure.colorbar(drawn, ax=axes[line][0], shrink=0.75, label=WORDS[kind], location="left")
        low, high = LOGARITHMIC[kind]
        for axis, row in zip(axes[line][1:], others, strict=True):
            error = np.abs(error_pictures(row, truth, fine=fine)[line])
            last = axis.imshow(np.clip(error, low, high), **look, norm=LogNorm(low, high), cmap="magma")
            axis.set_xlabel(f"rms {referee.rms(error):.2g} %, largest {error.max():.3g} %", fontsize=9)
            axis.set_title(_titled(row), fontsize=8)
        if others:
            figure.colorbar(last, ax=axes[line], shrink=0.75, label=ERRORS[kind])
        _dress(axes[line], pick(df, name="arrangement").iloc[0])
        axes[line][0].set_title(f"{kind}: {_titled(truth)}", fontsize=9)
    figure.suptitle(f"The plane x = L/2, {BOUNDARIES[boundary]}", fontsize=11)
    _mark(axes[0][0])


def _drawn(df, network, boundary):
    """The finest row of each method but the witness; of the paper's network one between walls, as the paper has it."""
    rows, truth = pick(df, boundary=boundary), witness(df, boundary)
    found = [group.loc[group["unknowns"].idxmax()] for group in (pick(rows, name=n) for n in COMPARED) if len(group)]
    found = [row for row in found if row["case"] != truth["case"]]
    papers = {"packing": "lsa", "held": "center", "seed": 0}
    ours = pick(network, **papers) if len(network) and boundary == "walls" else ()
    return found + [row for _, row in ours[-1:].iterrows()] if len(ours) else found


def _titled(row):
    if row["name"] == NAME:
        return f"DEM as in the paper, halo of 11,\n{row['particles']:.0f} particles"
    return f"{label(row)},\n{resolution(row)}"


def _dress(axes, place):
    """No ticks; outlines of the spheres; the load goes from left to right."""
    from matplotlib.patches import Circle

    for axis in axes:
        axis.set(xticks=[], yticks=[])
        axis.grid(False)
        if isinstance(place.get("circles"), str):
            for y, z, radius in numbers(place["circles"]).reshape(-1, 3):
                axis.add_patch(Circle((y, z), radius, fill=False, color="white", linewidth=0.7))
        else:  # rows of before have the distances of pixels only
            gap = picture(place["slice_gap"])
            middle = (np.arange(len(gap)) + 0.5) / len(gap)
            axis.contour(middle, middle, gap, levels=[0.0], colors="white", linewidths=0.7)
    axes[0].set_xlabel("y: 25 C at the left, 35 C at the right", fontsize=9)
    axes[0].set_ylabel("z", fontsize=9)


def _mark(axis):
    for letter, place in POINTS.items():
        axis.plot(*place[1:], "o", color="white", markeredgecolor="black", markersize=5)
        axis.annotate(letter, place[1:], xytext=(5, 4), textcoords="offset points", color="white", fontweight="bold")


def _points(axis, found, network, paper):
    """Errors of the flux at the points, of the finest row of each method and load, and what the paper prints."""
    series = []
    for boundary, full in (("walls", True), ("gradient", False)):
        for name in COMPARED:
            rows = pick(found, name=name, boundary=boundary)
            rows = rows[rows["worst_q"] > 0]
            if len(rows):
                row = rows.loc[rows["unknowns"].idxmax()]
                _, colour, marker, _ = LOOK[name]
                style = {"color": colour, "marker": marker, "mfc": colour if full else "white"}
                series.append((f"{name.upper()}, {boundary}", row, style))
        rows = pick(network, boundary=boundary) if len(network) else network
        if len(rows):
            row = rows.loc[rows["particles"].idxmax()]
            style = {"color": PINK, "marker": "s", "mfc": PINK if full else "white"}
            series.append((f"paper's network, {boundary}", row, style))
    series = [(name, [abs(row[f"q_{x}_error"]) for x in POINTS], style) for name, row, style in series]
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
    axis.set_ylim(8e-3, 1.5 * max(10.0, *(max(values) for _, values, _ in series)))
    axis.legend(fontsize=7, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.08))


def _by_size(axis, found, network, column, words):
    for boundary, full in (("walls", True), ("gradient", False)):
        for name in (*COMPARED, "fem-p1"):
            rows = pick(found, name=name, boundary=boundary).sort_values("unknowns")
            rows = rows[rows[column] > 0]
            if len(rows):
                text, colour, marker, style = LOOK[name]
                face = colour if full else "white"
                line = {"color": colour, "marker": marker, "mfc": face, "ls": style if full else ":"}
                axis.plot(rows["unknowns"], rows[column], **line, label=f"{text}, {boundary}")
        rows = pick(network, boundary=boundary) if len(network) else network
        if len(rows):
            mean = rows.groupby("unknowns")[column].mean()
            line = {"color": PINK, "marker": "s", "mfc": PINK if full else "white", "ls": "--" if full else ":"}
            axis.plot(mean.index, mean, **line, label=f"DEM as in the paper, mean of variants, {boundary}")
    values = np.concatenate([each[column][each[column] > 0] for each in (found, network) if len(each)])
    axis.set(xscale="log", yscale="log", xlabel="unknowns", ylabel=words[1], title=words[0])
    axis.set_ylim(10 ** np.floor(np.log10(values.min())), 10 ** np.ceil(np.log10(values.max())))
    axis.set_xlim(1e4, 10 ** np.ceil(np.log10(found["unknowns"].max())))
    axis.yaxis.set_major_formatter("{x:g}")
