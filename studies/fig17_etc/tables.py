"""The table of fig17_etc: k and its deviation between cells, bounds and estimates, errors and costs of the methods."""

import math

from demheat import referee
from references import bounds
from studies.common import silica_epoxy
from studies.common.paper_variants import best_variant, shown, told_of, worst_error
from studies.fig17_etc.means import (
    CONTRAST,
    along_one_axis,
    change,
    change_interval,
    interval,
    network_errors,
    of_walls,
    walls_less_gradient,
    witness,
)
from studies.harness import methods
from studies.harness.converged import converged
from studies.harness.pick import pick, with_size
from studies.harness.printed import printed

COSTS = ("unknowns", "iterations", "cpu_s", "peak_mib")
ESTIMATES = {
    "Maxwell (lower bound of Hashin and Shtrikman)": bounds.maxwell,
    "upper bound of Hashin and Shtrikman": lambda *args: bounds.hashin_shtrikman(*args)[1],
    "Bruggeman, differential": bounds.bruggeman_differential,
    "Bruggeman, symmetric": bounds.bruggeman,
    "Rayleigh's formula, to the octupole, simple cubic array": bounds.rayleigh,
    "Lewis and Nielsen": bounds.lewis_nielsen,
    "Agari and Uno, nothing fitted": bounds.agari_uno,
}


def lines(df):
    """Table as a data frame, one column for each fraction."""
    import pandas as pd

    fractions = sorted(df["fraction"].unique())
    rows = [*_conductivities(df, fractions), *_estimates(df, fractions)]
    for kind, boundary in (("periodic", "gradient"), ("walled", "gradient")):
        rows += _errors(df, fractions, kind, boundary)
    rows += _walls(df, fractions)
    shown = [f"f = {f:g}" for f in fractions]
    return pd.DataFrame([row for row in rows if any(row.get(name) for name in shown)]).fillna(
        {name: "" for name in shown}
    )


def _line(quantity, of, values, digits=3, **costs):
    columns = {
        f"f = {f:g}": "" if value is None or math.isnan(value) else f"{value:.{digits}g}" for f, value in values.items()
    }
    return {"quantity": quantity, "of": of} | columns | dict.fromkeys(COSTS, math.nan) | costs


def _conductivities(df, fractions):
    """Means over cells, and what changes them."""
    exact = {f: interval(df, "periodic", f, name="multipole") for f in fractions}
    between = {f: interval(df, "periodic", f) for f in fractions}
    yield _line("k/k_m", "mean of cells, multipoles", {f: i and i.mean for f, i in exact.items()}, 5)
    yield _line("%", "95 % interval of that mean, +-", {f: i and 100 * i.half / i.mean for f, i in exact.items()})
    yield _line(
        "%", "standard deviation between cells", {f: i and 100 * i.deviation / i.mean for f, i in between.items()}
    )
    yield _line("%", "the same, along one axis", {f: along_one_axis(df, f) for f in fractions})
    for kind, name in (("unequal", "unequal spheres less equal ones"), ("walled", "walled cells less periodic ones")):
        yield _line("%", name, {f: change(df, f, kind) for f in fractions})
        yield _line("%", "95 % interval of that, +-", {f: change_interval(df, f, kind) for f in fractions})


def _estimates(df, fractions):
    """Formulas at the nominal fraction, with the polynomial's and the cells' mean zeta_2."""
    cells = {f: pick(df, name="zeta2", fraction=f)["zeta2"].mean() for f in fractions}
    zeta2 = {"of the cells": cells, "of the polynomial": {f: float(bounds.zeta2_hard_spheres(f)) for f in fractions}}
    for whose, values in zeta2.items():
        yield _line("zeta_2", whose, values, 4)
    for side, name in enumerate(("third-order lower bound", "third-order upper bound")):
        yield _formula(name, {f: bounds.third_order(1.0, CONTRAST, f, z)[side] for f, z in cells.items() if z == z})
    for whose, values in zeta2.items():
        yield _formula(
            f"Torquato, zeta_2 {whose}", {f: bounds.torquato(1.0, CONTRAST, f, z) for f, z in values.items() if z == z}
        )
    for name, formula in ESTIMATES.items():
        yield _formula(name, {f: formula(1.0, CONTRAST, f) for f in fractions})


