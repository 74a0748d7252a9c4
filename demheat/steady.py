"""Steady temperatures of a network under a scene's load."""

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from demheat import steady_kernels as kernels
from demheat.scene import WALLS

SOLVERS = ("auto", "cg", "amg")
# Measured in the study `speed_error`: beyond these, multigrid costs fewer CPU-seconds than Jacobi iterations.
AMG_UNKNOWNS = 2_000_000
AMG_CONTRAST = 50.0


class Solution(NamedTuple):
    """Temperatures of the particles and what the solver says of them.

    Attributes
    ----------
    fluctuation : (n,) float array, K
        Temperature minus the linear field of the mean gradient (periodic cell), or the temperature itself (walls);
        NaN on islands that no wall temperature reaches.
    gradient : (3,) float array, K/m
        Mean gradient; zero with walls.
    wall_temperature : (w,) float array, K
        At each wall facet of the network.
    wall_heat : (w,) float array, W
        Into the body through each wall facet.
    stats : dict
        unknowns, iterations, residual, solver, islands.
    """

    fluctuation: np.ndarray
    gradient: np.ndarray
    wall_temperature: np.ndarray
    wall_heat: np.ndarray
    stats: dict


class _System(NamedTuple):
    network: object
    diagonal: np.ndarray
    heat: np.ndarray
    scale: float
    start: np.ndarray


def solve_steady(network, scene, *, solver="auto", tolerance=1e-8, max_iterations=20_000):
    """Temperatures at which every particle receives as much heat as it gives.

    Parameters
    ----------
    network : Network
    scene : Scene
        Its load only.
    solver : {"auto", "cg", "amg"}
        Jacobi-preconditioned conjugate gradients, or conjugate gradients preconditioned by algebraic multigrid
        (Ruge-Stueben, pyamg); "auto" picks by size and contrast.
    tolerance : float
        On the norm of the residual heat relative to that of the heat passing through the particles in the mean
        gradient.
    max_iterations : int

    Returns
    -------
    Solution

    Raises
    ------
    ValueError
        If an argument is not as described or the load fixes no steady state.
    RuntimeError
        If the residual, recomputed after the solve, misses the tolerance.
    """
    if solver not in SOLVERS:
        raise ValueError(f"solver = {solver!r}: must be one of {', '.join(SOLVERS)}")
    if not 1e-15 < tolerance < 1e-2:
        raise ValueError(f"tolerance = {tolerance!r}: must lie between 1e-15 and 1e-2")
    scene.check_steady()
    gradient = np.array(scene.gradient if scene.periodic else (0.0, 0.0, 0.0))
    reached = _reached(network, scene)
    system, held = _system(network, scene, gradient, reached)
    chosen = _choose(int(reached.sum()), scene) if solver == "auto" else solver
    x, iterations = _iterate(system, chosen, tolerance, max_iterations)
    size = _residual(system, x)
    if not size <= 1.01 * tolerance:  # 1 %: rounding between the recursive and the recomputed residual
        raise RuntimeError(
            f"solve_steady ({chosen}): relative residual {size:.2e} after {iterations} iterations, "
            f"asked for {tolerance:.1e}"
        )
    if scene.periodic:
        x -= np.average(x, weights=network.volumes)
    x[~reached] = np.nan
    stats = {
        "unknowns": int(reached.sum()),
        "iterations": int(iterations),
        "residual": float(size),
        "solver": chosen,
        "islands": int((~reached).sum()),
    }
    return Solution(x, gradient, *_at_walls(network, scene, held, x), stats)


def _reached(network, scene):
    """Particles tied to a wall temperature (walls), or to any other particle (periodic cell)."""
    n = len(network.volumes)
    if scene.periodic:
        conducts = np.zeros(n, dtype=bool)
        conducts[np.repeat(np.arange(n), np.diff(network.indptr))[network.conductance > 0]] = True
        return conducts
    graph = sparse.csr_matrix((network.conductance, network.indices.astype(np.int32), network.indptr), shape=(n, n))
    graph.eliminate_zeros()
    _, label = csgraph.connected_components(graph, directed=False)
    held = [WALLS.index(name) for name in scene.wall_temperatures]
    anchors = network.wall_particle[np.isin(network.wall_side, held) & (network.wall_conductance > 0)]
    return np.isin(label, np.unique(label[anchors]))


