"""Numbers as users type them: cast, or refused with one line that names argument, value and what would be valid."""

from __future__ import annotations

import math
from collections.abc import Callable
from numbers import Integral, Real

import numpy as np

WORDS = {2: "two", 3: "three"}


def vector(name: str, value, *, length: int = 3) -> tuple[float, ...]:
    """Finite numbers as a tuple of floats.

    Parameters
    ----------
    name : str
        Of the argument, for the message.
    value : (length,) sequence of float
    length : {2, 3}

    Raises
    ------
    ValueError
        If the value is anything else.
    """
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        array = None
    if array is None or array.shape != (length,) or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} = {value!r}: must be {WORDS[length]} finite numbers")
    return tuple(array.tolist())


def finite(name: str, value, valid: str, accept: Callable[[float], bool] = lambda v: True) -> float:
    """A finite number as a float.

    Parameters
    ----------
    name : str
        Of the argument, for the message.
    value : float
        No strings, arrays or huge integers.
    valid : str
        What would be valid, for the message.
    accept : callable (value) -> bool
        Which finite numbers are valid.

    Raises
    ------
    ValueError
        If the value is anything else.
    """
    try:
        good = isinstance(value, Real) and math.isfinite(value) and accept(value)
    except OverflowError:
        good = False
    if not good:
        raise ValueError(f"{name} = {value!r}: must be {valid}")
    return float(value)


def axis_number(axis) -> int:
    """An axis as an int, or a ValueError."""
    if isinstance(axis, bool) or not isinstance(axis, Integral) or axis not in (0, 1, 2):
        raise ValueError(f"axis = {axis!r}: must be 0, 1 or 2")
    return int(axis)


def number(owner, field: str, valid: str, accept: Callable[[float], bool] = lambda v: True) -> None:
    """Check and cast a field of a frozen dataclass.

    Parameters
    ----------
    owner : dataclass instance
    field : str
        Name of the field.
    valid, accept
        As those of `finite`.
    """
    name = f"{type(owner).__name__}.{field}"
    object.__setattr__(owner, field, finite(name, getattr(owner, field), valid, accept))
