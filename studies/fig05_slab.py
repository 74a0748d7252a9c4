"""A slab heated from one side: temperatures in time, by all laws, against the exact series.

Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799), figure 5 and eq. 17: a cube of 0.1 m at 25 C, its wall y = L
at 35 C from time 0 on, its wall y = 0 at 25 C, the sides insulated; 0.05, 0.1 and 0.2 s. Its table 1 prints a heat
capacity of 0.9 J/(kg K), kept here. Laws: facets of the radical tessellation ("laguerre"), contacts calibrated in the
steady state ("calibrated", with wall temperatures in the centres of the particles at the wall as in the paper, or at
the wall), regular polyhedra ("platonic"). Errors are over all particles, in units of the span of 10 K; the paper's
measure, as it seems, is |dT|/T with T in degrees Celsius. Temporal accuracy is 1e-5 of the span.
"""

import numpy as np

from demheat import referee
from studies.common.slab import LENGTH, TIMES, packing_of, slab
from studies.common.slices import slice_means
from studies.harness.cells import cell, numbers
from studies.harness.pick import order, pick, present
from studies.harness.store import printed

NUMBERS = (1_000, 3_000, 10_000, 30_000, 100_000)
LAWS = (("laguerre", None), ("calibrated", "center"), ("calibrated", "surface"), ("platonic", "center"))
SEEDS = (0, 1, 2)
LIMITS = {0.05: 0.13, 0.1: 0.065, 0.2: 0.035}
ACCURACY = 1e-5
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


def _errors(field, exact):
    off, span = referee.temperature_error(field, exact, unit="K"), referee.span(field.scene, exact)
    y, temperature, t = off.points[:, 1] / LENGTH, field.samples.temperature, f"{field.time:g}"
    right = exact.temperature_at(off.points)
    local = referee.value_error(temperature, right, scale=right)
    middle, mean = slice_means(y, temperature)
    return {
        f"worst_{t}": 100 * off.max / span,
        f"rms_{t}": 100 * off.rms / span,
        f"relative_{t}": 100 * np.abs(local).max(),
        "profile_y": cell(middle),
        f"profile_{t}": cell(mean),
        f"profile_error_{t}": cell(100 * slice_means(y, off.values)[1] / span),
    }


def warm_up(law, wall, particles, seed, method):
    """Load and compile; the packing, kept or made anew, is not part of what is compared."""
    packing_of(particles, seed)
    # Wall temperatures at the wall need a bulk between the layers at the walls.
    run(law, wall, 3_000 if wall == "surface" else 500, 99, method)


def claims(df):
    """Laguerre's errors, order and heat, and the laws of contacts beside it.

    Limits at 1e5 particles lie 7 to 20 % above what was found; that of |dT|/T is a fourteenth of the paper's 0.7 %. The
    order expected is two; heat is kept to rounding.
    """
    yield from present([*_accuracy(df), *_order(df), *_balance(df)])


def _accuracy(df):
    full = pick(df, law="laguerre", particles=NUMBERS[-1])
    for t, limit in LIMITS.items():
        value = full[f"worst_{t:g}"].max() if len(full) else None
        yield f"Laguerre, 1e5 particles, {t:g} s: largest error, % of the span", value, limit
    measure = [f"relative_{t:g}" for t in TIMES]
    value = full[measure].max().max() if len(full) else None
    yield "Laguerre, 1e5 particles: largest |dT|/T in degrees Celsius, % (paper 0.7)", value, 0.05
    # A quick run has 1000 and 3000 particles only: errors go with N^(-2/3).
    small = pick(df, law="laguerre", particles=3_000)
    yield "Laguerre, 3000 particles, 0.2 s: error rms, % of the span", small["rms_0.2"].mean(), 0.25
    for law in ("calibrated", "platonic"):
        least = _smallest(df)
        ours, theirs = (least[least["law"] == name]["rms_0.2"].mean() for name in ("laguerre", law))
        yield f"Error rms at 0.2 s, {law} over Laguerre, equal number of particles", theirs / ours, ">= 3"


