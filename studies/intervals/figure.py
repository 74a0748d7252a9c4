"""What methods say of their errors against their errors, a point for each scene."""

from __future__ import annotations

import numpy as np

from studies.harness.figures import BLACK, GREY, look
from studies.intervals.means import answers, clear, half, held, off, title

# What is beyond is shown at the edge, %.
LEAST, MOST = 1e-6, 1e3


def draw(df):
    """A panel for each method: above the line the interval holds."""
    from matplotlib import pyplot

    groups = list(clear(answers(df)).groupby("method", sort=False))
    figure, panels = pyplot.subplots(1, len(groups), figsize=(3.2 * len(groups), 3.8), sharex=True, sharey=True)
    for axes, (name, rows) in zip(np.atleast_1d(panels), groups, strict=True):
        right, x, y = held(rows), *(np.clip(100 * each(rows).abs(), LEAST, MOST) for each in (off, half))
        style = look(name, linestyle="", markersize=3)
        axes.plot(x[right], y[right], **{**style, "label": "holds"})
        axes.plot(x[~right], y[~right], linestyle="", marker="x", color=BLACK, label="misses")
        axes.plot([LEAST, MOST], [LEAST, MOST], color=GREY, linewidth=1)
        axes.set(xscale="log", yscale="log", xlabel="error, %", title=title(name))
        axes.legend(loc="lower right", fontsize=8)
    np.atleast_1d(panels)[0].set_ylabel("half of the interval, %")
    figure.suptitle(f"{len(df[['scene', 'seed']].drop_duplicates())} drawn scenes: where the error is known well")
    return figure
