"""A beam heated at one end: temperatures in time, by all laws, against the exact series.

Terreros, Iordanoff, Charles, Comput. Mater. Sci. 69 (2013) 46, figure 10: an aluminium cylinder, 2.184 mm long and
0.116 mm in radius, at 298 K, 798 K at x = 0 from time 0 on, insulated elsewhere; 19465 elements, radii +-7.5 %; 1, 10,
50 and 100 ms. Errors are over all particles or nodes, in per cent of the span of 500 K. Laws: facets of the radical
tessellation ("laguerre"); contacts calibrated between the beam's ends ("calibrated"); the paper's regular polyhedra
("platonic") with a mean of 7.2 contacts, where its errors of capacity and conductance nearly cancel, and of 6.2: the
paper states none. Temperatures of the contact laws act in the centres of the particles at the end, as in the papers.

A beam between a temperature and insulation shows the diffusivity alone. Beside it stand the network's steady
conductivity between its two ends, and its heat capacity, both over the material's. Temporal accuracy is 1e-5 of the
span. Packings are relaxed ones, at a packing fraction of 0.64; the paper names neither an algorithm nor a fraction.
"""

import numpy as np

from demheat import referee
from studies.common.cases import laws_by_size
from studies.common.slices import slice_means
from studies.harness.cells import cell, numbers
from studies.harness.pick import pick
from studies.harness.printed import printed
from studies.harness.tolerance import Tolerance

# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "Largest heat lost over heat moved": "rounding of sums over all particles and steps",
    "Laguerre: steady conductivity off": "the tolerance of the equations, 1e-8, which a uniform body happens to beat",
}
PAPER = printed("fig10_beam")
TIMES = (0.001, 0.01, 0.05, 0.1)
NUMBERS = (2_000, int(PAPER["particles"]))
SEEDS = (0, 1, 2)
LAWS = (("laguerre", None), ("calibrated", 7.5), ("platonic", 7.2), ("platonic", 6.2))
ACCURACY = 1e-5
# Of one step: that of all steps together stays below the smallest error of the particles, about a thousandth of a %.
FEM_ACCURACY = 5e-7
SIZES = (0.08e-3, 0.05e-3)
TIMEOUT = 3600.0
# Linear equations of a step may end a step earlier on another processor of the same name: seen are 2e-6 % of the span.
TOLERANCES = {
    "(worst|rms|profile_error)_.*": Tolerance(0.0, 2e-5),
    "profile_.*": Tolerance(2e-6, 0.0),
}


def _cases():
    yield from laws_by_size(NUMBERS, LAWS, SEEDS)
    for size in SIZES:
        yield {"law": "tetrahedra", "size": size, "method": "fem"}


CASES = list(_cases())
VALUES = True


def QUICK(case):
    """One packing of 2000 for each law."""
    return case.get("particles") == NUMBERS[0] and case["seed"] == 0


def run(law, method, **case):
    """Errors at the four times, the profile, and of a network its steady conductivity and heat capacity."""
    return _elements(**case) if method == "fem" else _particles(law, **case)


def _particles(law, coordination, particles, seed):
    from demheat import evolve
    from studies.common.terreros import beam, packing_of, steady_conductivity

    scene = beam()
    packing = packing_of(scene, particles, seed)
    contact = {} if coordination is None else {"coordination": coordination}
    row = {"mean_radius": 1e6 * packing.radii.mean(), "phi": packing.phi}
    for field in _compared(evolve(scene, TIMES, packing=packing, law=law, accuracy=ACCURACY, **contact), row):
        last = field
    # Of a calibrated network the steady solve is the one that calibrates it.
    steady = steady_conductivity(packing, law, **contact) * last.stats["calibration"]
    capacity = float(last.samples.volumes.sum() / scene.volume)
    row |= {"conductivity": steady, "capacity": capacity, "diffusivity": steady / capacity}
    names = ("unknowns", "iterations", "residual", "integrator", "steps", "spectral_ratio", "energy_error")
    return row | {name: last.stats[name] for name in (*names, "calibration")}


def _elements(size):
    from references import fem
    from studies.common.terreros import beam

    row = {}
    for field in _compared(fem.evolve(beam(), TIMES, size=size, accuracy=FEM_ACCURACY), row):
        last = field
    names = ("unknowns", "iterations", "residual", "steps", "energy_error")
    return row | {name: last.stats[name] for name in names}


def _compared(fields, row):
    """The fields, with their errors put into the row one by one."""
    from references import series
    from studies.common.terreros import LENGTH, beam

    for field, exact in zip(fields, series.evolve(beam(), TIMES, points_per_axis=1), strict=True):
        off, t = referee.temperature_error(field, exact, unit="%"), f"{field.time:g}"
        x = off.points[:, 0] / LENGTH
        row |= {f"worst_{t}": off.max, f"rms_{t}": off.rms}
        middle, mean = slice_means(x, field.samples.temperature)
        row |= {"profile_x": cell(middle), f"profile_{t}": cell(mean)}
        row[f"profile_error_{t}"] = cell(slice_means(x, off.values)[1])
        yield field


