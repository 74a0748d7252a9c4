"""A sheet under a moving source: temperatures at three points, their scatter over packings, against finite elements.

Terreros, Iordanoff, Charles, Comput. Mater. Sci. 69 (2013) 46, figures 12 to 15: an insulated aluminium sheet of 50 x
30 x 2 mm at 25 C; a cylinder of heat through its thickness, 8 mm in diameter, 1e11 W/m3, starts at x = 20 mm on the
middle line and moves along +x at 3.3 mm/s. Its rim reaches the edge at 7.8788 s; here it stops at 7.878 s. Checkpoints
A (9.5, -0.5), B (31, 0), C (41.5, -9.5) mm at half the thickness (the axes and the stop are inferred: the paper prints
neither). Five packings each of 1000, 5000 and 20000 particles, radii +-7.5 %; the paper's dispersion is the mean over
time of (max - min)/max over the five, in degrees Celsius, below 4 % at 20000. Finite elements are trilinear bricks of
0.5 mm as in the paper, compared with the mean of the five, per checkpoint, where the two differ most in time.

The source is unphysical: it heats the metal inside of it by 40730 K/s and the sheet on average by 1365 K/s, to more
than 10000 C. The problem is linear, so the comparison does not mind. A thousand particles are 1.3 diameters through the
thickness: there is no bulk, where contacts could be counted. Contacts are therefore those within the gap that gives
7.5 (law "calibrated", between the sheet's ends) or 7.2 (the paper's law, "platonic") of them in a periodic packing.
All laws get the same power, whatever heat capacity they make of the sheet.
"""

import numpy as np

from demheat import referee
from studies.common.cases import laws_by_size
from studies.harness.cells import cell, numbers
from studies.harness.pick import pick
from studies.harness.printed import printed

# Limits from elsewhere: what the paper prints.
ELSEWHERE = ("(paper: below 4)",)
PAPER = printed("fig12_15_sheet")
STOP, OUTPUTS = 7.878, 60
TIMES = tuple(STOP * (k + 1) / OUTPUTS for k in range(OUTPUTS))
NUMBERS = (1_000, 5_000, int(PAPER["particles"]))
SEEDS = (0, 1, 2, 3, 4)
LAWS = (("laguerre", None), ("platonic", 7.2))
# Edges of the bricks; the paper's is the middle one.
COARSE, ELEMENT, FINE = 1e-3, 1e-3 * PAPER["element"], 0.334e-3
NAMES = ("A", "B", "C")
ACCURACY = 1e-4
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "Heat received off power": "rounding of sums over all particles and steps",
    "Heat lost over heat moved": "rounding of sums over all particles and steps",
    "mean warming at the end": "rounding of sums over all particles and steps",
}
TIMEOUT = 3600.0


def _cases():
    yield from laws_by_size(NUMBERS, LAWS, SEEDS)
    for size in (COARSE, ELEMENT, FINE):
        yield {"law": "hexahedra", "size": size, "method": "fem"}


CASES = list(_cases())
VALUES = True


def QUICK(case):
    """Two packings of 1000 for the tessellation and the paper's law; bricks of 1 mm."""
    if case["method"] == "fem":
        return case["size"] == COARSE
    return case["particles"] == NUMBERS[0] and case["seed"] < 2 and case["law"] != "calibrated"


def run(law, method, **case):
    """Temperatures at the checkpoints in time, heat capacity and heat of the sheet."""
    from studies.common.terreros import POINTS, sheet

    scene, curves = sheet(), []
    points = np.array([POINTS[name] for name in NAMES])
    for field in _fields(scene, law, method, **case):
        curves.append(field.temperature_at(points))
        last = field
    row = {name: cell(curve) for name, curve in zip(NAMES, np.transpose(curves), strict=True)}
    volumes, temperature = last.samples.volumes, last.samples.temperature
    row |= {"capacity": float(volumes.sum() / scene.volume), "mean": float(volumes @ temperature / volumes.sum())}
    stats = last.stats
    names = ("unknowns", "iterations", "residual", "integrator", "steps", "rejected", "energy_error")
    return row | {"heat": stats["heat_in"]["sources"]} | {name: stats[name] for name in names if name in stats}


def _fields(scene, law, method, **case):
    if method == "fem":
        from references import fem

        return fem.evolve(scene, TIMES, elements=law, size=case["size"], accuracy=ACCURACY / 5)
    from demheat import evolve
    from studies.common.terreros import bulk_gap, packing_of

    packing, contact = packing_of(scene, case["particles"], case["seed"]), {}
    if case["coordination"] is not None:
        contact = {"gap": bulk_gap(case["coordination"])}
    return evolve(scene, TIMES, packing=packing, law=law, accuracy=ACCURACY, **contact)


def curves_of(rows, name):
    """Curves of a checkpoint, one row per packing, (packings, times) float array, degrees Celsius."""
    return np.array([numbers(text) for text in rows[name]])


