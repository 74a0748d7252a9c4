"""What the calibration's rows are, and how they are shown: unchanged or with a change, a table and a figure."""

from __future__ import annotations

from studies.harness.figures import BLACK, BLUE, GREEN, GREY, ORANGE, PINK
from studies.harness.pick import pick
from studies.harness.store import printed

# What else the level depends on, one change at a time; on the paper's load and in the periodic cell.
VARIANTS = {
    "as in the paper": {},
    "harmonic mean radius": {"mean": "harmonic"},
    "geometric mean radius": {"mean": "geometric"},
    "one gap for all pairs": {"additive": True},
    "one gap, harmonic": {"additive": True, "mean": "harmonic"},
    "7 links": {"wanted": 7.0},
    "6.5 links": {"wanted": 6.5},
    "spread 0.15": {"spread": 0.15},
    "equal spheres": {"spread": 0.0},
}
VARIED = 100_000
PAPER = printed("fig03_calibration")
PRINTED = {100_000: PAPER["ct_1e5"], 1_000_000: PAPER["ct_1e6"]}
# What a case may change.
KNOBS = ("mean", "additive", "wanted", "spread", "margin", "wall", "poor", "count", "tiles")
LINES = {
    ("flux", "cube"): ("flux on top, as in the paper, cube", PINK, "s"),
    ("flux", "cylinder"): ("the same, cylinder", ORANGE, "v"),
    ("isothermal", "cube"): ("two isothermal ends, cube", GREY, "D"),
    ("across", "cube"): ("periodic across, temperatures at the wall", BLUE, "^"),
    ("periodic", "cube"): ("periodic cell", GREEN, "o"),
}


def unchanged(df):
    """Rows without a change, default in everything."""
    return df.reindex(columns=list(KNOBS)).isna().all(axis=1)


def variant(df, loading, change, column="ct"):
    """Value of the one row with exactly this change; None without it."""
    rows = pick(df, loading=loading, domain="cube", packing="lsa", particles=VARIED, seed=0)
    rows = pick(rows, **{name: change.get(name) for name in KNOBS})
    return float(rows[column].iloc[0]) if len(rows) == 1 else None


def table(df):
    """C_t by number of particles, mean over packings; scatter is the coefficient of variation at 1e5, %.

    Bound and formula are at the largest number of particles: 1 over the conductivity under a linear field, below which
    C_t cannot lie in the periodic cell, and 4 <R^3>/(Z phi <R_m^3>), <R^3> over particles and <R_m^3> over links.
    """
    import pandas as pd

    rows = []
    changes = [name for name in KNOBS if name in df]
    numbers = sorted(df["particles"].unique())
    for (loading, domain, packing, *change), group in df.groupby(
        ["loading", "domain", "packing", *changes], dropna=False, sort=False
    ):
        row = {"load": loading, "domain": domain, "packing": packing}
        row["change"] = ", ".join(f"{n} {v}" for n, v in zip(changes, change, strict=True) if v == v)
        mean = group.groupby("particles")["ct"].mean()
        row |= {f"{n:.0e}".replace("e+0", "e"): f"{mean[n]:.4f}" if n in mean else "" for n in numbers}
        here = group[group["particles"] == VARIED]["ct"]
        row["scatter"] = float(100 * here.std() / here.mean()) if len(here) > 1 else float("nan")
        largest = group[group["particles"] == group["particles"].max()]
        names = {"bound": "bound", "formula": "formula", "gap": "gap", "under_2": "under 2 links"}
        rows.append(row | {new: float(largest[old].mean()) for old, new in names.items()})
    return pd.DataFrame(rows)


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
    tiled = pick(df, packing="tiled")
    left.plot(tiled["particles"], tiled["ct"], "*", color=GREEN, markersize=11, label="periodic cell of 8 tiles")
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
