"""Steady temperatures of a network under a scene's load."""

import math
from typing import NamedTuple

import numpy as np
from scipy import sparse

from demheat.conduction import components
from demheat.conduction.balance import at_walls, conducted, level_of, linear_start, residual, system_of, throughput
from demheat.conduction.multigrid import preconditioner
from demheat.conduction.preconditioned import by_diagonal, preconditioned
from demheat.conduction.products import dot, spread
from demheat.conduction.robin import COLDEST, hottest, radiated, robin_of
from demheat.network.base import SIDES, without_links
from demheat.network.links_kernels import links_of
from demheat.runtime.process_state import one_blas_thread
from demheat.runtime.progress import stage
from demheat.scene import Radiation

SOLVERS = ("auto", "cg", "amg", "amg-single")
COARSE = {"amg": np.float64, "amg-single": np.float32}
# Beyond this size multigrid takes fewer CPU-seconds than Jacobi iterations, whose number grows with size and contrast.
# Found on one and on 83 spheres, 1e4 to 1e5 particles, contrasts 0.01 to 1e6: about as many at 2e4 unknowns, half as
# many or fewer at 1e5.
AMG_UNKNOWNS = 50_000
# Relative residual at which iterations stop, of whoever solves a network and is not told another.
TOLERANCE = 1e-8
# Iterations, at most.
MOST_ITERATIONS = 20_000
# Beyond this contrast rounding may keep residuals above a tolerance below that.
HIGH_CONTRAST, LOOSER = 1e7, 1e-6
# Beyond this one multigrid, in single precision, may go on in vain: in a periodic cell of 1e5 particles with a sphere
# of 3e6 for 7900 iterations, where the diagonal takes a few hundred. Few that took more came to an end.
HIGHER_FOR_MULTIGRID, MOST_MULTIGRID = 1e6, 300
# Radiation is linearised anew so often at most; each set of equations is solved to this part of what the last one left.
ROUNDS, FURTHER = 40, 1e-3
# A multigrid serves while Robin's condition changes the diagonal by less than this factor.
SERVES = 3.0


class Unsolved(RuntimeError):
    """Equations whose residual stays above the tolerance."""


class Solution(NamedTuple):
    """Temperatures of the particles and what the solver says of them."""

    # (n,) float array, K: Of each particle, less the linear field of the mean gradient; NaN in pores and on components
    # that no wall temperature reaches
    temperature: np.ndarray
    mean_gradient: np.ndarray  # (3,) float array, K/m: Of a periodic cell; zero with walls
    wall_temperature: np.ndarray  # (w,) float array, K: At each wall facet of the network
    wall_heat: np.ndarray  # (w,) float array, W: Into the body through each wall facet
    # unknowns, iterations, residual, solver, islands; with radiation its rounds, as it was linearised so often
    stats: dict
    # (n,) bool array, optional: Particles that no heat passes, see `demheat.conduction.components`; None if everything
    # conducts
    still: np.ndarray | None = None


def solve_steady(network, scene, *, solver="auto", tolerance=TOLERANCE, max_iterations=MOST_ITERATIONS):
    """Temperatures at which every particle receives as much heat as it gives."""
    check_solver(solver, tolerance)
    scene.require(steady=True, takes=("resistance", "exchange", "image"))
    return solve_checked(network, scene, solver=solver, tolerance=tolerance, max_iterations=max_iterations)


