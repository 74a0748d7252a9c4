"""Were the twins' constants tuned to their benchmark? Each one varied on scenes that were never used for it.

The DEM puts mirrored pairs of particles at interfaces; how far from them, how densely, how far other particles keep
away, are constants that were found on a few scenes. `varied`: each constant times several factors, one at a time, on
scenes drawn by seed: unequal spheres of many materials, off-centre between walls, cut by walls, nested off their
centres, nearly touching, of strong contrast. `reference`: what multipoles or fine elements say of these. `order`: on a
sphere, where the error of the conductivity comes from and with which power of the particle size each part falls.
"""

from demheat.runtime.lazy import lazy_names
from studies.harness.pick import pick
from studies.harness.tolerance import Tolerance
from studies.tuning.cases import COARSE, GROUPS, MOST_MESHED, NEARER, OLD, PACKINGS, SCENES, SPHERE, cases
from studies.tuning.scenes import FAMILIES, MESHED

__getattr__, __dir__ = lazy_names(__name__, {"studies.tuning.tables": ("table",), "studies.tuning.figure": ("plot",)})

# Rounding of sums over thousands of cells, %: a processor's own.
TOLERANCES = {"volume": Tolerance(0.0, 1e-10)}
# What another value must gain in every family to be called a clear win.
GAIN = 0.2
# As shipped, with offsets of a half, and with the margin that there was before.
BASE = ((None, 1.0), ("OFFSET", 0.7), ("MARGIN", 0.372))
NAMES = {"RELAXED": "relaxed packings", "BEFORE": "relaxed packings with the twins of 0.2.0"}
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "median error over that of relaxed packings": "one limit for all numbers, that of what was to be no worse",
    "error with twins nearer by 0.7": "half a power, as for all orders",
    "largest doubt of a witness": "one limit for all numbers of particles",
    "Layer under an inclined gradient": "iterated to 1e-10 of the heat, 1e-8 %",
}
# Why claims on the stored rows fail.
FAILS = {
    "largest doubt of a witness": "finite elements beside errors that are a ninth of what they were: of 8000 particles",
    "100000 particles: median error over that of relaxed packings with the twins of 0.2.0": (
        "seven scenes, less two that only elements know; the fewer particles, the more there was to take away"
    ),
    "|mean error| as shipped over its standard error": (
        "what is left of the third order has one sign, see docs/decisions/order.md"
    ),
    "Sphere, error: order in the particle size less 3": (
        "powers of unlike sign add up: an order fitted over a decade is no property of the scheme"
    ),
    "scatter of a packing's error": "2.5 is what independent errors of the bulk would leave; why it is more is open",
}


CASES = list(cases())
VALUES = True


def QUICK(case):
    """Few particles: witnesses without meshes, as shipped and with two values that were left; the coarsest packings."""
    if case["part"] == "reference":
        return case["family"] in ("walled", "close", "strong")
    if case["part"] == "varied":
        return case["particles"] == 2_000 and (case["constant"], case["factor"]) in BASE
    return case["particles"] <= 1_000 and case["constant"] is None and case["contrast"] == 10.0


def run(part, particles=None, group=None, family=None, constant=None, factor=1.0, *, method, **probe):
    """Conductivities of a group of scenes, by a witness or by the DEM with one constant changed; or parts of errors."""
    from studies.tuning import order, rows

    if part == "reference":
        return rows.references(family, range(*GROUPS[group]))
    changed = {"constant": constant, "factor": factor, "particles": particles}
    if part == "order":
        return order.decomposed(**probe, **changed, packings=PACKINGS[particles])
    families = [family for family in FAMILIES if family not in MESHED or particles <= MOST_MESHED]
    return rows.varied(families, range(*GROUPS[group])[: SCENES[particles]], **changed)


def claims(df):
    """Shipped values are near the best, without bias; parts of the error fall as theory says.

    Tiles may be worse than relaxed packings by 1.3; with today's twins a third of what there was before is asked for.
    Limits are those of the question: half as much again as the best value's error, two standard errors of the mean.
    Orders are held to half a power of theory's. All of them were set before the rows were there; what does not hold
    stands as FAIL: see docs/decisions/order.md. The fewest particles, on which quick rows are, say nothing of bias.
    When values were known the doubt of witnesses came down from .5, the layer from 1e-6, volumes from 1e-8.
    """
    from studies.tuning import means

    found = means.errors(df, "unseen")
    for particles in sorted(set(found["particles"])):
        yield from _levels(means, found[found["particles"] == particles], particles)
    yield from _orders(means, df)


def _levels(means, found, particles):
    sums, text = means.summed(found), f"{particles:.0f} particles"
    best = means.against_best(sums[~sums["constant"].isin(OLD)])
    ratio = best["ratio"].max() if len(best) else None
    yield f"{text}: median error as shipped over that of a constant's best value, worst constant", ratio, 1.5
    shipped = pick(sums, constant="").iloc[0]
    bias = abs(shipped["mean"] / shipped["sem"]) if particles > min(SCENES) else None
    yield f"{text}: |mean error| as shipped over its standard error", bias, 2.0
    for old, most in zip(OLD, (1.3, 1 / 3), strict=True):
        then = pick(sums, constant=old)
        ratio = shipped["median"] / then["median"].iloc[0] if len(then) and particles > min(SCENES) else None
        yield f"{text}: median error over that of {NAMES[old]}", ratio, most
    yield (
        f"{text}: largest doubt of a witness over the median error",
        found["doubt_percent"].max() / shipped["median"],
        0.15,
    )


def _orders(means, df):
    """Layers are exact, volumes too; what is off the exact temperature beside interfaces falls with the third power."""
    layer = means.parts(df, shape="layer")
    yield "Layer under an inclined gradient: |error|, %", abs(layer["error"]).max() if len(layer) else None, 1e-8
    sphere = means.parts(df, **SPHERE)
    yield "Sphere: |error of its volume|, %", abs(sphere["volume"]).max() if len(sphere) else None, 3e-10
    if len(sphere) < len(PACKINGS):
        return
    for text, table, name, theory in (
        ("misfit beside the interface", sphere, "misfit_beside", 3.0),
        ("error", sphere, "error", 3.0),
        (
            "error with twins nearer by 0.7, from 4000 particles on",
            _finer(means.parts(df, **SPHERE | NEARER)),
            "error",
            2.0,
        ),
        ("scatter of a packing's error", sphere, "error_scatter", 2.5),
    ):
        off = abs(means.fitted(table, name)[0] - theory)
        yield f"Sphere, {text}: order in the particle size less {theory:g}", off, 0.5


def _finer(table):
    return table[table["particles"] >= COARSE[1]]


def words(df):
    """Which values would be better than the shipped ones, by number of particles."""
    from studies.tuning import means

    found, parts = means.errors(df, "unseen"), []
    for particles, lines in found.groupby("particles"):
        better = means.wins(lines[~lines["constant"].isin(OLD)], GAIN)
        parts.append(f"{' and '.join(better) if better else 'nothing'} with {particles:.0f} particles")
    return f"the median error of every kind of scene is lowered by a fifth or more by {', by '.join(parts)}"
