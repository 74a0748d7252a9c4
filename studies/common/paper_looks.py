"""A panel with the errors of all variants of the paper's network."""

import numpy as np

from studies.common.paper_variants import best_variant
from studies.harness.figures import BLACK, BLUE, GREEN, GREY, PINK

# Of more particles than all variants have.
STAR = {"color": BLACK, "marker": "*", "markerfacecolor": BLACK, "markersize": 11}


def draw_variants(ax, made, names, printed=None, unit="%"):
    """Errors of all variants at the largest number of particles that all have, with intervals, side by side.

    Colours are the walls, full markers LSA and open ones relaxed packings, squares the paper's calibration by a flux;
    stars are variants with more particles than all have.
    """
    most = best_variant(made)[1]
    shown = [key for key in made if key[1] >= most]
    for place, (variant, number) in enumerate(shown):
        style = STAR if number > most else _style(variant)
        x = np.arange(len(names)) + 0.8 * ((place + 0.5) / len(shown) - 0.5)
        found = [made[variant, number].get(name) for name in names]
        mean = [each.mean if each else np.nan for each in found]
        half = [each.half if each else np.nan for each in found]
        label = variant.words.replace(" packing", "") + (f", {number} particles" if number > most else "")
        ax.errorbar(x, mean, half, linestyle="", capsize=2, linewidth=1, label=label, **{"markersize": 5} | style)
    if printed:
        ax.axhspan(-printed, printed, color=GREY, alpha=0.15, linewidth=0, label=f"+-{printed:g} {unit}, printed")
    ax.axhline(0.0, color=BLACK, linewidth=0.8)
    ax.set_xticks(range(len(names)), names)
    ax.grid(axis="x", visible=False)
    place = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.13), "ncols": 2}
    rest = ", others as said" if any(number > most for _, number in shown) else ""
    ax.legend(**place, fontsize=7, title=f"{most} particles{rest}", title_fontsize=8)


def _style(variant):
    colour = {"center": PINK, "surface": BLUE, "periodic": GREEN}[variant.held]
    marker = {"flux": "s", "isothermal": "^", "cell": "o"}[variant.calibration]
    face = colour if variant.packing == "lsa" else "white"
    return {"color": colour, "marker": marker, "markerfacecolor": face}
