"""The Field of a solved network: mean flux, and temperature and flux wherever they are asked for."""

from functools import cache, partial

import numpy as np
from scipy.spatial import cKDTree

from demheat.field import Field, Samples
from demheat.network.base import SIDES, image_shifts, row_numbers, without_links
from demheat.sampling.edges import edges_of, transformed
from demheat.sampling.fluxes import cell_fluxes, filled, mean_flux
from demheat.sampling.reconstruct import Reconstruction

# Networks of contacts are calibrated in the mean over a body of one material, or not at all: errors declared of them,
# at 2000 particles, are .13 to .4.
CONTACTS = 0.5


def field_of(
    scene, network, solution, *, stats, time=None, estimator=None, slack=(0.0, 0.0), extrapolator=None
) -> Field:
    """The Field of a solved network."""
    if solution.still is not None:
        network = without_links(network, solution.still)
    temperature, heat = {}, {}
    for name in scene.walls or {}:
        here = network.wall_side == SIDES.index(name)
        temperature[name] = _wall_mean(solution.wall_temperature[here], network.wall_area[here])
        heat[name] = float(solution.wall_heat[here].sum())
    # What enters a body in time need not leave it.
    by_walls = time is None and not scene.periodic
    sampler, temperature_at, flux_at = samplers(scene, network, solution, steady=time is None)
    return Field(
        scene=scene,
        mean_flux=(between_walls if by_walls else mean_flux)(network, scene, solution),
        fractions=np.bincount(network.phase, network.volumes, len(scene.materials)) / network.volumes.sum(),
        sampler=sampler,
        temperature_at=temperature_at,
        flux_at=flux_at,
        wall_temperature=temperature,
        wall_heat=heat,
        stats=solution.stats | _described(network) | stats,
        time=time,
        through=lambda axis, position: heat_through(network, solution, axis, position),
        estimator=estimator,
        extrapolator=extrapolator,
        slack=slack if network.cells else (CONTACTS, CONTACTS),
    )


def _wall_mean(temperature, area):
    """Area-averaged temperature of a wall, where it has one: not on pores and isolated components."""
    known = np.isfinite(temperature) & (area > 0)
    return float(np.average(temperature[known], weights=area[known])) if known.any() else float("nan")


def _described(network):
    packing = (network.stats or {}).get("packing", {})
    made = packing.get("of", packing)  # a replica's
    return {"mean_radius": float(network.radii.mean()), "cached": made.get("cached"), **(network.stats or {})}


def between_walls(network, scene, solution):
    """Volume average of the flux density in a steady state, (3,) float array, W/m2.

    Between two walls the component along the load is the mean of the heat that enters at one and leaves at the other,
    over their area: the volume average by the divergence theorem, and right also where centres are held at wall
    temperature. Other components average the cells' fluxes.
    """
    # Not by BLAS here and below: the order of its sums is that of its threads.
    flux = np.einsum("i,ij->j", network.volumes, cell_fluxes(network, solution)) / scene.volume
    for axis, letter in enumerate("xyz"):
        if set(scene.walls or {}) == {letter + "-", letter + "+"}:
            low, high = (float(solution.wall_heat[network.wall_side == 2 * axis + end].sum()) for end in (0, 1))
            flux[axis] = 0.5 * (low - high) * scene.size[axis] / scene.volume
    return flux


def _temperatures(network, solution):
    return solution.temperature + network.centers @ solution.mean_gradient