def solve_checked(network, scene, *, solver, tolerance, max_iterations=MOST_ITERATIONS, kept=None, start=None):
    """The same as `solve_steady` of arguments that were checked before."""
    bodies = components.bodies(network, scene)
    network = network if bodies is None else without_links(network, bodies.still)
    reached = reached_by(network, scene)
    by_size = "amg" if reached.sum() > AMG_UNKNOWNS else "cg"
    chosen, kept = by_size if solver == "auto" else solver, {} if kept is None else kept
    in_vain = chosen != "cg" and contrast_of(scene) >= HIGHER_FOR_MULTIGRID
    most = min(max_iterations, MOST_MULTIGRID) if in_vain else max_iterations
    how = {"solver": chosen, "tolerance": tolerance, "most": most, "kept": kept}
    solve = _radiating if scene.radiates else _linear
    system, x, iterations, size, more = solve(network, scene, reached, _first(network, scene, reached, start), how)
    if in_vain and solver == "auto" and not size <= tolerance:
        chosen, first = "cg", _first(network, scene, reached, start)
        how |= {"solver": chosen, "most": max_iterations}
        system, x, further, size, more = solve(network, scene, reached, first, how)
        iterations += further
    if not size <= tolerance:
        raise Unsolved(
            f"solve_steady ({chosen}): relative residual {size:.2e} after {iterations} iterations, "
            f"asked for {tolerance:.1e}{_advice(scene, tolerance)}"
        )
    if scene.periodic and bodies is None:
        x -= np.average(x, weights=network.volumes)
    x = np.where(reached, x + system.level, np.nan)
    if bodies is not None:
        if scene.periodic:
            components.level_off(x, np.where(bodies.still, -1, bodies.label), network.volumes)
        x = np.where(bodies.still, bodies.temperature, x)
    stats = {
        "unknowns": int(reached.sum()),
        "iterations": int(iterations),
        "residual": float(size),
        "solver": chosen,
        "islands": int((~reached).sum()),
    } | more
    still = None if bodies is None else bodies.still
    return Solution(x, system.gradient, *at_walls(system, scene, x), stats, still)


def _first(network, scene, reached, start):
    """Temperatures to begin with."""
    return linear_start(network, scene, reached) if start is None else np.where(reached, start - level_of(scene), 0.0)


def imbalance(network, scene, solution) -> float:
    """Residual heat of the particles at given temperatures, over the heat that passes through them, as norms."""
    network = network if solution.still is None else without_links(network, solution.still)
    reached = reached_by(network, scene)
    x = np.where(reached, np.nan_to_num(solution.temperature) - level_of(scene), 0.0)
    if scene.radiates:
        surface = np.maximum(np.nan_to_num(solution.wall_temperature), COLDEST * hottest(network, scene))
        system = system_of(network, scene, reached, robin_of(network, scene, surface))
        return _radiation_left(system, scene, x)[1]
    return _relative(system_of(network, scene, reached), x)[0]


def _relative(system, x):
    """Norm of the residual over that of the heat that passes, the residual, and the latter norm."""
    r = residual(system, x)
    norm, passing = math.sqrt(dot(r, r)), _passing(system, x)
    return norm / passing if passing > 0 else float(norm > 0), r, passing if passing > 0 else norm


def _linear(network, scene, reached, first, how):
    system = system_of(network, scene, reached)
    return system, *_iterate(system, first, **how), {}


def _radiating(network, scene, reached, first, how):
    """Newton's method: fourth powers by their tangents at the surfaces' last temperatures, each solve from the last."""
    top = hottest(network, scene)
    surface, x, aim = np.full(len(network.wall_side), top), first, FURTHER
    how, rounds, total, size = how | {"kept": {"serves": SERVES}}, 0, 0, math.inf
    while rounds < ROUNDS and total < how["most"] and not size <= how["tolerance"]:
        robin = robin_of(network, scene, np.maximum(surface, COLDEST * top))
        system = system_of(network, scene, reached, robin)
        x, count, _ = _iterate(system, x, **how | {"tolerance": aim, "most": how["most"] - total})
        surface, size = _radiation_left(system, scene, x)
        rounds, total = rounds + 1, total + count
        aim = min(FURTHER, max(FURTHER * size, 0.5 * how["tolerance"]))
    return system, x, total, size, {"rounds": rounds}


def _radiation_left(system, scene, x):
    """Surfaces as tangents have them, and the residual with the fourth powers themselves, of the heat that passes."""
    network, robin = system.network, system.robin
    inside = system.level + x[network.wall_particle]
    surface = robin.surface(network.wall_conductance, inside)
    black = [SIDES.index(name) for name in scene.wall_exchanges if isinstance(scene.walls[name], Radiation)]
    tied = np.isin(network.wall_side, black) & (system.ties > 0)
    by_tangents = robin.conductance[tied] * (robin.outside - surface)[tied]
    missing = radiated(network, scene, surface)[tied] - by_tangents
    r = residual(system, x) + np.bincount(network.wall_particle[tied], missing, minlength=len(x))
    norm, passing = math.sqrt(dot(r, r)), _passing(system, x)
    return surface, norm / passing if passing > 0 else float(norm > 0)


