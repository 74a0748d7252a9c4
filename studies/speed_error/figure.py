"""Error against CPU time, one panel for each scene."""

from __future__ import annotations

import math

import numpy as np

from studies.common.steady_scenes import STEADY_TITLES
from studies.harness.figures import BLACK, GREY, look
from studies.speed_error import means
from studies.speed_error.scenes import IN_TIME, STEADY, TUNED

COLUMNS = 4
# Of which the flux at points has a panel, too.
FLUXES = ("third", "83 spheres")
STAR = "*: constants of the DEM were found on this body, or on it at other contrasts"
# Below this errors are those of the linear solvers.
LEAST = 1e-5
TITLES = STEADY_TITLES | {
    "slab": "slab in time (temperature)",
    "ball": "ball in time (temperature)",
    "beam": "beam in time (temperature)",
}


def draw(df):
    """Panels of scenes, and of the flux at points of two of them, each with who gets to a target at least cost."""
    from matplotlib import pyplot

    panels = list(_panels(df))
    rows = math.ceil(len(panels) / COLUMNS)
    figure, grid = pyplot.subplots(rows, COLUMNS, figsize=(15, 1 + 3.2 * rows), squeeze=False, sharex=True, sharey=True)
    for axes, panel in zip(grid.flat, panels, strict=False):
        _panel(axes, *panel)
    for axes in grid.flat[len(panels) :]:
        axes.set_visible(False)
    grid[0, 0].set(xscale="log", yscale="log", ylim=(LEAST, 30))
    for axes in grid[:, 0]:
        axes.set_ylabel("|error|, %")
    # The lowest panel of each column.
    for axes in grid.flat[max(0, len(panels) - COLUMNS) : len(panels)]:
        axes.set_xlabel("CPU time, s")
        axes.tick_params(labelbottom=True)
    _legend(figure, grid)
    figure.suptitle(_headline(df))
    return figure


def _panels(df):
    """Points, title, target and winner of each panel."""
    for quantity, target, names in (("conductivity", 0.1, (*STEADY, *IN_TIME)), ("flux", 1.0, FLUXES)):
        points = means.points(df, quantity)
        best = means.winners(means.without_multipoles(df), quantity, (target,)).set_index("scene")
        for name in names:
            rows = points[points["scene"] == name]
            if len(rows):
                star = " *" if name in TUNED else ""
                title = f"{'' if quantity == 'conductivity' else 'flux at points: '}{TITLES[name]}{star}"
                yield rows, title, target, best.loc[name] if name in best.index else None


def _panel(axes, rows, title, target, best):
    for name, group in rows.groupby("name", sort=False):
        group, dem = group.sort_values("unknowns"), name == "dem"
        style = look(name, markersize=5 if dem else 4, linewidth=2.6 if dem else 1.2, zorder=3 if dem else 2)
        axes.plot(group["cpu_s"], np.maximum(group["error"], LEAST), **style)
    axes.axhline(target, color=BLACK, linewidth=0.8, linestyle="--", zorder=1)
    axes.set_title(f"{title}\n", fontsize=10, color=BLACK)
    said, colour = _verdict(target, best)
    note = axes.text(0, 1.02, said, transform=axes.transAxes, fontsize=9, color=colour, weight="bold")
    # A long one must not make its panel narrower.
    note.set_in_layout(False)


def _verdict(target, best):
    """Who gets to the target at least cost, in the colour of its line; grey where several do, or none."""
    if best is None:
        return f"{target:g} %: none gets there", GREY
    if len(best["tied"]) > 1:
        return f"{target:g} %: tie of {' and '.join(map(means.label, best['tied']))}", GREY
    (name,), following = best["tied"], best["next"]
    others = f"the next, {means.label(following)}, costs {best['margin']:.2g} times" if following else "no other"
    return f"{target:g} %: {means.label(name)}; {others}", look(name)["color"]


def _legend(figure, grid):
    found = {}
    for axes in grid.flat:
        found |= {label: handle for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(found.values(), found.keys(), loc="outside lower center", ncols=4)


def _headline(df):
    best = means.winners(means.without_multipoles(df), targets=(0.1,))
    counts = best.loc[best["tied"].map(len) == 1, "name"].map(means.label).value_counts()
    said = [f"{name} on {count}" for name, count in counts.items()]
    ties = (best["tied"].map(len) > 1).sum()
    said += [f"a tie on {ties}"] if ties else []
    scenes = df["scene"].nunique()
    what = f"Of {scenes} scenes the conductivity (in time: the temperature) within 0.1 %"
    return f"{what} costs least, of methods for any shape, by: {', '.join(said)}\n{STAR}"
