"""Fluxes of a solved network: of each of its cells, and of the whole body."""

import numpy as np

from demheat.conduction.products import flows, reconstruct
from demheat.network.base import wall_normals
from demheat.sampling.particle_flux import particle_flux

# Facets of a closed cell, at least. Tiny cells may have fewer: slivers are left out.
CLOSED = 4


def mean_flux(network, scene, solution):
    """Volume average of the flux density from the heat carried along links and wall links.

    In a periodic cell the first moment of the heat flows. Exact for linear temperatures on a Laguerre network. Between
    walls, unlike the mean of the heat that enters and leaves, it holds while heat is stored.
    """
    _, _, moment = flows(network, solution.mean_gradient, filled(solution))
    towards = wall_normals(network) * network.wall_distance[:, None]
    return (np.einsum("i,ij->j", solution.wall_heat, -towards) - moment.sum(axis=0)) / scene.volume


def cell_fluxes(network, solution):
    """Flux density of each particle from the heat flows of its links.

    With cells q = -(sum S e e)^-1 sum e W, with W the heat received through a facet of area S in direction e: exact for
    linear fields, one-sided at facets on interfaces, of least norm for a cell with too few facets. With contacts the
    papers' q = -1/(2 V) sum W b, V the volume that the particle stands for and b the branch vector (Haddad et al. 2021,
    eq. 20, with Fourier's sign).
    """
    if not network.cells:
        return particle_flux(network, solution, split="half")
    n = len(network.volumes)
    shape, flow = reconstruct(network, solution.mean_gradient, filled(solution))
    normal = wall_normals(network)
    outer = normal[:, :, None] * normal[:, None, :]
    np.add.at(shape, network.wall_particle, network.wall_area[:, None, None] * outer)
    np.add.at(flow, network.wall_particle, normal * solution.wall_heat[:, None])
    facets = np.diff(network.indptr) + np.bincount(network.wall_particle, minlength=n)
    few = np.flatnonzero(facets < CLOSED)
    known = np.linalg.pinv(shape[few], hermitian=True) @ flow[few, :, None]
    shape[few] = np.eye(3)
    flux = -np.linalg.solve(shape, flow[..., None])[..., 0]
    flux[few] = -known[..., 0]
    return flux


def filled(solution):
    """Fluctuations, those of isolated components, which exchange no heat, set to zero, (n,) float array, K."""
    return np.nan_to_num(solution.temperature)
