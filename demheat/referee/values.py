"""Errors of numbers already at hand: of rows of a table, of printed values, of curves in time, between packings.

Values may be single numbers, arrays or columns of a data frame; what is elementwise returns the same kind.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

Values = float | np.ndarray  # or a column of a data frame


class CurveError(NamedTuple):
    """How far a curve is off another one.

    Attributes
    ----------
    at : int
        Index at which the two differ most.
    local : float
        Signed difference there over the reference there.
    highest : float
        Size of that difference over the reference's highest value.
    last : float
        Signed relative difference at the end.
    """

    at: int
    local: float
    highest: float
    last: float


def value_error(found: Values, exact: Values, *, scale: Values | None = None) -> Values:
    """Signed error of values: found / exact - 1, or (found - exact) / scale.

    Parameters
    ----------
    found, exact : float or array, any unit
        Of one shape, or one of them a single number.
    scale : float or array, same unit, optional
        What errors are measured in, by default the exact values themselves: the span of the temperatures, say. 1 leaves
        them in the values' own unit.

    Returns
    -------
    float or array
    """
    if scale is None:
        return found / exact - 1
    return (found - exact) / scale


def vector_error(found: ArrayLike, exact: ArrayLike, *, scale: float = 1.0) -> np.ndarray:
    """Size of the difference of vectors, over a scale.

    Parameters
    ----------
    found, exact : (..., d) float array, any unit
    scale : float, same unit
        Of a flux the magnitude of the mean flux.

    Returns
    -------
    (...) float array
    """
    return np.linalg.norm(np.asarray(found) - np.asarray(exact), axis=-1) / scale


def rms(errors: ArrayLike, weights: np.ndarray | None = None) -> float:
    """Root of the mean square.

    Parameters
    ----------
    errors : float array, any unit
    weights : (n,) float array, optional
        Volumes of `errors` in one dimension; by default all weigh the same.

    Returns
    -------
    float, unit of the errors
        Not finite if one of the errors is not.
    """
    squares = np.asarray(errors) ** 2
    return float(np.sqrt(np.mean(squares) if weights is None else weights @ squares / weights.sum()))


def worst(errors: ArrayLike) -> tuple[int, float]:
    """Index and signed value of the largest |error|; those of the first not-a-number if there is one."""
    at = int(np.argmax(np.abs(errors)))
    return at, float(np.asarray(errors)[at])


def curve_error(curve: ArrayLike, reference: ArrayLike) -> CurveError:
    """Largest difference of two curves in time or along the load.

    Parameters
    ----------
    curve, reference : (n,) float array, any unit
        At the same times or places. Temperatures count from the zero of their scale.

    Returns
    -------
    CurveError
    """
    curve, reference = np.asarray(curve, dtype=float), np.asarray(reference, dtype=float)
    at, off = worst(curve - reference)
    local, highest = off / reference[at], abs(off) / reference.max()
    return CurveError(at, float(local), float(highest), float((curve[-1] - reference[-1]) / reference[-1]))


def dispersion(curves: ArrayLike) -> float:
    """Mean over time of (max - min) / max over realisations.

    The measure of Terreros, Iordanoff, Charles, Comput. Mater. Sci. 69 (2013) 46.

    Parameters
    ----------
    curves : (realisations, times) float array, degrees Celsius
    """
    curves = np.asarray(curves, dtype=float)
    highest = curves.max(axis=0)
    return float(np.mean((highest - curves.min(axis=0)) / highest))


def variation(values: np.ndarray, weights: np.ndarray | None = None) -> float:
    """Coefficient of variation: standard deviation over mean of values that should all be the same.

    Parameters
    ----------
    values : (n,) float array, any unit
    weights : (n,) float array, optional
        Volumes; by default all weigh the same.
    """
    mean = np.average(values, weights=weights)
    return float(np.sqrt(np.average((values - mean) ** 2, weights=weights)) / mean)
