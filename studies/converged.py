"""What a method would find with infinitely fine resolution, from its own rows: Richardson's extrapolation."""

from __future__ import annotations

import numpy as np

from studies.pick import pick

# Resolution, and exponents of the element's size whose terms are taken off, as many rows as needed from the finest on.
# Conforming cells, and quadratic elements on curved interfaces where near contacts rule, lose the square of their size;
# voxels cut by interfaces their size itself, and its square where few lie in a gap.
TERMS = {"dem": ("particles", (2,)), "fem": ("size", ()), "fft": ("voxels", (1, 2)), "fft-em": ("voxels", (1, 2))}


def spacing(rows, knob):
    """Size of an element, up to a factor, for the rows of a method."""
    values = rows[knob].to_numpy(dtype=float)
    return {"particles": values ** (-1 / 3), "size": values, "voxels": 1 / values}[knob]


def extrapolate(sizes, values, exponents):
    """Limit of values = limit + sum c_k size^exponent_k for vanishing size, through as many points as unknowns.

    Parameters
    ----------
    sizes, values : (n,) float array
        n one more than the exponents.
    exponents : sequence of float

    Returns
    -------
    float
    """
    h = np.asarray(sizes, dtype=float) / np.max(sizes)
    columns = np.stack([np.ones_like(h), *(h**p for p in exponents)], axis=1)
    return float(np.linalg.solve(columns, values)[0])


def converged(df, name, **where):
    """Extrapolated k over the matrix's of one method on one scene; None if its rows are too few, NaN if one failed."""
    knob, exponents = TERMS[name]
    rows = pick(df, name=name, **where).drop_duplicates(knob).sort_values(knob, ascending=knob != "size")
    rows = rows.tail(len(exponents) + 1)
    if len(rows) <= len(exponents):
        return None
    return extrapolate(spacing(rows, knob), rows["k_ratio"].to_numpy(dtype=float), exponents)
