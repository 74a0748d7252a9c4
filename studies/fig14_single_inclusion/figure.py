"""Figure of the single inclusion: k over the contrast, errors of the methods, and of the paper's network's variants."""

import numpy as np

from studies.common.paper_looks import draw_variants
from studies.common.paper_variants import best_variant, interval, parted, values, variant_errors
from studies.fig14_single_inclusion.means import PAPER, exact_of
from studies.fig14_single_inclusion.scenes import CONTRASTS, WORDS
from studies.harness import methods
from studies.harness.figures import BLACK, GREY, LOOK, PINK, look
from studies.harness.pick import finest, pick

ACROSS = "conductivity of the sphere / matrix"
# What stands in the panel of errors, besides the methods that every study compares.
SHOWN = ("dem-plain", "dem-calibrated", "fem-p1", "maxwell")


def plot(df):
    """Conductivity over contrast with the exact curve, errors of the methods, and of the paper's network's variants."""
    from matplotlib import pyplot

    network, others = parted(df)
    made = variant_errors(network, exact_of(df))
    third = others[(others["scene"] == "third") & others["periodic"].isna()]
    panels = 3 if made else 2
    figure, axes = pyplot.subplots(1, panels, figsize=(5.6 * panels, 5.6))
    _conductivity(axes[0], third, network, best_variant(made, WORDS))
    _errors(axes[1], third)
    if made:
        draw_variants(axes[2], made, WORDS, PAPER["worst_error"])
        axes[2].set(xlabel=ACROSS, ylabel="error, % of the exact value")
        axes[2].set_title("The paper's network: packings, walls and calibrations")
    return figure


def _conductivity(ax, third, network, first):
    """The exact curve, finely, and on it the default DEM, elements, voxels and the paper's network."""
    curve = np.geomspace(min(CONTRASTS), max(CONTRASTS), 65)
    ax.plot(curve, [methods.exact_ratio(methods.THIRD, c) for c in curve], color=BLACK, linewidth=0.8, label="exact")
    for name in ("dem", "fem", "fft"):
        mean = finest(third[third["name"] == name]).groupby("contrast")["k_ratio"].mean()
        ax.plot(
            mean.index, mean, **look(name, linestyle="", markerfacecolor="none", markersize=9 - 2 * (name == "fft"))
        )
    if first:
        rows = pick(network, particles=first[1])
        k = [interval(values(rows, first[0], f"k_{word}")).mean for word in WORDS]
        ax.plot(CONTRASTS, k, "x", color=PINK, label="DEM as in the paper, best variant")
    else:
        mean = finest(third[third["name"] == "dem-calibrated"]).groupby("contrast")["k_ratio"].mean()
        ax.plot(mean.index, mean, **look("dem-calibrated", linestyle="", marker="x"))
    ax.set(xscale="log", xlabel=ACROSS, ylabel="effective conductivity / matrix")
    ax.set_title("Fig. 14 of the paper with the exact curve")
    ax.legend(loc="upper left")


def _errors(ax, third):
    for method in methods.compared(*SHOWN):
        rows = finest(third[third["name"] == method.name])
        mean = rows.groupby("contrast")["error_percent"].mean().abs()
        mean = mean[mean.index.isin(CONTRASTS)]
        if len(mean):
            ax.plot(mean.index, mean, **look(method.name, label=_words(method.name, rows)))
    ax.axhline(
        PAPER["worst_error"], color=GREY, linewidth=1, linestyle=(0, (1, 1)), label="largest that the paper prints"
    )
    ax.set(xscale="log", yscale="log", xlabel=ACROSS, ylabel="|error|, % of the exact value")
    ax.set_title("Errors, finest rows of each method")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, fontsize=7)


def _words(name, rows):
    resolution = methods.resolution(rows.iloc[0])
    return LOOK[name][0] + (f", {resolution}" if resolution else "")
