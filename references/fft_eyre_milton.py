"""Eyre and Milton's accelerated scheme with the continuous Green operator, in polarisation form.

Eyre and Milton, Eur. Phys. J. Appl. Phys. 6 (1999) 41-47; the polarisation form of Monchiet and Bonnet, Int. J. Numer.
Meth. Engng 89 (2012) 1419-1436.  With g the temperature gradient, q = K g and p = q + c0 g, the local law gives
q - c0 g = Z p with Z = (K - c0)/(K + c0); equilibrium of q with compatibility of g gives
p = (1 - 2 Gamma)(q - c0 g) + 2 c0 <g>, Gamma = k k/k^2.  Iterating the two reflections contracts by
(sqrt(r) - 1)/(sqrt(r) + 1) for contrast r when c0 = sqrt(smallest * largest conductivity).  The change of p in one
iteration is exactly
|dp|^2 = 4 (|Gamma q|^2 + c0^2 |g - Gamma g - <g>|^2): equilibrium and compatibility errors together.

In a box with two isothermal and four insulated walls the mirrored periodic field has sines and cosines only, and the
same algebra runs on the box itself.
"""

from __future__ import annotations

import math

import numpy as np

from references import fft_eyre_milton_kernels as kernels
from references.fft_problem import Problem, Solution
from references.fft_transforms import fourier, trigonometric
from references.voxels import Voxels, medium


def solve(problem: Problem) -> Solution:
    """Fluxes by Eyre and Milton's iteration.

    Raises
    ------
    RuntimeError
        If the error is above the tolerance after the allowed iterations, or the recomputed one is above what that
        implies.
    """
    low, high = _extremes(problem.voxels)
    reference = math.sqrt(low * high)
    shape = problem.voxels.phase.shape
    mirror, conductor = _media(problem.voxels, reference, problem.dtype)
    transform = _transform(problem, 3)
    field = np.zeros((3, *shape), problem.dtype)
    iterations, error = _iterate(problem, reference, mirror, transform, field)
    # Not a number must fail too.
    if not error <= problem.tolerance:
        _fail(iterations, error, problem.tolerance)
    return _settle(problem, reference, high, mirror, conductor, transform, field, iterations)


def _fail(iterations, error, tolerance):
    raise RuntimeError(
        f"fft.solve: scheme 'eyre-milton' did not converge: {iterations} iterations, relative residual {error:.2e}, "
        f"tolerance {tolerance:.1e}; allow more max_iterations, a larger tolerance, or use scheme 'cg'"
    )


def _extremes(voxels: Voxels):
    """Smallest and largest conductivity on the grid; a laminate's lies between those of its phases."""
    present = voxels.conductivity[voxels.fractions > 0]
    return float(present.min()), float(present.max())


def _media(voxels, reference, dtype):
    """Z and K as kernels read them."""
    full = voxels.tensor[:, [[0, 5, 4], [5, 1, 3], [4, 3, 2]]]
    mirror = np.eye(3) - 2 * reference * np.linalg.inv(full + reference * np.eye(3))
    packed = np.stack([mirror[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))], axis=1)
    scalar = (voxels.conductivity - reference) / (voxels.conductivity + reference)
    return medium(voxels, scalar, packed, dtype), medium(voxels, voxels.conductivity, voxels.tensor, dtype)


def _transform(problem, components):
    shape, make = problem.voxels.phase.shape, {"dtype": problem.dtype, "threads": problem.team.threads}
    if not problem.walls:
        return fourier(components, shape, **make)
    gradient = [("cos2", "cos2", "cos2"), ("sin2", "sin2", "cos2"), ("sin2", "cos2", "sin2")]
    return trigonometric(gradient if components == 3 else [("sin2", "cos2", "cos2")], shape, **make)


