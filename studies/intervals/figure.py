"""What methods say of their errors against their errors, a point for each scene."""

import numpy as np

from studies.harness.figures import BLACK, GREY, look
from studies.intervals.means import answers, clear, half, held, off, title

# What is beyond is shown at the edge, %.
LEAST, MOST = 1e-6, 1e3
# Panels beside each other.
COLUMNS = 5


def plot(df):
    """What each method says of its error against its error: above the line the interval holds."""
    from matplotlib import pyplot

    groups = list(clear(answers(df)).groupby("method", sort=False))
    lines = -(-len(groups) // COLUMNS)
    columns = -(-len(groups) // lines)
    size = (3.2 * columns, 3.8 * lines)
    figure, panels = pyplot.subplots(lines, columns, figsize=size, sharex=True, sharey=True, squeeze=False)
    for axes, (name, rows) in zip(panels.flat, groups, strict=False):
        right, x, y = held(rows), *(np.clip(100 * each(rows).abs(), LEAST, MOST) for each in (off, half))
        style = look(name.removesuffix("-limit"), linestyle="", markersize=3)
        axes.plot(x[right], y[right], **{**style, "label": "holds"})
        axes.plot(x[~right], y[~right], linestyle="", marker="x", color=BLACK, label="misses")
        axes.plot([LEAST, MOST], [LEAST, MOST], color=GREY, linewidth=1)
        axes.set(xscale="log", yscale="log", xlabel="error, %")
        axes.set_title(title(name), fontsize=10)
        axes.legend(loc="lower right", fontsize=8)
    for axes in panels.flat[len(groups) :]:
        axes.set_visible(False)
    for axes in panels[:, 0]:
        axes.set_ylabel("half of the interval, %")
    figure.suptitle(f"{len(df[['scene', 'seed']].drop_duplicates())} drawn scenes: where the error is known well")
    return figure