def reference(df):
    """Row of the bricks to compare with: the paper's if it is there, else the finest."""
    rows = pick(df, law="hexahedra")
    rows = rows[rows["status"] == "ok"]
    return rows.iloc[(rows["size"] - ELEMENT).abs().argsort()[:1]]


def compared(df, law, particles, name):
    """Dispersion over packings; largest difference of the bricks from the packings' mean, and its time."""
    curves = curves_of(pick(df, law=law, particles=particles), name)
    off = referee.curve_error(curves_of(reference(df), name)[0], curves.mean(axis=0))
    found = {"off": 100 * off.local, "at": TIMES[off.at], "span": 100 * off.highest, "end": 100 * off.last}
    return {"dispersion": 100 * referee.dispersion(curves)} | found


def claims(df):
    """Scatter over packings; packings beside bricks, bricks beside finer ones; heat.

    The paper's dispersion, below 4 % with 20000 elements, is asked of its own law there and of 1000 particles of the
    tessellation; other limits are two to three times what was found, the largest of the three checkpoints.
    """
    return [*_scatter(df), *_against_bricks(df), *_bricks(df), *_balance(df)]


def _worst(df, law, particles, key):
    """Largest size of a measure of `compared` at any checkpoint; None without rows."""
    if not len(pick(df, law=law, particles=particles)):
        return None
    return max(abs(compared(df, law, particles, name)[key]) for name in NAMES)


def _scatter(df):
    for particles, limit in zip(NUMBERS, (1.0, 0.28, 0.09), strict=True):
        text = f"Laguerre, {particles} particles: dispersion over packings, %, largest of the checkpoints"
        yield text, _worst(df, "laguerre", particles, "dispersion"), limit
    text = "Platonic, 20000 particles: dispersion over packings, %, largest of the checkpoints (paper: below 4)"
    yield text, _worst(df, "platonic", NUMBERS[-1], "dispersion"), f"< {PAPER['dispersion']:g}"


def _against_bricks(df):
    # Where the difference is largest early, a checkpoint barely warm, a kelvin is some per cent of it: with 1000
    # particles A is 3.4 K off at 0.13 s, 5.8 % of the 58 C there are then.
    for particles, *limits in zip(NUMBERS, (12.0, 6.0, 1.5), (0.8, 0.28, 0.1), strict=True):
        text = f"Laguerre, {particles} particles: largest difference from bricks at any checkpoint,"
        yield f"{text} % of the temperature then", _worst(df, "laguerre", particles, "off"), limits[0]
        yield f"{text} % of the highest temperature", _worst(df, "laguerre", particles, "span"), limits[1]
    ratios = (
        compared(df, "platonic", NUMBERS[0], name)["span"] / compared(df, "laguerre", NUMBERS[0], name)["span"]
        for name in NAMES
    )
    # Platonic temperatures lack what its excess of heat capacity, a tenth, takes up.
    text = "1000 particles: largest difference from bricks, % of the highest, Platonic over Laguerre, least of the"
    yield f"{text} checkpoints", min(ratios), ">= 15"


def _bricks(df):
    fine, paper = (pick(df, law="hexahedra", size=size) for size in (FINE, ELEMENT))
    if len(fine) and len(paper):
        pairs = [[curves_of(rows, name)[0] for rows in (paper, fine)] for name in NAMES]
        # Twice what 0.5 mm are off: far below what packings are compared by. Where A is barely warm, at 0.26 s, the
        # same difference is 0.4 % of the temperature then.
        text = "Bricks of 0.5 mm against a third of a mm: largest difference at any checkpoint, % of the highest"
        yield f"{text} temperature", max(100 * referee.curve_error(*pair).highest for pair in pairs), 0.05


def _balance(df):
    import math

    from studies.common.terreros import AMBIENT, DIAMETER, METAL, POWER, SHEET

    given = POWER * math.pi / 4 * DIAMETER**2 * SHEET[2] * STOP
    off = referee.value_error(df["heat"], given).abs().max(skipna=False)
    # Rounding of sums over steps; the power does not change.
    yield "Heat received off power times time, relative, all methods", off, 1e-12
    yield "Heat lost over heat moved, all methods", df["energy_error"].max(skipna=False), 1e-11
    warmer = given / (METAL.density * METAL.heat_capacity * math.prod(SHEET))
    laguerre = pick(df, law="laguerre")
    off = referee.value_error(laguerre["mean"] - AMBIENT, warmer).abs().max(skipna=False)
    # The same balance, read from the temperatures.
    yield "Laguerre: mean warming at the end off heat over capacity, relative", off, 1e-12
    excess = referee.value_error(pick(df, law="platonic")["capacity"], 1.0).min(skipna=False)
    yield "Platonic law: least excess of the sheet's heat capacity", excess, ">= 0.02"


def table(df):
    """Scatter over packings at the checkpoints (the paper's dispersion, below 4 % with 20000), %; mean capacity.

    The heat capacity is that of the network over the body's.
    """
    return _lines(df, ("dispersion",), capacity=True)


