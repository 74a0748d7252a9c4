"""The lower bound: a balanced flux, normal parts constant on the faces of voxels, of nearly least energy."""

from __future__ import annotations

import math

import numpy as np

from demheat.progress import stage
from references.bracket.voxels import voxel_kernels as kernels
from references.bracket.voxels.descent import descend
from references.bracket.voxels.voxel_kernels import Cells, Modes
from references.fft.transforms import fourier
from references.threads import Team


def greatest_conductivity(
    cells: Cells, spacing, gradient, *, tolerance: float, most: int, team: Team
) -> tuple[float, dict]:
    """What a balanced flux proves: by Thomson's principle (flux along the load)^2 / energy is no more than the truth.

    The mean flux across the load is free. What rounding leaves unbalanced, d in each voxel, a flux of energy at most
    rho |d|^2 / s^2 would balance, where rho is the largest resistivity and s^2 the least eigenvalue of the grid's
    Laplacian; that is counted by the triangle inequality.

    Parameters
    ----------
    cells : Cells
        Of resistivities.
    spacing : (3,) float array
    gradient : (3,) float array
        Of length 1.
    tolerance, most
        Of the descent, see `descend`.
    team : Team

    Returns
    -------
    bound : float
        In the unit of the conductivities.
    stats : dict
        `unknowns`, `iterations` and `unbalanced`, how much of the bound was given up for that.
    """
    shape = cells.scalar.shape

    def slope(flux):
        work = np.empty(flux.shape)
        team.run(kernels.resist, shape[0], flux, work, cells)
        return work

    flux = np.empty((3, *shape))
    flux[:] = gradient[:, None, None, None]
    first = slope(flux)
    with stage("fluxes") as done:
        inverse, balanced = _balancing(shape, spacing, gradient, team.threads)
        begin = first, float(np.einsum("aijk,aijk->", flux, first))
        found = descend(slope, inverse, flux, loaded=begin, tolerance=tolerance, most=most, done=done)
        flux = balanced(found.field)
    energy = float(np.einsum("aijk,aijk->", flux, slope(flux))) / cells.scalar.size
    off = _unbalanced(flux, spacing) * math.sqrt(_largest(cells))
    along = float(gradient @ flux.mean(axis=(1, 2, 3)))
    left = 1 / (1 + off / math.sqrt(energy)) ** 2
    stats = {"unknowns": flux.size, "iterations": found.iterations, "unbalanced": 1 - left}
    return along**2 / energy * left, stats


def _balancing(shape, spacing, gradient, threads):
    """What inverts the slope of unit resistivity within balanced fluxes; and the balanced part of a flux."""
    transform = fourier(3, shape, np.float64, threads)
    values = transform.real[..., : shape[2]]
    angles = [2 * np.pi * np.arange(m) / n for m, n in zip((*shape[:2], shape[2] // 2 + 1), shape, strict=True)]
    turned = [(np.exp(1j * angle) - 1) / h for angle, h in zip(angles, spacing, strict=True)]
    turn = tuple(np.ascontiguousarray(np.stack([each.real, each.imag], axis=1)) for each in turned)
    weighted = Modes(turn, tuple((2 + np.cos(angle)) / 3 for angle in angles), gradient)
    plain = Modes(turn, tuple(np.ones(len(angle)) for angle in angles), np.zeros(3))

    def by(modes):
        def apply(flux):
            values[:] = flux
            transform.planes(forward=True)
            transform.columns(kernels.balance, modes, transform.scale)
            transform.planes(backward=True)
            return values.copy()

        return apply

    return by(weighted), by(plain)


def _unbalanced(flux, spacing):
    """Bound of the root mean square of a flux of no mean that balances another's rest."""
    rest = sum((np.roll(part, -1, axis=a) - part) / spacing[a] for a, part in enumerate(flux))
    least = min(
        (2 * math.sin(math.pi / n) / h for n, h in zip(rest.shape, spacing, strict=True) if n > 1), default=math.inf
    )
    return math.sqrt(float(np.einsum("ijk,ijk->", rest, rest)) / rest.size) / least


def _largest(cells):
    """What the energy of any flux is at most, over its mean square."""
    whole = cells.scalar[cells.row < 0].max(initial=0.0)
    # Of each table's matrix the largest eigenvalue is at most the sum of its entries; two voxels share a face.
    return max(whole, 2 * cells.table.sum(axis=2).max(initial=0.0))