def claims(df):
    """Laguerre at the paper's size; finite elements; what a transient hides of the Platonic law; heat.

    Limits of Laguerre are two to three times what was found, ratios and what the Platonic law hides at least a third of
    it.
    """
    return [*_accuracy(df), *_referee(df), *_hidden(df), *_balance(df)]


# Largest errors allowed to Laguerre at the four times, % of the span; those of 19465 particles, from .008, .005 and
# .0035, were lowered after the rows were there.
ALLOWED = {NUMBERS[-1]: (0.06, 0.004, 0.00085, 0.0015), NUMBERS[0]: (0.25, 0.03, 0.015, 0.0075)}


def _accuracy(df):
    for number, limits in ALLOWED.items():
        rows = pick(df, law="laguerre", particles=number)
        what = "the paper's 19465 particles" if number == NUMBERS[-1] else f"{number} particles"
        for t, limit in zip(TIMES, limits, strict=True):
            value = rows[f"worst_{t:g}"].max(skipna=False) if len(rows) else None
            yield f"Laguerre, {what}, {1e3 * t:g} ms: largest error, % of the span", value, limit
    for name, law, contacts, least in (("calibrated", "calibrated", 7.5, 30), ("Platonic", "platonic", 7.2, 50)):
        theirs = _means(df, law, contacts)["rms_0.01"] / _means(df, "laguerre", None)["rms_0.01"]
        text = f"Error rms at 10 ms, {name} over Laguerre, equal number of particles: least"
        yield text, theirs.min(skipna=False), f">= {least}"


def _means(df, law, contacts):
    columns = [f"rms_{t:g}" for t in TIMES]
    return pick(df, law=law, coordination=contacts).groupby("particles")[columns].mean()


def _referee(df):
    rows = pick(df, method="fem")
    worst = rows[[f"worst_{t:g}" for t in TIMES]].max(axis=1, skipna=False)
    # A fifth of what is asked of the particles.
    value = worst.min() if len(rows) else None
    yield "Finite elements, finest mesh, against the series: largest error, % of the span", value, 0.02


def _hidden(df):
    """What the transient does not show of the Platonic law."""
    for contacts, steady in ((7.2, 0.05), (6.2, 0.1)):
        rows = pick(df, law="platonic", coordination=contacts)
        text = f"Platonic law, {contacts} contacts:"
        for column, what in (("conductivity", "steady conductivity"), ("capacity", "heat capacity")):
            least = referee.value_error(rows[column], 1.0).min(skipna=False)
            yield f"{text} least excess of the {what}", least, f">= {steady:g}"
    full = pick(df, law="platonic", coordination=7.2, particles=NUMBERS[-1])
    if len(full):
        hidden = 100 * referee.value_error(full["conductivity"], 1.0)
        share = full[["worst_0.05", "worst_0.1"]].max(axis=1, skipna=False) / hidden
        text = "Platonic law, 7.2 contacts, 19465 particles: largest error at 50 and 100 ms over that of the steady"
        yield f"{text} conductivity", share.max(skipna=False), 0.1
    off = referee.value_error(pick(df, law="laguerre")["conductivity"], 1.0).abs().max(skipna=False)
    # Ten times the tolerance of the steady solve.
    yield "Laguerre: steady conductivity off the material's, relative", off, 1e-7


def _balance(df):
    rows = pick(df, method="dem")
    # Rounding of sums over particles and steps.
    yield "Largest heat lost over heat moved, networks", rows["energy_error"].max(skipna=False), 1e-12


def table(df):
    """Errors in per cent of the span, means over packings of one size; `worst` is the largest over particles or nodes.

    Size is the elements' edge, m.
    """
    return _shown(df, [f"{kind}_{t:g}" for kind in ("worst", "rms") for t in TIMES])


def notes(df):
    """What a transient hides, as a table; the paper's mean radius."""
    from studies.harness.table import markdown

    yield (
        "The network's steady conductivity between the beam's ends, its heat capacity and their quotient, over the "
        "material's; by construction 1 with calibrated contacts."
    )
    relative = ["conductivity", "capacity", "diffusivity"]
    found = _shown(pick(df, method="dem"), relative).drop(columns="size")
    found[relative] = found[relative].map(lambda value: "" if value != value else f"{value:.4f}")
    yield markdown(found)
    full = pick(df, law="laguerre", particles=NUMBERS[-1])
    if len(full):
        off = 100 * referee.value_error(full["mean_radius"].mean(), PAPER["mean_radius"])
        yield (
            f"Mean radius of {NUMBERS[-1]} particles: {full['mean_radius'].mean():.3f} um, {off:+.2f} % off the "
            "paper's, by the packing fraction of 0.64 that is chosen here."
        )


