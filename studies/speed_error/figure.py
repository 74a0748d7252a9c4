"""Error against CPU time in time, one panel for each scene."""

from __future__ import annotations

import numpy as np

from studies.harness.figures import BLACK, GREY, look
from studies.speed_error import means
from studies.speed_error.scenes import IN_TIME

# Below this nothing is found in time.
LEAST = 1e-3
TARGET = 0.1  # per cent


def draw(df):
    """Panels of scenes, each with who gets to a target at least cost."""
    from matplotlib import pyplot

    points, best = means.points(df), means.winners(df, (TARGET,)).set_index("scene")
    figure, grid = pyplot.subplots(1, len(IN_TIME), figsize=(11, 4.2), squeeze=False, sharex=True, sharey=True)
    for axes, name in zip(grid.flat, IN_TIME, strict=True):
        _panel(axes, points[points["scene"] == name], name, best.loc[name] if name in best.index else None)
        axes.set_xlabel("CPU time, s")
    grid[0, 0].set(xscale="log", yscale="log", ylim=(LEAST, 30), ylabel="error of the temperature, % of the span")
    _legend(figure, grid)
    return figure


def _panel(axes, rows, name, best):
    for method, group in rows.groupby("name", sort=False):
        group, dem = group.sort_values("unknowns"), method == "dem"
        style = look(method, markersize=5 if dem else 4, linewidth=2.6 if dem else 1.2, zorder=3 if dem else 2)
        axes.plot(group["cpu_s"], np.maximum(group["error"], LEAST), **style)
    axes.axhline(TARGET, color=BLACK, linewidth=0.8, linestyle="--", zorder=1)
    axes.set_title(f"{name}\n", fontsize=10, color=BLACK)
    said, colour = _verdict(best)
    note = axes.text(0, 1.02, said, transform=axes.transAxes, fontsize=9, color=colour, weight="bold")
    # A long one must not make its panel narrower.
    note.set_in_layout(False)


def _verdict(best):
    """Who gets to the target at least cost, in the colour of its line; grey where several do, or none."""
    if best is None:
        return f"{TARGET:g} %: none gets there", GREY
    if len(best["tied"]) > 1:
        return f"{TARGET:g} %: tie of {' and '.join(map(means.label, best['tied']))}", GREY
    (name,), following = best["tied"], best["next"]
    others = f"the next, {means.label(following)}, costs {best['margin']:.2g} times" if following else "no other"
    return f"{TARGET:g} %: {means.label(name)}; {others}", look(name)["color"]


def _legend(figure, grid):
    found = {}
    for axes in grid.flat:
        found |= {label: handle for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(found.values(), found.keys(), loc="outside lower center", ncols=4)
