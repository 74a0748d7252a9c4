"""Conductivities that differ with direction: symmetric positive definite tensors, as users give them."""

import math
from numbers import Real

import numpy as np

from demheat.scene.inputs import LEAST, MOST, finite, moderate, reals, shown
from demheat.scene.rotations import IDENTITY
from demheat.scene.rotations import rotation as rows_of

# Relative to the largest entry: rounding of a tensor that a user has turned; the least of the smallest conductivity.
SAME, FLATTEST = 1e-12, 1e-10
VALID = (
    f"a number >= 0 W/(m K), of {LEAST:g} to {MOST:g} where it is neither 0 nor infinite, or a symmetric positive "
    f"definite (3, 3) tensor of finite ones, least over {FLATTEST:g} of the largest in any direction"
)


def checked_conductivity(name: str, value) -> float | tuple[tuple[float, float, float], ...]:
    """A conductivity as users give it: a float, or a tensor as three tuples; an isotropic one is a float."""
    if isinstance(value, Real) and value == math.inf:
        return math.inf
    if not isinstance(value, list | tuple) and not (isinstance(value, np.ndarray) and value.ndim):
        return finite(name, value, VALID, lambda v: v >= 0 and moderate(v))
    tensor = reals(name, value, VALID)
    good = tensor.shape == (3, 3) and np.all(np.isfinite(tensor))
    largest = float(np.abs(tensor).max()) if good else 0.0
    if not good or not moderate(largest) or np.abs(tensor - tensor.T).max() > SAME * largest:
        raise ValueError(f"{name} = {shown(value)}: must be {VALID}")
    tensor = (tensor + tensor.T) / 2
    diagonal = tensor.diagonal()
    if np.array_equal(tensor, diagonal[0] * np.eye(3)):
        return checked_conductivity(name, float(diagonal[0]))
    principal = np.linalg.eigvalsh(tensor)
    if not (principal[0] > FLATTEST * principal[-1] and moderate(principal[0])):
        raise ValueError(f"{name} = {shown(value)}, {principal.tolist()} along its axes: must be {VALID}")
    return tuple(map(tuple, tensor.tolist()))


def orthotropic(k1: float, k2: float, k3: float, *, rotation=None) -> tuple[tuple[float, float, float], ...]:
    """Conductivity tensor with three principal values along x, y and z, or along these turned.

    Parameters
    ----------
    k1, k2, k3 : float, W/(m K)
    rotation : (3,) or (3, 3) array_like, or scipy.spatial.transform.Rotation, optional
        A rotation vector, along the axis and as long as the angle in radians; or a rotation matrix, whose columns are
        the principal directions.

    Returns
    -------
    (3, 3) tuple of tuples of float, W/(m K)
        As `Material` takes it.

    Raises
    ------
    ValueError
        If a conductivity is not above 0, or the rotation is none.

    Examples
    --------
    >>> from math import pi
    >>> import numpy as np
    >>> from demheat import orthotropic
    >>> np.round(orthotropic(1.0, 2.0, 3.0, rotation=(0, 0, pi / 4)), 12).tolist()
    [[1.5, -0.5, 0.0], [-0.5, 1.5, 0.0], [0.0, 0.0, 3.0]]
    """
    principal = [finite(f"k{n}", k, "a number > 0 W/(m K)", lambda v: v > 0) for n, k in enumerate((k1, k2, k3), 1)]
    turn = np.array(IDENTITY if rotation is None else rows_of("rotation", rotation))
    tensor = turn @ np.diag(principal) @ turn.T
    return tuple(map(tuple, ((tensor + tensor.T) / 2).tolist()))