def _formula(name, values):
    return _line("k/k_m", name, values, 5)


def _errors(df, fractions, kind, boundary):
    """Errors of each method and resolution beside the witness, and of the extrapolated values."""
    here = {"kind": kind, "boundary": boundary, "realisation": 0, "axes": "y"}
    exact = {f: witness(df, kind, f) for f in fractions}
    if not any(exact.values()):
        return
    what = f"error, %, {kind}"
    for method in methods.compared("dem-calibrated"):
        for resolution, rows in _ladder(pick(df, name=method.name, **here)):
            k = dict(zip(rows["fraction"], rows["k_ratio"], strict=True))
            values = {f: _percent_off(k.get(f), exact[f]) for f in fractions}
            yield _line(what, f"{method.label}, {resolution}", values, **_costs(rows))
        if method.role == "main":
            limits = {f: converged(df, method.name, fraction=f, **here) for f in fractions}
            values = {f: _percent_off(k, exact[f]) for f, k in limits.items()}
            yield _line(what, f"{method.label}, converged", values)
    yield _nearest(df, exact, kind, here)
    rows = pick(df, name="multipole", **here)
    left = {row["fraction"]: 100 * row["truncation"] for _, row in rows.iterrows()}
    yield _line(what, "multipoles, by their own estimate", {f: left.get(f) for f in fractions}, **_costs(rows))


def _percent_off(k, exact):
    """Error, %; None if one of the two is missing."""
    return 100 * referee.value_error(k, exact) if k and exact else None


def _nearest(df, exact, kind, here):
    """Which converged value is nearest to the witness, and what its finest row cost."""
    line = {"quantity": f"nearest, {kind}", "of": "converged values; processor seconds of the finest row"}
    for fraction, right in exact.items():
        limits = {method: converged(df, method.name, fraction=fraction, **here) for method in methods.compared()}
        off = {method: abs(referee.value_error(k, right)) for method, k in limits.items() if right and k}
        if len(off) > 1:
            best = min(off, key=off.get)
            spent = pick(df, name=best.name, fraction=fraction, **here)["cpu_s"].max()
            line[f"f = {fraction:g}"] = f"{best.title}, {spent:.0f} s"
    return line | dict.fromkeys(COSTS, math.nan)


def _ladder(rows):
    """Rows of one method at each of its resolutions, coarse to fine, with its name."""
    groups = with_size(rows).fillna({"h": 0.0}).groupby("h")
    for _, group in sorted(groups, key=lambda pair: pair[0], reverse=True):
        yield silica_epoxy.words(group.iloc[0]), group


def _costs(rows):
    """Costs of the row at the largest fraction."""
    return {cost: rows.sort_values("fraction")[cost].iloc[-1] for cost in COSTS if len(rows)}


def _walls(df, fractions):
    """Isothermal walls less mean gradient, on the same spheres, by the converged values of each method."""
    for method in methods.compared():
        values = {f: walls_less_gradient(df, method.name, f) for f in fractions}
        yield _line("walls less gradient, %", method.label, values)
    cells = {f: of_walls(df, f) for f in fractions}
    yield _line("walls less gradient, %", "FFT, mean over cells", {f: v.mean() for f, v in cells.items()})
    yield _line("walls less gradient, %", "FFT, deviation between cells", {f: v.std() for f, v in cells.items()})


def notes(df):
    """The variants of the paper's network."""
    said = []
    for boundary, against in (("gradient", "periodic cells, against the multipoles"), ("walls", "")):
        made = network_errors(df, boundary)
        if not made:
            continue
        against = against or "the same spheres between isothermal walls, against the converged voxels"
        names = {name: f"f = {name}" for name in sorted({name for found in made.values() for name in found})}
        said += [*shown(made, names, f"on {against}: errors, %"), told_of(made)]
        if boundary == "gradient":
            off = worst_error(made[best_variant(made)])
            said[-1] += f" The paper prints {printed('fig17_etc')['dem_fft']:g} % between its DEM of 8e6 and its FFT"
            said[-1] += f"; ours of {best_variant(made)[1]} is within {off:.2g} % of exact."
    return said