def _smallest(df):
    return df[df["particles"] == df["particles"].min()]


def _order(df):
    means = pick(df, law="laguerre").groupby("particles")["rms_0.2"].mean()
    slope = -3 * order(means.index, means)
    yield "Laguerre: order of the error rms at 0.2 s in the particle spacing", slope, ">= 1.5"


def _balance(df):
    yield "Largest heat lost over heat moved", df["energy_error"].max(), 1e-10
    walled = df["spectral_ratio"].max()
    yield "Spectral radius over the mean row (slivers: hundreds)", walled, 20.0


def table(df):
    """Errors in per cent of the span by law, wall and number of particles, means over packings.

    `worst` is the largest over particles, `relative` the largest |dT|/T in degrees Celsius.
    """
    shown = [f"{kind}_{t:g}" for kind in ("worst", "rms", "relative") for t in TIMES]
    found = df.fillna({"wall": ""}).groupby(["law", "wall", "particles"], sort=False)
    return found[[*shown, "steps", "spectral_ratio"]].mean().reset_index()


def plot(df):
    """Profile and error of the largest rows of each law; errors against the number of particles."""
    from matplotlib import pyplot

    from studies.harness.figures import BLUE, PINK, RED

    figure, (left, middle, right) = pyplot.subplots(1, 3, figsize=(14, 4.6))
    looks = {"laguerre": (RED, "o"), "calibrated": (PINK, "s"), "platonic": (BLUE, "^")}
    _profiles(left, middle, df, looks)
    for (law, wall), rows in df.fillna({"wall": ""}).groupby(["law", "wall"], sort=False):
        means = rows.groupby("particles")["rms_0.2"].mean()
        colour, marker = looks[law]
        open_ = "white" if wall == "surface" else colour
        label = f"{law} {'(wall: ' + wall + ')' if wall else ''}"
        right.plot(means.index, means, marker=marker, color=colour, markerfacecolor=open_, label=label)
    right.set(xscale="log", yscale="log", xlabel="particles", ylabel="error rms at 0.2 s, % of the span")
    right.set_title("Error against the number of particles")
    right.legend()
    return figure


def _profiles(left, middle, df, looks):
    from references import series
    from studies.harness.figures import BLACK

    y = np.linspace(0.0, 1.0, 201)
    points = np.column_stack([np.full(201, 0.5 * LENGTH), y * LENGTH, np.full(201, 0.5 * LENGTH)])
    for t, exact in zip(TIMES, series.evolve(slab(), TIMES, points_per_axis=1), strict=True):
        left.plot(y, exact.temperature_at(points), color=BLACK, linewidth=0.8)
        at = (0.54, exact.temperature_at(points)[108])
        left.annotate(f"{t:g} s", at, xytext=(-24, 8), textcoords="offset points", fontsize=8)
    for law, wall in (("laguerre", None), ("calibrated", "center"), ("platonic", "center")):
        rows = pick(df, law=law, wall=wall)
        row = rows.loc[rows["particles"].idxmax()]
        at = numbers(row["profile_y"])
        for t, style in zip(TIMES, ("-", "--", ":"), strict=True):
            colour, marker = looks[law]
            label = f"{law}, {row['particles']:.0f}" if t == TIMES[0] else None
            values, errors = (numbers(row[f"{kind}_{t:g}"]) for kind in ("profile", "profile_error"))
            left.plot(at, values, marker, color=colour, markersize=3, label=label)
            middle.plot(at, errors, style, color=colour, label=label)
    left.set(xlabel="y / L", ylabel="temperature, C", title="Lines: exact; points: means over slices")
    left.legend()
    middle.set(xlabel="y / L", ylabel="mean error in a slice, % of the span")
    middle.set_title("Error: .05 s (solid), .1 s (dashed), .2 s (dotted)")
    middle.legend()
