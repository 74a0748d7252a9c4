"""Errors of networks of grains against gaps, contacts and conductivities."""

import math

import numpy as np

from demheat.grains import Gap
from studies.grains.cases import GOOD, KINDS
from studies.harness.figures import BLACK, BLUE, GREEN, GREY, ORANGE, PINK, RED
from studies.harness.pick import pick

COLOURS = dict(zip(KINDS, (BLUE, GREEN, ORANGE), strict=True))
# Between surfaces, over the radius: as the networks here have it.
WIDEST = Gap(conductivity=1.0).widest
MARKS = {10.0: "o", 100.0: "s", 1000.0: "^"}


def plot(df):
    """Errors against the gap; against the radius of contacts; networks beside the continuum."""
    from matplotlib import pyplot

    figure, (left, middle, right) = pyplot.subplots(1, 3, figsize=(14, 4.8))
    _missing(left, pick(df, part="array"))
    _contacts(middle, pick(df, part="contact"))
    _beside(right, df[df["part"].ne("contact")])
    figure.suptitle("Networks of grains know gaps and contacts; what flows elsewhere, some k of the medium, they miss")
    return figure


def _missing(axes, rows):
    for (kind, contrast), group in rows.groupby(["kind", "contrast"], sort=False):
        group = group.sort_values("gap")
        faint = 1.0 if contrast >= GOOD else 0.4
        how = {"color": COLOURS[kind], "marker": MARKS[contrast], "alpha": faint, "label": f"{kind}, {contrast:g}"}
        axes.plot(group["gap"], group["missing"], **how)
    axes.axhline(0, color=BLACK, linewidth=0.8)
    axes.set(xscale="log", xlabel="gap over radius", ylabel="missing, conductivities of the medium")
    axes.set_title("Arrays: exact less network")
    if len(rows):
        axes.legend(ncols=3, fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.14))
    _second(axes, pick(rows, kind="bcc"))


def _second(axes, rows):
    """Say where second neighbours of a body-centred array are farther apart than a gap may be."""
    beyond = rows[2 / math.sqrt(3) * (2 + rows["gap"]) - 2 > WIDEST]
    if len(beyond):
        at = beyond.loc[beyond["missing"].idxmin()]
        words = f"here second neighbours of bcc are\nbeyond the widest gap of a pair, {WIDEST:g}"
        arrow = {"arrowstyle": "->", "color": COLOURS["bcc"]}
        axes.annotate(words, (at["gap"], at["missing"]), xytext=(0.97, 0.13), textcoords="axes fraction", fontsize=8,
                      color=COLOURS["bcc"], ha="right", arrowprops=arrow)  # fmt: skip


def _contacts(axes, rows):
    bare = rows[rows["contrast"].isna()].sort_values("contact")
    axes.plot(bare["contact"], bare["error_percent"], "o-", color=BLACK, label="vacuum")
    for (contrast, group), colour in zip(rows.groupby("contrast"), (GREY, PINK, RED), strict=False):
        group = group.sort_values("contact")
        axes.plot(group["contact"], group["error_percent"], marker=MARKS[contrast], color=colour, label=f"{contrast:g}")
    axes.axhline(0, color=BLACK, linewidth=0.8)
    axes.set(xlabel="radius of the contact over that of the grain", ylabel="error of the conductance, %")
    axes.set_title("Contacts, by contrast")
    axes.legend()


def _beside(axes, rows):
    for part, mark, colour in (("array", "o", BLUE), ("bed", "*", RED)):
        mine = pick(rows, part=part)
        axes.plot(mine["exact_ratio"], mine["k_ratio"], mark, color=colour, label=part)
    ends = np.array([1.0, max(rows["exact_ratio"].max(), 2.0)])
    axes.plot(ends, ends, color=BLACK, linewidth=0.8)
    axes.set(xscale="log", yscale="log", xlabel="continuum", ylabel="network", title="Conductivity over the medium's")
    axes.legend()
