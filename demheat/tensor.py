"""The whole conductivity tensor of a body: the loads along x, y and z that show it, and what their fields say of it.

Every method's `solve_axes` solves these three loads and sets up only once what they have in common.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from demheat.field import Field
from demheat.gate import check_tensor
from demheat.scene import Scene, check_scene


def axis_loads(scene: Scene) -> tuple[Scene, Scene, Scene]:
    """The same body under a load along x, along y and along z.

    Of a periodic cell they are mean gradients as steep as its own; of a box between two isothermal walls with four
    insulated faces, the same two temperatures on the walls across each axis. Insulated faces are mirrors: with
    its images beyond all walls the box makes a periodic cell of three mirror planes, whose tensor is diagonal.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    tuple of three Scenes

    Raises
    ------
    ValueError
        If the load does not fix a steady temperature.
    NotImplementedError
        If it is neither a mean gradient nor one pair of isothermal walls.

    Examples
    --------
    >>> from demheat import gallery, tensor
    >>> [scene.gradient for scene in tensor.axis_loads(gallery.simple_cubic())]
    [(100.0, 0.0, 0.0), (0.0, 100.0, 0.0), (0.0, 0.0, 100.0)]
    """
    check_scene(scene)
    scene.require(
        "loads along all axes are those of a periodic cell or of two opposite walls with temperatures, the others "
        "insulated; only these have a tensor",
        steady=True,
        walls="one isothermal pair",
        takes=("resistance", "anisotropy", "dependence", "image", "perfect"),
    )
    if scene.periodic:
        steep = math.hypot(*scene.gradient)
        return tuple(replace(scene, gradient=tuple(row)) for row in steep * np.eye(3))
    letter = "xyz"[scene.axis]
    low, high = (scene.walls[letter + side] for side in "-+")
    return tuple(replace(scene, walls={name + "-": low, name + "+": high}) for name in "xyz")


def conductivity_tensor(fields: Sequence[Field]) -> np.ndarray:
    """Effective conductivity tensor by the fields of three loads.

    As it is found, not made symmetric: how far k_ij is from k_ji shows what the method, or its solver, leaves open.

    Parameters
    ----------
    fields : (3,) sequence of Field
        Of one body under loads along x, y and z, as `solve_axes` of any method returns them.

    Returns
    -------
    (3, 3) float array, W/(m K)
        In a periodic cell k_ij = -q_i / g_j with the mean flux q of the load j; of a box between walls the
        conductivities between each two of them, and zeros beside the diagonal, which mirrors make.

    Raises
    ------
    ValueError
        If they are not three fields of such loads on one body, or two walls have the same temperature.
    RuntimeError
        If no body with these fractions of its materials has such a tensor, see `demheat.gate`.

    Examples
    --------
    >>> from demheat import gallery, tensor
    >>> from references import fft
    >>> tensor.conductivity_tensor(fft.solve_axes(gallery.laminate(), voxels=8)).round(6).diagonal()
    array([99., 55., 99.])
    """
    if not isinstance(fields, Sequence) or len(fields) != 3:
        raise ValueError(f"fields = {fields!r}: must be three, under loads along x, y and z")
    for number, field in enumerate(fields):
        if not isinstance(field, Field):
            raise ValueError(f"fields[{number}] = {field!r}: must be a Field, as methods return it")
        if not _is_load(field.scene, fields[0].scene, number):
            raise ValueError(
                f"fields[{number}]: must be of the body of fields[0], under a load along {'xyz'[number]} alone, as "
                "solve_axes returns them"
            )
    if not fields[0].scene.periodic:
        return np.diag([field.conductivity for field in fields])
    # The sum takes the sign off a zero.
    found = np.stack([-field.mean_flux / field.scene.gradient[j] for j, field in enumerate(fields)], axis=1) + 0.0
    first = fields[0]
    check_tensor(first.scene, found, first.fractions, first.stats, first.slack)
    return found


def _is_load(scene, first, axis):
    """Whether a scene is the body of another, loaded along one axis only."""
    if replace(scene, gradient=first.gradient, walls=first.walls) != first:
        return False
    return np.flatnonzero(scene.gradient).tolist() == [axis] if scene.periodic else scene.axis == axis