def _waves(problem, transform):
    """Wave numbers per axis, and how often each counts in a sum of squares over all modes."""
    shape = problem.voxels.phase.shape
    lengths = np.array(shape) * problem.voxels.spacing
    if problem.walls:
        numbers = [np.pi * np.arange(n + 1) / length for n, length in zip(shape, lengths, strict=True)]
        weights = [np.full(n + 1, 2.0) for n in shape]
        for number, weight, sign in zip(numbers, weights, (1, -1, -1), strict=True):
            number *= sign
            number[-1] = 0.0
            weight[[0, -1]] = 1.0
        free = [np.arange(n + 1) == n for n in shape]
        return _cast(numbers, problem), _cast(free, problem), _cast(weights, problem)
    numbers, free = [], []
    for n, length in zip(shape, lengths, strict=True):
        number = 2 * np.pi / length * np.fft.fftfreq(n, 1 / n)
        nyquist = np.arange(n) * 2 == n
        number[nyquist] = 0.0
        numbers.append(number)
        free.append(nyquist)
    half = transform.modes.shape[3]
    numbers[2], free[2] = np.abs(numbers[2][:half]), free[2][:half]
    weight = np.full(half, 2.0)
    weight[0] = 1.0
    if shape[2] % 2 == 0:
        weight[-1] = 1.0
    return _cast(numbers, problem), _cast(free, problem), weight.astype(problem.dtype)


def _cast(arrays, problem):
    return tuple(array.astype(problem.dtype) for array in arrays)


def _planes(problem, transform):
    """Planes of modes along the first axis; a box has wave numbers 0 to nx."""
    return transform.modes.shape[1] + (1 if problem.walls else 0)


def _iterate(problem, reference, mirror, transform, field):
    """Reflect in turn until p no longer changes; returns the iterations and the error that the last change shows."""
    run, cells = problem.team.run, problem.voxels.phase.size
    sums = np.zeros((field.shape[1], 4))
    wave, free, _ = _waves(problem, transform)
    turn = kernels.reflect_waves if problem.walls else kernels.reflect_modes
    scale, mean = problem.dtype(transform.scale), (2 * reference * problem.gradient).astype(problem.dtype)
    work = transform.real
    for component, value in zip(work, mean, strict=True):
        component[:] = value
    run(kernels.reflect, field.shape[1], field, work, mirror, sums)
    iterations, error = 0, math.inf
    while error > problem.tolerance and iterations < problem.max_iterations:
        transform.forward()
        run(turn, _planes(problem, transform), transform.modes, wave, free, scale, mean)
        transform.backward()
        run(kernels.reflect, field.shape[1], field, work, mirror, sums)
        total = sums.sum(axis=0)
        flux = 0.5 * np.linalg.norm(total[1:]) / cells
        error = 0.5 * math.sqrt(total[0] / cells) / flux if flux > 0 else math.inf
        iterations += 1
    return iterations, error


def _settle(problem, reference, high, mirror, conductor, transform, field, iterations):
    """Make the gradient exactly compatible, the flux its own, and measure what is left of the equilibrium error."""
    run, cells, work = problem.team.run, problem.voxels.phase.size, transform.real
    run(kernels.gradient, field.shape[1], field, work, mirror, problem.dtype(0.5 / reference))
    potential = _transform(problem, 1)
    gradient = problem.gradient.astype(problem.dtype)
    _, incompatible = _split(problem, transform, potential.modes[0], gradient)
    transform.backward()
    sums = np.zeros((field.shape[1], 4))
    run(kernels.conduct, field.shape[1], field, work, conductor, sums)
    potential.backward()
    temperature = np.array(potential.real[0, ..., : field.shape[3]])
    ends = sums[[0, -1], 0] / (cells / len(sums))
    mean_flux = sums.sum(axis=0)[:3] / cells
    unbalanced, _ = _split(problem, transform, potential.modes[0], mean_flux.astype(problem.dtype))
    scale = float(np.linalg.norm(mean_flux))
    errors = {"residual": 0.0, "equilibrium": math.sqrt(unbalanced) / scale, "compatibility": math.sqrt(incompatible)}
    errors["residual"] = errors["equilibrium"]
    # The iterate's errors are below the tolerance; making g compatible moves q by at most K/c0 of it.
    if not errors["equilibrium"] <= (1 + high / reference) * problem.tolerance:
        _fail(iterations, errors["equilibrium"], problem.tolerance)
    return Solution(mean_flux, ends, lambda: (temperature, field), 3 * cells, iterations, errors)


def _split(problem, transform, potential, mean):
    """Replace a field's modes by its compatible part; returns the mean squares of that part and of the rest."""
    transform.forward()
    wave, free, weight = _waves(problem, transform)
    planes = _planes(problem, transform)
    sums = np.zeros((planes, 2))
    kernel = kernels.split_waves if problem.walls else kernels.split_modes
    scale = problem.dtype(transform.scale)
    problem.team.run(kernel, planes, transform.modes, potential, wave, free, weight, scale, mean, sums)
    return sums.sum(axis=0)
