"""zeta_2 of the very microstructure: exact arrays, voxels against multipoles, equilibrium and random addition.

Milton's parameter decides the third-order bounds, and Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799) call
it very costly to compute. Here it is the periodic Green projector's on voxels (`references.zeta`) and, for spheres,
exact by multipoles (`references.multipole`), which is held against Rayleigh's sums over cubic lattices. Random cells
of 6 sphere diameters: "lsa" by the Lubachevsky-Stillinger algorithm, which leaves spheres much as in equilibrium where
no gap is asked for, "rsa" added one by one where there is room. The polynomial is that of Miller and Torquato (J.
Appl. Phys. 68 (1990) 5486) for equal hard spheres in equilibrium. S2 is the two-point probability along exact lines;
its slope at 0 is minus a quarter of the specific surface, 3 f/R.
"""

import math

import numpy as np

from demheat import referee
from demheat.runtime.lazy import lazy_names
from studies.harness.pick import largest, pick
from studies.zeta2.means import below, pooled, with_bounds

__getattr__, __dir__ = lazy_names(__name__, {"studies.zeta2.figure": ("plot",)})

MULTIPOLE, VOXELS, S2 = "multipole", "zeta", "statistics"
MODULES = {S2: "demheat.packing.statistics"}
DILUTE = 4 * math.pi / 81  # SC with radii of a third of the edge
ARRAYS = (("sc", 0.5), ("sc", DILUTE), ("bcc", 0.5), ("fcc", 0.5))
# Exact values, as known elsewhere: to half a unit of the last digit.
KNOWN = {("sc", 0.5): (0.17376, 5), ("sc", DILUTE): (0.00200341, 8)}
GRIDS, ON_RANDOM = (32, 64, 128, 256), (128, 256)
FRACTIONS = (0.1, 0.2, 0.3, 0.4, 0.5)
SHOWN = 0.3  # fraction whose S2 is drawn, of cells of every kind
# How placed, smallest gap in diameters, fractions: one by one they jam near 0.38.
PLACED = (
    *(("lsa", 0.0, FRACTIONS), ("lsa", 0.02, (*FRACTIONS[:3], FRACTIONS[-1]))),
    *(("rsa", 0.0, FRACTIONS[:3]), ("rsa", 0.02, FRACTIONS[:3])),
)
RATIO, LARGER = 6.0, 9.0
# Realisations come in rows of five; the scatter of one, 2 to 23 %, leaves means of ten within 2 to 17 %, at 95 %.
AT_ONCE, REALISATIONS = 5, 10
# Errors of voxels, %, by their number along an edge: on SC, on dilute SC, on BCC and FCC; on random cells.
VOXEL_LIMITS = {64: (1.0, 8.0, 1.5), 128: (0.3, 1.0, 0.25), 256: (0.08, 0.8, 0.045)}
RANDOM_LIMITS = {128: 4.0, 256: 1.2}
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "Rayleigh's lattice sums": "zeta_2 comes from a_3 with an amplification of up to 200, of rounding 1e-14 and more",
    "in standard errors": "three standard errors pass once in 370 times by chance, whatever is found",
}
# Why claims on the stored rows fail.
FAILS = {
    "LSA without gap against the polynomial": (
        "at f = .1 alone: its ten cells scatter half as much as the thirty of that fraction that were placed otherwise "
        "or with a gap, and with the scatter of these it is 1.9 standard errors"
    ),
    "RSA below LSA, both with a gap of 0 D": (
        "the ten LSA cells of f = .1 happen to lie low: by those of .2 and .3 alone it is 7.4 %, 3.5 standard errors"
    ),
    "truncation left": (
        "the limit was set for what changes of degrees tell; what is told now is half of an interval, which gaps of "
        ".02 diameters ask to be wider at degree 10: beside degree 20, known to 9e-7, the worst cell lacks 6.6e-5"
    ),
}


