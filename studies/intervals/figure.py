"""What methods say of their errors against their errors, a point for each scene."""

from studies.harness.figures import GREY, MISS, look
from studies.intervals.means import answers, clear, half, held, off, title

# What is beyond is shown at the edge, as an arrow, %.
LEAST, MOST = 1e-6, 1e3
BEYOND = {"linestyle": "", "marker": r"$\uparrow$", "markersize": 9}
# Panels beside each other.
COLUMNS = 4


def plot(df):
    """What each method says of its error against its error: above the line the interval holds."""
    from matplotlib import pyplot

    shown = clear(answers(df))
    groups = list(shown.groupby("method", sort=False))
    lines = -(-len(groups) // COLUMNS)
    columns = -(-len(groups) // lines)
    size = (3.4 * columns, 1.0 + 3.7 * lines)
    figure, panels = pyplot.subplots(lines, columns, figsize=size, sharex=True, sharey=True, squeeze=False)
    for axes, (name, rows) in zip(panels.flat, groups, strict=False):
        _panel(axes, name, rows)
    for axes in panels.flat[len(groups) :]:
        axes.set_visible(False)
    for axes in panels[:, 0]:
        axes.set_ylabel("half of the interval, %")
    figure.suptitle(_headline(df, shown), fontsize=11)
    return figure


def _panel(axes, name, rows):
    right, error, said = held(rows), 100 * off(rows).abs(), 100 * half(rows)
    x, y, far = error.clip(LEAST, MOST), said.clip(LEAST, MOST), said > MOST
    style = look(name.removesuffix("-limit"), linestyle="", markersize=3.5)
    axes.plot(x[~far], y[~far], **{**style, "label": f"{right.sum()} hold"})
    if far.any():
        # The error itself may be beyond, too: it is the same edge.
        axes.plot(x[far], y[far], color=style["color"], label=f"{far.sum()} of them beyond {MOST:g} %", **BEYOND)
    if not right.all():
        axes.plot(x[~right], y[~right], label=f"{(~right).sum()} {'misses' if sum(~right) == 1 else 'miss'}", **MISS)
    axes.plot([LEAST, MOST], [LEAST, MOST], color=GREY, linewidth=1)
    axes.set(xscale="log", yscale="log", xlabel="error, %")
    axes.set_title(title(name), fontsize=10)
    axes.legend(loc="lower right", fontsize=8, handletextpad=0.2)


def _headline(df, shown):
    """How many intervals on how many scenes are drawn, and why some hold below the line."""
    asked = df[df["method"] != "truth"]
    told = [_counted(*(rows[_limits(rows) == each] for rows in (shown, asked))) for each in (False, True)]
    below = int((held(shown) & (half(shown) < off(shown).abs())).sum())
    return (
        f"Where the error is known well: {'; extrapolated, '.join(filter(None, told))}\n"
        "On the line half of the interval is the error. Intervals may be lopsided: one that reaches farther to one "
        f"side can hold below ({below} do)"
    )


def _limits(rows):
    return rows["method"].str.endswith("-limit")


def _counted(shown, asked):
    return f"{len(shown)} intervals on {_scenes(shown)} of {_scenes(asked)} drawn scenes" if len(shown) else ""


def _scenes(rows):
    return len(rows[["scene", "seed"]].drop_duplicates())
