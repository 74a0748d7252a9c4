"""The figure: errors against costs, a point for each scene, a line through medians; and scenes within an error."""

import numpy as np

from studies.harness.figures import BLACK, BLUE, GREY, LOOK, ORANGE, PINK, SKY, look
from studies.sphere_benchmark.means import finest, stepped, title_of

# Below this errors are those of solvers, %.
LEAST = 1e-6
# Of guests, one after the other.
COLOURS = (ORANGE, SKY, PINK, BLUE, BLACK)


def draw(df):
    """Two panels."""
    from matplotlib import pyplot

    real = df[~df["scene"].str.startswith("relation")]
    good = stepped(real[real["status"] == "ok"])
    good = good.assign(off=np.maximum(good["error_percent"].abs(), LEAST))
    strangers = [name for name in good["name"].unique() if name not in LOOK]
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(13, 5))
    for name, rows in good.groupby("name", sort=False):
        style = _style(name, strangers)
        plain = {"color": style["color"], "marker": style["marker"] or "x", "linestyle": ""}
        left.plot(rows["cpu_s"], rows["off"], **plain, markersize=4, alpha=0.35, markeredgewidth=0)
        # Of scenes that have every resolution, so that a line does not go from some scenes to others.
        every = rows[rows.groupby("scene")["place"].transform("nunique") == rows["place"].nunique()]
        middle = every.groupby("place")[["cpu_s", "off"]].median()
        left.plot(middle["cpu_s"], middle["off"], **style | {"marker": style["marker"] or "x"}, markersize=9)
        best = np.sort(np.maximum(finest(rows)["error_percent"].abs(), LEAST))
        right.step([*best, 1e3], [*np.arange(1, len(best) + 1), len(best)], where="post", **style | {"marker": ""})
    left.set(xscale="log", yscale="log", xlabel="CPU time, s", ylabel="|error|, %", xlim=(1e-4, None))
    left.set_title("each scene, and medians of those at every resolution")
    right.set(xscale="log", xlim=(LEAST, 100), xlabel="|error|, %, at the finest resolution")
    right.set_ylabel("scenes with at most this error")
    right.axhline(real["scene"].nunique(), color=GREY, linewidth=0.6, linestyle="--")
    right.set_title(f"of {real['scene'].nunique()} scenes")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def _style(name, strangers):
    if name in LOOK:
        return look(name, label=title_of(name))
    colour = COLOURS[strangers.index(name) % len(COLOURS)]
    return {"label": title_of(name), "color": colour, "marker": "X", "linestyle": "--"}
