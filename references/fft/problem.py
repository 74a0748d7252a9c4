"""What the two schemes share: the scaled problem they are given and the solution they hand back."""

import math
from collections.abc import Callable
from time import perf_counter
from typing import NamedTuple

import numpy as np

from references.fft.link_kernels import Links
from references.threads import Team
from references.voxels.paint import Voxels


class Problem(NamedTuple):
    """One load on one grid, in units that make the largest conductivity, length and gradient about 1."""

    voxels: Voxels  # In units of the largest conductivity and of the longest side
    links: Links | None  # Conductivities of the links, for the scalar scheme's rule "links"
    gradient: np.ndarray  # (3,) float array: Of length 1; along the first axis if there are walls
    walls: bool  # Two isothermal walls across the first axis and four insulated ones; else a periodic cell
    dtype: type
    team: Team
    tolerance: float
    max_iterations: int


class SolvedGrid(NamedTuple):
    """A solved problem, in the units of the problem; fluxes are along the gradient, against Fourier's direction."""

    mean_flux: np.ndarray  # (3,) float array
    # (2,) float array: Mean of the first flux component over the planes of voxels at the two ends of the first axis
    ends: np.ndarray
    # callable () -> (temperature, flux): (nx, ny, nz) temperature less its linear part, (3, nx, ny, nz) flux, both at
    # the voxel centres; made anew at each call
    state: Callable[[], tuple]
    unknowns: int
    iterations: int
    errors: dict  # dict of str to float: Relative errors, recomputed after the solve; `residual` is the largest
    # dict of str to float: Wall seconds: `iteration_s` of all iterations, `transform_s` of the Fourier transforms among
    # them
    cost: dict


def total(sums: np.ndarray) -> float:
    """Sum over planes or columns, one after the other.

    NumPy's own sum groups them as it likes, and at contrasts of 1e6 the last bit of an energy is ten iterations.
    """
    return float(np.cumsum(sums)[-1])


def converged(first: float, error: float, tolerance: float) -> float:
    """Share of the way from a first error to the tolerance, 0 to 1, by logarithms."""
    if error <= tolerance:
        return 1.0
    if not tolerance < error < first < math.inf:
        return 0.0
    return math.log(first / error) / math.log(first / tolerance)


class Clock:
    """Wall seconds between `with` and its end, all of them together, and those of them that a transform took."""

    def __init__(self, transform):
        self._transform, self._whole, self._part = transform, 0.0, 0.0

    def __enter__(self):
        self._whole -= perf_counter()
        self._part -= self._transform.seconds

    def __exit__(self, *_):
        self._whole += perf_counter()
        self._part += self._transform.seconds

    def cost(self) -> dict:
        """As `SolvedGrid.cost`."""
        return {"iteration_s": self._whole, "transform_s": self._part}
