"""The upper bound: a continuous temperature, trilinear in each voxel, of nearly least energy."""

from __future__ import annotations

import math

import numpy as np

from demheat.progress import stage
from references.bracket.voxels import voxel_kernels as kernels
from references.bracket.voxels.descent import descend
from references.bracket.voxels.voxel_kernels import Cells
from references.fft import cg_kernels
from references.fft.cg_kernels import Symbol
from references.fft.transforms import fourier
from references.threads import Team


def least_energy(cells: Cells, spacing, gradient, *, tolerance: float, most: int, team: Team) -> tuple[float, dict]:
    """Energy of a temperature that fits the load: by Dirichlet's principle no less than the conductivity along it.

    Parameters
    ----------
    cells : Cells
        Of conductivities.
    spacing : (3,) float array
    gradient : (3,) float array
        Of length 1.
    tolerance, most
        Of the descent, see `descend`.
    team : Team

    Returns
    -------
    energy : float
        In the unit of the conductivities.
    stats : dict
        `unknowns` and `iterations`.
    """
    shape = cells.scalar.shape
    energies = np.zeros(shape[0])

    def slope(theta, load=0.0):
        work = np.empty(shape)
        team.run(kernels.conduct, shape[0], theta, work, cells, np.array([1 / spacing, load * gradient]), energies)
        return work

    theta = np.zeros(shape)
    begin = slope(theta, 1.0), math.fsum(energies)
    with stage("temperatures") as done:
        inverse = _homogeneous(shape, spacing, team.threads)
        found = descend(slope, inverse, theta, loaded=begin, tolerance=tolerance, most=most, done=done)
    slope(found.field, 1.0)
    return math.fsum(energies) / theta.size, {"unknowns": theta.size, "iterations": found.iterations}


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
