"""Figure of the study `fig10_halo`, and its rows by halo radius."""

from studies.harness.cells import numbers
from studies.harness.pick import pick
from studies.harness.store import printed

# Halo radii in mean radii; 0 is no halo.
RATIOS = (0.0, 1.5, 2.0, 3.0, 4.0, 5.5, 7.0, 9.0, 11.0, 13.0, 15.0)
# Numbers of particles, and their packings.
SEEDS = {3_000: (0,), 10_000: (0, 1, 2), 100_000: (0,), 500_000: (0,)}
STATISTICS = ("number", "cov", "cov_volume", "least", "mean", "most")
# Halo radii whose density functions are kept, and their range in units of the flux, in equal bins.
DENSITIES = {0.0: (0.0, 3.0), 2.0: (0.0, 3.0), 4.0: (0.6, 1.4), 11.0: (0.8, 1.2)}
BINS = 80
PAPER = printed("fig10_halo")


def long(df):
    """One row per halo radius."""
    import pandas as pd

    rows = []
    for row in df[df["status"] == "ok"].to_dict("records"):
        lists = [numbers(row[f"{part}{name}"]) for part in ("", "bulk_") for name in STATISTICS]
        names = [f"{part}{name}" for part in ("", "bulk_") for name in STATISTICS]
        case = {name: row[name] for name in ("law", "split", "walls", "particles", "seed")}
        rows += [case | {"ratio": r} | dict(zip(names, v, strict=True)) for r, *v in zip(RATIOS, *lists, strict=True)]
    return pd.DataFrame(rows)


def plot(df):
    """CoV, and smallest and largest flux, against the halo's radius; density functions; CoV against N."""
    from matplotlib import pyplot

    figure, ((cov, extremes), (raw, halos)) = pyplot.subplots(2, 2, figsize=(12, 9))
    rows = long(df)
    _cov(cov, rows)
    _extremes(extremes, rows)
    _densities(raw, halos, df)
    return figure


def _looks():
    from studies.harness.figures import BLUE, GREEN, ORANGE, RED

    return dict(zip(SEEDS, (ORANGE, GREEN, BLUE, RED), strict=True))


def _cov(axes, rows):
    from studies.harness.figures import BLACK, GREY

    for number, colour in _looks().items():
        here = pick(rows, law="calibrated", particles=number)
        for split, walls, column, style, what in (
            ("half", "held", "bulk_cov", "o-", "bulk"),
            ("half", "held", "cov", "o:", "all"),
            ("half", "periodic", "cov", "x--", "periodic cell"),
        ):
            means = pick(here, split=split, walls=walls).groupby("ratio")[column].mean().dropna()
            if len(means):
                axes.plot(means.index, means, style, color=colour, markersize=4, label=f"{number}, {what}")
        for split, column, marker in (("radii", "bulk_cov", "^"), ("half", "bulk_cov_volume", "D")):
            mean = pick(here, split=split, walls="held", ratio=0.0)[column].mean()
            axes.plot([0.0], [mean], marker, color=colour, fillstyle="none")
    axes.plot([], [], "^", color=GREY, fillstyle="none", label="R_p/(R_p+R_q), bulk")
    axes.plot([], [], "D", color=GREY, fillstyle="none", label="half, by volume, bulk")
    printed_values = [PAPER["cov_0"], PAPER["cov_4"], PAPER["cov_11"]]
    axes.plot([0.0, 4.0, 11.0], printed_values, "*", color=BLACK, markersize=11, label="paper")
    axes.set(xlabel="halo radius, mean radii", ylabel="CoV by number, %", yscale="log", ylim=(0.4, 130))
    ticks = (0.5, 1, 2, 5, 10, 20, 50, 100)
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    exact = pick(rows, law="laguerre", ratio=0.0)["cov"].max()
    axes.set_title(f"Scatter of the flux (Laguerre, no halo: {exact:.0e} %)")
    axes.legend(ncols=2, fontsize=7.5)


def _extremes(axes, rows):
    for number, colour in _looks().items():
        here = pick(rows, law="calibrated", split="half", walls="held", particles=number)
        for column, style in (("bulk_least", "v-"), ("bulk_mean", "o-"), ("bulk_most", "^-"), ("least", "v:")):
            means = here.groupby("ratio")[column].mean().dropna()
            if len(means):
                label = f"{number} particles" if column == "bulk_mean" else None
                axes.plot(means.index, means, style, color=colour, markersize=4, label=label)
    axes.axhline(1.0, color="black", linewidth=0.8)
    axes.set(xlabel="halo radius, mean radii", ylabel="flux / 3300 W/m2", ylim=(-0.2, 3.0))
    axes.set_title("Smallest, mean and largest flux of the bulk; dotted: smallest of all")
    axes.legend()


def _densities(raw, halos, df):
    import numpy as np

    from studies.harness.figures import BLUE, GREY, ORANGE, PINK, RED

    rows = pick(df, law="calibrated", walls="held", seed=0)
    if len(rows) == 0:
        return
    rows = rows[rows["particles"] == rows["particles"].max()]
    colours = {
        (0.0, "half"): RED,
        (0.0, "radii"): ORANGE,
        (2.0, "half"): PINK,
        (4.0, "half"): BLUE,
        (11.0, "half"): GREY,
    }
    for (ratio, split), colour in colours.items():
        low, high = DENSITIES[ratio]
        middle = low + (np.arange(BINS) + 0.5) * (high - low) / BINS
        axes = raw if ratio < 4 else halos
        for part, style in (("bulk_", "-"), ("", ":")):
            for cell in pick(rows, split=split)[f"{part}density_{ratio:g}"].dropna():
                label = f"{'no halo' if ratio == 0 else f'halo of {ratio:g}'}, {split}, {part.strip('_') or 'all'}"
                density = numbers(cell) * BINS / (high - low)
                axes.plot(middle, density, style, color=colour, label=label)
    number = int(rows["particles"].max())
    for axes, what in ((raw, "no halo, and a narrow one"), (halos, "halos")):
        axes.set(xlabel="flux / 3300 W/m2", ylabel="density", title=f"Density functions, {number} particles: {what}")
        axes.set_ylim(bottom=0.0)
        axes.legend(fontsize=8)
