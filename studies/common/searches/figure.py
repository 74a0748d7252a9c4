"""Cost over error, a panel for each scene: each method at its best, the frontier broad, ties grey."""

import math

import numpy as np

from studies.common.searches import means
from studies.common.searches.scenes import HELD_BACK, TITLES, TUNED
from studies.common.searches.search import TARGETS
from studies.harness.figures import GREY, look

COLUMNS = 6
TICKS = (1.0, 0.1, 0.01)
FAMILIES = {"dem": "DEM", "fem": "FEM", "fft": "FFT", "multipole": "multipoles (spheres only)"}
# Broad line of the frontier, thin ones of methods.
BROAD, THIN = 7.0, 1.4
# Of a witness, larger and below, so that it hides no method of the same cost.
MARK = {"multipole": {"markersize": 7, "markerfacecolor": "white", "zorder": 2.5}}
# Where the truth is not known well enough to judge.
UNKNOWN = {"facecolor": "none", "edgecolor": "0.8", "hatch": "///", "linewidth": 0, "zorder": 0}


def plot(df, quantity="conductivity", *, told=TICKS):
    """Cost over error, a panel for each scene; some accuracies are told of in the headline."""
    from matplotlib import pyplot
    from matplotlib.ticker import NullFormatter

    scenes = means.scenes_of(df)
    rows = max(1, math.ceil(len(scenes) / COLUMNS))
    columns = min(COLUMNS, max(1, len(scenes)))
    figure, grid = pyplot.subplots(
        rows, columns, figsize=(2.9 * columns, 1.2 + 2.5 * rows), squeeze=False, sharex=True, sharey=True
    )
    known = {target: means.judged(df, quantity, target) for target in TARGETS}
    for axes, scene in zip(grid.flat, scenes, strict=False):
        _panel(axes, df, scene, quantity, known)
    for axes in grid.flat[len(scenes) :]:
        axes.set_visible(False)
    grid[0, 0].set(xscale="log", yscale="log", xlim=(5.0, 0.002), ylim=(3e-3, 200.0))
    grid[0, 0].set_xticks(TICKS, [f"{tick:g}".removeprefix("0") for tick in TICKS])
    grid[0, 0].xaxis.set_minor_formatter(NullFormatter())
    for axes in grid[:, 0]:
        axes.set_ylabel("CPU time, s")
    for axes in grid.flat[max(0, len(scenes) - columns) : len(scenes)]:
        axes.set_xlabel(f"error of the {quantity}, %")
        axes.tick_params(labelbottom=True)
    _legend(figure, grid)
    figure.suptitle(
        _headline(df, quantity, told) if means.searched(df) else "No search has been run on a quiet machine yet"
    )
    return figure


def _legend(figure, grid):
    found = {}
    for axes in grid.flat:
        found |= {label: handle for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(found.values(), found.keys(), loc="outside lower center", ncols=6)


def _panel(axes, df, scene, quantity, known):
    every = {target: means.reached(df, scene, quantity, target, any_shape=False) for target in TARGETS}
    for name, label in FAMILIES.items():
        cheapest = {
            target: min((e.cpu_s for e in ways if e.family == name), default=np.nan) for target, ways in every.items()
        }
        mark = MARK.get(name, {"markersize": 3.5, "zorder": 3})
        style = look(name, label=label, linewidth=THIN, linestyle="-", **mark)
        axes.plot(list(cheapest), list(cheapest.values()), **style)
    for target in TARGETS:
        best = means.best(df, scene, quantity, target)
        if scene not in known[target]:
            axes.axvspan(*_about(target), **UNKNOWN, label="truth not known")
        if best is None:
            continue
        tie = len(best.tied) > 1
        colour = GREY if tie else look(best.first.family)["color"]
        axes.plot(
            [target / 1.6, target * 1.6], [best.first.cpu_s] * 2, color=colour, linewidth=BROAD, alpha=0.45, zorder=2
        )
        if tie:
            axes.axvspan(*_about(target), color=GREY, alpha=0.18, linewidth=0, label="tie", zorder=0)
    if not any(every.values()):
        axes.text(
            0.5, 0.5, "no method within\nthe seconds of a search", transform=axes.transAxes, ha="center", fontsize=7
        )
    mark = " *" if scene in TUNED else " (held back)" if scene in HELD_BACK else ""
    axes.set_title(f"{TITLES[scene]}{mark}", fontsize=9)


def _about(target):
    return target / 1.7, target * 1.7


def _headline(df, quantity, targets):
    parts = []
    for target in targets:
        every = {scene: means.best(df, scene, quantity, target) for scene in means.judged(df, quantity, target)}
        won = [best.first.family for best in every.values() if best is not None and len(best.tied) == 1]
        said = [f"{FAMILIES[name]} {won.count(name)}" for name in ("dem", "fem", "fft")]
        parts.append(f"{target:g} % on {len(every)} scenes: {', '.join(said)}")
    lines = "  -  " if len(parts) <= len(TICKS) else "\n"
    return (
        f"Cheapest method for any shape, without a tie{lines}{'  -  '.join(parts)}\n"
        "Lower is cheaper, farther right more exact.  *: constants of the DEM were found on this body, or on it at "
        f"other contrasts\nA line ends, or is missing, where its search of {_seconds(df)} ended: the method may go on"
    )


def _seconds(df):
    """CPU seconds of searches, most and all, in words."""
    found = means.longest(df)["seconds"]
    usual, low, high = found.mode().iloc[0], found.min(), found.max()
    return f"{usual:g} CPU seconds" + (f" ({low:g} to {high:g} on some scenes)" if low < high else "")