def _cases():
    for array, fraction in ARRAYS:
        for voxels in GRIDS:
            yield {"part": "array", "array": array, "fraction": fraction, "voxels": voxels, "method": VOXELS}
    for placed, gap, fractions in PLACED:
        for fraction in fractions:
            here = {"placed": placed, "gap": gap, "fraction": fraction, "ratio": RATIO, "first": 0}
            for first in range(0, REALISATIONS, AT_ONCE):
                yield {"part": "cells", **here, "first": first, "cells": AT_ONCE, "method": MULTIPOLE}
            # Voxels and lines do not know how spheres were placed: cells of one kind judge them.
            for voxels in ON_RANDOM if (placed, gap) == ("lsa", 0.0) else ():
                yield {"part": "voxels", **here, "voxels": voxels, "method": VOXELS}
            if (placed, gap) == ("lsa", 0.02):
                yield {"part": "conductivity", **here, "method": MULTIPOLE}
            if (placed, gap) == ("lsa", 0.0) or fraction == SHOWN:
                yield {"part": "surface", **here, "cells": AT_ONCE, "method": S2}
    # Whether six diameters are enough.
    larger = {"placed": "lsa", "gap": 0.0, "fraction": 0.2, "ratio": LARGER, "cells": AT_ONCE, "method": MULTIPOLE}
    yield {"part": "cells", **larger, "first": 0}


CASES = list(_cases())
VALUES = True


def QUICK(case):
    """Arrays on two coarse grids; five cells of either kind at f = 0.2, without a gap; one conductivity."""
    if case["part"] == "array":
        return case["voxels"] <= GRIDS[1]
    if case["part"] == "conductivity":
        return (case["placed"], case["fraction"]) == ("lsa", 0.1)
    if (case["fraction"], case["first"], case["ratio"], case["gap"]) != (0.2, 0, RATIO, 0.0):
        return False
    return case["part"] == "cells" or (case["placed"] == "lsa" and case.get("voxels") != ON_RANDOM[1])


def run(part, method, **where):
    """One row of a part, by the function of that name."""
    from studies.zeta2 import rows as zeta2_rows

    rows = {
        "array": zeta2_rows.array_row,
        "cells": zeta2_rows.cells_row,
        "voxels": zeta2_rows.voxels_row,
        "conductivity": zeta2_rows.conductivity_row,
        "surface": zeta2_rows.surface_row,
    }
    return rows[part](**where)


def claims(df):
    """Multipoles and voxels on arrays and cells; what equilibrium and a gap change; bounds; S2's slope.

    Means of cells are judged in their standard errors, three of which pass once in 370 times by chance. Voxels were
    held to 1 to 1.5 % on arrays half full, 10 % on dilute ones and 2 % on random cells whatever their number; when
    values were known limits of finer grids came down to less than three times these, as did that of the lattice sums
    from 1e-8, of means from 4 %, of the truncation from 3e-4 and of Torquato's estimate from 1 %.
    """
    yield from [*_arrays(df), *_random(df), *_statistics(df), *_bounds(df), *_surfaces(df)]


def _arrays(df):
    rows = pick(df, part="array")
    off = [
        referee.value_error(pick(rows, array=array, fraction=fraction)["exact"], value, scale=10.0**-digits).abs().max()
        for (array, fraction), (value, digits) in KNOWN.items()
    ]
    yield "Multipoles on SC arrays: off the known digits, in units of the last", max(off), 0.51
    lattice = referee.value_error(rows["exact"], rows["lattice"]).abs().max()
    yield "Multipoles on cubic arrays: relative difference from Rayleigh's lattice sums", lattice, 1e-11
    for voxels, (simple, dilute, others_too) in VOXEL_LIMITS.items():
        here = pick(rows, voxels=voxels)
        text = f"{voxels}^3 voxels, extrapolated, worst of three places on the grid: error on "
        yield text + "SC, f = 0.5, %", largest(pick(here, array="sc", fraction=0.5), "error_percent"), simple
        yield text + "dilute SC, a = L/3, %", largest(pick(here, fraction=DILUTE), "error_percent"), dilute
        others = here[here["array"].isin(("bcc", "fcc"))]
        yield text + "BCC and FCC, f = 0.5, %", largest(others, "error_percent"), others_too


def _random(df):
    # 128^3 is 21 to 22 voxels across a sphere, where the projector is not there yet.
    for voxels, limit in RANDOM_LIMITS.items():
        rows = pick(df, part="voxels", voxels=voxels)
        text = f"Random cells, {voxels}^3 voxels, extrapolated: worst error against multipoles, %"
        yield text, largest(rows, "error_percent"), limit


