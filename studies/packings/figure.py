"""Figure of the study `packings`."""

import numpy as np

from studies.harness.cells import numbers
from studies.harness.figures import BLACK, BLUE, GREEN, GREY, ORANGE, RED
from studies.harness.pick import pick
from studies.packings.rows import GAPS

OURS = {"lsa": ("ours", RED, "o"), "spheropack": ("spheropack", BLUE, "s")}


def draw(df, large):
    """Six panels from the rows; the polar plot and S2(r) of the packing of `large` spheres, if it is there."""
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=(13, 8))
    panels = [figure.add_subplot(2, 3, k + 1, projection="polar" if k == 3 else None) for k in range(6)]
    ok = df[df["status"] == "ok"]
    peers = pick(ok, part="peer", particles=int(pick(ok, part="peer")["particles"].max()))
    _speed(panels[0], peers)
    _contacts(panels[1], peers)
    _scaled_g(panels[2], pick(peers, radii="gaussian", seed=0))
    shown = pick(ok, part="large", maker="lsa", particles=large)
    shown = (shown if len(shown) else pick(peers, maker="lsa", radii="gaussian", seed=0)).iloc[0]
    _polar(panels[3], shown)
    _two_point(panels[4], shown)
    _width(panels[5], ok)
    return figure


def _speed(axes, peers):
    """Packing fraction at the same pressure against CPU time."""
    for (maker, radii), rows in peers.groupby(["maker", "radii"], sort=False):
        label, colour, marker = OURS[maker]
        filled = colour if radii == "gaussian" else "white"
        axes.plot(
            rows["cpu_s"], rows["phi_reached"], marker, color=colour, markerfacecolor=filled,
            label=f"{label}, {radii} radii",
        )  # fmt: skip
    number = int(peers["particles"].iloc[0])
    axes.set(xscale="log", xlabel="CPU seconds, points to packing", ylabel="packing fraction at pressure 1e6")
    _plain_ticks(axes.xaxis)
    means = peers[peers["radii"] == "gaussian"].groupby("maker")["cpu_s"].mean()
    faster = f": {means['spheropack'] / means['lsa']:.1f} times faster" if len(means) > 1 else ""
    axes.set_title(f"{number} spheres jammed{faster}")
    axes.legend()


def _plain_ticks(axis):
    """Ticks 1, 2, 5, 10, ... of a logarithmic axis, as plain numbers."""
    from matplotlib import ticker

    axis.set_major_locator(ticker.LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axis.set_minor_locator(ticker.NullLocator())


def _contacts(axes, peers):
    """Mean number of neighbours within a gap."""
    for (maker, radii), rows in peers.groupby(["maker", "radii"], sort=False):
        label, colour, _ = OURS[maker]
        mean = np.mean([numbers(text) for text in rows["z_of_gap"]], axis=0)
        style = {"lsa": "-", "spheropack": (0, (2, 2))}[maker]
        axes.plot(
            GAPS, mean, color=colour if radii == "gaussian" else BLACK, linestyle=style, label=f"{label}, {radii}"
        )
    axes.axhline(7.5, color=GREY, linewidth=0.8)
    axes.annotate("7.5, the paper's", (GAPS[0], 7.45), fontsize=8, color=GREY, va="top")
    axes.set(xscale="log", xlabel="gap over the sum of radii", ylabel="neighbours within the gap")
    axes.set_title("A mean of 7.5 neighbours needs a gap of several %")
    axes.legend()


def _scaled_g(axes, rows):
    """Pair correlation over the distance in units of contact."""
    for _, row in rows.iterrows():
        label, colour, _ = OURS[row["maker"]]
        dash = "-" if row["maker"] == "lsa" else (0, (2, 2))
        axes.plot(numbers(row["scaled_r"]), numbers(row["scaled_g"]), color=colour, linestyle=dash, label=label)
    axes.set(xlabel="distance over the sum of radii", ylabel="g", title="Pair correlation, Gaussian radii, jammed")
    axes.set_xlim(0.8, 2.0)
    axes.legend()


def _polar(axes, row):
    """Density of link directions in the three coordinate planes."""
    angles = numbers(row["polar_angle"])
    for name, plane, colour in (("x", "yz", RED), ("y", "zx", GREEN), ("z", "xy", BLUE)):
        closed = np.append(numbers(row[f"polar_{name}"]), numbers(row[f"polar_{name}"])[0])
        axes.plot(np.append(angles, angles[0] + 2 * np.pi), closed, color=colour, linewidth=1, label=f"plane {plane}")
    axes.set_ylim(0, 1.25)
    axes.set_yticks([0.5, 1.0])
    deviation = max(row["fabric_sd"], row["fourth_sd"])
    axes.set_title(
        f"Link directions, {row['particles']} spheres: isotropic\nwithin {deviation:.1f} standard deviations"
    )
    axes.legend(loc="lower left", bbox_to_anchor=(-0.25, -0.12))


def _two_point(axes, row):
    """S2(r) along the three axes with the exact tangent."""
    r = numbers(row["s2_r"])
    for k, (name, colour) in enumerate((("x", RED), ("y", GREEN), ("z", BLUE))):
        axes.plot(r, numbers(row[f"s2_{k}"]), color=colour, linewidth=1.2, label=f"along {name}")
    phi = row["phi_reached"]
    near = r[r < 0.45]
    axes.plot(near, phi + row["slope_exact"] * near, color=BLACK, linestyle=(0, (1, 2)), label="exact slope -surface/4")
    axes.axhline(phi**2, color=GREY, linewidth=0.8)
    axes.set(xlabel="r over the mean diameter", ylabel="S2(r)", ylim=(0.9 * phi**2 - 0.03, None))
    axes.set_title("Two-point probability: the same along each axis")
    axes.legend()


def _width(axes, ok):
    """Cost per collision: widths of the distribution, and numbers."""
    rows = ok[ok["us_per_collision"].notna() & (ok["maker"] == "lsa") & ok["domain"].isna()]
    names = {
        "equal": ("equal", "o", BLACK),
        "gaussian": ("Gaussian, spread 0.3", "s", RED),
        "ten": ("1 : 10", "^", ORANGE),
    }
    for radii, group in rows.groupby("radii", sort=False):
        label, marker, colour = names[radii]
        axes.plot(group["particles"], group["us_per_collision"], marker, color=colour, label=label)
    peer = ok[(ok["maker"] == "spheropack") & (ok["radii"] == "gaussian")]
    axes.plot(peer["particles"], peer["us_per_collision"], "s", color=BLUE, markerfacecolor="white", label="spheropack")
    axes.set(xscale="log", yscale="log", xlabel="spheres", ylabel="CPU microseconds per collision")
    _plain_ticks(axes.yaxis)
    axes.set_title("Spread 0.3 costs little, radii 1 : 10 more")
    axes.legend()
