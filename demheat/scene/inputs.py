"""Numbers as users type them: cast, or refused with one line that names argument, value and what would be valid."""

import math
from collections.abc import Callable, Iterable, Sequence
from numbers import Integral, Real

import numpy as np

POINTS = "(n, 3) finite coordinates in metres"
WORDS = {2: "two", 3: "three"}
# Sizes of numbers whose products and squares floating point still holds: beyond, methods gave zeros and not-a-number.
LEAST, MOST = 1e-50, 1e50


def vector(name: str, value, *, length: int = 3) -> tuple[float, ...]:
    """Finite numbers as a tuple of floats."""
    valid = f"{WORDS[length]} finite numbers"
    array = reals(name, value, valid)
    # Flags among numbers have become numbers there.
    flags = isinstance(value, Sequence) and any(isinstance(part, bool | np.bool_) for part in value)
    if flags or array.shape != (length,) or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} = {value!r}: must be {valid}")
    return tuple(array.tolist())


def reals(name: str, value, valid: str) -> np.ndarray:
    """Real numbers as a float array of any shape: no text, flags, complex numbers or masks, which NumPy would cast."""
    try:
        array = np.asarray(value)
        good = array.dtype.kind in "iuf" or (array.dtype.kind == "O" and all(map(_is_real, array.flat)))
        array = np.asarray(array, dtype=float) if good and not np.ma.is_masked(value) else None
    except (TypeError, ValueError, OverflowError):
        array = None
    if array is None:
        raise ValueError(f"{name} = {shown(value)}: must be {valid}")
    return array


def points_of(name: str, value) -> np.ndarray:
    """Points as an (n, 3) float array, one alone as one row; what is wrong with one is told by its row."""
    points = reals(name, value, POINTS)
    points = points[None] if points.shape == (3,) else points
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"{name} of shape {points.shape}: must be {POINTS}")
    check_rows(name, points, np.isfinite(points).all(axis=1), "must be finite coordinates in metres")
    return points


def check_rows(name: str, points: np.ndarray, good: np.ndarray, what: str) -> None:
    """Raise ValueError, with the first of them, unless all rows of points are good."""
    if not good.all():
        which, more = int(np.argmin(good)), int(np.sum(~good)) - 1
        also = f"; {more} more rows are so" if more > 1 else "; one more row is so" if more else ""
        raise ValueError(f"{name}[{which}] = {points[which].tolist()}: {what}{also}")


def one_line(error: Exception) -> str:
    """Message of an error or a warning without its line breaks, or its kind where it says nothing."""
    return " ".join(str(error).split()) or type(error).__name__


def shown(value) -> str:
    """A value as it is shown in a message: in one line."""
    return " ".join(repr(value).split())


def whole(name: str, value, valid: str, accept: Callable[[int], bool] = lambda v: True) -> int:
    """A whole number as an int."""
    if isinstance(value, bool) or not isinstance(value, Integral) or not accept(value):
        raise ValueError(f"{name} = {value!r}: must be {valid}")
    return int(value)


def chosen(name: str, value, valid: Iterable[str]) -> None:
    """Raise ValueError unless a value is one of some words."""
    if not isinstance(value, str) or value not in valid:
        raise ValueError(f"{name} = {value!r}: must be one of {', '.join(valid)}")


def flag(name: str, value) -> bool:
    """A flag as a bool, or a ValueError: numbers and text are none."""
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} = {value!r}: must be True or False")
    return bool(value)


def finite(name: str, value, valid: str, accept: Callable[[float], bool] = lambda v: True) -> float:
    """A finite number as a float."""
    try:
        good = _is_real(value) and math.isfinite(value) and accept(float(value))
    except OverflowError:
        good = False
    if not good:
        raise ValueError(f"{name} = {value!r}: must be {valid}")
    return float(value)


def moderate(value) -> bool:
    """Whether floating point holds products of a number with some others like it: 0, or of a size in between."""
    return value == 0 or LEAST <= abs(value) <= MOST


def axis_number(axis) -> int:
    """An axis as an int, or a ValueError."""
    return whole("axis", axis, "0, 1 or 2", lambda v: 0 <= v <= 2)


def number(owner, field: str, valid: str, accept: Callable[[float], bool] = lambda v: True) -> None:
    """Check and cast a field of a frozen dataclass."""
    name = f"{type(owner).__name__}.{field}"
    object.__setattr__(owner, field, finite(name, getattr(owner, field), valid, accept))


def _is_real(value):
    return isinstance(value, Real) and not isinstance(value, bool)
