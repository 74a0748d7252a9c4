"""Figure of the calibration: C_t by load and number of particles, and at one number by what else is changed."""

from studies.fig03_calibration.variants import PAPER, PRINTED, VARIANTS, VARIED, unchanged, variant
from studies.harness.figures import BLACK, BLUE, GREEN, GREY, ORANGE, PINK
from studies.harness.pick import pick

LINES = {
    ("flux", "cube"): ("flux on top, as in the paper, cube", PINK, "s"),
    ("flux", "cylinder"): ("the same, cylinder", ORANGE, "v"),
    ("isothermal", "cube"): ("two isothermal ends, cube", GREY, "D"),
    ("across", "cube"): ("periodic across, temperatures at the wall", BLUE, "^"),
    ("periodic", "cube"): ("periodic cell", GREEN, "o"),
}


def plot(df):
    """C_t over the number of particles by load, and at 1e5 by what else is changed."""
    from matplotlib import pyplot

    found = {loading: _levels(df, loading) for loading in ("flux", "periodic")}
    # A quick run has no rows for the second panel.
    panels = 2 if any(found.values()) else 1
    figure, axes = pyplot.subplots(1, panels, figsize=(12, 5.2), width_ratios=(1.5, 1)[:panels], squeeze=False)
    left = axes[0, 0]
    plain = df[unchanged(df)]
    for (loading, domain), (label, colour, marker) in LINES.items():
        for packing, fill, dashes in (("lsa", colour, "-"), ("relaxed", "white", "--")):
            rows = pick(plain, loading=loading, domain=domain, packing=packing)
            mean = rows.groupby("particles")["ct"].mean()
            style = {"color": colour, "marker": marker, "markerfacecolor": fill, "linestyle": dashes}
            if len(mean):
                left.plot(mean.index, mean, label=label, **style)
                label = None
    replicated = pick(df, packing="replicated")
    left.plot(
        replicated["particles"], replicated["ct"], "*", color=GREEN, markersize=11, label="periodic cell of 8 replicas"
    )
    left.axhspan(PAPER["ct_least"], PAPER["ct_most"], color=GREY, alpha=0.15, label="range that the paper prints")
    left.plot(list(PRINTED), list(PRINTED.values()), "x", color=BLACK, markersize=9, label="paper")
    left.set(xscale="log", xlabel="particles", ylabel="C_t")
    left.set_title("With the paper's walls C_t drifts; without walls,\nor with links at the wall, it does not")
    note = "full: hard spheres (LSA), open: relaxed"
    left.annotate(note, (0.99, 0.02), xycoords="axes fraction", fontsize=8, color=GREY, ha="right")
    if panels == 2:
        _draw_levels(axes[0, 1], found)
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def _levels(df, loading):
    """C_t of each variant that has a row, as (C_t, position from below)."""
    values = [variant(df, loading, change) for change in VARIANTS.values()]
    return [(value, len(values) - k) for k, value in enumerate(values) if value is not None]


def _draw_levels(axes, found):
    for loading, points in found.items():
        _, colour, marker = LINES[loading, "cube"]
        if points:
            axes.plot(*zip(*points, strict=True), linestyle="", marker=marker, color=colour)
    axes.axvspan(PAPER["ct_least"], PAPER["ct_most"], color=GREY, alpha=0.15)
    axes.axvline(PRINTED[VARIED], color=BLACK, linewidth=1)
    positions = range(len(VARIANTS), 0, -1)
    axes.set(yticks=positions, yticklabels=VARIANTS, ylim=(0.4, len(VARIANTS) + 0.6), xlabel="C_t, 1e5 particles (LSA)")
    axes.set_title("Fewer links or a narrower spread of radii\nreach the paper's 0.806 (line)")
