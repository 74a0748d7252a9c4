"""Lower bounds: balanced fluxes, normal parts constant on the faces of voxels, of nearly least energy."""

import math

import numpy as np

from demheat.runtime.progress import stage
from references.bracket.voxels import voxel_kernels as kernels
from references.bracket.voxels.descent import descend
from references.bracket.voxels.voxel_kernels import Cells, Modes
from references.fft.transforms import fourier
from references.threads import Team


def flux(cells: Cells, spacing, gradient, *, tolerance: float, most: int, team: Team) -> tuple[np.ndarray, dict]:
    """A balanced flux, up to rounding, of nearly least energy for what it is along a direction; free across that."""
    start = np.empty((3, *cells.scalar.shape))
    start[:] = gradient[:, None, None, None]
    first = _slope(cells, start, team)
    with stage("fluxes") as done:
        inverse, balanced = _balancing(cells.scalar.shape, spacing, gradient, team.threads)
        found = descend(
            lambda direction: _slope(cells, direction, team),
            inverse,
            start,
            loaded=(first, _dot(start, first)),
            tolerance=tolerance,
            most=most,
            done=done,
        )
        return balanced(found.field), {"unknowns": start.size, "iterations": found.iterations}


def least(cells: Cells, spacing, fluxes, *, team: Team) -> tuple[np.ndarray, float]:
    """What fluxes prove: by Thomson's principle g . L g is no more than the conductivity along g.

    With q_i of means m_i and energies E_ij, of which the best combination is taken, L = m E^-1 m. What rounding leaves
    unbalanced, d in each voxel, a flux of energy at most rho |d|^2 / s^2 would balance, where rho is the largest
    resistivity and s^2 the least eigenvalue of the grid's Laplacian; that is added, since for any t > 0
    (a + b)^2 <= (1 + t) a^2 + (1 + 1 / t) b^2.
    """
    slopes = [_slope(cells, each, team) for each in fluxes]
    means = np.array([each.mean(axis=(1, 2, 3)) for each in fluxes])
    size = cells.scalar.size
    energies = np.array([[_dot(one, slope) for slope in slopes] for one in fluxes]) / size
    energies = (energies + energies.T) / 2
    off = _largest(cells) * sum(_unbalanced(each, spacing) ** 2 for each in fluxes)
    smallest = np.linalg.eigvalsh(energies)[0]
    # The best t for that combination.
    t = math.sqrt(off / smallest)
    energies = (1 + t) * energies + (off + math.sqrt(off * smallest)) * np.eye(len(fluxes))
    return means.T @ np.linalg.solve(energies, means), t * (2 + t)


def _slope(cells, flux, team):
    """Half the slope of the energy, times the number of voxels."""
    work = np.empty(flux.shape)
    team.run(kernels.resist, flux.shape[1], flux, work, cells)
    return work


def _dot(one, other):
    return float(np.einsum("aijk,aijk->", one, other))


def _balancing(shape, spacing, gradient, threads):
    """What inverts the slope of unit resistivity within balanced fluxes, and takes the balanced part of a flux."""
    transform = fourier(3, shape, np.float64, threads)
    values = transform.real[..., : shape[2]]
    angles = [2 * np.pi * np.arange(m) / n for m, n in zip((*shape[:2], shape[2] // 2 + 1), shape, strict=True)]
    turned = [(np.exp(1j * angle) - 1) / h for angle, h in zip(angles, spacing, strict=True)]
    turn = tuple(np.ascontiguousarray(np.stack([each.real, each.imag], axis=1)) for each in turned)
    weighted = Modes(turn, tuple((2 + np.cos(angle)) / 3 for angle in angles), gradient)
    plain = Modes(turn, tuple(np.ones(len(angle)) for angle in angles), np.zeros(3))

    def by(modes):
        def apply(given):
            values[:] = given
            transform.planes(forward=True)
            transform.columns(kernels.balance, modes, transform.scale)
            transform.planes(backward=True)
            return values.copy()

        return apply

    return by(weighted), by(plain)


def _unbalanced(flux, spacing):
    """Bound of the root mean square of a flux of no mean that balances another's rest."""
    rest = sum((np.roll(part, -1, axis=a) - part) / spacing[a] for a, part in enumerate(flux))
    frequency = min(
        (2 * math.sin(math.pi / n) / h for n, h in zip(rest.shape, spacing, strict=True) if n > 1), default=math.inf
    )
    return math.sqrt(float(np.einsum("ijk,ijk->", rest, rest)) / rest.size) / frequency


def _largest(cells):
    """What the energy of any flux is at most, over its mean square."""
    whole = cells.scalar[cells.row < 0].max(initial=0.0)
    # Of each table's matrix the largest eigenvalue is at most the sum of its entries; two voxels share a face.
    return max(whole, 2 * cells.table.sum(axis=2).max(initial=0.0))
