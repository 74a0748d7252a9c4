"""The Field of a solved network: mean flux, and temperature and flux wherever they are asked for."""

from functools import cache

import numpy as np
from scipy.spatial import cKDTree

from demheat.conduction import steady_kernels as kernels
from demheat.field import Field, Samples
from demheat.network.base import SIDES, image_shifts, row_numbers, wall_normals
from demheat.sampling.edges import edges_of
from demheat.sampling.reconstruct import Reconstruction


def field_of(scene, packing, facets, network, solution, *, law, stats, mean_flux=None, time=None):
    """The Field of a solved network; a transient's brings its own mean flux, since what enters need not leave."""
    walls = scene.walls or {}
    temperature, heat = {}, {}
    for name in walls:
        here = network.wall_side == SIDES.index(name)
        temperature[name] = float(np.average(solution.wall_temperature[here], weights=network.wall_area[here]))
        heat[name] = float(solution.wall_heat[here].sum())
    sampler, temperature_at, flux_at = _samplers(scene, packing, facets, network, solution, law)
    return Field(
        scene=scene,
        mean_flux=_mean_flux(scene, facets, network, solution, heat, law) if mean_flux is None else mean_flux,
        fractions=np.bincount(network.phase, network.volumes, len(scene.materials)) / network.volumes.sum(),
        sampler=sampler,
        temperature_at=temperature_at,
        flux_at=flux_at,
        wall_temperature=temperature,
        wall_heat=heat,
        stats=solution.stats | stats | _described(packing),
        time=time,
        through=lambda axis, position: _heat_through(network, solution, packing.periodic, axis, position),
    )


def _described(packing):
    provenance = packing.provenance
    made = provenance.get("of", provenance)  # a tile's
    return {"mean_radius": float(packing.radii.mean()), "cached": made.get("cached"), "packing": provenance}


def _mean_flux(scene, facets, network, solution, wall_heat, law):
    """Volume average of the flux density.

    In a periodic cell it is the first moment of the heat flows over links. Between two walls the component along the
    load is the mean of the heat that enters at one and leaves at the other, over their area: the same by the divergence
    theorem, and right also where centres are held at wall temperature. Other components average the cells' fluxes.
    """
    if scene.periodic:
        first = np.empty((len(network.volumes), 3))
        kernels.moments(*_links(network), network.conductance, solution.gradient, _filled(solution), first)
        return -first.sum(axis=0) / scene.volume
    flux = network.volumes @ cell_fluxes(facets, network, solution, law=law) / scene.volume
    for axis, letter in enumerate("xyz"):
        if set(wall_heat) == {letter + "-", letter + "+"}:
            flux[axis] = 0.5 * (wall_heat[letter + "-"] - wall_heat[letter + "+"]) * scene.size[axis] / scene.volume
    return flux


def _links(network):
    return network.centers, network.size, network.indptr, network.indices, network.image


def _filled(solution):
    """Fluctuations with islands, which exchange no heat, set to zero."""
    return np.nan_to_num(solution.fluctuation)


def _temperatures(network, solution):
    return solution.fluctuation + network.centers @ solution.gradient


def cell_fluxes(facets, network, solution, *, law="laguerre"):
    """Flux density of each particle from the heat flows of its links, (n, 3) float array, W/m2.

    For "laguerre" q = -(sum S e e)^-1 sum e W, with W the heat received through a facet of area S in direction e:
    exact for linear fields, one-sided at facets on interfaces. Otherwise the papers' q = -1/(2 V) sum W b, V the volume
    that the particle stands for and b the branch vector (Haddad et al. 2021, eq. 20, with Fourier's sign).
    """
    n = len(network.volumes)
    flow = np.empty((n, 3))
    if law != "laguerre":
        kernels.moments(*_links(network), network.conductance, solution.gradient, _filled(solution), flow)
        return -flow / network.volumes[:, None]
    shape = np.empty((n, 3, 3))
    kernels.reconstruct(
        *_links(network), facets.area, network.conductance, solution.gradient, _filled(solution), shape, flow
    )
    normal = wall_normals(facets)
    outer = normal[:, :, None] * normal[:, None, :]
    np.add.at(shape, network.wall_particle, network.wall_area[:, None, None] * outer)
    np.add.at(flow, network.wall_particle, normal * solution.wall_heat[:, None])
    return -np.linalg.solve(shape, flow[..., None])[..., 0]


