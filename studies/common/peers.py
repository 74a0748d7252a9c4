"""Our tessellation and our steady solver beside others', on the same data and in the same process."""

import math
import warnings

import numpy as np

from demheat.gallery import sphere_in_cube
from studies.harness.cost import measured


def tessellation(particles, seed):
    """CPU time of the radical cells of one walled packing by our kernel and by Voro++ (multivoro)."""
    from demheat.network.laguerre import laguerre
    from demheat.packing.cache import relaxed

    size = sphere_in_cube().size
    for number in (1000, particles):  # the first loads the compiled kernels
        packing = relaxed(number, size=size, periodic=False, seed=seed)
        facets, cost = measured(laguerre, packing.centers, packing.radii**2, packing.size, periodic=packing.periodic)
    found = {"us_per_particle": 1e6 * cost["cpu_s"] / particles}
    inner = (len(facets.indices) + len(facets.wall_particle)) / particles
    return found | {"facets_per_cell": inner} | _voro(packing) | cost


def _voro(packing):
    try:
        from multivoro import compute_voronoi
    except ImportError:
        return {"peer_us_per_particle": None, "peer_facets_per_cell": None}
    limits = np.array([np.zeros(3), packing.size])
    periodic = tuple(bool(p) for p in packing.periodic)
    cells, cost = measured(
        compute_voronoi, packing.centers, limits=limits, periodic_boundaries=periodic, radii=packing.radii
    )
    sample = cells[:: math.ceil(len(cells) / 2000)]
    facets = np.mean([len(cell.get_neighbors()) for cell in sample])
    return {"peer_us_per_particle": 1e6 * cost["cpu_s"] / len(cells), "peer_facets_per_cell": float(facets)}


def steady(particles, seed, scene):
    """CPU time of one steady solve by our solver and by plain pyamg on the same matrix, to the same residual.

    The packing is replicas of a smaller one, drawn off the walls; twins at interfaces are not repeated.
    """
    import pyamg

    from demheat.conduction.steady import solve_steady

    for number in (1000, particles):  # the first loads the compiled kernels
        network = laguerre_network(scene, number, seed)
        solution, cost = measured(solve_steady, network, scene)
    a, b = matrix_of(network, scene)
    reached = float(np.linalg.norm(b - a @ solution.temperature) / np.linalg.norm(b))
    low, high = scene.wall_temperatures["y-"], scene.wall_temperatures["y+"]
    start = low + (high - low) * network.centers[:, 1] / scene.size[1]  # as ours starts
    row = {"solver": solution.stats["solver"], "unknowns": len(b), "residual": reached}
    row |= {"iterations": solution.stats["iterations"], **cost}
    peers = {"ruge_stuben": pyamg.ruge_stuben_solver, "aggregation": pyamg.smoothed_aggregation_solver}
    for name, setup in peers.items():
        (x, iterations), peer = measured(_pyamg, setup, a, b, start, reached)
        row |= {f"{name}_{key}": peer[key] for key in ("cpu_s", "peak_mib")} | {f"{name}_iterations": iterations}
        row[f"{name}_residual"] = float(np.linalg.norm(b - a @ x) / np.linalg.norm(b))
    return row


# Particles in a replica of the packing, at most: what the matrix looks like does not depend on it, and it is soon made.
REPLICA = 130_000


def laguerre_network(scene, particles, seed):
    """The network of a scene on replicas of a small packing."""
    from demheat.dem.networks import network_of
    from demheat.laws import Laguerre
    from demheat.packing.cache import replicated

    counts = [math.ceil((particles / REPLICA) ** (1 / 3))] * 3
    packing = replicated(particles, counts, size=scene.size, periodic=scene.periodic, seed=seed)
    with warnings.catch_warnings():
        # Few particles do not resolve gaps, which no solver of the matrix notices.
        warnings.filterwarnings("ignore", message=".*do not fit into gaps")
        return network_of(scene, packing, Laguerre(), seed=seed)


def matrix_of(network, scene):
    """Heat balance of the particles as a SciPy matrix and right-hand side, W/K and W."""
    from demheat.conduction.steady import matrix
    from demheat.network.base import row_numbers
    from demheat.scene import WALLS

    n = len(network.volumes)
    held = np.array([scene.wall_temperatures.get(name, np.nan) for name in WALLS])[network.wall_side]
    ties = np.where(np.isfinite(held), network.wall_conductance, 0.0)
    diagonal = np.bincount(row_numbers(network.indptr), network.conductance, n) + np.bincount(
        network.wall_particle, ties, n
    )
    return matrix(network, diagonal), np.bincount(network.wall_particle, ties * np.nan_to_num(held), n)


def _pyamg(setup, a, b, start, tolerance):
    history = []
    x = setup(a).solve(b, x0=start.copy(), tol=tolerance, accel="cg", maxiter=200, residuals=history)
    return x, len(history) - 1
