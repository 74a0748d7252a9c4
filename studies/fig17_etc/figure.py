"""The figure of fig17_etc: conductivity with its bounds, errors of the methods, and deviations between cells."""

import numpy as np

from demheat import referee
from demheat.gallery import EPOXY
from references import bounds
from studies.common.paper_looks import draw_variants
from studies.common.paper_variants import parted
from studies.fig17_etc.means import CONTRAST, along_one_axis, change, interval, network_errors, of_walls, witness
from studies.harness import methods
from studies.harness.converged import converged
from studies.harness.figures import BLACK, BLUE, GREEN, GREY, LOOK, PINK, RED, SKY, look
from studies.harness.pick import pick, with_size
from studies.harness.printed import printed

HERE = {"kind": "periodic", "boundary": "gradient", "realisation": 0, "axes": "y"}
PAPER = printed("fig17_etc")
WALLS = {"gradient": "periodic cells", "walls": "between isothermal walls"}
FLOOR = 1e-4  # per cent; what is below is drawn there


def plot(df):
    """k, and k over Maxwell's, with bounds and estimates; errors; deviations between cells; the network's variants."""
    from matplotlib import pyplot

    network, others = parted(df)
    others = others[others["status"] == "ok"]
    across = 3 if len(network) else 2
    figure, axes = pyplot.subplots(2, across, figsize=(5.5 * across, 11))
    _plain(axes[0, 0], others)
    _conductivity(axes[0, 1], others)
    _spreads(axes[1, 1], others)
    _errors(axes[1, 0], others)
    for ax, (boundary, words) in zip(axes[:, 2:].ravel(), WALLS.items(), strict=False):
        made = network_errors(df, boundary)
        names = sorted({name for found in made.values() for name in found})
        draw_variants(ax, made, names, PAPER["dem_fft"] if boundary == "gradient" else None)
        ax.set(xlabel="volume fraction", ylabel="error, % of k", title=f"The paper's network, {words}")
    return figure


def _fractions(df):
    return np.array(sorted(df["fraction"].unique()))


def _plain(ax, df):
    """k itself, as in the paper's figure: bounds, Torquato's estimate, means over cells and the paper's network."""
    fractions, curve = _fractions(df), np.linspace(1e-3, _fractions(df).max(), 100)
    matrix = EPOXY.conductivity
    smooth = _zeta2(df, curve)
    low, high = bounds.third_order(1.0, CONTRAST, curve, smooth)
    ax.fill_between(curve, matrix * low, matrix * high, color=SKY, alpha=0.35, label="third-order bounds")
    ax.plot(curve, matrix * bounds.torquato(1.0, CONTRAST, curve, smooth), color=BLUE, label="Torquato", linewidth=1)
    found = {f: interval(df, "periodic", f, name="multipole") for f in fractions}
    mean = {f: matrix * each.mean for f, each in found.items() if each}
    ax.plot(list(mean), list(mean.values()), "o", color=BLACK, markersize=5, label="multipoles, mean over cells")
    rows = pick(df, name="dem-calibrated", **HERE)
    ax.plot(rows["fraction"], matrix * rows["k_ratio"], "s", color=PINK, mfc="none", label=LOOK["dem-calibrated"][0])
    ax.set(xlabel="volume fraction", ylabel="conductivity, W/(m K)", title="Silica in epoxy, as the paper draws it")
    ax.legend(loc="upper left")


def _zeta2(df, curve):
    """zeta_2 of the cells along the fractions, linear between."""
    fractions = _fractions(df)
    known = [pick(df, name="zeta2", fraction=f)["zeta2"].mean() for f in fractions]
    return np.interp(curve, [0.0, *fractions], [0.0, *known])


def _conductivity(ax, df):
    """Over Maxwell's estimate: k rises threefold, what is to be told apart is a few per cent."""
    fractions, curve = _fractions(df), np.linspace(1e-3, _fractions(df).max(), 100)

    def relative(k, f):
        return k / bounds.maxwell(1.0, CONTRAST, f)

    smooth = _zeta2(df, curve)
    low, high = bounds.third_order(1.0, CONTRAST, curve, smooth)
    ax.fill_between(
        curve, relative(low, curve), relative(high, curve), color=SKY, alpha=0.35, label="third-order bounds"
    )
    ax.plot(curve, relative(bounds.torquato(1.0, CONTRAST, curve, smooth), curve), color=BLUE, label="Torquato")
    for name, formula, style in (
        ("Bruggeman, differential", bounds.bruggeman_differential, "--"),
        ("Lewis and Nielsen", bounds.lewis_nielsen, "-."),
        ("Maxwell", bounds.maxwell, ":"),
    ):
        ax.plot(curve, relative(formula(1.0, CONTRAST, curve), curve), color=GREY, linestyle=style, label=name)
    for f in fractions:
        found = interval(df, "periodic", f, name="multipole")
        if found:
            first = f == fractions[0]
            ax.errorbar(
                f, relative(found.mean, f), relative(found.half, f), color=BLACK, marker="o", markersize=5, capsize=4,
                label=f"multipoles, {found.number} cells, 95 %" if first else None,
            )  # fmt: skip
    _markers(ax, df, relative)
    ax.set(xlabel="volume fraction", ylabel="k over Maxwell's estimate", title="The same over Maxwell's estimate")
    ax.legend(loc="upper left")


