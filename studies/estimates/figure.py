"""What methods say of their errors against their errors."""

import numpy as np

from studies.estimates.means import answered, inside, present
from studies.harness.figures import BLACK, GREY, look
from studies.harness.methods import all_methods

# Errors below are shown there, %.
LEAST = 1e-5


def draw(df, names):
    """A panel for each method: above the line the interval holds."""
    from matplotlib import pyplot

    names = [name for name in names if present(df, name)]
    figure, panels = pyplot.subplots(1, len(names), figsize=(4 * len(names), 4.6), sharex=True, sharey=True)
    for axes, name in zip(np.atleast_1d(panels), names, strict=True):
        _panel(axes, df, name)
    np.atleast_1d(panels)[0].set_ylabel("half of the interval that it gives, %")
    held = min(inside(df, name).mean() for name in names)
    share = "all" if held == 1 else f"at least {np.floor(1000 * held) / 10:g} % of the"
    figure.suptitle(f"On up to {len(df)} unseen scenes the exact conductivity lies inside of {share} intervals")
    return figure


def _panel(axes, df, name):
    rows, held = answered(df, name), inside(df, name)
    off, half = rows[f"{name}_off"].abs().clip(lower=LEAST), rows[f"{name}_half"].clip(lower=LEAST)
    style = look(name, linestyle="", markersize=4)
    axes.plot(off[held], half[held], **{**style, "label": "holds"})
    axes.plot(off[~held], half[~held], linestyle="", marker="x", color=BLACK, label="misses")
    ends = np.array([LEAST, max(off.max(), half.max(), 1.0) * 2])
    axes.plot(ends, ends, color=GREY, linewidth=1)
    axes.plot(ends, 5 * ends, color=GREY, linewidth=0.8, linestyle=":")
    # Beside the lines where few points are.
    low = 20 * LEAST
    axes.annotate("interval = error", (1.3 * low, low), fontsize=8, color=GREY, va="top")
    axes.annotate("5 times", (low / 1.3, 5 * low), fontsize=8, color=GREY, ha="right", va="bottom")
    axes.set(xscale="log", yscale="log", xlabel="error of the conductivity, %")
    axes.set_title(f"{all_methods()[name].title}: {int(held.sum())} of {len(held)} hold")
    axes.legend(loc="lower right")
