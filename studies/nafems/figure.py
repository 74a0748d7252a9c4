"""The figure: errors against unknowns, over the body and at the point, and the exact solutions."""

import numpy as np
from matplotlib import pyplot
from matplotlib.ticker import NullFormatter

from studies.harness.figures import BLACK, GREY, look
from studies.nafems.scenes import ABOVE, HEIGHT, THICK, WIDTH, problem

LABELS = {"fem-bricks": {"label": "FEM, bricks"}}
KINDS = (("over the body", {"linestyle": "-"}), ("at the point", {"linestyle": ":", "marker": ".", "linewidth": 0.8}))


def drawn(df):
    """Two panels of errors and one of the plate."""
    figure, panels = pyplot.subplots(1, 3, figsize=(15, 4.8), width_ratios=(1, 1, 0.8))
    for axes, which, title in zip(
        panels, ("T3", "T4"), ("T3: an end swings, 32 s", "T4: a plate convects"), strict=False
    ):
        for name, rows in df[df["problem"] == which].groupby("name", sort=False):
            _errors(axes, name, rows)
        axes.set(xscale="log", yscale="log", xlabel="unknowns", title=title)
        axes.xaxis.set_minor_formatter(NullFormatter())
    for words, how in KINDS:
        panels[0].plot([], [], color=BLACK, label=words, **how)
    panels[0].set_ylabel("error, % of the span")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=6)
    _plate(panels[2])
    figure.suptitle("\n".join(_best(df, which) for which in ("T3", "T4")))
    return figure


def _best(df, which):
    """What quadratic elements and particles reach over the body, and with how many unknowns."""
    said = []
    for name, words in (("fem", "quadratic elements"), ("dem", "particles")):
        rows = df[(df["problem"] == which) & (df["name"] == name)]
        if len(rows):
            row = rows.loc[rows["unknowns"].idxmax()]
            said.append(f"{words} {row['rms_percent']:.2g} % with {row['unknowns']:.0f} unknowns")
    return f"{which}: {', '.join(said)}"


def _errors(axes, name, rows):
    rows = rows.assign(size=rows["error_percent"].abs())
    knob = "particles" if name == "dem" else "edge"
    means = rows.groupby(knob)[["unknowns", "rms_percent", "size"]].mean().sort_values("unknowns")
    style = look(name, **LABELS.get(name, {}))
    axes.plot(means["unknowns"], means["rms_percent"], **style)
    axes.plot(means["unknowns"], means["size"], ":", marker=".", color=style["color"], linewidth=0.8)


def _plate(axes):
    given = problem("T4")
    x, y = np.meshgrid(np.linspace(0, WIDTH, 61), np.linspace(ABOVE * HEIGHT, HEIGHT, 96))
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, THICK / 2)])
    lines = axes.contour(
        x, y, given.exact(points).reshape(x.shape), levels=(1, 2, 5, 10, 20, 40, 60, 80), colors=[GREY]
    )
    axes.clabel(lines, fontsize=8)
    axes.plot(*given.point[:2], "o", color=BLACK, clip_on=False)
    axes.set(aspect="equal", xlabel="x, m", ylabel="y, m", xlim=(0, WIDTH), ylim=(0, HEIGHT))
    axes.set_title("T4: exact, C")
