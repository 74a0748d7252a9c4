"""Bounds of the conductivity of a periodic image, each voxel of which conducts as it is told."""

import time
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from demheat.runtime.limits import check_memory
from demheat.runtime.process_state import one_blas_thread
from demheat.scene.inputs import LEAST, MOST, finite, reals, vector, whole
from references.bracket.answers import ROUNDING, Bracket
from references.bracket.voxels import fluxes, temperatures
from references.bracket.voxels.voxel_kernels import Cells
from references.threads import Team, thread_count

# Bytes that a voxel of the finest grid takes, of the lower bound and of the upper one.
BYTES = {"lower": 150, "upper": 60}
# Of iterations: bounds hold wherever they stop.
ITERATIONS = 2000


class Effort(NamedTuple):
    """How far the two energies are lowered."""

    tolerance: float
    threads: int


def bounds(
    conductivity: np.ndarray,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    *,
    gradient: Sequence[float] = (1.0, 0.0, 0.0),
    refine: int = 1,
    tolerance: float = 1e-6,
    threads: int | None = 2,
) -> Bracket:
    """Bound the conductivity of a periodic image along a direction from both sides.

    Between two isothermal walls across an axis and four insulated ones an image conducts as one twice as long each way
    with its mirror images.

    Parameters
    ----------
    conductivity : (nx, ny, nz) float array, W/(m K)
        Of each voxel.
    spacing : (3,) sequence of float, m
        Edges of a voxel.
    gradient : (3,) sequence of float
        Any length.
    refine : int
        Parts of each voxel's edges: bounds close in with them, to the image's own conductivity.
    tolerance : float
        Of the energies at which iterations stop; it costs width, never certainty.
    threads : int or None
        None takes one per processor.

    Returns
    -------
    Bracket
        `stats` holds `voxels` (of the finest grid), `temperatures` and `fluxes`, each with `unknowns` and `iterations`,
        `unbalanced`, the part of the lower bound given up for rounding, and `cpu_s` of lower and upper.

    Raises
    ------
    ValueError
        If an argument is not as described, or the grid does not fit into memory.
    NotImplementedError
        If a conductivity is 0; `upper_bound` takes it.

    Examples
    --------
    >>> import numpy as np
    >>> from references.bracket import voxels
    >>> image = np.ones((4, 4, 4))
    >>> image[:, 2:] = 5.0  # layers across y
    >>> found = voxels.bounds(image, gradient=(0.0, 1.0, 0.0))
    >>> print(f"{found.lower:.5f} {found.upper:.5f}")  # the harmonic mean is 5/3
    1.66667 1.66667
    """
    values, load = checked_image(conductivity, spacing, gradient, refine, BYTES["lower"])
    effort = checked_effort(tolerance, threads)
    check_pores(values)
    return bracketed(conducting(values), resisting(values), load, effort)


def upper_bound(
    conductivity: np.ndarray,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    *,
    gradient: Sequence[float] = (1.0, 0.0, 0.0),
    refine: int = 1,
    tolerance: float = 1e-6,
    threads: int | None = 2,
) -> float:
    """The upper of the two `bounds`, W/(m K); conductivities may be 0."""
    values, load = checked_image(conductivity, spacing, gradient, refine, BYTES["upper"])
    effort = checked_effort(tolerance, threads)
    return _upper(conducting(values), load, effort)[0]


class Load(NamedTuple):
    """Units that make the longest side and the greatest conductivity about 1, and the load."""

    unit: float  # float, W/(m K)
    spacing: np.ndarray  # (3,) float array
    gradient: np.ndarray  # (3,) float array: Of length 1


def scaled_load(conductivity: np.ndarray, shape: Sequence[int], spacing, gradient: Sequence[float]) -> Load:
    """The load of a grid."""
    # A power of two: no conductivity is rounded.
    unit = 2.0 ** np.ceil(np.log2(conductivity.max())) if conductivity.any() else 1.0
    gradient = np.array(gradient, dtype=float)
    gradient = gradient / np.abs(gradient).max()
    return Load(float(unit), spacing / np.max(spacing * shape), gradient / np.linalg.norm(gradient))


def conducting(values: np.ndarray) -> Cells:
    """An image's conductivities as kernels read them."""
    return Cells(values, np.full(values.shape, -1, np.int32), np.empty((0, 3, 3, 3)))


