"""Conductivity against damage: spheres that have come off, discs, links that are gone."""

import numpy as np

from studies.damage.cases import NEIGHBOURS, RADII, REMOVED, THRESHOLD
from studies.damage.means import left, theory
from studies.harness import methods
from studies.harness.figures import BLACK, BLUE, GREY, ORANGE, RED, SKY, look
from studies.harness.pick import finest, pick


def plot(df):
    """Conductivity against damage of each kind, with what is known of it as lines."""
    from matplotlib import pyplot

    figure, (one, two, three) = pyplot.subplots(1, 3, figsize=(14, 4.6))
    _spheres(one, pick(df, part="debonded"))
    _discs(two, pick(df, part="cracks"))
    _links(three, pick(df, part="links"))
    figure.suptitle("Conductivity against damage, beside what is known: multipoles, an exact series, bounds")
    return figure


def _spheres(axes, rows):
    for name in dict.fromkeys(rows["name"]):
        best = finest(pick(rows, name=name))
        axes.plot(best["share"], best["k_ratio"], **look(name, label=methods.all_methods()[name].title))
    axes.set(xlabel="share of the spheres that have come off", ylabel="conductivity over the matrix's")
    axes.set_title("Silica in epoxy")
    axes.legend()


def _discs(axes, rows):
    from references.exact.cracks import discs
    from references.exact.ellipsoids import penny_cracks

    radii = np.linspace(0.02, max(RADII), 20)
    axes.plot(radii, [discs(each).conductivity for each in radii], color=BLACK, label="exact")
    axes.plot(radii, [penny_cracks(each**3) for each in radii], color=GREY, linestyle="--", label="dilute")
    for (particles, group), marker, colour in zip(rows.groupby("particles"), "v^o", (SKY, ORANGE, RED), strict=False):
        how = {"marker": marker, "color": colour, "linestyle": "", "label": f"DEM, {particles:g} particles"}
        axes.plot(group["radius"], group["k_ratio"], **how)
    axes.set(xlabel="radius of the disc over the cell", ylabel="conductivity over that without cracks")
    axes.set_title("Insulated discs across the load")
    axes.legend()


def _links(axes, rows):
    gone = np.linspace(0, 1, 200)
    axes.plot(gone, theory(gone), color=BLACK, label=f"effective medium, {NEIGHBOURS} neighbours")
    axes.plot(gone, 1 - gone, color=GREY, linestyle="--", label="upper bound of the mean")
    if len(rows):
        for (body, number), group in left(rows).groupby(level=["body", "number"]):
            where = group.index.get_level_values("removed")
            few = number == left(rows).loc[body].index.get_level_values("number").min()
            colour, marker = BLUE if body == "lattice" else ORANGE, "x" if few else "o"
            axes.plot(where, group, marker, color=colour, label=f"{body} of {number:g}", alpha=0.8)
    axes.axvline(1 - THRESHOLD, color=BLUE, linewidth=0.8, linestyle=":", label="an infinite lattice falls apart")
    axes.set(xlabel="share of the links gone", ylabel="conductivity left", xlim=(0, max(REMOVED) + 0.05))
    axes.set_title("Links that are gone")
    axes.legend(fontsize=8)
