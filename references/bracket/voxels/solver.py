"""Bounds of a scene's conductivity on a regular grid, whatever its surfaces cut."""

import math
from collections.abc import Sequence

import numpy as np

from demheat.gate import check_bracket
from demheat.runtime.deadline import budget
from demheat.runtime.limits import check_memory
from demheat.runtime.progress import stage
from demheat.scene import Scene
from demheat.scene.symmetry import mirrors
from references.bracket.answers import Bracket, check
from references.bracket.voxels.image import (
    BYTES,
    Load,
    bracketed,
    checked_effort,
    conducting,
    resisting,
    scaled_load,
)
from references.bracket.voxels.painting import GRAIN, mirrored, painted
from references.bracket.voxels.voxel_kernels import Cells
from references.voxels.paint import grid_shape

# Voxels along the longest side, where an image does not say.
USUAL = 64
PAIR = "bounds on voxels know one pair of isothermal walls"
PORES = "Fourier modes of a balanced flux fill pores; references.bracket.solve takes them"


def solve(
    scene: Scene,
    *,
    voxels: int | Sequence[int] | None = None,
    tolerance: float = 1e-6,
    threads: int | None = 2,
    seconds: float | None = None,
) -> Bracket:
    """Bound the conductivity of a scene along its load from both sides, on voxels.

    Surfaces may touch, and no mesh is made; but fields that know nothing of the surfaces inside a voxel close in with
    first order only: `references.bracket.solve` is narrower by far wherever it has a mesh.

    Parameters
    ----------
    scene : Scene
        Spheres and layers, or an image, all of some conductivity, in a periodic cell, or between two opposite
        isothermal walls; a box without mirror planes of its own is doubled by its mirror images, along each axis that
        lacks one.
    voxels : int or (3,) sequence of int, optional
        Along the longest side of the scene, the others as nearly cubic as they can be; or along each side. Default: 64,
        or the voxels of an image.
    tolerance : float
        Of the energies at which iterations stop; it costs width, never certainty.
    threads : int or None
        None takes one per processor.
    seconds : float, s, optional
        That it may take, see `demheat.budget`; then TimeoutError. What is asked of the result is not in it.

    Returns
    -------
    Bracket
        With `stats` as those of `bounds`, and `cut`, the number of voxels that a surface may cut.

    Raises
    ------
    ValueError
        If an argument is not as described, or the grid does not fit into memory.
    NotImplementedError
        If the load is another, a shape, or a conductivity is 0.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references.bracket import voxels
    >>> found = voxels.solve(gallery.sphere_in_cube(5.0), voxels=16)
    >>> bool(found.lower < 42.6403 < found.upper)
    True
    """
    with budget(seconds):
        effort = checked_effort(tolerance, threads)
        above, below, load, slack = on_grid(scene, voxels, BYTES["lower"], tolerance)
        found = bracketed(above, below, load, effort)
        stats = found.stats | {"cut": len(above.table)}
        check_bracket(scene, found.lower, found.upper)
        return Bracket(found.lower * max(1 - slack, 0.0), found.upper * (1 + slack), stats)


def on_grid(scene: Scene, voxels, bytes_each: int, tolerance: float) -> tuple[Cells, Cells, Load, float]:
    """A scene as a periodic grid; raises what `solve` does."""
    check(scene, tolerance, takes=("image",))
    scene.require(PAIR, walls="one isothermal pair", takes=("image",))
    scene.require(PORES, pores=False, takes=("image",))
    factors, own = _factors(scene), grid_shape(scene, voxels, USUAL)
    shape = tuple(n * factor for n, factor in zip(own, factors, strict=True))
    check_memory("voxels", voxels or own, bytes_each * math.prod(shape), power=3)
    spacing, conductivity = np.array(scene.size) * factors / shape, scene.conductivities
    load = scaled_load(conductivity, shape, spacing, scene.gradient if scene.periodic else np.eye(3)[scene.axis])
    if scene.image is not None:
        values = (conductivity / load.unit)[_mirrored(scene.image.phase_on(own), factors)]
        return conducting(values), resisting(values), load, 0.0
    images = mirrored(scene.images(), scene.size, [factor == 2 for factor in factors])
    with stage("voxels"):
        cells = painted(conductivity / load.unit, images, shape, spacing)
    # Faces of layers count as on those of voxels, and bodies as mirrored, within rounding: what that matters at most.
    slack = 2 * GRAIN * len(scene.inclusions) * conductivity.max() / conductivity.min()
    return cells.conducting, cells.resisting, load, slack


def _factors(scene):
    """1, or 2 where mirror images are needed to make a periodic cell of the box, along each axis."""
    if scene.periodic:
        return (1, 1, 1)
    if scene.image is not None:
        phase = scene.image.phase
        return tuple(1 if np.array_equal(phase, np.flip(phase, axis)) else 2 for axis in range(3))
    return tuple(2 if plane is None else 1 for plane in mirrors(scene))


def _mirrored(phase, factors):
    """Phases of an image, and of its mirror image beyond it along axes with a factor of 2."""
    for axis in (axis for axis, factor in enumerate(factors) if factor == 2):
        phase = np.concatenate([phase, np.flip(phase, axis)], axis)
    return phase