def _system(network, scene, gradient, reached):
    """Diagonal, heat sources, scale of the residual and start vector of A x = heat."""
    n = len(network.volumes)
    received, throughput = np.empty(n), np.empty(n)
    links = (network.centers, network.size, network.indptr, network.indices, network.image, network.conductance)
    diagonal = np.bincount(np.repeat(np.arange(n), np.diff(network.indptr)), network.conductance, minlength=n)
    if scene.periodic:
        kernels.linear_flows(*links, gradient, received, throughput)
        return _System(network, diagonal, received, float(np.linalg.norm(throughput)), np.zeros(n)), None
    temperatures, fluxes = scene.wall_temperatures, scene.wall_fluxes
    held = np.array([temperatures.get(name, np.nan) for name in WALLS])[network.wall_side]
    is_held = np.isfinite(held)
    ties = np.where(is_held, network.wall_conductance, 0.0)
    given = np.array([fluxes.get(name, 0.0) for name in WALLS])[network.wall_side] * network.wall_area
    level = np.mean(list(temperatures.values()))
    slope = (np.ptp(list(temperatures.values())) + _flux_rise(network, fluxes)) / network.size.max()
    kernels.linear_flows(*links, np.full(3, slope), received, throughput)
    particle = network.wall_particle
    diagonal += np.bincount(particle, ties, minlength=n)
    heat = np.bincount(particle, ties * np.where(is_held, held, 0.0) + given, minlength=n)
    lost = np.bincount(particle, given, minlength=n)[~reached]
    if np.any(lost != 0):
        raise ValueError(
            f"Scene.walls: {np.count_nonzero(lost)} particles receive an imposed flux but are cut off from "
            "every wall temperature; no steady state exists"
        )
    start = _linear_start(network, scene, level)
    diagonal[~reached], start[~reached] = 0.0, 0.0
    return _System(network, diagonal, heat, float(np.linalg.norm(throughput)), start), held


def _flux_rise(network, fluxes):
    """Temperature rise that imposed fluxes would make in a bar of the network's mean link conductivity."""
    if not fluxes:
        return 0.0
    k = np.median(network.wall_conductance / network.wall_area) * network.volumes.mean() ** (1 / 3)
    return max(abs(q) for q in fluxes.values()) * network.size.max() / k if k > 0 else 0.0


def _linear_start(network, scene, level):
    """Linear field between two opposite wall temperatures, else their mean."""
    temperatures = scene.wall_temperatures
    start = np.full(len(network.volumes), level)
    for axis, letter in enumerate("xyz"):
        if {letter + "-", letter + "+"} == set(temperatures):
            low, high = temperatures[letter + "-"], temperatures[letter + "+"]
            start = low + (high - low) * network.centers[:, axis] / network.size[axis]
    return start


def _choose(unknowns, scene):
    """Multigrid for many unknowns or a wide contrast, else Jacobi-preconditioned conjugate gradients."""
    k = scene.conductivities[scene.conductivities > 0]
    wide = len(k) and k.max() > AMG_CONTRAST * k.min()
    return "amg" if unknowns > AMG_UNKNOWNS or (wide and unknowns > 200_000) else "cg"


def _iterate(system, solver, tolerance, most):
    net, x = system.network, system.start.copy()
    limit = tolerance * system.scale
    r = np.empty_like(x)
    kernels.residual(net.indptr, net.indices, net.conductance, system.diagonal, system.heat, x, r)
    r[system.diagonal == 0.0] = 0.0
    if np.linalg.norm(r) <= limit:
        return x, 0
    if solver == "amg":
        return _multigrid(system, x, r, limit, most)
    done, total = 0, 0
    for _ in range(3):  # restart from the recomputed residual where the recursive one has drifted
        done = kernels.conjugate_gradients(net.indptr, net.indices, net.conductance, system.diagonal, r, x, limit, most)
        total += abs(done)
        kernels.residual(net.indptr, net.indices, net.conductance, system.diagonal, system.heat, x, r)
        r[system.diagonal == 0.0] = 0.0
        if np.linalg.norm(r) <= limit or total >= most:
            break
    return x, total


def matrix(network, diagonal):
    """The network's heat balance as a SciPy matrix: diagonal minus conductances; empty rows get a one."""
    n = len(diagonal)
    off = sparse.csr_matrix(
        (-network.conductance, network.indices.astype(np.int32), network.indptr.astype(np.int32)), shape=(n, n)
    )
    return (off + sparse.diags(np.where(diagonal > 0, diagonal, 1.0))).tocsr()


def _multigrid(system, x, r, limit, most):
    import pyamg

    a = matrix(system.network, system.diagonal)
    hierarchy = pyamg.ruge_stuben_solver(a, max_coarse=500)
    precondition = hierarchy.aspreconditioner(cycle="V")
    count = [0]

    def tick(_):
        count[0] += 1

    dx, _ = sparse.linalg.cg(a, r, rtol=0.0, atol=limit, maxiter=most, M=precondition, callback=tick)
    return x + dx, count[0]


def _residual(system, x):
    """Recomputed relative residual; islands, which have no equation, left out."""
    net, r = system.network, np.empty_like(x)
    kernels.residual(net.indptr, net.indices, net.conductance, system.diagonal, system.heat, x, r)
    r[system.diagonal == 0.0] = 0.0
    norm = np.linalg.norm(r)
    return norm / system.scale if system.scale > 0 else norm


def _at_walls(network, scene, held, x):
    """Temperature and entering heat of each wall facet."""
    if scene.periodic:
        return np.empty(0), np.empty(0)
    particle, ties = network.wall_particle, network.wall_conductance
    fluxes = np.array([scene.wall_fluxes.get(name, 0.0) for name in WALLS])[network.wall_side]
    imposed = fluxes * network.wall_area
    there = x[particle]
    rise = np.divide(imposed, ties, out=np.zeros_like(ties), where=ties > 0)
    is_held = np.isfinite(held)
    temperature = np.where(is_held, held, there + rise)
    heat = np.where(is_held, ties * (np.where(is_held, held, 0.0) - there), imposed)
    return temperature, np.where(np.isnan(heat), 0.0, heat)
