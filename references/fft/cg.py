"""Scalar scheme: one temperature per node, conjugate gradients preconditioned by a homogeneous medium through FFT.

Two discretisations.  Voxels: hexahedra with one integration point, which is Willot's rotated scheme, C. R. Mecanique
343 (2015) 232-245; Schneider, Merkert and Kabel, Int. J. Numer. Meth. Engng 109 (2017) 1461-1489.  Links: seven-point
differences between voxel centres with harmonic means along each link.  In a box the transforms are sines along the
load and cosines across, the eigenvectors of the homogeneous box.

The iteration stops when two numbers are small: the decrease of the energy over the last eighth of the iterations,
which estimates the error in the energy norm (Strakos and Tichy, Electron. Trans. Numer. Anal. 13 (2002) 56-80), below
tolerance^2 times the energy; and the part of the flux that is not divergence-free below tolerance times the mean
flux.  The first alone stops on a plateau at contrast 1e6, the second alone too early when inclusions insulate.  Both
are then checked once more from the recomputed residual.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from demheat.runtime.progress import stage
from references.fft import cg_kernels as kernels
from references.fft.cg_kernels import Symbol, Vectors
from references.fft.hexahedron_kernels import Body, Sums, conduct_voxels, voxel_state
from references.fft.link_kernels import Links, conduct_links, link_state
from references.fft.problem import Clock, Problem, SolvedGrid, converged, total
from references.fft.sweeps import Transform
from references.fft.transforms import fourier, trigonometric
from references.threads import Team
from references.voxels.laminates import with_own
from references.voxels.paint import medium

# cos^2 of a Nyquist frequency is rounding of zero; the smallest that is not zero is about 1 / (number of voxels)^2.
ZERO = 1e-30


class System(NamedTuple):
    """The discrete problem, the vectors of its iteration, and what inverts the homogeneous problem.

    Another with the same methods, `size`, `transform` and `vectors` may have parts of all that (`ranks`).
    """

    problem: Problem
    kernel: Callable
    body: Body
    transform: Transform
    symbol: Symbol
    vectors: Vectors
    sums: Sums

    @property
    def size(self) -> int:
        """Voxels."""
        return self.problem.voxels.phase.size

    @property
    def unknowns(self) -> int:
        """Nodes."""
        return self.vectors.theta.size

    def conduct(self, theta: np.ndarray, gradient: np.ndarray) -> Sums:
        """work = -div(K grad(theta + gradient.x)); returns the sums of every plane."""
        arguments = (theta, self.vectors.work, self.body, gradient.astype(self.problem.dtype), self.sums)
        self.problem.team.run(self.kernel, len(theta), *arguments)
        return self.sums

    def precondition(self, kernel: Callable, *arguments) -> float:
        """work = inverse homogeneous operator on what a kernel leaves in work; returns residual.work."""
        transform, vectors = self.transform, self.vectors
        transform.planes(kernel, vectors, *arguments, forward=True)
        transform.columns(kernels.divide, self.symbol, self.problem.dtype(transform.scale))
        transform.planes(kernels.dot, vectors, backward=True)
        return float(vectors.partial.sum())

    def turn(self, beta: float) -> float:
        """Make work + beta direction the direction; returns p.A p."""
        vectors = self.vectors
        self.problem.team.run(kernels.turn, len(vectors.work), vectors, self.problem.dtype(beta))
        return total(self.conduct(vectors.direction, np.zeros(3)).energy)

    def keeper(self) -> Callable:
        """What makes temperatures and fluxes of voxels from the solution; `SolvedGrid.state`."""
        # Without the system itself, whose transform holds as much as all temperatures.
        problem, body, theta = self.problem, self.body, self.vectors.theta
        shape, gradient = problem.voxels.phase.shape, problem.gradient.astype(problem.dtype)

        def centers():
            flux = np.empty((3, *shape), problem.dtype)
            with Team(problem.team.threads) as team:
                if problem.links:
                    team.run(link_state, shape[0], theta, body, gradient, flux)
                    return theta.copy(), flux
                temperature = np.empty(shape, problem.dtype)
                team.run(voxel_state, shape[0], theta, body, gradient, temperature, flux)
            return temperature, flux

        return centers


class _State(NamedTuple):
    """Where the true residual stands: sums of g.q and q, mean flux at both ends, r.z and p.A p of the next step."""

    energy: float
    flux: np.ndarray
    ends: np.ndarray
    rz: float
    curvature: float

    @property
    def decrease(self):
        return self.rz**2 / self.curvature if self.curvature > 0 else 0.0


def solve(problem: Problem, *, kept: dict | None = None) -> SolvedGrid:
    """Temperatures by preconditioned conjugate gradients."""
    kept = {} if kept is None else kept
    system = kept["system"] = _again(kept["system"], problem) if kept else _system(problem)
    return solved(problem, system)


def solved(problem: Problem, system: System) -> SolvedGrid:
    """The solution of a discrete problem, see `solve`."""
    iterations, before, clock = 0, math.inf, Clock(system.transform)
    while True:
        state = _restart(problem, system)
        error = _error(state.rz, state.energy, system)
        # How far each criterion is from being met: both are below 1 at the end.
        excess = max(state.decrease / (problem.tolerance**2 * state.energy), error / problem.tolerance) if error else 0
        if excess <= 1:
            return _solution(system, state, iterations, error, clock.cost())
        if iterations >= problem.max_iterations or not excess < before:
            _fail(problem, iterations, error)
        before = excess
        with clock, stage("iterations") as done:
            iterations = _iterate(problem, system, state, iterations, done)


def _error(rz, energy, system):
    """Part of the flux that is not divergence-free, root mean square over the mean flux: the equilibrium error."""
    return math.sqrt(max(rz, 0.0) * system.size) / float(energy) if energy > 0 else 0.0


def _fail(problem, iterations, error):
    if problem.dtype == np.float32:
        ask = "allow more max_iterations, a larger tolerance, or use precision 'float64'"
    elif iterations >= problem.max_iterations:
        ask = "allow more max_iterations or a larger tolerance"
    else:
        ask = "rounding ends it: a larger tolerance, or inf or 0 for a conductivity so far from the others"
    raise RuntimeError(
        f"fft.solve: scheme 'cg' did not converge: {iterations} iterations, relative residual {error:.2e}, "
        f"tolerance {problem.tolerance:.1e}; {ask}"
    )


def _system(problem):
    (nx, ny, nz), (conduct, body) = problem.voxels.phase.shape, body_of(problem)
    nodes = nodes_of(problem, (nx, ny, nz))
    transform = _transform(problem, nodes)
    vectors = vectors_of(problem, nodes, transform.real[0])
    sums = Sums(np.zeros(nx), np.zeros((nx, 3)))
    return System(problem, conduct, body, transform, _symbol(problem, transform), vectors, sums)


def body_of(problem: Problem) -> tuple[Callable, Body]:
    """What conducts, and the kernel that knows how."""
    voxels, links, dtype = problem.voxels, problem.links, problem.dtype
    if links:
        conduct, inverse = conduct_links, 1.0 / voxels.spacing
        material = Links(*(np.ascontiguousarray(link, dtype) for link in links))
    else:
        conduct, inverse = conduct_voxels, 0.25 / voxels.spacing
        voxels = voxels if voxels.tensors is None else with_own(voxels)
        material = medium(voxels, voxels.conductivity, voxels.tensor, dtype)
    return conduct, Body(material, inverse.astype(dtype), problem.walls)


def nodes_of(problem: Problem, shape: tuple) -> tuple:
    """Nodes along each axis of so many voxels."""
    nx, ny, nz = shape
    return (nx - 1, ny + 1, nz + 1) if problem.walls and not problem.links else (nx, ny, nz)


def _again(system, problem):
    """The same for another gradient, with temperatures of its own: a solution keeps those before."""
    return system._replace(problem=problem, vectors=system.vectors._replace(theta=np.zeros_like(system.vectors.theta)))


def _transform(problem, nodes):
    make = {"dtype": problem.dtype, "threads": problem.team.threads}
    if not problem.walls:
        return fourier(1, nodes, **make)
    # Links have their nodes half a step inside the walls, voxels on them.
    kind = "2" if problem.links else "1"
    return trigonometric([("sin" + kind, "cos" + kind, "cos" + kind)], nodes, **make)


def vectors_of(problem: Problem, nodes: tuple, work: np.ndarray) -> Vectors:
    """The vectors of the iteration, zeros."""
    theta, residual, direction = (np.zeros(nodes, problem.dtype) for _ in range(3))
    weights = [np.ones(n, problem.dtype) for n in nodes[1:]]
    if problem.walls and not problem.links:
        # A node on an insulated face owns half a cell: the preconditioner acts on its residual per volume.
        for weight in weights:
            weight[[0, -1]] = 2
    return Vectors(theta, residual, direction, work, *weights, partial=np.zeros(len(work)))


def _symbol(problem, transform):
    """The symbol with the factors of x as wide as a column of modes."""
    modes, shape = transform.modes.shape[1:], problem.voxels.phase.shape
    found = symbol(modes, shape, problem)
    if problem.walls:
        return found
    # Columns of modes have real and imaginary parts in turn.
    return Symbol(*((np.repeat(along, 2), *across) for along, *across in found))


def symbol(modes: tuple, shape: tuple, problem: Problem) -> Symbol:
    """Per axis (2 sin(k/2) / h)^2, and cos(k/2)^2 or 1."""
    if problem.walls:
        numbers = [np.pi * (np.arange(m) + (axis == 0)) / shape[axis] for axis, m in enumerate(modes)]
    else:
        numbers = [2 * np.pi * np.arange(m) / n for m, n in zip(modes, shape, strict=True)]
    sines = [(2 * np.sin(k / 2) / h) ** 2 for k, h in zip(numbers, problem.voxels.spacing, strict=True)]
    cosines = [np.ones_like(k) if problem.links else np.cos(k / 2) ** 2 for k in numbers]
    return Symbol(
        tuple(s.astype(problem.dtype) for s in sines),
        tuple(np.where(c < ZERO, 0.0, c).astype(problem.dtype) for c in cosines),
    )


def _restart(problem, system):
    """Recompute the residual and make the preconditioned residual the direction."""
    sums = system.conduct(system.vectors.theta, problem.gradient)
    energy, flux = total(sums.energy), sums.flux.sum(axis=0)
    ends = sums.flux[[0, -1], 0] * len(sums.flux) / system.size
    rz = system.precondition(kernels.start)
    return _State(energy, flux, ends, rz, curvature=system.turn(0))


def _iterate(problem, system, state, iterations, done):
    """Conjugate gradients from a fresh direction until the decrease of energy is small; returns the iterations."""
    energy, rz, curvature, decreases = state.energy, state.rz, state.curvature, []
    first = _error(rz, energy, system)
    while iterations < problem.max_iterations and curvature > 0:
        alpha = rz / curvature
        decreases.append(alpha * rz)
        energy -= decreases[-1]
        iterations += 1
        before, rz = rz, system.precondition(kernels.step, problem.dtype(alpha))
        small = sum(decreases[-max(2, len(decreases) // 8) :]) <= problem.tolerance**2 * energy
        error = _error(rz, energy, system)
        if small and error <= problem.tolerance:
            break
        done(converged(first, error, problem.tolerance))
        curvature = system.turn(rz / before)
    return iterations


def _solution(system, state, iterations, error, cost):
    errors, mean_flux = {"residual": error}, state.flux / system.size
    return SolvedGrid(mean_flux, state.ends, system.keeper(), system.unknowns, iterations, errors, cost)
