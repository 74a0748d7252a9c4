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

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from references.fft import cg_kernels as kernels
from references.fft import link_kernels
from references.fft.problem import Clock, Problem, Solution
from references.fft.sweeps import Transform
from references.fft.transforms import fourier, trigonometric
from references.threads import Team
from references.voxels.paint import medium

# cos^2 of a Nyquist frequency is rounding of zero; the smallest that is not zero is about 1 / (number of voxels)^2.
ZERO = 1e-30


class _Operator(NamedTuple):
    """The discrete problem: kernels, their arguments, and what inverts the homogeneous one."""

    conduct: object
    material: object
    inverse: np.ndarray
    transform: Transform
    symbol: tuple
    weights: tuple
    shape: tuple


class _Vectors(NamedTuple):
    theta: np.ndarray
    residual: np.ndarray
    direction: np.ndarray
    work: np.ndarray
    sums: np.ndarray
    partial: np.ndarray


class _State(NamedTuple):
    """Where the true residual stands: sums of g.q, q and q.q, flux at both ends, r.z and p.A p of the next step."""

    sums: np.ndarray
    ends: np.ndarray
    rz: float
    curvature: float

    @property
    def decrease(self):
        return self.rz**2 / self.curvature if self.curvature > 0 else 0.0


def solve(problem: Problem) -> Solution:
    """Temperatures by preconditioned conjugate gradients.

    Raises
    ------
    RuntimeError
        If the energy still decreases after the allowed iterations, or rounding keeps the recomputed residual up.
    """
    operator = _operator(problem)
    work = operator.transform.real[0]
    theta, residual, direction = (np.zeros(operator.shape, problem.dtype) for _ in range(3))
    planes = problem.voxels.phase.shape[0]
    vectors = _Vectors(theta, residual, direction, work, np.zeros((planes, 5)), np.zeros(len(work)))
    iterations, before, clock = 0, math.inf, Clock(operator.transform)
    while True:
        state = _restart(problem, operator, vectors)
        error = _error(state.rz, state.sums[0], problem)
        # How far each criterion is from being met: both are below 1 at the end.
        excess = max(state.decrease / (problem.tolerance**2 * state.sums[0]), error / problem.tolerance) if error else 0
        if excess <= 1:
            return _solution(problem, operator, vectors, state, iterations, error, clock.cost())
        if iterations >= problem.max_iterations or not excess < before:
            _fail(iterations, error, problem.tolerance)
        before = excess
        with clock:
            iterations = _iterate(problem, operator, vectors, state, iterations)


def _error(rz, energy, problem):
    """Part of the flux that is not divergence-free, root mean square over the mean flux: the equilibrium error."""
    return math.sqrt(max(rz, 0.0) * problem.voxels.phase.size) / float(energy) if energy > 0 else 0.0


def _fail(iterations, error, tolerance):
    raise RuntimeError(
        f"fft.solve: scheme 'cg' did not converge: {iterations} iterations, relative residual {error:.2e}, "
        f"tolerance {tolerance:.1e}; allow more max_iterations, a larger tolerance, or use precision 'float64'"
    )


def _operator(problem):
    shape, spacing = problem.voxels.phase.shape, problem.voxels.spacing
    make = {"dtype": problem.dtype, "threads": problem.team.threads}
    nx, ny, nz = shape
    if problem.links is not None:
        conduct, inverse, kind = link_kernels.conduct_links, 1.0 / spacing, "2"
        material = link_kernels.Links(*(np.ascontiguousarray(link, problem.dtype) for link in problem.links))
    else:
        conduct, inverse, kind = kernels.conduct_voxels, 0.25 / spacing, "1"
        material = medium(problem.voxels, problem.voxels.conductivity, problem.voxels.tensor, problem.dtype)
        shape = (nx - 1, ny + 1, nz + 1) if problem.walls else shape
    if problem.walls:
        transform = trigonometric([("sin" + kind, "cos" + kind, "cos" + kind)], shape, **make)
        numbers = [np.pi * (np.arange(shape[0]) + 1) / nx]
        numbers += [np.pi * np.arange(m) / n for m, n in zip(shape[1:], (ny, nz), strict=True)]
    else:
        transform = fourier(1, shape, **make)
        numbers = [2 * np.pi * np.arange(m) / n for m, n in zip(transform.modes.shape[1:], shape, strict=True)]
    weights = tuple(np.ones(n, problem.dtype) for n in shape[1:])
    if problem.walls and kind == "1":
        # A node on an insulated face owns half a cell: the preconditioner acts on its residual per volume.
        for weight in weights:
            weight[[0, -1]] = 2
    if not problem.walls:
        # Columns of modes have real and imaginary parts in turn.
        numbers[0] = np.repeat(numbers[0], 2)
    symbol = _symbol(numbers, spacing, kind == "2", problem.dtype)
    return _Operator(conduct, material, inverse.astype(problem.dtype), transform, symbol, weights, shape)


