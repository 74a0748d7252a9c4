"""Directions and rotations as users give them: unit vectors, orthonormal matrices."""

from __future__ import annotations

from itertools import product

import numpy as np

from demheat.scene.inputs import reals, vector

# Of a rotation's entries, as people round them; what is closer than the second is left as it is.
TYPED, ROUNDING = 1e-6, 1e-14
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
VALID = "a 3 x 3 rotation matrix, whose columns are the directions of the body's own axes, or a scipy Rotation"


def unit(name: str, value) -> tuple[float, float, float]:
    """A direction as a vector of length 1, which is left as it is if it has that already.

    Parameters
    ----------
    name : str
        Of the argument, for the message.
    value : (3,) sequence of float

    Raises
    ------
    ValueError
        If the value is no direction.
    """
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


def rotation(name: str, value) -> tuple[tuple[float, ...], ...]:
    """A rotation as the rows of its matrix.

    Parameters
    ----------
    name : str
        Of the argument, for the message.
    value : (3, 3) array_like or scipy.spatial.transform.Rotation
        Entries may be rounded to 1e-6; the nearest rotation is then taken.

    Raises
    ------
    ValueError
        If the value is no rotation.
    """
    valid = f"{VALID}: columns at right angles, of length 1, right-handed"
    matrix = reals(name, value.as_matrix() if hasattr(value, "as_matrix") else value, valid)
    good = matrix.shape == (3, 3) and np.all(np.isfinite(matrix))
    off = np.abs(matrix.T @ matrix - np.eye(3)).max() if good else np.inf
    if not off < TYPED or np.linalg.det(matrix) < 0:
        shown = value.tolist() if isinstance(value, np.ndarray) else value
        raise ValueError(f"{name} = {shown!r}: must be {valid}")
    if off > ROUNDING:
        left, _, right = np.linalg.svd(matrix)
        matrix = left @ right
    return tuple(tuple(row) for row in (matrix + 0.0).tolist())


def turned_rotation(rows, order) -> tuple[tuple[float, ...], ...]:
    """A rotation after axes order[0], order[1], order[2] have become axes 0, 1, 2, of a body with three mirrors.

    Parameters
    ----------
    rows : (3, 3) tuple of float
    order : (3,) sequence of int
    """
    matrix = np.array(rows)[list(order)]
    if np.linalg.det(matrix) < 0:
        # What a mirror made left-handed: the body is its own mirror image.
        matrix[:, 2] *= -1
    return tuple(tuple(row) for row in (matrix + 0.0).tolist())


def corners(columns: np.ndarray) -> np.ndarray:
    """The eight sums of three vectors with all signs, (8, 3) float array.

    Parameters
    ----------
    columns : (3, 3) float array
        The vectors as columns.
    """
    return np.array(list(product((-1.0, 1.0), repeat=3))) @ columns.T