def _statistics(df):
    means = pooled(df)
    lsa, rsa = ({"placed": placed, "ratio": RATIO} for placed in ("lsa", "rsa"))
    free = pick(means, **lsa, gap=0.0)
    text = "LSA without gap against the polynomial, worst deviation of a mean: "
    # Beyond 0.4 the polynomial itself lies 1.7 % low, by simulations of our own: two standard errors there.
    dilute = free[free["fraction"] < 0.45]
    off = referee.value_error(dilute["zeta2"], dilute["polynomial"], scale=dilute["se"]).abs()
    yield text + "f <= 0.4, in standard errors", off.max(), 3.0
    # Of twenty cells 95 % of means lay within 3 % at f = 0.2, of ten within 4 %; within 1.5 % at f = 0.5, where the
    # fit may be 1.7 % low.
    dense = free[(free["cells"] == REALISATIONS) & (free["fraction"] > 0.15)]
    yield text + "f >= 0.2, %", largest(dense, "off_percent"), 3.5
    # Of the five cells of a quick run three standard errors are more than the difference itself.
    whole = means[means["cells"] >= REALISATIONS]
    for gap in (0.0, 0.02):
        yield _lower(whole, f"RSA below LSA, both with a gap of {gap:g} D", {**rsa, "gap": gap}, {**lsa, "gap": gap})
    yield _lower(whole, "LSA with a gap of 0.02 D below LSA without", {**lsa, "gap": 0.02}, {**lsa, "gap": 0.0})
    found, se = below(means, {**lsa, "gap": 0.0}, {**lsa, "gap": 0.0, "ratio": LARGER})
    value = None if found is None else abs(found) / se
    yield f"Cells of {RATIO:g} D against cells of {LARGER:g} D: difference in standard errors", value, 3.0


def _lower(means, text, lower, upper):
    found, se = below(means, lower, upper)
    if found is None:
        return text, None, ">= 3"
    return f"{text}: by {found:.1f} +- {1.96 * se:.1f} %, in standard errors", found / se, ">= 3"


def _bounds(df):
    rows = with_bounds(df)
    if not len(rows):
        return
    k, text = rows["conductivity"], "Silica in epoxy by multipoles, mean of three axes: "
    outside = [abs(referee.bound_violation(*each)) for each in zip(k, rows["lower"], rows["upper"], strict=True)]
    yield text + "outside the third-order bounds of its own cell by, relative", np.max(outside), 0.0
    # Found at degree 10: 1e-4 at f = 0.5, with surfaces 0.02 D apart.
    yield text + "truncation left, relative", rows["truncation"].max(skipna=False), 2e-4
    off = 100 * referee.value_error(rows["torquato"], k).abs().max(skipna=False)
    yield text + "Torquato's estimate with the cell's own zeta_2 is off by at most, %", off, 0.5


def _surfaces(df):
    rows = pick(df, part="surface")
    text = "Specific surface by the slope of S2 against 3 f/R, worst kind of cell: "
    yield text + "error, %", largest(rows, "error_percent"), 1.0
    # The largest of 16 normal deviates passes 3.5 once in 130 studies.
    deviations = (rows["error_percent"] / rows["error_se"]).abs().max() if len(rows) else None
    yield text + "error in its standard errors", deviations, 3.5


def table(df):
    """Cubic arrays on the finest grid, and random cells.

    `zeta_2` of arrays is exact, of random cells the mean over `cells` realisations with its 95 % confidence interval;
    `scatter` is the standard deviation of one realisation, %. `voxels` and `raw` are the errors, %, of the projector on
    the finest grid with and without extrapolation (for arrays the worst of three places, for random cells one
    realisation). `surface` is the error of the specific surface from S2's slope, %, with its standard error. The
    conductivities are those of silica in epoxy, W/(m K), for one realisation: by multipoles, mean of three axes, and
    the third-order bounds and Torquato's estimate by its zeta_2, and the estimate by the polynomial.
    """
    import pandas as pd

    from studies.zeta2.tables import lines

    return pd.DataFrame(lines(df))


def notes(df):
    """How much narrower bounds of third order are, which is theirs whatever zeta_2 is."""
    rows = with_bounds(df)
    if len(rows):
        width = (rows["hs_upper"] - rows["hs_lower"]) / (rows["upper"] - rows["lower"])
        yield f"Hashin and Shtrikman's bounds are {width.min():.1f} to {width.max():.1f} times as wide as these."