def _markers(ax, df, relative):
    """Unequal spheres, and the paper's network on the first cell."""
    for f in _fractions(df):
        changed = change(df, f, "unequal")
        equal = interval(df, "periodic", f, name="multipole")
        if changed is not None and equal:
            ax.plot(
                f, relative(equal.mean * (1 + changed / 100), f), "v", color=GREEN, label=_once(ax, "unequal spheres")
            )
    rows = pick(df, name="dem-calibrated", **HERE)
    if len(rows):
        ax.plot(
            rows["fraction"], relative(rows["k_ratio"], rows["fraction"]), "s", color=PINK, markerfacecolor="none",
            label="DEM as in the paper, first cell",
        )  # fmt: skip


def _once(ax, label):
    return None if label in ax.get_legend_handles_labels()[1] else label


def _errors(ax, df):
    """On the first cell: the finest row of each method open, its converged value filled."""
    for method in (methods.all_methods()["dem-calibrated"], *methods.compared()):
        name, rows = method.name, with_size(pick(df, name=method.name, **HERE)).fillna({"h": 0.0})
        if not len(rows):
            continue
        fine = rows.loc[rows.groupby("fraction")["h"].idxmin()]
        errors = [_percent_off(df, f, k) for f, k in zip(fine["fraction"], fine["k_ratio"], strict=True)]
        style = look(name)
        ax.plot(fine["fraction"], np.maximum(errors, FLOOR), **style | {"markerfacecolor": "none", "linestyle": ":"})
        if method.terms:
            limits = {f: converged(df, name, fraction=f, **HERE) for f in fine["fraction"]}
            errors = [_percent_off(df, f, k) if k else np.nan for f, k in limits.items()]
            ax.plot(
                list(limits),
                np.maximum(errors, FLOOR),
                **style | {"label": f"{LOOK[name][0]}, extrapolated", "linestyle": "none"},
            )
    ax.set(xlabel="volume fraction", ylabel="|error|, % of the multipole value", yscale="log")
    ax.set_title("One cell, all methods on the same spheres")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, fontsize=7)


def _percent_off(df, fraction, k):
    return 100 * abs(referee.value_error(k, witness(df, "periodic", fraction)))


def _spreads(ax, df):
    """What changes k: the cell, boundaries, the spheres' sizes, and the method."""
    fractions = _fractions(df)
    cells = [interval(df, "periodic", f) for f in fractions]
    groups = {
        ("standard deviation between cells, one axis", BLACK): [along_one_axis(df, f) for f in fractions],
        ("the same, mean over three axes", GREY): [i and 100 * i.deviation / i.mean for i in cells],
        ("isothermal walls instead of a gradient", PINK): [of_walls(df, f).mean() for f in fractions],
        ("unequal spheres instead of equal ones", GREEN): [change(df, f, "unequal") for f in fractions],
        ("largest difference of two methods, converged", RED): [_between(df, f) for f in fractions],
    }
    # Points, as on an axis of logarithms bars begin nowhere; a little aside of each other.
    aside = 0.5 / len(groups)
    for k, ((label, colour), values) in enumerate(groups.items()):
        heights = np.array([np.nan if v is None else abs(v) for v in values])
        places = np.arange(len(fractions)) + (k + 0.5) * aside - 0.25
        if np.isfinite(heights).any():
            ax.plot(places, heights, color=colour, marker="osD^v"[k], linestyle="", label=label)
    ax.set(xlabel="volume fraction", ylabel="% of k", yscale="log", title="What changes the result")
    ax.set_axisbelow(True)
    ax.set_xticks(range(len(fractions)), [f"{f:g}" for f in fractions])
    top = ax.get_ylim()[1]
    ax.set_ylim(top=20 * top)  # room for the legend
    ax.legend(fontsize=8, loc="upper left")


def _between(df, fraction):
    """Largest difference of two methods' converged values on the first cell, %; None with fewer than two."""
    k = [converged(df, name, fraction=fraction, **HERE) for name in (method.name for method in methods.compared())]
    k = [each for each in k if each]
    return 100 * referee.value_error(max(k), min(k)) if len(k) > 1 else None
