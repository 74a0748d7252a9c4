"""A slab heated from one side: temperatures in time, by all laws, against the exact series.

Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799), figure 5 and eq. 17: a cube of 0.1 m at 25 C, its wall y = L
at 35 C from time 0 on, its wall y = 0 at 25 C, the sides insulated; 0.05, 0.1 and 0.2 s. Its table 1 prints a heat
capacity of 0.9 J/(kg K), kept here. Laws: facets of the radical tessellation ("laguerre"), contacts calibrated in the
steady state ("calibrated", with wall temperatures in the centres of the particles at the wall as in the paper, or at
the wall), regular polyhedra ("platonic"). Errors are over all particles, in units of the span of 10 K; the paper's
measure, as it seems, is |dT|/T with T in degrees Celsius, over the particles' places in its figure 5b: it prints 0.7 %
at most with 1e5 elements. Temporal accuracy is 1e-5 of the span.
"""

import numpy as np

from demheat import referee
from studies.common.slab import LENGTH, TIMES, packing_of, slab
from studies.common.slices import slice_means
from studies.harness.cells import cell, numbers
from studies.harness.pick import order, pick
from studies.harness.printed import printed

NUMBERS = (1_000, 3_000, 10_000, 30_000, 100_000)
LAWS = (("laguerre", None), ("calibrated", "center"), ("calibrated", "surface"), ("platonic", "center"))
SEEDS = (0, 1, 2)
# Twice what was found: another packing.
LIMITS = {0.05: 0.25, 0.1: 0.12, 0.2: 0.06}
ACCURACY = 1e-5
# Particles of a row's picture, and its slices.
DOTS, SLICES = 250, 20
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "Largest heat lost over heat moved": "rounding of sums over all particles and steps",
    "Laguerre, 1e5 particles: largest |dT|/T": "the paper's own statement, asked of every law alike",
}
# Why claims on the stored rows fail.
FAILS = {
    "largest |dT|/T of any particle": (
        "of single particles not reproduced by contacts, with temperatures in centres or at the wall; means over "
        "slices with temperatures at the wall are within it (column `slices`), see docs/decisions/printed.md"
    ),
}
PAPER = printed("fig05_slab")
TIMEOUT = 3600.0


def _case(law, wall, particles, seed):
    return {"law": law, "wall": wall, "particles": particles, "seed": seed, "method": "dem"}


# More packings of the law that the claims judge; large ones cost a minute each. Wall temperatures at the wall need a
# bulk between the walls' layers, which 1000 particles do not have.
CASES = [
    _case(law, wall, number, seed)
    for number in NUMBERS
    for law, wall in LAWS
    for seed in SEEDS[: 3 if law == "laguerre" and number <= 10_000 else 1]
    if wall != "surface" or number > 1_000
]
VALUES = True


def QUICK(case):
    """One packing of 1000 for each law, and of 3000 for Laguerre and where wall temperatures are at the wall."""
    most = 3_000 if case["law"] == "laguerre" or case["wall"] == "surface" else 1_000
    return case["particles"] <= most and case["seed"] == 0


def run(law, wall, particles, seed, method):
    """Errors at the three times, and the profile."""
    from demheat.dem import evolve
    from references import series

    scene = slab()
    knobs = {} if wall is None else {"wall": wall}
    fields = evolve(scene, TIMES, packing=packing_of(particles, seed), law=law, accuracy=ACCURACY, **knobs)
    row = {}
    for field, exact in zip(fields, series.evolve(scene, TIMES, points_per_axis=1), strict=True):
        row |= _errors(field, exact)
    names = ("unknowns", "iterations", "residual", "integrator", "steps", "stages", "spectral_ratio", "energy_error")
    return row | {name: field.stats[name] for name in (*names, "calibration")}


def _over_particles(y, local, t):
    """|dT|/T of every so-many-th particle, %, and the largest in each slice: the paper's panel b."""
    some = np.linspace(0, len(y) - 1, min(DOTS, len(y))).astype(int)
    most = np.zeros(SLICES)
    np.maximum.at(most, np.minimum((y * SLICES).astype(int), SLICES - 1), np.abs(local))
    dots = {"dots_y": cell(y[some], ".3g"), f"dots_{t}": cell(100 * np.abs(local[some]), ".2g")}
    return dots | {f"dots_most_{t}": cell(100 * most, ".3g")}


