"""Maps of the search: what each set gives, coloured by how far that is off what is printed."""

import numpy as np

from studies.ct_search.means import LIMITS, PAPER, TOLERANCES, ranked
from studies.harness.figures import BLACK
from studies.harness.pick import pick

# Panel -> weighting of the scatter, column, how its numbers are written.
PANELS = {
    "C_t at 1e5 (printed .806)": ("number", "ct_1e5", "{:.3f}"),
    "C_t at 1e6 (printed .834)": ("number", "ct_1e6", "{:.3f}"),
    f"One sphere, 1.5e5, % (at most {PAPER['sphere']:g})": ("number", "sphere", "{:.2f}"),
    f"Fewer than 2 links, % (at most {LIMITS['under_2']:g})": ("number", "under_2", "{:.2f}"),
    "Own flux, by number, % (27)": ("number", "cov_0", "{:.0f}"),
    "Own flux, by volume, % (27)": ("volume", "cov_0", "{:.0f}"),
    "Halo of 4, by number, % (5)": ("number", "cov_4", "{:.1f}"),
    "Halo of 11, by number, % (2)": ("number", "cov_11", "{:.2f}"),
}
# Colours change at so many tolerances: within one there is none.
STEPS = (-4.0, -2.0, -1.0, 1.0, 2.0, 4.0)


def plot(df):
    """Maps of what is printed over spread and links, one block for each mean radius."""
    from matplotlib import pyplot

    lines = ranked(df)
    means = list(dict.fromkeys(df["mean"]))
    best = lines.iloc[0]
    figure = pyplot.figure(figsize=(13, 5.6 * len(means) + 0.6))
    blocks = np.atleast_1d(figure.subfigures(len(means), 1))
    for block, mean in zip(blocks, means, strict=True):
        block.suptitle(f"R_m the {mean} mean of two radii", x=0.01, ha="left", fontsize=12)
        for axes, (title, (weighting, column, form)) in zip(block.subplots(2, 4).flat, PANELS.items(), strict=True):
            rows = pick(lines, mean=mean, weighting=weighting)
            image = _map(axes, rows, column, form)
            axes.set_title(title, fontsize=10)
            chosen = best["mean"] == mean and (weighting == best["weighting"] or not column.startswith("cov"))
            if chosen:
                _frame(axes, rows, best)
        bar = block.colorbar(image, ax=block.axes, shrink=0.8, aspect=30, pad=0.01, extend="both")
        bar.set_label("off what is printed, in tolerances (white: within)")
    return figure


def _map(axes, rows, column, form):
    """One quantity over spread (across) and links (up)."""
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm, ListedColormap

    spreads, links = (sorted(rows[name].unique()) for name in ("spread", "links"))
    off, values = np.full((2, len(links), len(spreads)), np.nan)
    for _, row in rows.iterrows():
        place = links.index(row["links"]), spreads.index(row["spread"])
        misfit = row[f"misfit_{column}"]
        # Of a limit nothing below it is off.
        off[place] = misfit if column in TOLERANCES else max(misfit - 1.0, 0.0)
        values[place] = row[column]
    colours = ListedColormap(colormaps["RdBu_r"](np.linspace(0.05, 0.95, len(STEPS) + 1)))
    norm = BoundaryNorm(STEPS, colours.N, extend="both")
    image = axes.imshow(off, origin="lower", cmap=colours, norm=norm, aspect="auto")
    for (k, j), value in np.ndenumerate(values):
        if np.isfinite(value):
            dark = abs(off[k, j]) > STEPS[-1]
            axes.text(j, k, form.format(value), ha="center", va="center", fontsize=8, color="white" if dark else BLACK)
    axes.set_xticks(range(len(spreads)), [f"{s:g}" for s in spreads])
    axes.set_yticks(range(len(links)), [f"{z:g}" for z in links])
    axes.set(xlabel="spread of the radii", ylabel="links")
    axes.grid(False)
    return image


def _frame(axes, rows, best):
    """A frame around the best set."""
    from matplotlib.patches import Rectangle

    spreads, links = (sorted(rows[name].unique()) for name in ("spread", "links"))
    place = (spreads.index(best["spread"]) - 0.5, links.index(best["links"]) - 0.5)
    axes.add_patch(Rectangle(place, 1, 1, fill=False, edgecolor=BLACK, linewidth=2.5))
