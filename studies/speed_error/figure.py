"""Error against CPU time, one panel for each scene."""

from __future__ import annotations

import math

import numpy as np

from studies.harness.figures import BLACK, GREY, look
from studies.speed_error import means
from studies.speed_error.scenes import IN_TIME, STEADY

COLUMNS = 4
# Below this errors are those of the linear solvers.
LEAST = 1e-5
TITLES = {
    "third": "sphere, f = .155, contrast 10",
    "third at 0.01": "the same, contrast .01",
    "third at 1000": "the same, contrast 1000",
    "third at infinity": "the same, contrast 1e6",
    "half": "sphere, f = .5, contrast 10",
    "half at 100": "the same, contrast 100",
    "thin shell": "sphere in a thin shell",
    "polydisperse": "24 spheres, radii 1 to 3",
    "83 spheres": "83 spheres, f = .2",
    "1000 spheres": "1000 spheres, f = .2",
    "laminate": "laminate off the grid",
    "slab": "slab in time (temperature)",
    "ball": "ball in time (temperature)",
    "beam": "beam in time (temperature)",
}


def draw(df):
    """Panels of scenes, and of the flux at points of the first one and of the sphere that fills half."""
    from matplotlib import pyplot

    scenes = [name for name in (*STEADY, *IN_TIME) if name in set(df["scene"])]
    every, flux = means.points(df), means.points(df, "flux")
    fluxes = [name for name in ("third", "83 spheres") if name in set(flux["scene"])]
    number = len(scenes) + len(fluxes)
    rows = math.ceil(number / COLUMNS)
    figure, grid = pyplot.subplots(rows, COLUMNS, figsize=(15, 1 + 3 * rows), squeeze=False, sharex=True, sharey=True)
    for axes, scene in zip(grid.flat, scenes, strict=False):
        _panel(axes, every[every["scene"] == scene], TITLES[scene])
    for axes, scene in zip(grid.flat[len(scenes) :], fluxes, strict=False):
        _panel(axes, flux[flux["scene"] == scene], f"flux at points: {TITLES[scene]}")
    for axes in grid.flat[number:]:
        axes.set_visible(False)
    grid[0, 0].set(xscale="log", yscale="log", ylim=(LEAST, 30))
    for axes in grid[:, 0]:
        axes.set_ylabel("|error|, %")
    # The lowest panel of each column.
    for axes in grid.flat[max(0, number - COLUMNS) : number]:
        axes.set_xlabel("CPU time, s")
        axes.tick_params(labelbottom=True)
    _legend(figure, grid)
    figure.suptitle(_headline(df))
    return figure


def _panel(axes, rows, title):
    for name, group in rows.groupby("name", sort=False):
        group = group.sort_values("unknowns")
        error = np.maximum(group["error"], LEAST)
        axes.plot(group["cpu_s"], error, **look(name, markersize=4))
        if name == "dem":
            cached = look(name, label="the same, packing at hand", markerfacecolor="white", linestyle=":", markersize=4)
            axes.plot(group["cached_cpu_s"], error, **cached)
    for target in means.TARGETS:
        axes.axhline(target, color=GREY, linewidth=0.5, linestyle="--", zorder=0)
    axes.set_title(title, fontsize=10, color=BLACK)


def _legend(figure, grid):
    found = {}
    for axes in grid.flat:
        found |= {label: handle for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(found.values(), found.keys(), loc="outside lower center", ncols=4)


def _headline(df):
    best = means.winners(means.without_multipoles(df), targets=(0.1,))
    counts = best["name"].map(means.label).value_counts()
    said = ", ".join(f"{name} on {count}" for name, count in counts.items())
    return f"0.1 % costs least, of methods for any shape, by: {said}"
