"""What a method would find with infinitely fine resolution, from its own rows: Richardson's extrapolation."""

from __future__ import annotations

import numpy as np

from references.richardson import extrapolate
from studies.pick import pick

# Resolution; exponents of the element's size whose terms are taken off, none or (None) the one that three rows show;
# rows, from the finest. Conforming cells lose the square of their size. Voxels cut by interfaces lose more the more of
# them lie in gaps, so that no one order holds at all fractions. Meshes follow gaps and spheres besides the size that is
# asked for: nothing can be extrapolated in it.
TERMS = {
    "dem": ("particles", 2.0, 2),
    "fem": ("size", (), 1),
    "fft": ("voxels", None, 3),
    "fft-em": ("voxels", None, 3),
}


def spacing(rows, knob):
    """Size of an element, up to a factor, for the rows of a method."""
    values = rows[knob].to_numpy(dtype=float)
    return {"particles": values ** (-1 / 3), "size": values, "voxels": 1 / values}[knob]


def converged(df, name, **where):
    """Extrapolated k over the matrix's of one method on one scene; None if its rows are too few, NaN if one failed."""
    knob, order, needed = TERMS[name]
    rows = pick(df, name=name, **where).drop_duplicates(knob).sort_values(knob, ascending=knob != "size").tail(needed)
    if len(rows) < needed:
        return None
    values = rows["k_ratio"].to_numpy(dtype=float)
    if needed == 1 or not np.all(np.isfinite(values)):
        return float(values[-1]) if needed == 1 else np.nan
    return extrapolate(values, spacing(rows, knob), order)
