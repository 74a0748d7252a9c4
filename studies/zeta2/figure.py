"""Figure of the study of zeta_2: cells beside the polynomial, errors of voxels, bounds, two-point probability."""

import numpy as np

from demheat import referee
from studies.harness.cells import numbers
from studies.harness.figures import BLACK, BLUE, GREEN, GREY, ORANGE, RED, SKY
from studies.harness.pick import pick
from studies.zeta2.means import pooled, with_bounds

# How placed and gap -> label, colour, marker, filled.
LOOKS = {
    ("lsa", 0.0): ("LSA, no gap: near equilibrium", RED, "o", True),
    ("lsa", 0.02): ("LSA, gap 0.02 D", RED, "o", False),
    ("rsa", 0.0): ("one by one (RSA), no gap", BLUE, "s", True),
    ("rsa", 0.02): ("one by one (RSA), gap 0.02 D", BLUE, "s", False),
}
ARRAYS = {"sc": ("SC", RED), "bcc": ("BCC", GREEN), "fcc": ("FCC", BLUE)}


def plot(df):
    """zeta_2 over f beside the polynomial; errors of voxels; what it does to bounds; S2."""
    df = df[df["status"] == "ok"]
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(2, 2, figsize=(12, 9.2))
    _cells(axes[0, 0], pooled(df))
    _voxels(axes[0, 1], df)
    _bounds(axes[1, 0], with_bounds(df))
    _two_point(axes[1, 1], pick(df, part="surface"))
    return figure


def _cells(axis, means):
    from references.bounds import zeta2_hard_spheres

    f = np.linspace(0.05, 0.55, 101)
    label = "equilibrium, Miller and Torquato's polynomial"
    axis.plot(f, zeta2_hard_spheres(f) / f, color=BLACK, label=label)
    for number, ((placed, gap), (text, colour, marker, full)) in enumerate(LOOKS.items()):
        rows = pick(means, placed=placed, gap=gap, ratio=6.0)
        if len(rows):
            face = colour if full else "white"
            axis.errorbar(
                rows["fraction"] + 0.006 * (number - 1.5), rows["zeta2"] / rows["fraction"],
                yerr=rows["half"] / rows["fraction"], label=text, color=colour, marker=marker, linestyle="",
                markerfacecolor=face, capsize=3,
            )  # fmt: skip
    axis.set(xlabel="volume fraction f", ylabel="zeta_2 / f")
    most = int(means["cells"].max())
    axis.set_title(f"Mean of {most} cells of 6 diameters, 95 % confidence,\nby multipoles")
    axis.set_ylim(0.9 * (means["zeta2"] / means["fraction"]).min(), 0.245)
    axis.legend(fontsize=8, loc="upper right")


def _voxels(axis, df):
    for (array, fraction), rows in pick(df, part="array").groupby(["array", "fraction"], sort=False):
        name, colour = ARRAYS[array]
        colour = ORANGE if fraction < 0.2 else colour
        size = {"label": f"{name}, f = {fraction:.3g}", "color": colour, "marker": "o"}
        axis.plot(rows["per_diameter"], rows["error_percent"].abs(), **size)
        axis.plot(rows["per_diameter"], rows["raw_percent"].abs(), color=colour, marker="o", mfc="white", ls=":")
    cells = pick(df, part="voxels")
    axis.plot(cells["per_diameter"], cells["error_percent"].abs(), "D", color=SKY, markersize=4, label="random cells")
    axis.plot(cells["per_diameter"], cells["raw_percent"].abs(), "D", color=SKY, markersize=4, mfc="white")
    axis.plot([], [], color=GREY, marker="o", mfc="white", ls=":", label="without extrapolation")
    axis.set(xscale="log", yscale="log", xlabel="voxels across a sphere", ylabel="|error of zeta_2|, %")
    axis.set_title("Green projector on voxels against multipoles\n(arrays: worst of three places on the grid)")
    axis.set_xticks([10, 20, 50, 100, 200], labels=["10", "20", "50", "100", "200"])
    axis.minorticks_off()
    axis.yaxis.set_major_formatter("{x:g}")
    axis.legend(fontsize=8)


def _bounds(axis, rows):
    rows = pick(rows, placed="lsa").sort_values("fraction")
    unit = rows["conductivity"]

    def off(name):
        return 100 * referee.value_error(rows[name], unit)

    f = rows["fraction"]
    more = {"marker": "_"} if len(rows) == 1 else {}
    for name, colour, label in (("hs", GREY, "Hashin and Shtrikman"), ("third", GREEN, "third order, own zeta_2")):
        low, high = ("hs_lower", "hs_upper") if name == "hs" else ("lower", "upper")
        axis.fill_between(f, off(low), off(high), color=colour, alpha=0.25, label=label)
        for each in (low, high):
            axis.plot(f, off(each), color=colour, linewidth=1, **more)
    axis.plot(f, off("torquato"), color=RED, marker="o", label="Torquato, own zeta_2")
    axis.plot(f, off("torquato_polynomial"), color=RED, marker="o", mfc="white", ls=":", label="Torquato, polynomial")
    axis.axhline(0.0, color=BLACK, linewidth=1)
    # Linear up to a tenth of a per cent, then by decades: bounds are off by tens, estimates by hundredths.
    axis.set_yscale("symlog", linthresh=0.1)
    axis.yaxis.set_major_formatter("{x:g}")
    axis.set(xlabel="volume fraction f", ylabel="off the multipole conductivity, %")
    axis.set_title("Silica in epoxy (contrast 7.7), one LSA cell each, gap 0.02 D:\nwhat knowing zeta_2 is worth")
    axis.set_ylim(top=2e3)  # room for the legend
    axis.set_yticks([-10, -1, -0.1, 0, 0.1, 1, 10])
    axis.legend(fontsize=8, loc="upper left", ncols=2)


def _two_point(axis, rows):
    shown = rows[rows["fraction"] == (0.3 if (rows["fraction"] == 0.3).any() else rows["fraction"].max())]
    for row in shown.itertuples():
        text, colour, _, full = LOOKS[row.placed, row.gap]
        r, s2 = numbers(row.r), numbers(row.s2)
        style = "-" if full else "--"
        axis.plot(r, (s2 - row.fraction**2) / (row.fraction * (1 - row.fraction)), style, color=colour, label=text)
    f = shown["fraction"].iloc[0]
    start = np.linspace(0.0, 2 / 3 * (1 - f), 2)
    axis.plot(start, 1 - 1.5 * start / (1 - f), color=BLACK, linewidth=1, label="slope of the exact surface, 3 f/R")
    axis.axhline(0.0, color=GREY, linewidth=1)
    axis.set(xlabel="distance / D", ylabel="(S2 - f^2) / (f - f^2)")
    worst = rows["error_percent"].abs().max()
    axis.set_title(f"Two-point probability at f = {f:g}; surface by its slope\nwithin {worst:.2g} % at every f")
    axis.legend(fontsize=8)
