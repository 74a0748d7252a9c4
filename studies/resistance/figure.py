"""Errors against the Kapitza length, the fall of the conductivity, and what resistance the papers' gap asks for."""

import numpy as np

from studies.harness import methods
from studies.harness.figures import BLACK, BLUE, GREEN, GREY, ORANGE, RED, look
from studies.harness.pick import finest, pick
from studies.resistance.cases import FRACTION, FRACTIONS, GAP, KNOWING, SILICA, USUAL
from studies.resistance.means import conductivity, curve, explaining, radius_of

COLOURS = dict(zip(FRACTIONS, (BLUE, GREEN, ORANGE, RED), strict=True))


def plot(df):
    """Errors against the Kapitza length; the fall of the conductivity; the resistance that the gap asks for."""
    from matplotlib import pyplot

    figure, (left, middle, right) = pyplot.subplots(1, 3, figsize=(14, 4.8))
    _errors(left, pick(df, part="array"))
    rows = pick(df, part="silica")
    _falls(middle, rows)
    _needed(right, rows)
    radius = explaining(rows, FRACTION, GAP)
    told = (
        ""
        if radius is None
        else f": R = {USUAL:g} m$^2$K/W makes {GAP:.0%} at f = {FRACTION:g} of {_nanometres(radius)}"
    )
    figure.suptitle(f"Resistance of interfaces matters where the Kapitza length is a part of the radius{told}")
    return figure


def _nanometres(length):
    return f"{1e9 * radius_of(length, USUAL):.0f} nm radius"


def _errors(axes, rows):
    """Of the finest rows, and faint those of coarser ones."""
    for name in KNOWING:
        mine = pick(rows, name=name)
        if not len(mine):
            continue
        best = finest(mine)
        for label, group in (("", mine.drop(best.index)), (None, best)):
            how = look(name) if label is None else look(name, label="_", alpha=0.35, linestyle="")
            # A length of 0 has no place on a logarithmic axis.
            axes.plot(np.maximum(group["kapitza"], 0.02), group["error_percent"].abs(), **how)
        axes.lines[-1].set_label(f"{methods.all_methods()[name].title}, {methods.resolution(best.iloc[0])}")
    axes.plot([], [], "o", color=GREY, alpha=0.35, label="faint: coarser")
    axes.set(xscale="log", yscale="log", xlabel="Kapitza length over radius (leftmost: 0)")
    axes.set(ylabel="|error of the conductivity|, %", title="Sphere in a cube, contrast 10")
    if axes.get_legend_handles_labels()[0]:
        # Below the curves.
        axes.set_ylim(bottom=axes.get_ylim()[0] / 300)
        axes.legend(loc="lower left")


def _falls(axes, rows):
    lengths = np.linspace(0.0, max(SILICA), 100)
    for fraction, colour in COLOURS.items():
        found = curve(rows, fraction)
        if not len(found):
            continue
        axes.plot(found.index, found / found.iloc[0], "o", color=colour, label=f"f = {fraction:g}")
        formula = np.array([conductivity(fraction, length) for length in lengths])
        axes.plot(lengths, formula / formula[0], color=colour, linewidth=1.0)
    axes.plot([], [], "o", color=GREY, label="multipoles")
    axes.plot([], [], color=GREY, linewidth=1.0, label="Hasselman-Johnson")
    axes.axhline(1 - GAP, color=BLACK, linestyle="--", linewidth=0.8)
    axes.annotate(f"{GAP:.0%} less", (max(SILICA), 1 - GAP), ha="right", va="bottom", fontsize=8)
    axes.set(xlabel="Kapitza length over radius", ylabel="conductivity over that with perfect interfaces")
    axes.set_title("Silica in epoxy")
    axes.legend()


def _needed(axes, rows):
    radii = np.logspace(-9, -4, 50)
    for fraction, colour in COLOURS.items():
        length = explaining(rows, fraction, GAP)
        if length is not None:
            axes.plot(radii, radii / radius_of(length, 1.0), color=colour, label=f"f = {fraction:g}")
    axes.axhline(USUAL, color=BLACK, linestyle="--", linewidth=0.8)
    axes.annotate("usual order", (radii[-1], USUAL), ha="right", va="bottom", fontsize=8)
    axes.axhspan(USUAL / 10, USUAL * 10, color=GREY, alpha=0.15, linewidth=0)
    axes.set(xscale="log", yscale="log", xlabel="radius of the spheres, m", ylabel="resistance, m$^2$K/W")
    axes.set_title(f"What {GAP:.0%} less asks for")
    if axes.get_legend_handles_labels()[0]:
        axes.legend()
