"""Transmission surfaces and interface rules: the error of the DEM against the number of particles.

One sphere of radius L/3 in a cube between two isothermal faces; and a sphere of the matrix's own conductivity (contrast
1) in a cube heated by a flux, where the temperature is linear. Laguerre facets, plain or on packings that conform to
the interface, and the calibrated contact network of Haddad et al. (2021), each with the harmonic or the arithmetic mean
of conductivities at the interface.
"""

from dataclasses import replace

import numpy as np

from demheat import Flux, referee
from demheat.gallery import EDGE, TEMPERATURES, sphere_in_cube
from studies.harness import methods
from studies.harness.figures import BLACK, GREY, LOOK, look
from studies.harness.pick import mean_errors, order, pick, worst

NUMBERS = (1_000, 10_000, 100_000, 400_000)
SEEDS = (0, 1, 2)
CONTRASTS = (0.01, 0.1, 10.0, 100.0)
SIDE_BY_SIDE = ("dem-plain", "dem-mean", "dem-calibrated", "dem-arithmetic")
COLD, SLOPE = TEMPERATURES[0], (TEMPERATURES[1] - TEMPERATURES[0]) / EDGE
TIMEOUT = 3600.0


def _cases():
    for number in NUMBERS:
        for seed in SEEDS if number < NUMBERS[-1] else SEEDS[:1]:
            here = {"particles": number, "seed": seed}
            yield from (methods.case("dem", contrast=contrast, **here) for contrast in CONTRASTS)
            # The others err by far more than they scatter: one packing of each shows it.
            for name in SIDE_BY_SIDE if seed == 0 and number < NUMBERS[-1] else ():
                yield from (methods.case(name, contrast=contrast, **here) for contrast in (0.01, 10.0))
        for name in ("dem", "dem-plain"):
            # A tight tolerance, so that what is left is the rounding of the law and not the solver's.
            yield methods.case(name, contrast=1.0, particles=number, seed=0, tolerance=1e-12)


CASES = list(_cases())
VALUES = True
# Why claims on the stored rows fail.
FAILS = {
    "10000 to 400000 particles: lowest order": (
        "at contrast .1 the mean of three packings of 10000 is 6e-5 %, as two of them are negative there: no "
        "order can be read off; at contrasts of 10 and 100 it is 2.2 to 2.3"
    ),
}
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "homogeneous cube": "iterated to 1e-12 of the heat; temperatures are off by that times a part of the condition",
    "worst error of any contrast": "rows from before twins had their margin; since then 10 000 particles err a third",
}


def QUICK(case):
    """Few particles, one packing."""
    return case["particles"] <= 10_000 and case["seed"] == 0


def run(name, contrast, method, **knobs):
    """Solve and compare with the exact value; at contrast 1 also with the linear temperature."""
    scene = sphere_in_cube(contrast)
    if contrast == 1.0:
        # Not two temperatures: the solver would start from the solution.
        scene = replace(scene, walls={"y-": COLD, "y+": Flux(methods.MATRIX * SLOPE)})
    field, row = methods.solved(scene, methods.exact_ratio(methods.THIRD, contrast), method=method, **knobs)
    if contrast == 1.0:
        warmer, linear = field.samples.temperature - COLD, SLOPE * field.samples.points[:, 1]
        row["linear_error"] = float(abs(referee.value_error(warmer, linear, scale=SLOPE * EDGE)).max())
    return row


def claims(df):
    """Linear temperatures where there is one material; orders and levels of the default's errors.

    Linear fields are exact to rounding; their limits were 1e-10 and 1e-9. The order expected is two. Levels were held
    to 0.8 and 0.06 %, as in `fig14_single_inclusion`, before they were known, and now to three times what was found.
    Nothing is extrapolated: the order that is found is not the one that theory gives.
    """
    laguerre = pick(df, law="laguerre", contrast=1.0)
    text = "homogeneous cube, Laguerre facets, any number of particles:"
    yield f"{text} worst error of the conductivity", laguerre["error_percent"].abs().max(skipna=False) / 100, 1e-12
    yield f"{text} worst error of a temperature over the span", laguerre["linear_error"].max(skipna=False), 1e-10
    sphere = df[df["contrast"] != 1.0]
    yield from _size_claims(sphere)


