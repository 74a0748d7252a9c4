"""Rotations as users give them: vectors, matrices, scipy's."""

import numpy as np

from demheat.scene.inputs import reals, shown

# Of a rotation's entries, as people round them; what is closer than the second is left as it is.
TYPED, ROUNDING = 1e-6, 1e-14
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
VALID = (
    "a rotation vector of three finite numbers, radians; a 3 x 3 rotation matrix, whose columns are the directions of "
    "the body's own axes: at right angles, of length 1, right-handed; or a scipy Rotation"
)


def rotation(name: str, value) -> tuple[tuple[float, ...], ...]:
    """A rotation as the rows of its matrix."""
    matrix = reals(name, value.as_matrix() if hasattr(value, "as_matrix") else value, VALID)
    if matrix.shape == (3,) and np.all(np.isfinite(matrix)):
        return _rows(_about(matrix))
    good = matrix.shape == (3, 3) and np.all(np.isfinite(matrix))
    off = np.abs(matrix.T @ matrix - np.eye(3)).max() if good else np.inf
    if not off < TYPED or np.linalg.det(matrix) < 0:
        raise ValueError(f"{name} = {shown(value)}: must be {VALID}")
    if off > ROUNDING:
        left, _, right = np.linalg.svd(matrix)
        matrix = left @ right
    return _rows(matrix)


def turned_rotation(rows, order) -> tuple[tuple[float, ...], ...]:
    """A rotation after axes order[0], order[1], order[2] have become axes 0, 1, 2, of a body with three mirrors."""
    matrix = np.array(rows)[list(order)]
    if np.linalg.det(matrix) < 0:
        # What a mirror made left-handed: the body is its own mirror image.
        matrix[:, 2] *= -1
    return _rows(matrix)


def _about(vector):
    """Matrix of a rotation vector, by Rodrigues' formula."""
    angle = float(np.sqrt(vector @ vector))
    x, y, z = vector / angle if angle else np.zeros(3)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + 2 * np.sin(angle / 2) ** 2 * (cross @ cross)


def _rows(matrix):
    # Without negative zeros.
    return tuple(tuple(row) for row in (matrix + 0.0).tolist())