def _shown(df, columns):
    """Means over packings of one size."""
    keys = ["law", "coordination", "particles", "size"]
    df = df.assign(**{name: np.nan for name in (*keys, *columns) if name not in df})
    return df.groupby(keys, sort=False, dropna=False)[columns].mean().reset_index()


def plot(df):
    """Each time in a panel: temperature above, error below; what a transient shows, and what it hides."""
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=(14, 11))
    upper, lower = figure.subfigures(2, 1, height_ratios=(2.0, 1.0))
    panels = upper.subplots(2, len(TIMES), sharex=True, sharey="row")
    for (warm, off), t in zip(panels.T, TIMES, strict=True):
        _profile(warm, off, df, t)
    panels[0][0].set_ylabel("temperature, K")
    panels[1][0].set_ylabel("|mean error| in a slice, % of the span")
    upper.suptitle("The beam in time: exact (line) and means over twenty slices (points)", fontsize=12)
    upper.legend(*panels[1][0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    _shown_and_hidden(lower.subplots(), df)
    return figure


def _looks():
    """Colour, marker and name of each law."""
    from studies.harness.figures import BLUE, PINK, RED, SKY

    return {
        ("laguerre", None): (RED, "o", "Laguerre"),
        ("calibrated", 7.5): (PINK, "s", "calibrated, 7.5 contacts"),
        ("platonic", 7.2): (BLUE, "^", "Platonic, 7.2 contacts"),
        ("platonic", 6.2): (SKY, "v", "Platonic, 6.2 contacts"),
    }


def _profile(warm, off, df, t):
    from references import series
    from studies.common.terreros import LENGTH, RADIUS, beam
    from studies.harness.figures import BLACK

    x = np.linspace(0.0, 1.0, 201)
    points = np.column_stack([x * LENGTH, np.full(201, RADIUS), np.full(201, RADIUS)])
    (exact,) = series.evolve(beam(), [t], points_per_axis=1)
    warm.plot(x, exact.temperature_at(points), color=BLACK, linewidth=0.8)
    for (law, contacts), (colour, marker, name) in _looks().items():
        rows = pick(df, law=law, coordination=contacts)
        row = rows.loc[rows["particles"].idxmax()]
        at, values, errors = (numbers(row[name]) for name in ("profile_x", f"profile_{t:g}", f"profile_error_{t:g}"))
        warm.plot(at, values, marker, color=colour, fillstyle="none", markersize=5)
        label = f"{name}, {row['particles']:.0f} particles"
        look = {"color": colour, "linewidth": 1, "markersize": 3, "label": label}
        sizes = np.abs(errors)
        # Where the heat has not come yet there is nothing to be off.
        off.plot(at, np.where(sizes > 1e-5, sizes, np.nan), marker + "-", **look)
    warm.set_title(f"{1e3 * t:g} ms")
    off.set(xlabel="x / L", yscale="log", ylim=(1e-5, 10))


def _shown_and_hidden(axes, df):
    names = ("worst_0.05", "worst_0.1", "conductivity", "capacity", "diffusivity")
    for number, ((law, contacts), (colour, marker, name)) in enumerate(_looks().items()):
        rows = pick(df, law=law, coordination=contacts)
        rows = rows[rows["particles"] == rows["particles"].max()]
        means = [rows[column].mean() for column in names]
        heights = [*means[:2], *(100 * abs(referee.value_error(mean, 1.0)) for mean in means[2:])]
        place = np.arange(5) + 0.2 * (number - 1.5)
        # Points, as bars would have no foot on a logarithmic axis.
        axes.plot(place, np.maximum(heights, 1e-4), marker, color=colour, label=name)
        for at, height in zip(place, heights, strict=True):
            text = f"{height:.2g}" if height > 1e-4 else "0"
            above = {"xytext": (0, 5), "textcoords": "offset points", "ha": "center", "fontsize": 8}
            axes.annotate(text, (at, max(height, 1e-4)), **above)
    axes.axvline(1.5, color="black", linewidth=0.8, linestyle=":")
    shown = ["temperature, 50 ms", "temperature, 100 ms", "steady conductivity", "heat capacity", "diffusivity"]
    axes.set_xticks(range(5), shown)
    axes.set(yscale="log", ylim=(1e-4, 300), ylabel="error, %")
    axes.set_title(
        "What the transient shows (left), and errors of the network's constants (right): their quotient shows"
    )
    axes.grid(False, axis="x")
    axes.set_axisbelow(True)
