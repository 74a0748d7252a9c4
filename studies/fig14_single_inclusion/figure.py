"""Figure of the single inclusion: errors over the contrast, where the sphere fills half of the cube, and by cost."""

import numpy as np

from studies.common.paper_variants import best_variant, parted, variant_errors
from studies.fig14_single_inclusion.means import PAPER, exact_of
from studies.fig14_single_inclusion.scenes import CONTRASTS, WORDS
from studies.harness import methods
from studies.harness.figures import BLACK, GREY, PINK, look
from studies.harness.pick import finest, mean_errors, pick, with_size

# What stands beside the methods that every study compares; those of which there are rows at contrast 10 alone.
BESIDE, AT_TEN = ("dem-plain", "dem-calibrated", "maxwell"), ("fem-straight", "fem-p1", "fft-plain", "fft-em-plain")
TEN = 10.0
BEST = {"color": PINK, "marker": "*", "markersize": 11, "markeredgecolor": BLACK, "markeredgewidth": 0.7}
NETWORK = "network"
LABELS = {NETWORK: "DEM as in the paper, best"}
ERROR = "|error| of the conductivity, %"


def plot(df):
    """Errors of the methods and of the paper's network over the contrast, at f = .5, and against what they cost."""
    from matplotlib import pyplot

    network, others = parted(df)
    others = others[others["periodic"].isna() & others["contrast"].isin(CONTRASTS)]
    made = variant_errors(network, exact_of(df))
    figure, (left, middle, right) = pyplot.subplots(1, 3, figsize=(16, 6.2), width_ratios=(1.1, 1, 1.1))
    _by_contrast(left, pick(others, scene="third"), made)
    _half(middle, others, made)
    _by_cost(right, pick(others, scene="third", contrast=TEN))
    found = {}
    for axes in (left, right):
        found |= dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    figure.legend(found.values(), found, loc="outside lower center", ncols=4, fontsize=9)
    return figure


def _by_contrast(axes, third, made):
    """Finest rows of each method; of the paper's network all variants as a band and the best of them."""
    for method in methods.compared(*BESIDE):
        mean = mean_errors(finest(pick(third, name=method.name))).abs()
        if len(mean):
            axes.plot(mean.index, mean, **look(method.name))
    first = best_variant(made, WORDS)
    if first:
        every = np.array([[abs(each[word].mean) for word in WORDS] for key, each in made.items() if key[1] == first[1]])
        label = f"the paper's network, {first[1]} particles: all variants"
        axes.fill_between(CONTRASTS, every.min(0), every.max(0), color=PINK, alpha=0.25, linewidth=0, label=label)
        best = [abs(made[first][word].mean) for word in WORDS]
        axes.plot(CONTRASTS, best, linestyle=":", label="the paper's network: its best variant", **BEST)
    axes.axhline(PAPER["worst_error"], color=GREY, linewidth=1, linestyle=(0, (1, 1)), label="largest the paper prints")
    axes.set(xscale="log", yscale="log", xlabel="conductivity of the sphere / matrix", ylabel=ERROR)
    axes.set_title("Sphere of radius L/3, finest rows of each method")


def _half(axes, others, made):
    """Methods down: the sphere of a third open, the one that fills half of the cube full, both at contrast 10."""
    lines = {name: _pair(others, name) for name in (each.name for each in methods.compared(*BESIDE))}
    styles = {name: look(name, linestyle="", label="_") for name in lines}
    first = best_variant(made, WORDS)
    if first:
        found = [made[first].get(word) for word in (f"{TEN:g}", "half")]
        lines[NETWORK] = [abs(each.mean) if each else np.nan for each in found]
        styles[NETWORK] = BEST | {"linestyle": ""}
    lines = {name: pair for name, pair in lines.items() if np.isfinite(pair[1])}
    order = sorted(lines, key=lambda name: -lines[name][1])
    for place, name in enumerate(order):
        axes.plot(lines[name], [place] * 2, color=styles[name]["color"], linewidth=1, alpha=0.6)
        mark = styles[name] if styles[name]["marker"] else styles[name] | {"marker": "_", "markersize": 12}
        axes.plot(lines[name][0], place, **mark | {"markerfacecolor": "white"})
        axes.plot(lines[name][1], place, **mark)
    axes.set_yticks(range(len(order)), [LABELS.get(name) or methods.all_methods()[name].title for name in order])
    axes.set(xscale="log", xlabel=ERROR)
    axes.set_title("Contrast 10: radius L/3 (open), half of the cube (full)")


def _pair(others, name):
    """|Error| on both scenes at contrast 10, not-a-number without rows."""
    found = [mean_errors(finest(pick(others, name=name, scene=scene))).abs() for scene in ("third", "half")]
    return [float(each.get(TEN, np.nan)) for each in found]


def _by_cost(axes, rows):
    """From coarse to fine what each method costs and how far it is off; a packing comes from the cache."""
    from matplotlib.ticker import LogLocator

    for method in methods.compared(*BESIDE, *AT_TEN):
        # A formula, which nothing refines, has no size, and costs nothing.
        mean = with_size(pick(rows, name=method.name)).groupby("h")[["cpu_s", "error_percent"]].mean()
        if len(mean):
            axes.plot(mean["cpu_s"], mean["error_percent"].abs(), **look(method.name))
    axes.set(xscale="log", yscale="log", xlabel="CPU time, s", ylabel=ERROR)
    axes.xaxis.set_minor_locator(LogLocator(subs=(2, 5)))
    for formatter in (axes.xaxis.set_major_formatter, axes.xaxis.set_minor_formatter):
        formatter("{x:g}")
    axes.set_title("Radius L/3, contrast 10: from coarse to fine")
