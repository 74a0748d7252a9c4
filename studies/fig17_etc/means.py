"""Means over axes and realisations of random dispersions, their intervals, and the bounds of each."""

import numpy as np

from demheat import referee
from demheat.gallery import EPOXY, SILICA
from references import bounds
from studies.common.paper_variants import parted, variant_errors
from studies.harness.converged import converged
from studies.harness.pick import pick, student

CONTRAST = SILICA.conductivity / EPOXY.conductivity


def witness(df, kind, fraction):
    """k over the matrix's of the first cell along y, by multipoles; None if it was not solved."""
    rows = pick(df, name="multipole", kind=kind, fraction=fraction, realisation=0, axes="y")
    return float(rows["k_ratio"].iloc[0]) if len(rows) else None


def all_axes(df):
    """Rows that are means over the three axes of a periodic cell of equal spheres."""
    return pick(df, kind="periodic", axes="xyz")


def bounds_of(df, row):
    """Third-order bounds with the zeta_2 of the very cell and the method's own volume fraction, over the matrix's k."""
    rows = pick(df, name="zeta2", fraction=row["fraction"], realisation=row["realisation"])
    zeta2 = float(rows["zeta2"].iloc[0]) if len(rows) else np.nan
    if np.isnan(row["inclusion"]):  # a failed row: the claim that needs it fails
        return np.nan, np.nan
    low, high = bounds.third_order(1.0, CONTRAST, row["inclusion"], zeta2)
    return float(low), float(high)


def interval(df, kind, fraction, *, name="fft"):
    """Interval of the mean over cells of one method's means over three axes; None if there are not two or more."""
    cells = pick(df, name=name, kind=kind, boundary="gradient", fraction=fraction, axes="xyz")["k_ratio"]
    return student(cells.to_numpy()) if len(cells) > 1 else None


def along_one_axis(df, fraction):
    """Standard deviation of k of one cell along one axis, FFT, % of the mean; not-a-number if unknown."""
    rows = pick(df, name="fft", kind="periodic", fraction=fraction, axes="xyz")
    if not len(rows):
        return np.nan
    values = rows[["k_x", "k_y", "k_z"]].to_numpy(dtype=float)
    return 100 * float(np.std(values, ddof=1) / np.mean(values))


def change(df, fraction, kind):
    """Change of that mean from equal periodic cells to another kind, %; None if one is missing."""
    equal, other = (interval(df, each, fraction) for each in ("periodic", kind))
    return 100 * referee.value_error(other.mean, equal.mean) if equal and other else None


def change_interval(df, fraction, kind):
    """Half the width of the 95 % interval of that change, %; None if one is missing."""
    equal, other = (interval(df, each, fraction) for each in ("periodic", kind))
    return 100 * float(np.hypot(equal.half / equal.mean, other.half / other.mean)) if equal and other else None


def of_walls(df, fraction):
    """Isothermal walls less gradient on the same walled spheres, %, of each cell; empty where not solved."""
    rows = pick(df, name="fft", kind="walled", fraction=fraction, axes="xyz")
    if rows["boundary"].nunique() < 2:
        return rows["k_ratio"][:0]
    k = rows.pivot(index="realisation", columns="boundary", values="k_ratio")
    return 100 * referee.value_error(k["walls"], k["gradient"])


def walls_less_gradient(df, name, fraction):
    """Isothermal walls less gradient on the first walled cell, converged values of one method, %; None if unknown."""
    pair = [
        converged(df, name, kind="walled", boundary=boundary, fraction=fraction, realisation=0, axes="y")
        for boundary in ("walls", "gradient")
    ]
    return None if None in pair else 100 * referee.value_error(*pair)


def network_errors(df, boundary):
    """Errors of the paper's network's variants on the first cells under one boundary condition."""
    network, others = parted(df)
    fractions = sorted(others["fraction"].unique())
    if boundary == "gradient":
        network, exact = pick(network, held="periodic"), {f: witness(others, "periodic", f) for f in fractions}
    else:
        here = {"kind": "walled", "boundary": "walls", "realisation": 0, "axes": "y"}
        network = network[network["held"] != "periodic"] if len(network) else network
        exact = {f: converged(others, "fft", fraction=f, **here) for f in fractions}
    return variant_errors(network, {f"{f:g}": k for f, k in exact.items() if k})
