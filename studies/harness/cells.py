"""Numbers as one cell of a table, and back: what a row keeps of curves and pictures."""

import math

import numpy as np
from numpy.typing import ArrayLike


def cell(values: ArrayLike, form: str = ".6g", *, decimals: int | None = None) -> str:
    """Numbers as one cell, separated by blanks."""
    found = (float(value) for value in np.ravel(values))
    if decimals is not None:
        # Adding zero turns the -0.0 that rounding leaves into 0.0.
        found = (round(value, decimals) + 0.0 for value in found)
    return " ".join(format(value, form) for value in found)


def numbers(text: str | float) -> np.ndarray:
    """The numbers of a cell, (n,) float array; of an empty one, which a data frame reads as not-a-number, that."""
    return np.array([float(word) for word in str(text).split()])


def picture(text: str) -> np.ndarray:
    """The numbers of a cell that holds a square picture, (n, n) float array."""
    values = numbers(text)
    side = math.isqrt(len(values))
    if side**2 != len(values):
        raise ValueError(f"cell of {len(values)} numbers: must hold a square picture")
    return values.reshape(side, side)