def _errors(field, exact):
    off, span = referee.temperature_error(field, exact, unit="K"), referee.span(field.scene, exact)
    y, temperature, t = off.points[:, 1] / LENGTH, field.samples.temperature, f"{field.time:g}"
    right = exact.temperature_at(off.points)
    local = referee.value_error(temperature, right, scale=right)
    middle, mean = slice_means(y, temperature, SLICES)
    return _over_particles(y, local, t) | {
        f"worst_{t}": 100 * off.max / span,
        f"rms_{t}": 100 * off.rms / span,
        f"relative_{t}": 100 * np.abs(local).max(),
        "profile_y": cell(middle),
        f"profile_{t}": cell(mean),
        f"profile_error_{t}": cell(100 * slice_means(y, off.values, SLICES)[1] / span),
        f"relative_slice_{t}": 100 * np.nanmax(np.abs(slice_means(y, local, SLICES)[1])),
    }


def claims(df):
    """Laguerre's errors, order and heat, and the laws of contacts beside it; the paper's 0.7 % by every law.

    Limits of Laguerre are twice what was found. What the paper prints is asked of its own law with 1e5 particles, wall
    temperatures where it has them and at the wall, and of Laguerre. The order expected is two; heat is kept to
    rounding.
    """
    yield from [*_accuracy(df), *_printed(df), *_order(df), *_balance(df)]


def _accuracy(df):
    full = pick(df, law="laguerre", particles=NUMBERS[-1])
    for t, limit in LIMITS.items():
        value = full[f"worst_{t:g}"].max() if len(full) else None
        yield f"Laguerre, 1e5 particles, {t:g} s: largest error, % of the span", value, limit
    # A quick run has 1000 and 3000 particles only: errors go with N^(-2/3).
    small = pick(df, law="laguerre", particles=3_000)
    yield "Laguerre, 3000 particles, 0.2 s: error rms, % of the span", small["rms_0.2"].mean(), 0.3
    for law in ("calibrated", "platonic"):
        least = _smallest(df)
        ours, theirs = (least[least["law"] == name]["rms_0.2"].mean() for name in ("laguerre", law))
        yield f"Error rms at 0.2 s, {law} over Laguerre, equal number of particles", theirs / ours, ">= 8"


def _printed(df):
    """The largest |dT|/T of any particle at the three times, as printed: 0.7 %."""
    for law, wall, who in (
        ("laguerre", None, "Laguerre"),
        ("calibrated", "center", "Contacts, temperatures in centres as in the paper"),
        ("calibrated", "surface", "Contacts, temperatures at the wall"),
    ):
        rows = pick(df, law=law, wall=wall, particles=int(PAPER["particles"]))
        value = rows[[f"relative_{t:g}" for t in TIMES]].max(axis=1, skipna=False).max(skipna=False)
        text = f"{who}, 1e5 particles: largest |dT|/T of any particle in degrees Celsius, % (paper: 0.7)"
        yield text, value if len(rows) else None, PAPER["worst_relative"]


def _smallest(df):
    return df[df["particles"] == df["particles"].min()]


def _order(df):
    means = pick(df, law="laguerre").groupby("particles")["rms_0.2"].mean()
    slope = -3 * order(means.index, means)
    yield "Laguerre: order of the error rms at 0.2 s in the particle spacing", slope, ">= 1.5"


def _balance(df):
    yield "Largest heat lost over heat moved", df["energy_error"].max(), 1e-12
    walled = df["spectral_ratio"].max()
    # Slivers make it hundreds.
    yield "Spectral radius over the mean row", walled, 40.0


def table(df):
    """Errors in per cent of the span by law, wall and number of particles, means over packings.

    `worst` is the largest over particles.
    """
    return _means(df, [f"{kind}_{t:g}" for kind in ("worst", "rms") for t in TIMES])


def notes(df):
    """The same in the paper's measure, and what a march takes."""
    from studies.harness.table import markdown

    yield (
        f"In the paper's measure, |dT|/T in per cent with T in degrees Celsius (it prints {PAPER['worst_relative']:g} "
        "with 1e5 elements): `relative` is the largest of any particle, `slices` the largest mean over one of twenty "
        "slices across the load. Steps of the march, and its spectral radius over the mean row."
    )
    shown = [f"{kind}_{t:g}" for kind in ("relative", "relative_slice") for t in TIMES]
    found = _means(df, [name for name in (*shown, "steps", "spectral_ratio") if name in df])
    yield markdown(found.rename(columns=lambda name: name.replace("relative_slice", "slices")))


def _means(df, columns):
    """Means over packings by law, wall and number of particles."""
    return df.fillna({"wall": ""}).groupby(["law", "wall", "particles"], sort=False)[columns].mean().reset_index()