def _size_claims(sphere):
    """Orders and levels of the default; few particles make a coarse start, one packing scatters."""
    for first, last, limit in ((1_000, 10_000, ">= 1.4"), (10_000, 400_000, ">= 1.7")):
        orders = _orders(pick(sphere, name="dem"), first, last)
        slowest = None if orders is None else min(orders.values())
        yield f"DEM default, {first} to {last} particles: lowest order in particle size of any contrast", slowest, limit
    for number, limit in ((10_000, 0.14), (100_000, 0.014)):
        text = f"DEM default, {number} particles: worst error of any contrast, %"
        yield text, worst(sphere, name="dem", particles=number), limit


def _orders(rows, first, last):
    """Fitted order in the particle size at each contrast; None unless both ends are there."""
    rows = rows[rows["particles"].between(first, last)]
    if not {first, last} <= set(rows["particles"]):
        return None
    found = {}
    for contrast, group in rows.groupby("contrast"):
        errors = mean_errors(group, by="particles")
        found[contrast] = order(errors.index.to_numpy(float) ** (-1 / 3), errors.to_numpy())
    return found


def table(df):
    """Error, %, of each method and contrast against the number of particles, and the order.

    Of the default that is the mean over three packings up to 100 000 particles; all else is of one packing.
    In poor conductors the error of packings of 10 000 is of either sign, so that the order there, fitted to absolute
    values, is none of the scheme (docs/decisions/order.md).
    """
    import pandas as pd

    rows = []
    for (name, contrast), group in df.groupby(["name", "contrast"], sort=False):
        errors = mean_errors(group, by="particles")
        row = {"method": LOOK[name][0], "contrast": f"{contrast:g}"}
        row |= {f"{number:.0e}".replace("e+0", "e"): float(error) for number, error in errors.items()}
        known = errors.dropna()
        fitted = contrast != 1.0 and len(known) > 1
        rows.append(row | {"order": order(known.index.to_numpy(float) ** (-1 / 3), known) if fitted else float("nan")})
    return pd.DataFrame(rows)


def plot(df):
    """Error against the number of particles, at a low and a high contrast."""
    from matplotlib import pyplot

    figure, panels = pyplot.subplots(1, 2, figsize=(11, 5.2), sharey=True)
    for axes, contrast in zip(panels, (0.01, 10.0), strict=True):
        for name in ("dem", *SIDE_BY_SIDE):
            rows = pick(df, name=name, contrast=contrast)
            errors = abs(mean_errors(rows, by="particles"))
            axes.plot(errors.index, errors, **look(name))
            if name == "dem":
                axes.plot(rows["particles"], abs(rows["error_percent"]), ".", color=LOOK[name][1], alpha=0.4)
                _slopes(axes, errors)
        axes.set(xscale="log", yscale="log", xlabel="particles", title=f"sphere {contrast:g} times as conducting")
    panels[0].set_ylabel("|error of the effective conductivity|, %")
    shown = df[(df["name"] == "dem") & df["contrast"].isin((0.01, 10.0)) & (df["particles"] >= 100_000)]
    late = shown["error_percent"].abs().max()
    figure.suptitle(f"With facets on the interface the DEM errs by {late:.2g} % at most from 100 000 particles on")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _slopes(axes, errors):
    """Lines of first and second order through the coarsest error."""
    numbers = np.array([errors.index.min(), errors.index.max()], dtype=float)
    for power, text, colour in ((1, "order 1", GREY), (2, "order 2", BLACK)):
        line = errors.iloc[0] * (numbers / numbers[0]) ** (-power / 3)
        axes.plot(numbers, line, color=colour, linewidth=0.8, linestyle=(0, (1, 2)))
        place = {"xytext": (0, 7), "textcoords": "offset points", "ha": "right", "va": "bottom"}
        axes.annotate(text, (numbers[1], line[1]), fontsize=8, color=colour, **place)
