"""Directions as users give them: unit vectors."""

from itertools import product

import numpy as np

from demheat.scene.inputs import vector

# What is closer to straight is left as it is.
ROUNDING = 1e-14


def unit(name: str, value) -> tuple[float, float, float]:
    """A direction as a vector of length 1, which is left as it is if it has that already."""
    found = np.array(vector(name, value))
    largest = np.abs(found).max()
    if largest == 0:
        raise ValueError(f"{name} = {value!r}: must be a direction, not all three 0")
    length = np.linalg.norm(found)
    if abs(length - 1) > ROUNDING:
        found = found / largest
        found = found / np.linalg.norm(found)
    # Rounding of an axis that is straight.
    found[np.abs(found) < ROUNDING] = 0.0
    return tuple((found + 0.0).tolist())


def across(direction: np.ndarray) -> np.ndarray:
    """Two directions at right angles to another and to each other, the rows of a (2, 3) float array."""
    one = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    one = one / np.linalg.norm(one)
    return np.stack([one, np.cross(direction, one)])


def corners(columns: np.ndarray) -> np.ndarray:
    """The eight sums of three vectors with all signs, (8, 3) float array."""
    return np.array(list(product((-1.0, 1.0), repeat=3))) @ columns.T
