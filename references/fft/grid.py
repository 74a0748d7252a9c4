"""A solution on voxels, and what it is of."""

from typing import NamedTuple

import numpy as np

from demheat.scene import Scene
from references.voxels.bodies import Bodies
from references.voxels.paint import Voxels


class Grid(NamedTuple):
    """A solution at the voxel centres, its axes in the order of the box (the load first if there are walls)."""

    scene: Scene  # In the order of the box
    order: tuple  # tuple of int: Axes of the user's scene that are axes 0, 1, 2 of the box
    voxels: Voxels
    slope: np.ndarray  # (3,) float array, K/m
    level: float  # K: Linear part: level + slope.x
    sharp: bool  # The temperature of a cut voxel is that of its centre (links), not a mean over its phases
    rings: bool = False  # The temperature rings beside interfaces (Eyre and Milton's), which the flux does not
    bodies: Bodies | None = None  # Bodies, or None: That pores leave; None if all phases conduct
    # (nx, ny, nz) float array, K: Less the linear part; as `flux`, None until it is solved for
    temperature: np.ndarray | None = None
    flux: np.ndarray | None = None  # (3, nx, ny, nz) float array, W/m2: Along Fourier's direction
    # (2,) tuple of int, optional: Of a grid of which some planes across the first axis are held: the first of them, and
    # the number of all
    planes: tuple | None = None