def resisting(values: np.ndarray) -> Cells:
    """An image's resistivities as kernels read them."""
    return Cells(1 / values, np.full(values.shape, -1, np.int32), np.empty((0, 3, 3)))


def bracketed(above: Cells, below: Cells, load: Load, effort: Effort) -> Bracket:
    """Both bounds."""
    begin = time.process_time()
    lower, said = _lower(below, load, effort)
    middle = time.process_time()
    upper, told = _upper(above, load, effort)
    cpu = {"lower": middle - begin, "upper": time.process_time() - middle}
    stats = {"voxels": above.scalar.shape, "unbalanced": said.pop("unbalanced"), "cpu_s": cpu}
    return Bracket(lower, upper, stats | {"temperatures": told, "fluxes": said})


def _upper(cells, load, effort):
    form, stats = greatest_form(cells, load.spacing, [load.gradient], effort)
    return float(form[0, 0] * load.unit * (1 + ROUNDING)), stats


def _lower(cells, load, effort):
    form, stats = least_form(cells, load.spacing, [load.gradient], effort)
    return float(load.gradient @ form @ load.gradient * load.unit * (1 - ROUNDING)), stats


def greatest_form(cells: Cells, spacing, gradients, effort: Effort) -> tuple[np.ndarray, dict]:
    """Upper bounds of all combinations of some loads."""
    knobs = {"tolerance": effort.tolerance, "most": ITERATIONS}
    with one_blas_thread(), Team(effort.threads) as team:
        found = [temperatures.temperature(cells, spacing, each, team=team, **knobs) for each in gradients]
        thetas = [theta for theta, _ in found]
        return temperatures.greatest(cells, spacing, thetas, gradients, team=team), found[-1][1]


def least_form(cells: Cells, spacing, gradients, effort: Effort) -> tuple[np.ndarray, dict]:
    """Lower bounds of the conductivity by fluxes along some directions."""
    knobs = {"tolerance": effort.tolerance, "most": ITERATIONS}
    with one_blas_thread(), Team(effort.threads) as team:
        found = [fluxes.flux(cells, spacing, each, team=team, **knobs) for each in gradients]
        form, unbalanced = fluxes.least(cells, spacing, [flux for flux, _ in found], team=team)
    return form, found[-1][1] | {"unbalanced": unbalanced}


def checked_effort(tolerance: float, threads: int | None) -> Effort:
    """The knobs of the iterations; raises what `bounds` does."""
    finite("tolerance", tolerance, "a number between 0 and 1", lambda v: 0 < v < 1)
    return Effort(float(tolerance), thread_count(threads))


def checked_image(conductivity, spacing, gradient, refine: int, bytes_each: int) -> tuple[np.ndarray, Load]:
    """Conductivities of the finest grid in units of the load, and the load; raises what `bounds` does."""
    values = reals("conductivity", conductivity, "(nx, ny, nz) numbers >= 0, W/(m K)")
    sizes = (values == 0) | ((values >= LEAST) & (values <= MOST))
    if values.ndim != 3 or not values.size or not np.all(sizes):
        raise ValueError(
            f"conductivity of shape {values.shape}: must be (nx, ny, nz) numbers from {LEAST:g} to {MOST:g}, or 0"
        )
    spacing = np.array(vector("spacing", spacing))
    if not np.all(spacing > 0):
        raise ValueError(f"spacing = {tuple(spacing)}: all three edges must be > 0 m")
    if not np.any(vector("gradient", gradient)):
        raise ValueError(f"gradient = {gradient!r}: must have some length to be a direction")
    whole("refine", refine, "a whole number >= 1", lambda v: v >= 1)
    check_memory("refine", refine, bytes_each * values.size * float(refine) ** 3, power=3)
    for axis in range(3):
        values = np.repeat(values, refine, axis=axis) if refine > 1 else values
    load = scaled_load(values, values.shape, spacing / refine, gradient)
    return values / load.unit, load


def check_pores(values: np.ndarray) -> None:
    """Refuse pores; raises what `bounds` does."""
    if values.min() == 0:
        raise NotImplementedError(
            "a conductivity is 0: a balanced flux would have to keep out of pores, which Fourier modes fill; "
            "upper_bound takes pores, and references.bracket.solve has both bounds of a scene's"
        )
