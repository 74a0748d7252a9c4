"""What methods say of their errors against their errors."""

import numpy as np

from studies.estimates.means import answered, inside, present
from studies.harness.figures import GREY, MISS, look
from studies.harness.methods import all_methods

# Errors below are shown there, %.
LEAST = 1e-5
# Panels beside each other.
COLUMNS = 4


def draw(df, main, beside):
    """A panel for each method: above the line the interval holds."""
    from matplotlib import pyplot

    names = [name for name in (*main, *beside) if present(df, name)]
    columns = min(COLUMNS, len(names))
    rows = -(-len(names) // columns)
    size = (3.6 * columns, 0.9 + 3.4 * rows)
    figure, panels = pyplot.subplots(rows, columns, figsize=size, sharex=True, sharey=True, squeeze=False)
    for axes, name in zip(panels.flat, names, strict=False):
        _panel(axes, df, name)
    for axes in panels.flat[len(names) :]:
        axes.set_visible(False)
    for axes in panels[:, 0]:
        axes.set_ylabel("half of the interval, %")
    for axes in panels.flat[max(0, len(names) - columns) : len(names)]:
        axes.set_xlabel("error of the conductivity, %")
        axes.tick_params(labelbottom=True)
    groups = [[name for name in names if name in some] for some in (main, beside)]
    told = "; ".join(_least(df, group) for group in groups if group)
    figure.suptitle(f"Intervals that hold the exact conductivity of unseen scenes\n{told}", fontsize=12)
    return figure


def _least(df, names):
    """The least share of intervals that hold among some methods, and whose it is, in words."""
    shares = {name: inside(df, name).mean() for name in names}
    titles, least = [all_methods()[name].title for name in names], min(shares, key=shares.get)
    scenes = max(len(inside(df, name)) for name in names)
    who = " and ".join(filter(None, (", ".join(titles[:-1]), titles[-1])))
    who = who if len(titles) < COLUMNS else f"{len(titles)} others"
    if shares[least] == 1:
        return f"{who}: all, on up to {scenes} scenes"
    return f"{who}, up to {scenes} scenes each: {100 * shares[least]:.1f} % at the least ({all_methods()[least].title})"


def _panel(axes, df, name):
    rows, held = answered(df, name), inside(df, name)
    off, half = rows[f"{name}_off"].abs().clip(lower=LEAST), rows[f"{name}_half"].clip(lower=LEAST)
    style = look(name, linestyle="", markersize=4)
    axes.plot(off, half, **{**style, "label": "holds"})
    if not held.all():
        axes.plot(off[~held], half[~held], label="misses", **MISS)
    ends = np.array([LEAST, max(off.max(), half.max(), 1.0) * 2])
    axes.plot(ends, ends, color=GREY, linewidth=1)
    axes.plot(ends, 5 * ends, color=GREY, linewidth=0.8, linestyle=":")
    # Beside the lines where few points are.
    low = 20 * LEAST
    axes.annotate("interval = error", (1.3 * low, low), fontsize=8, color=GREY, va="top")
    axes.annotate("5 times", (low / 1.3, 5 * low), fontsize=8, color=GREY, ha="right", va="bottom")
    axes.set(xscale="log", yscale="log")
    axes.set_title(f"{all_methods()[name].title}: {int(held.sum())} of {len(held)} hold", fontsize=9.5)
    axes.legend(loc="lower right")
