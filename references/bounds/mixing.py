"""What bounds and estimates of two phases share: checked arguments, and formulas with their limits at 0 and infinity.

All bounds have one form (Hill; Milton 2002, ch. 26): with <k> = p1 k1 + p2 k2 and the exchanged <k~> = p2 k1 +
p1 k2, k(X) = <k> - p1 p2 (k2 - k1)^2 / (<k~> + X) = (k1 k2 + X <k>) / (<k~> + X), rising with X. X = 2 k1 is Maxwell,
X = 2 min(k1, k2) and 2 max(k1, k2) Hashin and Shtrikman. The last form loses no digits and has its limits.
"""

import numpy as np

from demheat.scene.inputs import reals

# Fractions worked out by a method sum to 1 within this, by rounding of sums over millions of cells.
SUM_TOLERANCE = 1e-8


def checked_phases(conductivities, fractions):
    """Conductivities and fractions of any number of phases as arrays, or ValueError."""
    given = {"conductivities": _conductivity("conductivities", conductivities)}
    k, p = _alike(given | {"fractions": checked_fraction("fractions", fractions)})
    if k.ndim == 0 or not np.all(np.abs(p.sum(axis=-1) - 1) <= SUM_TOLERANCE):
        raise ValueError(f"fractions = {fractions!r}: must sum to 1 along the last axis, that of the phases")
    return k, p


def checked_pair(k_matrix, k_inclusion, fraction):
    """Arguments of a two-phase function as arrays, or ValueError."""
    return _alike(_pair(k_matrix, k_inclusion, fraction))


def checked_third_order(k_matrix, k_inclusion, fraction, zeta2):
    """Those of a function of the third order, or ValueError."""
    return _alike(_pair(k_matrix, k_inclusion, fraction) | {"zeta2": checked_fraction("zeta2", zeta2)})


def _pair(k_matrix, k_inclusion, fraction):
    given = {name: _conductivity(name, k) for name, k in (("k_matrix", k_matrix), ("k_inclusion", k_inclusion))}
    given["fraction"] = checked_fraction("fraction", fraction)
    return given


def _alike(given):
    """Arrays by their names, broadcast, or ValueError."""
    try:
        return np.broadcast_arrays(*given.values())
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in given.items())
        raise ValueError(f"arguments of shapes {shapes}: must be alike, or broadcast") from None


def _conductivity(name, value):
    array = reals(name, value, "numbers >= 0, infinity included")
    if not np.all(array >= 0):
        raise ValueError(f"{name} = {value!r}: must be >= 0, infinity included")
    return array


def checked_fraction(name, value):
    """A number of 0 to 1, or ValueError."""
    array = reals(name, value, "numbers from 0 to 1")
    if not np.all((array >= 0) & (array <= 1)):
        raise ValueError(f"{name} = {value!r}: must lie in 0 to 1")
    return array


def checked_positive(name, value):
    """A finite number above 0, or ValueError."""
    array = reals(name, value, "finite numbers > 0")
    if not np.all((array > 0) & np.isfinite(array)):
        raise ValueError(f"{name} = {value!r}: must be a finite number > 0")
    return array


def contrast(k1, k2, weight):
    """(k2 - k1)/(k2 + weight k1) with its limits."""
    with np.errstate(invalid="ignore", divide="ignore"):
        value = np.where(np.isinf(k2), 1.0, (k2 - k1) / (k2 + weight * k1))
    return np.where(k1 == k2, 0.0, np.where(np.isinf(k1), -1 / weight, value))


def dispersed(k1, p2, beta, third):
    """Maxwell's estimate with a term of third order in the contrast, k1 (1 + 2 p2 beta - t)/(1 - p2 beta - t)."""
    # Rounding must not pass the pole.
    above, below = 1 + 2 * p2 * beta - third, np.maximum(1 - p2 * beta - third, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(above == 0, 0.0, k1 * above / below)


def mixed(k1, k2, p2, x):
    """k(X) of the module docstring, with its limits."""
    p1 = 1 - p2
    with np.errstate(invalid="ignore", divide="ignore"):
        mean, exchanged = p1 * k1 + p2 * k2, p2 * k1 + p1 * k2
        k = (k1 * k2 + x * mean) / (exchanged + x)
        k = np.where(np.isinf(k2), np.where(np.isinf(x), np.inf, (k1 + x * p2) / p1), k)
        k = np.where(np.isinf(k1), np.where(np.isinf(x), np.inf, (k2 + x * p1) / p2), k)
    k = np.where((exchanged + x == 0) | (np.isinf(k1) & np.isinf(k2)), np.maximum(k1, k2), k)
    return pure(k, k1, k2, p2)


def pure(k, k1, k2, p2):
    """The value of a mixture, or that of the phase where there is one alone."""
    return np.where(p2 == 0, k1, np.where(p2 == 1, k2, k))[()]
