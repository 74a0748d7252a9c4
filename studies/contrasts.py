"""Iterations against the contrast: from a hundred to a trillion and to infinity, with a resistance and without.

One sphere in a periodic cell, 83 at random, and a chain of three that touch across most of it. Bodies that conduct very
well, or perfectly, are one unknown each, or are deflated, so that the conjugate gradients of the DEM and of finite
elements should not feel how well; the FFT has voxels of its own for perfect conductors and none for a finite trillion,
where it says that it does not converge. Finite elements refuse spheres that touch and would take a minute for 83.
"""

import math
import warnings

from demheat import referee
from demheat.gallery import random_dispersion
from demheat.scene import Material, Scene, Sphere
from studies.harness import methods
from studies.harness.figures import look
from studies.harness.pick import pick

BODIES = ("one", "83", "chain")
TITLES = {"one": "one sphere", "83": "83 spheres", "chain": "three that touch"}
CONTRASTS, RESISTANCES = (1e2, 1e6, 1e9, 1e12, math.inf), (0.0, 0.05)
RADIUS, LINKS = 1 / 3, 3
# What each method is given; a resistance is for laminates of its voxels.
GIVEN = {"dem": {"particles": 8_000, "seed": 0}, "fem": {"size": 0.1}, "fft": {"voxels": 32, "max_iterations": 2_000}}
WITHOUT = {"fem": ("83", "chain")}
# What was asked for before any was counted: at a trillion at most so many times those at a hundred.
MOST, FAR = 2.0, 1e12
BLIND = ("dem", "fem")
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "and at infinity": "iterations stop at 1e-8 of the heat, of either",
    "chain without": "what a contact passes has terms beside the logarithm",
}
CASES = [
    {"body": body, "resistance": resistance, "contrast": contrast, "method": method}
    for method in GIVEN
    for body in BODIES
    if body not in WITHOUT.get(method, ())
    for resistance in RESISTANCES
    for contrast in CONTRASTS
]
VALUES = True


def QUICK(case):
    """One sphere without a resistance."""
    return case["body"] == "one" and case["resistance"] == 0


def scene_of(body, resistance, contrast) -> Scene:
    """Spheres so many times as conducting as their matrix, in a unit cell."""
    if body == "83":
        places = [(each.center, each.radius) for each in random_dispersion(83, fraction=0.2, edge=1.0).inclusions]
    elif body == "chain":
        radius = 0.5 / (LINKS + 1)
        places = [(((2 * n + 1) * radius, 0.5, 0.5), radius) for n in range(LINKS)]
    else:
        places = [((0.5,) * 3, RADIUS)]
    spheres = [Sphere(center, radius, Material(contrast), resistance=resistance) for center, radius in places]
    return Scene((1.0,) * 3, Material(1.0), spheres, gradient=(1.0, 0.0, 0.0))


def run(body, resistance, contrast, method):
    """Iterations and the conductivity; a refusal is a result."""
    with warnings.catch_warnings():
        # Of gaps that elements do not resolve: iterations are what is counted.
        warnings.simplefilter("ignore", UserWarning)
        try:
            field = methods.load(method).solve(scene_of(body, resistance, contrast), **GIVEN[method])
        except (NotImplementedError, RuntimeError) as error:
            return {"status": "unsupported", "note": f"refused: {' '.join(str(error).split())}"}
    return {"iterations": field.stats["iterations"], "conductivity": field.conductivity}


def claims(df):
    """Blind to the contrast, and no jump between a trillion and infinity.

    The factor of two was set before any iteration was counted. What spheres that touch lack of infinity falls as one
    over the logarithm of the contrast, as what a contact passes grows with it (Batchelor and O'Brien 1977): that was
    found when a thousandth was asked of all and the chain lacked two hundredths; then the others were held to 1e-6.
    """
    for method in BLIND:
        for resistance in RESISTANCES:
            worst = max(_grown(df, method, resistance), default=None)
            words = "with a resistance" if resistance else "without"
            yield f"{method.upper()}, {words}: iterations at {FAR:.0e} over those at 100, largest", worst, MOST
        # Spheres that touch and do not resist close in on infinity as slowly as a logarithm.
        pairs = _pairs(df[(df["body"] != "chain") | (df["resistance"] > 0)], method, "conductivity", FAR, math.inf)
        off = max((abs(referee.value_error(*pair)) for pair in pairs), default=None)
        yield f"{method.upper()}: conductivity at {FAR:.0e} and at infinity, largest difference, relative", off, 1e-6
    yield (
        "DEM, chain without a resistance: what lacks of infinity times ln(contrast), 1e12 over 1e6, less 1",
        _log(df),
        0.05,
    )


def _log(df):
    """How far what a touching chain lacks of infinity is from falling as one over the logarithm of the contrast."""
    rows = df[(df["method"] == "dem") & (df["body"] == "chain") & (df["resistance"] == 0)]
    lacking = []
    for contrast in (FAR, CONTRASTS[1]):
        for one, limit in _pairs(rows, "dem", "conductivity", contrast, math.inf):
            lacking.append((limit - one) * math.log(contrast))
    return abs(referee.value_error(*lacking)) if len(lacking) == 2 else None


def _grown(df, method, resistance):
    rows = df[df["resistance"] == resistance]
    return [far / near for far, near in _pairs(rows, method, "iterations", FAR, CONTRASTS[0])]


def _pairs(df, method, column, one, other):
    """Values at two contrasts, of each body and resistance that has both."""
    for body in BODIES:
        for resistance in RESISTANCES:
            rows = [pick(df, method=method, body=body, resistance=resistance, contrast=c) for c in (one, other)]
            values = [each[column].dropna() for each in rows if column in each]
            if len(values) == 2 and all(len(each) == 1 for each in values):
                yield tuple(float(each.iloc[0]) for each in values)


def table(df):
    """Iterations by method, body and resistance (over the radius of one and the matrix's conductivity), by contrast."""
    cells = df.assign(cell=[_cell(row) for row in df.to_dict("records")], contrast=df["contrast"].map("{:.0e}".format))
    wide = cells.pivot(index=["method", "body", "resistance"], columns="contrast", values="cell")
    return wide[list(dict.fromkeys(cells["contrast"]))].fillna("").reset_index()


def _cell(row):
    return f"{row['iterations']:.0f}" if row["status"] == "ok" else "no"


def plot(df):
    """Iterations over the contrast."""
    from matplotlib import pyplot

    figure, grid = pyplot.subplots(1, len(BODIES), figsize=(11, 3.8), sharey=True)
    finite = [c for c in CONTRASTS if c < math.inf]
    places = {c: c for c in finite} | {math.inf: 1e3 * finite[-1]}
    for axes, body in zip(grid, BODIES, strict=True):
        for method in GIVEN:
            for resistance, line in zip(RESISTANCES, ("-", "--"), strict=True):
                rows = pick(df, method=method, body=body, resistance=resistance)
                rows = rows[rows["status"] == "ok"].sort_values("contrast")
                label = f"{method.upper()}{', resistance' if resistance else ''}"
                style = look(method, label=label, linestyle=line)
                axes.plot(rows["contrast"].map(places), rows["iterations"], **style)
        axes.set(xscale="log", yscale="log", title=TITLES[body], xlabel="contrast")
        axes.set_xticks(list(places.values()), [*(f"1e{math.log10(c):.0f}" for c in finite), "infinity"])
    grid[0].set_ylabel("iterations")
    figure.legend(*grid[0].get_legend_handles_labels(), loc="outside lower center", ncols=6)
    return figure