def contrast_of(scene) -> float:
    """Largest conductivity over the least of what conducts; 0 if nothing does."""
    conducting = scene.mean_conductivities[scene.mean_conductivities > 0]
    return float(conducting.max(initial=0.0) / conducting.min(initial=math.inf))


def _advice(scene, tolerance):
    """What may help where rounding keeps the residual up: found from contrast 1e8 on."""
    if (contrast := contrast_of(scene)) < HIGH_CONTRAST:
        return ""
    looser = f"tolerance = {LOOSER:g}, which is mostly met, or " if tolerance < LOOSER else ""
    return f"; rounding keeps it up at a contrast of {contrast:.1e}: must be {looser}a lower contrast"


def check_solver(solver, tolerance):
    """Raise ValueError unless the solver is known and its tolerance sensible."""
    if solver not in SOLVERS:
        raise ValueError(f"solver = {solver!r}: must be one of {', '.join(SOLVERS)}")
    if not (isinstance(tolerance, int | float) and 1e-15 < tolerance < 1e-2):
        raise ValueError(f"tolerance = {tolerance!r}: must lie between 1e-15 and 1e-2")


def reached_by(network, scene):
    """Particles tied to a temperature, a wall's or of surroundings, or in a periodic cell to any other particle."""
    if scene.periodic:
        return conducted(network) > 0
    held = [SIDES.index(name) for name in scene.imposed_temperatures]
    reached = np.zeros(len(network.volumes), dtype=bool)
    reached[network.wall_particle[np.isin(network.wall_side, held) & (network.wall_conductance > 0)]] = True
    if network.cells and network.whole and network.conductance.min(initial=np.inf) > 0:
        # Cells fill the body: facets that conduct join all of them.
        reached[:] = reached.any()
    else:
        spread(links_of(network), reached)
    return reached


def _iterate(system, x, solver, tolerance, most, kept):
    """Solve in rounds: the heat that passes, which sets the limit, is known only once the solution nearly is."""
    total, solve = 0, None
    for _ in range(10):
        size, r, unit = _relative(system, x)
        if size <= tolerance or total >= most:
            break
        solve = solve or (_jacobi(system) if solver == "cg" else _multigrid(system, kept, COARSE[solver]))
        done, x = solve(r, x, 0.9 * tolerance * unit, most - total)
        total += done
    return x, total, size


def _passing(system, x):
    """Norm of the heat that passes through the particles."""
    through = throughput(system, x)
    return math.sqrt(dot(through, through))


def _jacobi(system):
    return _by(system, by_diagonal(system.diagonal))


def _by(system, precondition):
    """Conjugate gradients with a preconditioner; their own sums are not by BLAS."""
    links, diagonal = links_of(system.network), system.diagonal

    def solve(r, x, limit, most):
        with stage("equations") as done:
            return preconditioned(links, diagonal, precondition, r, x, limit, most, done), x

    return solve


def matrix(network, diagonal):
    """The network's heat balance as a SciPy matrix: diagonal minus conductances."""
    n = len(diagonal)
    off = sparse.csr_matrix(
        (-network.conductance, network.indices.astype(np.int32), network.indptr.astype(np.int32)), shape=(n, n)
    )
    return (off + sparse.diags(np.where(diagonal > 0, diagonal, 1.0))).tocsr()


def _multigrid(system, kept, coarse):
    """Conjugate gradients by multigrid, which is kept for another load that leads to the very same matrix."""
    diagonal = system.diagonal
    conductance, same = kept.get("matrix", (None, diagonal))
    if conductance is not system.network.conductance or not _serves(same, diagonal, kept.get("serves", 1.0)):
        with one_blas_thread():
            kept["precondition"] = preconditioner(links_of(system.network), diagonal, coarse)
        kept["matrix"] = system.network.conductance, diagonal
    solve = _by(system, kept["precondition"])

    def by_one_thread(*given):
        with one_blas_thread():
            return solve(*given)

    return by_one_thread


def _serves(one, other, factor):
    """Whether two diagonals are within a factor of each other."""
    return bool(np.all((one <= factor * other) & (other <= factor * one)))
