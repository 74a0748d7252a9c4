"""A periodic image's or scene's conductivity tensor between two that are certain, by three loads on one grid."""

from collections.abc import Sequence

import numpy as np

from demheat.runtime.deadline import budget
from demheat.scene import Scene
from references.bracket.answers import ROUNDING, Tensor
from references.bracket.voxels.image import (
    check_pores,
    checked_effort,
    checked_image,
    conducting,
    greatest_form,
    least_form,
    resisting,
)
from references.bracket.voxels.solver import on_grid

# Bytes that a voxel takes, with three fluxes and their slopes at once.
BYTES_OF_THREE = 240


def bounds_tensor(
    conductivity: np.ndarray,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    *,
    refine: int = 1,
    tolerance: float = 1e-6,
    threads: int | None = 2,
) -> Tensor:
    """Bound the conductivity tensor of a periodic image."""
    values, load = checked_image(conductivity, spacing, (1.0, 0.0, 0.0), refine, BYTES_OF_THREE)
    effort = checked_effort(tolerance, threads)
    check_pores(values)
    return _tensor(conducting(values), resisting(values), load, effort)


def solve_tensor(
    scene: Scene,
    *,
    voxels: int | Sequence[int] | None = None,
    tolerance: float = 1e-6,
    threads: int | None = 2,
    seconds: float | None = None,
) -> Tensor:
    """Bound the conductivity tensor of a periodic cell on voxels."""
    with budget(seconds):
        effort = checked_effort(tolerance, threads)
        above, below, load, slack = on_grid(scene, voxels, BYTES_OF_THREE, tolerance)
        if not scene.periodic:
            raise ValueError(
                f"Scene.walls = {scene.walls}: a tensor is that of a periodic cell; give a gradient instead"
            )
        return _tensor(above, below, load, effort, slack)


def _tensor(above, below, load, effort, slack=0.0):
    unit = np.eye(3)
    greatest, _ = greatest_form(above, load.spacing, unit, effort)
    least, _ = least_form(below, load.spacing, unit, effort)
    # Entries beside the diagonal are differences of larger numbers. What surfaces may be off matters in proportion.
    doubt = ROUNDING * np.trace(greatest) * unit
    least, greatest = least * max(1 - slack, 0.0) - doubt, greatest * (1 + slack) + doubt
    return Tensor(load.unit * least, load.unit * greatest, {"voxels": above.scalar.shape})
