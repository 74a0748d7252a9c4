"""The discrete element method: a packing, its network of conductances, and the field they give."""

import time
from functools import cache

import numpy as np
from scipy.spatial import cKDTree

from demheat import steady_kernels as kernels
from demheat.field import Field, Samples
from demheat.network.interface import connect
from demheat.network.laguerre import laguerre
from demheat.packing.cache import relaxed
from demheat.packing.conforming import conform
from demheat.scene import WALLS
from demheat.steady import solve_steady

LAWS = ("laguerre", "calibrated")


def solve(
    scene,
    *,
    particles=100_000,
    seed=0,
    law="laguerre",
    conforming=None,
    interface="harmonic",
    packing=None,
    solver="auto",
    tolerance=1e-8,
    allow_few=False,
):
    """Steady conduction in a scene by the discrete element method.

    Parameters
    ----------
    scene : Scene
    particles : int
        Number of particles of the packing before twins are added at interfaces.
    seed : int
        Of the packing.
    law : {"laguerre", "calibrated"}
        Transmission surfaces: facets of the radical tessellation, or C_t pi R_m^2 between touching particles with C_t
        from a homogeneous solve (Haddad et al. 2021, eqs. 7-9).
    conforming : bool, optional
        Mirror particles across every interface so that facets lie on it; the default for "laguerre".
    interface : {"harmonic", "arithmetic"}
        Rule for links between materials (Haddad et al. 2021, eq. 24).
    packing : Packing, optional
        Used instead of a relaxed one; must have the scene's box and periodicity.
    solver : {"auto", "cg", "amg"}
    tolerance : float
        On the relative residual of the heat balance.
    allow_few : bool
        Accept fewer than 100 particles.

    Returns
    -------
    Field

    Raises
    ------
    ValueError
        If an argument is not as described, before any heavy work.
    RuntimeError
        If the solver does not converge.
    """
    if law not in LAWS:
        raise ValueError(f"law = {law!r}: must be one of {', '.join(LAWS)}")
    conforming = law == "laguerre" if conforming is None else conforming
    scene.check_steady()
    clock = [time.perf_counter()]
    if packing is None:
        packing = relaxed(particles, size=scene.size, periodic=scene.periodic, seed=seed, allow_few=allow_few)
    clock.append(time.perf_counter())
    if conforming:
        packing = conform(packing, scene, seed=seed)
    facets = laguerre(packing.centers, packing.radii**2, packing.size, periodic=packing.periodic)
    clock.append(time.perf_counter())
    phase = scene.phase_at(packing.centers)
    network = connect(facets, packing.centers, packing.size, phase, scene.conductivities, rule=interface)
    clock.append(time.perf_counter())
    solution = solve_steady(network, scene, solver=solver, tolerance=tolerance)
    clock.append(time.perf_counter())
    spent = dict(zip(("packing_s", "tessellation_s", "network_s", "solve_s"), np.diff(clock), strict=True))
    return field_of(scene, packing, facets, network, solution, stats=spent)


def field_of(scene, packing, facets, network, solution, *, stats):
    """The Field of a solved network."""
    walls = scene.walls or {}
    temperature, heat = {}, {}
    for name in walls:
        here = network.wall_side == WALLS.index(name)
        temperature[name] = float(np.average(solution.wall_temperature[here], weights=network.wall_area[here]))
        heat[name] = float(solution.wall_heat[here].sum())
    sampler, temperature_at, flux_at = _samplers(scene, packing, facets, network, solution)
    return Field(
        scene=scene,
        mean_flux=_mean_flux(scene, network, solution),
        fractions=np.bincount(network.phase, network.volumes, len(scene.materials)) / network.volumes.sum(),
        sampler=sampler,
        temperature_at=temperature_at,
        flux_at=flux_at,
        wall_temperature=temperature,
        wall_heat=heat,
        stats={**solution.stats, **stats, **packing.provenance},
    )


def _mean_flux(scene, network, solution):
    """Volume average of the flux density: the first moment of the heat flows over links and wall facets."""
    first = np.empty((len(network.volumes), 3))
    kernels.moments(*_links(network), network.conductance, solution.gradient, _filled(solution), first)
    flow = first.sum(axis=0)
    for heat, side, height in zip(solution.wall_heat, network.wall_side, network.wall_distance, strict=True):
        flow[side // 2] += heat * height * (2 * (side % 2) - 1)
    return -flow / scene.volume


def _links(network):
    return network.centers, network.size, network.indptr, network.indices, network.image


def _filled(solution):
    """Fluctuations with islands, which exchange no heat, set to zero."""
    return np.nan_to_num(solution.fluctuation)


def _temperatures(network, solution):
    return solution.fluctuation + network.centers @ solution.gradient


def cell_fluxes(facets, network, solution):
    """Flux density of each particle from its facets' heat flows, (n, 3) float array, W/m2.

    q = -(sum S e e)^-1 sum e W, with W the heat received through a facet of area S in direction e: exact for linear
    fields, and one-sided at facets on interfaces.
    """
    n = len(network.volumes)
    shape, flow = np.empty((n, 3, 3)), np.empty((n, 3))
    kernels.reconstruct(
        *_links(network), facets.area, network.conductance, solution.gradient, _filled(solution), shape, flow
    )
    axis, sign = network.wall_side // 2, 2 * (network.wall_side % 2) - 1
    np.add.at(shape, (network.wall_particle, axis, axis), network.wall_area)
    np.add.at(flow, (network.wall_particle, axis), sign * solution.wall_heat)
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


def _samplers(scene, packing, facets, network, solution):
    """The three lazy parts of a Field: its samples, temperature_at and flux_at."""
    fluxes = cache(lambda: cell_fluxes(facets, network, solution))
    locate = cache(lambda: _Locator(packing))
    conductivity = scene.conductivities[network.phase]

    def samples():
        return Samples(network.centers, network.volumes, _temperatures(network, solution), network.phase, fluxes())

    def temperature_at(points):
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        cell, offsets = locate()(points)
        slope = -np.divide(
            fluxes()[cell], conductivity[cell, None], out=np.zeros_like(offsets), where=conductivity[cell, None] > 0
        )
        level = solution.fluctuation[cell] + (points - offsets) @ solution.gradient
        return level + np.einsum("ij,ij->i", slope, offsets)

    def flux_at(points):
        cell, _ = locate()(np.asarray(points, dtype=float).reshape(-1, 3))
        return fluxes()[cell]

    return samples, temperature_at, flux_at