LOOKS = {
    ("laguerre", None): ("Laguerre", "o"),
    ("calibrated", "center"): ("contacts, calibrated", "s"),
    ("calibrated", "surface"): ("the same, temperatures at the wall", "D"),
    ("platonic", "center"): ("contacts, polyhedra", "^"),
}


def plot(df):
    """The paper's panels a and b: profiles, and |dT|/T of the particles, one panel for each law; errors by number."""
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=(14, 8.2))
    upper, lower = figure.subfigures(2, 1)
    left, right = upper.subplots(1, 2, width_ratios=(1.3, 1.0))
    _profiles(left, df)
    for (law, wall), (name, marker) in LOOKS.items():
        means = pick(df, law=law, wall=wall).groupby("particles")["rms_0.2"].mean()
        colour, fill = _colours()[law, wall]
        right.plot(means.index, means, marker=marker, color=colour, markerfacecolor=fill, label=name)
    right.set(xscale="log", yscale="log", xlabel="particles", ylabel="error rms at 0.2 s, % of the span")
    right.set_title("Error against the number of particles")
    upper.legend(*right.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    panels = lower.subplots(1, len(LOOKS), sharex=True, sharey=True)
    for axes, (law, wall) in zip(panels, LOOKS, strict=True):
        _particles(axes, df, law, wall)
    panels[0].set_ylabel("|dT|/T, T in degrees Celsius, %")
    lower.suptitle("In the paper's measure (its Fig. 5b): particles, and the largest in each slice", fontsize=12)
    lower.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def _colours():
    """Colour of the line and of the inside of the marker, by law and wall."""
    from studies.harness.figures import BLUE, PINK, RED

    inside = {("calibrated", "surface"): "white"}
    line = {"laguerre": RED, "calibrated": PINK, "platonic": BLUE}
    return {(law, wall): (line[law], inside.get((law, wall), line[law])) for law, wall in LOOKS}


def _largest(df, law, wall):
    """First packing of a law with most particles; None without rows."""
    rows = pick(df, law=law, wall=wall, seed=0)
    return rows.loc[rows["particles"].idxmax()] if len(rows) else None


def _profiles(axes, df):
    """Exact temperatures over the height, and means over slices of the largest packing of each law."""
    from references import series
    from studies.harness.figures import BLACK

    y = np.linspace(0.0, 1.0, 201)
    points = np.column_stack([np.full(201, 0.5 * LENGTH), y * LENGTH, np.full(201, 0.5 * LENGTH)])
    for t, exact in zip(TIMES, series.evolve(slab(), TIMES, points_per_axis=1), strict=True):
        warm = exact.temperature_at(points)
        axes.plot(y, warm, color=BLACK, linewidth=0.8, label="exact" if t == TIMES[0] else None)
        axes.annotate(f"{t:g} s", (0.6, warm[120]), xytext=(-26, 6), textcoords="offset points", fontsize=9)
    for (law, wall), (name, marker) in LOOKS.items():
        row = _largest(df, law, wall)
        if row is None or wall == "surface":
            continue
        at, label = numbers(row["profile_y"]), f"{name}, {row['particles']:.0f}"
        for t in TIMES:
            values = numbers(row[f"profile_{t:g}"])
            axes.plot(at, values, marker, color=_colours()[law, wall][0], markersize=4, fillstyle="none", label=label)
            label = None
    axes.set(xlabel="y / L", ylabel="temperature, C", title="Temperature in time: exact, and means over slices")
    axes.legend(loc="upper left")


def _particles(axes, df, law, wall):
    """|dT|/T of some particles of the largest packing of a law, and the largest in each slice, at the three times."""
    from studies.harness.figures import BLACK, GREEN, GREY, ORANGE

    row = _largest(df, law, wall)
    axes.set(xlabel="y / L", yscale="log", ylim=(1e-4, 20))
    axes.axhline(PAPER["worst_relative"], color=BLACK, linewidth=1, label="printed: largest, 1e5 elements")
    if row is None or "dots_y" not in row or row["dots_y"] != row["dots_y"]:
        return
    axes.set_title(f"{LOOKS[law, wall][0]},\n{row['particles']:.0f} particles", fontsize=10)
    middle = (np.arange(SLICES) + 0.5) / SLICES
    for t, colour in zip(TIMES, (ORANGE, GREEN, GREY), strict=True):
        axes.plot(numbers(row["dots_y"]), numbers(row[f"dots_{t:g}"]), ".", color=colour, markersize=2, alpha=0.6)
        axes.plot(middle, numbers(row[f"dots_most_{t:g}"]), "-", color=colour, linewidth=1.2, label=f"{t:g} s")
