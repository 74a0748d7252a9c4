"""Upper bounds: continuous temperatures, trilinear in each voxel, of nearly least energy."""

import math
from itertools import combinations

import numpy as np

from demheat.runtime.progress import stage
from references.bracket.voxels import voxel_kernels as kernels
from references.bracket.voxels.descent import descend
from references.bracket.voxels.voxel_kernels import Cells
from references.fft import cg_kernels
from references.fft.cg_kernels import Symbol
from references.fft.transforms import fourier
from references.threads import Team


def temperature(cells: Cells, spacing, gradient, *, tolerance: float, most: int, team: Team) -> tuple[np.ndarray, dict]:
    """A temperature that fits the load, of nearly least energy."""
    shape = cells.scalar.shape
    theta = np.zeros(shape)
    first, energy = _slope(cells, spacing, theta, gradient, team)
    with stage("temperatures") as done:
        inverse = _homogeneous(shape, spacing, team.threads)
        found = descend(
            lambda direction: _slope(cells, spacing, direction, np.zeros(3), team)[0],
            inverse,
            theta,
            loaded=(first, energy),
            tolerance=tolerance,
            most=most,
            done=done,
        )
    return found.field, {"unknowns": theta.size, "iterations": found.iterations}


def greatest(cells: Cells, spacing, thetas, gradients, *, team: Team) -> np.ndarray:
    """What temperatures prove: by Dirichlet's principle c . E c is no less than the conductivity along sum c_i g_i."""
    count = len(thetas)

    def energy(theta, gradient):
        return _slope(cells, spacing, theta, gradient, team)[1] / theta.size

    found = np.diag([energy(*pair) for pair in zip(thetas, gradients, strict=True)])
    for i, j in combinations(range(count), 2):
        both = energy(thetas[i] + thetas[j], gradients[i] + gradients[j])
        found[i, j] = found[j, i] = (both - found[i, i] - found[j, j]) / 2
    return found


def _slope(cells, spacing, theta, gradient, team):
    """Half the slope of the energy, and the energy, times the number of voxels."""
    work, energies = np.empty(theta.shape), np.zeros(len(theta))
    team.run(kernels.conduct, len(theta), theta, work, cells, np.array([1 / spacing, gradient]), energies)
    return work, math.fsum(energies)


def _homogeneous(shape, spacing, threads):
    """What inverts the slope in a cell of unit conductivity, but for the mean."""
    transform, symbol = fourier(1, shape, np.float64, threads), _symbol(shape, spacing)
    values = transform.real[0, ..., : shape[2]]

    def inverse(residual):
        values[:] = residual
        transform.planes(forward=True)
        transform.columns(cg_kernels.divide, symbol, transform.scale)
        transform.planes(backward=True)
        return values.copy()

    return inverse


def _symbol(shape, spacing):
    angles = [2 * np.pi * np.arange(m) / n for m, n in zip((*shape[:2], shape[2] // 2 + 1), shape, strict=True)]
    # Columns of modes have real and imaginary parts in turn.
    angles[0] = np.repeat(angles[0], 2)
    sines = tuple((2 * np.sin(angle / 2) / h) ** 2 for angle, h in zip(angles, spacing, strict=True))
    return Symbol(sines, tuple((2 + np.cos(angle)) / 3 for angle in angles))