class _Locator:
    """Finds the radical cell that holds a point: the nearest centre in four dimensions, weight included."""

    def __init__(self, packing):
        self.size, self.periodic = packing.size, packing.periodic
        weights = packing.radii**2
        lifted = np.column_stack([packing.centers, np.sqrt(weights.max() - weights)])
        self.centers = packing.centers
        self.tree = cKDTree(lifted, boxsize=np.append(np.where(self.periodic, self.size, 0.0), 0.0))

    def __call__(self, points):
        """Cell numbers and offsets from their centres."""
        wrapped = np.where(self.periodic, points % self.size, points)
        _, cell = self.tree.query(np.column_stack([wrapped, np.zeros(len(points))]))
        offsets = wrapped - self.centers[cell]
        return cell, offsets - np.where(self.periodic, self.size * np.round(offsets / self.size), 0.0)


def _samplers(scene, packing, facets, network, solution, law):
    """The three lazy parts of a Field: its samples, temperature_at and flux_at."""
    fluxes = cache(lambda: cell_fluxes(facets, network, solution, law=law))
    slopes = cache(lambda: _slopes(scene, network, fluxes()))

    def samples():
        return Samples(network.centers, network.volumes, _temperatures(network, solution), network.phase, fluxes())

    if law == "laguerre":
        how = {"periodic": packing.periodic, "phase_at": scene.phase_at, "conductivities": scene.conductivities}
        edges = cache(lambda: edges_of(scene, facets, network, solution))
        parts = solution.fluctuation, solution.gradient
        smooth = cache(lambda: Reconstruction(network, edges(), *parts, slopes(), **how))
        return samples, lambda points: smooth().temperature_at(points), lambda points: smooth().flux_at(points)
    locate = cache(lambda: _Locator(packing))

    def temperature_at(points):
        cell, offsets = locate()(points)
        level = solution.fluctuation[cell] + (points - offsets) @ solution.gradient
        return level + np.einsum("ij,ij->i", slopes()[cell], offsets)

    def flux_at(points):
        return fluxes()[locate()(points)[0]]

    return samples, temperature_at, flux_at


def _slopes(scene, network, fluxes):
    """Gradient of each cell from its flux, zero in insulators, (n, 3) float array, K/m."""
    k = scene.conductivities[network.phase][:, None]
    return -np.divide(fluxes, k, out=np.zeros_like(fluxes), where=k > 0)


def _heat_through(network, solution, periodic, axis, position):
    """Heat that crosses the facets between cells on either side of a plane, along the axis, W.

    Cells are on the side of their centres; walls across the axis count as neighbours at their place. Between them every
    plane carries the same heat where none is stored, to the residual of the solver.
    """
    length, x, row = network.size[axis], network.centers[:, axis], row_numbers(network.indptr)
    step = x[network.indices] + image_shifts(network.image, network.size)[:, axis]

    def side(at):
        return np.floor((at - position) / length) if periodic[axis] else (at >= position).astype(float)

    temperature = _filled(solution)
    rise = temperature[network.indices] - temperature[row] + solution.gradient[axis] * (step - x[row])
    for k in (k for k in range(3) if solution.gradient[k] and k != axis):
        y = network.centers[:, k]
        there = y[network.indices] + image_shifts(network.image, network.size)[:, k]
        rise += solution.gradient[k] * (there - y[row])
    # Each link stands in two rows, with both signs changed.
    heat = -0.5 * float((side(step) - side(x[row])) @ (network.conductance * rise))
    for end in (0, 1):
        here = network.wall_side == 2 * axis + end
        heat += float((side(x[network.wall_particle[here]]) - end) @ solution.wall_heat[here])
    return heat
