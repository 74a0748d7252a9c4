"""What a method would find with infinitely fine resolution, from its own rows: Richardson's extrapolation."""

import numpy as np

from references.richardson import extrapolate
from studies.harness import methods
from studies.harness.pick import pick, with_size


def converged(df, name, **where):
    """Extrapolated k over the matrix's of one method on one scene; None if its rows are too few, NaN if one failed.

    Terms of the exponents that the method declares are taken off, through one row more from the finest on; without
    exponents the finest row counts.
    """
    terms = methods.all_methods()[name].terms
    needed = len(terms) + 1
    rows = with_size(pick(df, name=name, **where))
    rows = rows.drop_duplicates("h").sort_values("h", ascending=False).tail(needed)
    if len(rows) < needed:
        return None
    values = rows["k_ratio"].to_numpy(dtype=float)
    if needed == 1 or not np.all(np.isfinite(values)):
        return float(values[-1]) if needed == 1 else np.nan
    return extrapolate(values, rows["h"].to_numpy(), terms)
