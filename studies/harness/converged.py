"""What a method would find with infinitely fine resolution, from its own rows: Richardson's extrapolation."""

from __future__ import annotations

import numpy as np

from references.richardson import extrapolate
from studies.harness.pick import pick

# Resolution, and exponents of the element's size whose terms are taken off, through one row more from the finest on.
# Conforming cells lose the square of their size. Laminates in the voxels that interfaces cut lose the size itself in
# the end, its square before that, while few voxels lie across a gap. Meshes follow gaps and spheres besides the size
# that is asked for: nothing can be extrapolated in it.
TERMS = {
    "dem": ("particles", (2.0,)),
    "fem": ("size", ()),
    "fft": ("voxels", (1.0, 2.0)),
    "fft-em": ("voxels", (1.0, 2.0)),
}
TITLES = {"dem": "DEM", "fem": "FEM", "fft": "FFT, scalar", "fft-em": "FFT, Eyre-Milton"}


def spacing(rows, knob):
    """Size of an element, up to a factor, for the rows of a method."""
    values = rows[knob].to_numpy(dtype=float)
    return {"particles": values ** (-1 / 3), "size": values, "voxels": 1 / values}[knob]


def converged(df, name, **where):
    """Extrapolated k over the matrix's of one method on one scene; None if its rows are too few, NaN if one failed."""
    knob, order = TERMS[name]
    needed = len(order) + 1
    rows = pick(df, name=name, **where)
    if len(rows) < needed:
        return None
    rows = rows.drop_duplicates(knob).sort_values(knob, ascending=knob != "size").tail(needed)
    if len(rows) < needed:
        return None
    values = rows["k_ratio"].to_numpy(dtype=float)
    if needed == 1 or not np.all(np.isfinite(values)):
        return float(values[-1]) if needed == 1 else np.nan
    return extrapolate(values, spacing(rows, knob), order)
