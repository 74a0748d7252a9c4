"""Figure of many_inclusions."""

from studies.harness import methods
from studies.harness.figures import BLACK, GREY, look

FLOOR = 1e-4  # per cent; smaller errors are drawn there
COSTS = {"cpu_s": ("CPU time", "s", 1), "peak_mib": ("peak memory", "GiB", 1024)}


def draw(df, paper):
    """Error against CPU time and memory, and, where they are counted, against elements per inclusion."""
    from matplotlib import pyplot

    df = df[df["error_percent"].notna()].assign(off=lambda d: d["error_percent"].abs().clip(lower=FLOOR))
    counted = df["per_inclusion"].notna().any()
    panels = 2 + bool(counted)
    figure, axes = pyplot.subplots(1, panels, figsize=(5.3 * panels, 6), squeeze=False)
    axes = axes[0]
    for ax, (cost, (name, unit, size)) in zip(axes, COSTS.items(), strict=False):
        _by_cost(ax, df, cost, size)
        ax.set(xscale="log", yscale="log", xlabel=f"{name}, {unit}", ylabel="|error| of k, %")
        ax.set_title(f"83 spheres: error against {name}")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9)
    if counted:
        _per_inclusion(axes[2], df, paper)
    return figure


def _by_cost(ax, df, cost, unit):
    double = df[df["precision"].isna()] if "precision" in df else df
    for method in methods.compared("dem-calibrated", "fem-p1"):
        rows = double[double["name"] == method.name].sort_values(cost)
        if len(rows):
            ax.plot(rows[cost] / unit, rows["off"], **look(method.name))
    # The highest degree is what the others are held against.
    spheres = df[df["name"] == "multipole"].sort_values("degree")
    spheres = spheres[spheres["degree"] < spheres["degree"].max()]
    ax.plot(spheres[cost] / unit, spheres["off"], **look("multipole"))


def _per_inclusion(ax, df, paper):
    for method in ("dem", "dem-calibrated"):
        rows = df[df["name"] == method].sort_values("per_inclusion")
        if len(rows):
            ax.plot(rows["per_inclusion"], rows["off"], **look(method))
    ax.axvline(paper["per_inclusion"], color=BLACK, linestyle=":", label="enough, says the paper")
    ax.axhline(paper["dem_fft"], color=GREY, linestyle="--", label="DEM against FFT in the paper")
    ax.set(xscale="log", yscale="log", xlabel="elements in an inclusion, twins among them", ylabel="|error| of k, %")
    ax.set_title("How many elements an inclusion needs")
    ax.legend(fontsize=8, loc="lower left")