class _Locator:
    """Finds the radical cell that holds a point: the nearest centre in four dimensions, weight included."""

    def __init__(self, network, among=None):
        self.among = np.arange(len(network.radii)) if among is None else np.flatnonzero(among)
        self.size, self.periodic = network.size, network.periodic
        weights = network.radii**2
        lifted = np.column_stack([network.centers, np.sqrt(weights.max() - weights)])
        self.centers = network.centers
        self.tree = cKDTree(lifted[self.among], boxsize=np.append(np.where(self.periodic, self.size, 0.0), 0.0))

    def __call__(self, points):
        """Cell numbers and offsets from their centres."""
        wrapped = np.where(self.periodic, points % self.size, points)
        _, cell = self.tree.query(np.column_stack([wrapped, np.zeros(len(points))]))
        cell = self.among[cell]
        offsets = wrapped - self.centers[cell]
        return cell, offsets - np.where(self.periodic, self.size * np.round(offsets / self.size), 0.0)


def samplers(scene, network, solution, *, steady=True):
    """The three lazy parts of a Field: its samples, temperature_at and flux_at."""
    fluxes = cache(lambda: cell_fluxes(network, solution))
    slopes = cache(lambda: _slopes(scene, network, fluxes()))

    def samples():
        return Samples(network.centers, network.volumes, _temperatures(network, solution), network.phase, fluxes())

    if network.cells:
        conducting = scene.conductivities[network.phase]
        if solution.still is not None:
            conducting[solution.still] = 0.0
        how = {"periodic": network.periodic, "phase_at": scene.phase_at, "conductivity": conducting, "steady": steady}
        edges = cache(lambda: edges_of(scene, network, solution))
        parts = transformed(scene, network.phase, solution.temperature), solution.mean_gradient
        smooth = cache(lambda: Reconstruction(network, edges(), *parts, slopes(), **how))
        return samples, partial(_temperature_at, scene, smooth), lambda points: smooth().flux_at(points)
    # In a steady state nobody asks for points in pores.
    solid = None if solution.still is None else scene.conductivities[network.phase] > 0
    locate = cache(lambda: _Locator(network, solid))

    def temperature_at(points):
        cell, offsets = locate()(points)
        level = solution.temperature[cell] + (points - offsets) @ solution.mean_gradient
        return level + np.einsum("ij,ij->i", slopes()[cell], offsets)

    def flux_at(points):
        return fluxes()[locate()(points)[0]]

    return samples, temperature_at, flux_at


def _temperature_at(scene, smooth, points):
    """Temperature at points, of what `transformed` made of it."""
    found = smooth().temperature_at(points)
    return scene.dependences.inverse(scene.phase_at(points), found) if scene.varies else found


def _slopes(scene, network, fluxes):
    """Gradient of each cell from its flux, zero in insulators, (n, 3) float array, K/m."""
    k = scene.conductivities[network.phase][:, None]
    return -np.divide(fluxes, k, out=np.zeros_like(fluxes), where=k > 0)


def heat_through(network, solution, axis, position):
    """Heat that crosses the facets between cells on either side of a plane, along the axis, W.

    Cells are on the side of their centres; walls across the axis count as neighbours at their place. Between them every
    plane carries the same heat where none is stored, to the residual of the solver.
    """
    length, x, row = network.size[axis], network.centers[:, axis], row_numbers(network.indptr)
    step = x[network.indices] + image_shifts(network.image, network.size)[:, axis]

    def side(at):
        return np.floor((at - position) / length) if network.periodic[axis] else (at >= position).astype(float)

    temperature = filled(solution)
    rise = temperature[network.indices] - temperature[row] + solution.mean_gradient[axis] * (step - x[row])
    for k in (k for k in range(3) if solution.mean_gradient[k] and k != axis):
        y = network.centers[:, k]
        there = y[network.indices] + image_shifts(network.image, network.size)[:, k]
        rise += solution.mean_gradient[k] * (there - y[row])
    # Each link stands in two rows, with both signs changed.
    heat = -0.5 * float(np.einsum("i,i->", side(step) - side(x[row]), network.conductance * rise))
    for end in (0, 1):
        here = network.wall_side == 2 * axis + end
        heat += float(np.einsum("i,i->", side(x[network.wall_particle[here]]) - end, solution.wall_heat[here]))
    return heat
