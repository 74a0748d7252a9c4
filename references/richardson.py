"""Richardson's extrapolation: the limit of values computed with smaller and smaller elements, and the order they show.

Richardson, Phil. Trans. R. Soc. A 210 (1911) 307; the order from three sizes as in Roache, J. Fluids Eng. 116 (1994)
405, for any ratio of sizes.
"""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

from demheat.scene.inputs import reals

# Orders looked for. Below the lowest an error hardly falls, beyond the highest rounding and noise are what is seen.
LOWEST, HIGHEST = 0.1, 8.0


def extrapolate(values: Sequence[float], sizes: Sequence[float], order: float | Sequence[float] | None = None) -> float:
    """Limit L of values = L + sum of c_k size^order_k for elements of no size."""
    values, sizes = _checked(values, sizes)
    powers = [observed_order(values, sizes)] if order is None else _powers(order)
    if len(values) <= len(powers):
        raise ValueError(f"values: {len(values)} given; {len(powers)} exponents need at least {len(powers) + 1}")
    h = sizes / sizes.max()
    # Columns scaled to their own largest number, so that high powers of small sizes are not lost.
    columns = np.stack([np.ones_like(h), *(h**power / np.max(h**power) for power in powers)], axis=1)
    return float(np.linalg.lstsq(columns, values, rcond=None)[0][0])


def observed_order(values: Sequence[float], sizes: Sequence[float]) -> float:
    """Order p of values = L + c size^p from exactly three values."""
    values, sizes = _checked(values, sizes)
    if len(values) != 3:
        raise ValueError(f"values: {len(values)} given; an observed order needs exactly 3")
    first, second, third = np.argsort(-sizes)
    change, rest = values[first] - values[second], values[second] - values[third]
    h = sizes / sizes[first]

    def excess(p):
        return rest * (1 - h[second] ** p) - change * (h[second] ** p - h[third] ** p)

    # The trivial root at p = 0 lies below the bracket; changes of both signs leave no root in it.
    if not excess(LOWEST) * excess(HIGHEST) < 0:
        raise ValueError(
            f"values = {values.tolist()} at sizes {sizes.tolist()}: show no order between {LOWEST} and {HIGHEST}; must "
            "approach a limit from one side, by less and less"
        )
    return float(brentq(excess, LOWEST, HIGHEST, xtol=1e-12))


def _powers(order):
    """Exponents as a list of floats."""
    try:
        powers = np.atleast_1d(order)
    except ValueError:
        powers = np.empty(0)
    good = powers.ndim == 1 and powers.size > 0 and powers.dtype.kind in "iuf"
    if not good or not np.all(np.isfinite(powers) & (powers > 0)) or len(np.unique(powers)) < len(powers):
        raise ValueError(f"order = {order!r}: must be finite exponents > 0, all different")
    return powers.astype(float).tolist()


def _checked(values, sizes):
    valid = "a list of finite numbers"
    values, sizes = reals("values", values, valid), reals("sizes", sizes, valid)
    if values.ndim != 1 or values.shape != sizes.shape or not np.all(np.isfinite(values)):
        raise ValueError(f"values = {values.tolist()}: must be as many finite numbers as sizes = {sizes.tolist()}")
    if not np.all(np.isfinite(sizes)) or np.any(sizes <= 0) or len(np.unique(sizes)) < len(sizes):
        raise ValueError(f"sizes = {sizes.tolist()}: must be finite, > 0 and all different")
    return values, sizes