def notes(df):
    """Differences from bricks, and why the Platonic law is not better with 20000 particles than with 5000."""
    from studies.harness.table import markdown

    yield (
        "Difference of the bricks from the mean of the packings, as the paper compares its FEM: `off` is bricks minus "
        "mean over that mean, %, at the time, s, at which the two differ most; `span` its size over the highest mean, "
        "%; `end` as off, at the last time."
    )
    yield markdown(_lines(df, ("off", "at", "span", "end")))
    yield from _of_platonic(df)


def _lines(df, keys, *, capacity=False):
    import pandas as pd

    df, found = df[df["status"] == "ok"], []
    for (law, particles), rows in pick(df, method="dem").groupby(["law", "particles"], sort=False):
        line = {"law": law, "particles": particles}
        if capacity:
            line |= {"packings": len(rows), "capacity": f"{rows['capacity'].mean():.4f}"}
        for name in NAMES:
            here = compared(df, law, particles, name)
            line |= {f"{name} {key}": here[key] for key in keys}
        found.append(line)
    return pd.DataFrame(found)


def _of_platonic(df):
    """Temperature rises of the Platonic law beside what its heat capacity takes up."""
    rows, said = pick(df, law="platonic", status="ok"), []
    excess = 100 * referee.value_error(rows.groupby("particles")["capacity"].mean(), 1.0)
    if len(excess) < len(NUMBERS):
        return
    for number in excess.index:
        ends = ", ".join(f"{compared(df, 'platonic', number, name)['end']:.1f}" for name in NAMES)
        said.append(
            f"{number:.0f} particles: capacity {excess[number]:.1f} % too large, bricks warmer at the end by {ends} %"
        )
    yield (
        f"The Platonic law at A, B, C: {'; '.join(said)}. It is worse with 20000 than with 5000 since its error of the "
        "heat capacity does not fall with the number: with the gap that gives 7.2 contacts it is 8 to 9 % in the bulk "
        "(study table1_platonic), and another one near the sheet's faces, where all particles of a coarse packing are. "
        "All laws get the same power, so temperatures lack what the capacity is too large by."
    )


def plot(df):
    """Curves at the checkpoints, band over packings; scatter, and difference from bricks, against their number."""
    from matplotlib import pyplot

    from studies.harness.figures import BLACK

    df = df[df["status"] == "ok"]
    figure = pyplot.figure(figsize=(14, 12))
    upper, lower = figure.subfigures(2, 1, height_ratios=(1.0, 1.7))
    curves, scatter = upper.subplots(1, 3), lower.subplots(2, 3, sharex=True, sharey="row")
    for axes, name in zip(curves, NAMES, strict=True):
        _curves(axes, df, name)
        axes.set_title(f"Checkpoint {name}")
    curves[0].set_ylabel("temperature, C")
    upper.suptitle("Bricks (line), mean of five packings (dashed) and their band, most particles", fontsize=12)
    upper.legend(*curves[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    for (dispersion, off), name in zip(scatter.T, NAMES, strict=True):
        _against_number(dispersion, df, name, "dispersion", f"{name}: dispersion over packings")
        limit = {"color": BLACK, "linestyle": ":", "linewidth": 1, "label": "paper's limit with 20000"}
        dispersion.axhline(PAPER["dispersion"], **limit)
        _against_number(off, df, name, "span", f"{name}: largest difference from bricks")
        off.set_xlabel("particles")
    scatter[0][0].set_ylabel("mean of (max - min) / max, %")
    scatter[1][0].set_ylabel("% of the highest temperature")
    lower.legend(*scatter[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def _colours():
    from studies.harness.figures import BLUE, PINK, RED

    return {"laguerre": RED, "platonic": BLUE, "calibrated": PINK}


def _curves(axes, df, name):
    """Temperature in time of the bricks and of the largest packings of each law."""
    from studies.harness.figures import BLACK

    axes.plot(TIMES, curves_of(reference(df), name)[0], color=BLACK, linewidth=0.9, label="bricks")
    for law, most in pick(df, method="dem").groupby("law")["particles"].max().items():
        mine = curves_of(pick(df, law=law, particles=most), name)
        axes.fill_between(TIMES, mine.min(axis=0), mine.max(axis=0), color=_colours()[law], alpha=0.3)
        axes.plot(TIMES, mine.mean(axis=0), "--", color=_colours()[law], label=f"{law}, {most:.0f} particles")
    axes.set(xlabel="time, s", xlim=(0, 8), ylim=(0, None))


def _against_number(axes, df, name, key, title):
    """A measure of `compared` against the number of particles, by law."""
    from matplotlib import ticker

    for law, rows in pick(df, method="dem").groupby("law"):
        numbers = sorted(rows["particles"].unique())
        values = [compared(df, law, number, name)[key] for number in numbers]
        axes.plot(numbers, values, "o-", color=_colours()[law], label=law)
    axes.set(xscale="log", yscale="log", title=title, xlim=(750, 28_000))
    axes.set_xticks(NUMBERS, [f"{number}" for number in NUMBERS])
    axes.minorticks_off()
    axes.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
