"""Errors of numbers already at hand: of rows of a table, of printed values, of curves in time, between packings.

Values may be single numbers, arrays or columns of a data frame; what is elementwise returns the same kind.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from demheat.scene.inputs import finite, reals

NUMBERS = "real numbers"
Values = float | np.ndarray  # or a column of a data frame


class CurveError(NamedTuple):
    """How far a curve is off another one."""

    at: int  # Index at which the two differ most
    local: float  # Signed difference there over the reference there
    highest: float  # Size of that difference over the reference's highest value
    last: float  # Signed relative difference at the end


def value_error(found: Values, exact: Values, *, scale: Values | None = None) -> Values:
    """Signed error of values: found / exact - 1, or (found - exact) / scale."""
    found, exact = _as_they_are("found", found), _as_they_are("exact", exact)
    below = _as_they_are("scale", scale) if scale is not None else exact
    if np.ndim(below) == 0 and below == 0:
        raise ValueError(f"{'exact' if scale is None else 'scale'} = {below!r}: must not be 0, errors are over it")
    _check_shapes(found, exact, below)
    return found / exact - 1 if scale is None else (found - exact) / scale


def vector_error(found: ArrayLike, exact: ArrayLike, *, scale: float = 1.0) -> np.ndarray:
    """Size of the difference of vectors, over a scale."""
    found, exact = (reals(name, value, NUMBERS) for name, value in (("found", found), ("exact", exact)))
    finite("scale", scale, "a finite number > 0", lambda v: v > 0)
    if found.ndim == 0 or exact.ndim == 0 or found.shape[-1] != exact.shape[-1] or not found.shape[-1]:
        raise ValueError(f"found of shape {found.shape}, exact of shape {exact.shape}: must be vectors of one length")
    _check_shapes(found, exact)
    return np.linalg.norm(found - exact, axis=-1) / scale


def rms(errors: ArrayLike, weights: np.ndarray | None = None) -> float:
    """Root of the mean square."""
    squares = _some("errors", errors) ** 2
    if weights is not None:
        weights = _weights(weights, squares)
    return float(np.sqrt(np.mean(squares) if weights is None else weights @ squares / weights.sum()))


def worst(errors: ArrayLike) -> tuple[int, float]:
    """Index and signed value of the largest |error|; those of the first not-a-number if there is one."""
    errors = _some("errors", errors)
    if errors.ndim != 1:
        raise ValueError(f"errors of shape {errors.shape}: must be (n,)")
    at = int(np.argmax(np.abs(errors)))
    return at, float(errors[at])


def curve_error(curve: ArrayLike, reference: ArrayLike) -> CurveError:
    """Largest difference of two curves in time or along the load."""
    curve, reference = _some("curve", curve), _some("reference", reference)
    if curve.ndim != 1 or curve.shape != reference.shape:
        raise ValueError(f"curve of shape {curve.shape}, reference of shape {reference.shape}: must be (n,) both")
    at, off = worst(curve - reference)
    if 0 in (reference[at], reference.max(), reference[-1]):
        raise ValueError(
            f"reference = {reference.tolist()!r:.80}: must not be 0 at its end or where the two differ most"
        )
    local, highest = off / reference[at], abs(off) / reference.max()
    return CurveError(at, float(local), float(highest), float((curve[-1] - reference[-1]) / reference[-1]))


def dispersion(curves: ArrayLike) -> float:
    """Mean over time of (max - min) / max over realisations.

    The measure of Terreros, Iordanoff, Charles, Comput. Mater. Sci. 69 (2013) 46.
    """
    curves = _some("curves", curves)
    if curves.ndim != 2:
        raise ValueError(f"curves of shape {curves.shape}: must be (realisations, times)")
    highest = curves.max(axis=0)
    if np.any(highest == 0):
        raise ValueError("curves: their highest at each time must not be 0, it is what the measure is over")
    return float(np.mean((highest - curves.min(axis=0)) / highest))


def variation(values: np.ndarray, weights: np.ndarray | None = None) -> float:
    """Coefficient of variation: standard deviation over mean of values that should all be the same."""
    values = _some("values", values)
    if weights is not None:
        weights = _weights(weights, values)
    mean = np.average(values, weights=weights)
    if mean == 0:
        raise ValueError(f"values = {values.tolist()!r:.80}: their mean must not be 0, the measure is over it")
    return float(np.sqrt(np.average((values - mean) ** 2, weights=weights)) / mean)


def _as_they_are(name, values):
    """Numbers, columns and arrays as they are, checked; lists as arrays."""
    array = reals(name, values, NUMBERS)
    return array if isinstance(values, list | tuple) else values


def _check_shapes(*values):
    """Of arrays; columns of data frames find their rows by themselves."""
    shapes = [each.shape for each in values if isinstance(each, np.ndarray)]
    try:
        np.broadcast_shapes(*shapes)
    except ValueError:
        said = ", ".join(map(str, shapes))
        raise ValueError(f"found, exact of shapes {said}: must be of one shape, or single numbers") from None


def _some(name, values):
    """Numbers as a float array that is not empty."""
    array = reals(name, values, NUMBERS)
    if array.size == 0 or array.ndim == 0:
        raise ValueError(f"{name} of shape {array.shape}: must be an array with a number in it, at least")
    return array


def _weights(weights, values):
    array = reals("weights", weights, "numbers >= 0")
    if array.shape != values.shape or np.any(array < 0) or not 0 < array.sum() < np.inf:
        raise ValueError(f"weights of shape {array.shape}: must be {values.shape} numbers >= 0, not all of them 0")
    return array