def _symbol(numbers, spacing, links, dtype):
    """Factors of the symbol of minus the discrete Laplacian, per axis: (2 sin(k/2) / h)^2, and cos(k/2)^2 or 1."""
    sines = tuple(((2 * np.sin(k / 2) / h) ** 2).astype(dtype) for k, h in zip(numbers, spacing, strict=True))
    cosines = [np.ones_like(k) if links else np.cos(k / 2) ** 2 for k in numbers]
    return sines, tuple(np.where(c < ZERO, 0.0, c).astype(dtype) for c in cosines)


def _conduct(problem, operator, vectors, theta, gradient):
    """work = -div(K grad(theta + gradient.x)); returns the sums over all voxels."""
    arguments = (theta, vectors.work, operator.material, gradient.astype(problem.dtype), operator.inverse)
    problem.team.run(operator.conduct, len(theta), *arguments, problem.walls, vectors.sums)
    return vectors.sums.sum(axis=0)


def _precondition(problem, operator, vectors, kernel, *arguments):
    """work = inverse homogeneous operator on what kernel(*arguments) leaves in work; returns residual.work."""
    transform = operator.transform
    transform.planes(kernel, *arguments, *operator.weights, forward=True)
    transform.columns(kernels.divide, *operator.symbol, problem.dtype(transform.scale))
    transform.planes(kernels.dot, vectors.residual, vectors.work, vectors.partial, backward=True)
    return float(vectors.partial.sum())


def _restart(problem, operator, vectors):
    """Recompute the residual and make the preconditioned residual the direction."""
    sums = _conduct(problem, operator, vectors, vectors.theta, problem.gradient)
    ends = vectors.sums[[0, -1], 1] * len(vectors.sums) / problem.voxels.phase.size
    rz = _precondition(problem, operator, vectors, kernels.start, vectors.residual, vectors.work)
    problem.team.run(kernels.turn, len(vectors.work), vectors.direction, vectors.work, problem.dtype(0))
    curvature = _conduct(problem, operator, vectors, vectors.direction, np.zeros(3))[0]
    return _State(sums, ends, rz, curvature)


def _iterate(problem, operator, vectors, state, iterations):
    """Conjugate gradients from a fresh direction until the decrease of energy is small; returns the iterations."""
    planes = len(vectors.work)
    energy, rz, curvature, decreases = state.sums[0], state.rz, state.curvature, []
    while iterations < problem.max_iterations and curvature > 0:
        alpha = rz / curvature
        decreases.append(alpha * rz)
        energy -= decreases[-1]
        iterations += 1
        arguments = (vectors.theta, vectors.direction, vectors.residual, vectors.work, problem.dtype(alpha))
        before, rz = rz, _precondition(problem, operator, vectors, kernels.step, *arguments)
        small = sum(decreases[-max(2, len(decreases) // 8) :]) <= problem.tolerance**2 * energy
        if small and _error(rz, energy, problem) <= problem.tolerance:
            break
        problem.team.run(kernels.turn, planes, vectors.direction, vectors.work, problem.dtype(rz / before))
        curvature = _conduct(problem, operator, vectors, vectors.direction, np.zeros(3))[0]
    return iterations


def _solution(problem, operator, vectors, state, iterations, error, cost):
    shape, theta = problem.voxels.phase.shape, vectors.theta
    # Not the operator itself, whose transform holds as much as all temperatures.
    arguments = (operator.material, problem.gradient.astype(problem.dtype), operator.inverse, problem.walls)

    def centers():
        flux = np.empty((3, *shape), problem.dtype)
        with Team(problem.team.threads) as team:
            if problem.links is not None:
                team.run(link_kernels.link_state, shape[0], theta, *arguments, flux)
                return theta.copy(), flux
            temperature = np.empty(shape, problem.dtype)
            team.run(kernels.voxel_state, shape[0], theta, *arguments, temperature, flux)
        return temperature, flux

    mean_flux = state.sums[1:4] / problem.voxels.phase.size
    return Solution(mean_flux, state.ends, centers, theta.size, iterations, {"residual": error}, cost)
