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

from references.fft import eyre_milton_kernels as kernels
from references.fft.problem import Clock, Problem, Solution
from references.fft.transforms import fourier, trigonometric
from references.threads import Team
from references.voxels.paint import Voxels, medium


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
    mirror, conductor = _media(problem.voxels, reference, problem.dtype)
    transform = _transform(problem, 3)
    field = np.zeros((3, *problem.voxels.phase.shape), problem.dtype)
    iterations, error, cost = _iterate(problem, reference, mirror, transform, field)
    # Not a number must fail too.
    if not error <= problem.tolerance:
        _fail(iterations, error, problem.tolerance)
    mean_flux, ends, errors = _measure(problem, reference, mirror, conductor, transform, field)
    # The iterate's errors are below the tolerance; making g compatible moves q by at most K/c0 of it.
    if not errors["equilibrium"] <= (1 + high / reference) * problem.tolerance:
        _fail(iterations, errors["equilibrium"], problem.tolerance)

    def state():
        return _state(problem, reference, mirror, conductor, field)

    return Solution(mean_flux, ends, state, field.size, iterations, errors, cost)


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
    tensor = voxels.tensor.copy()
    kernels.mirror(tensor, reference)
    scalar = (voxels.conductivity - reference) / (voxels.conductivity + reference)
    return medium(voxels, scalar, tensor, dtype), medium(voxels, voxels.conductivity, voxels.tensor, dtype)


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


def _rows(wave, free):
    """Wave numbers as columns of modes have them: real and imaginary parts in turn along x."""
    return (np.repeat(wave[0], 2), *wave[1:]), (np.repeat(free[0], 2), *free[1:])


def _on_modes(problem, transform, name, *arguments, backward=True):
    """Transform along x, let the kernel of this name change the modes, transform back; y and z are done before."""
    wave, free, _ = _waves(problem, transform)
    if not problem.walls:
        kernel = getattr(kernels, name + "_modes")
        transform.columns(kernel, *_rows(wave, free), *arguments, backward=backward)
        return
    # Components of a box have modes of different wave numbers at the same place: they do not go column by column.
    transform.columns(backward=False)
    kernel = getattr(kernels, name + "_waves")
    problem.team.run(kernel, transform.modes.shape[1] + 1, transform.modes, wave, free, *arguments)
    if backward:
        transform.columns(forward=False)


def _iterate(problem, reference, mirror, transform, field):
    """Reflect in turn until p no longer changes; returns the iterations, the error that the last change shows, cost."""
    cells, work = problem.voxels.phase.size, transform.real
    sums = np.zeros((field.shape[1], 4))
    scale, mean = problem.dtype(transform.scale), (2 * reference * problem.gradient).astype(problem.dtype)
    for component, value in zip(work, mean, strict=True):
        component[:] = value
    transform.planes(kernels.reflect, field, work, mirror, sums, forward=True)
    iterations, error, clock = 0, math.inf, Clock(transform)
    with clock:
        while error > problem.tolerance and iterations < problem.max_iterations:
            _on_modes(problem, transform, "reflect", scale, mean)
            transform.planes(kernels.reflect, field, work, mirror, sums, backward=True, forward=True)
            total = sums.sum(axis=0)
            flux = 0.5 * np.linalg.norm(total[1:]) / cells
            error = 0.5 * math.sqrt(total[0] / cells) / flux if flux > 0 else math.inf
            iterations += 1
    return iterations, error, clock.cost()


def _measure(problem, reference, mirror, conductor, transform, field):
    """Mean flux, flux at both ends and errors of the compatible gradient and its own flux; the field stays."""
    cells, work = problem.voxels.phase.size, transform.real
    transform.planes(kernels.gradient, field, work, mirror, problem.dtype(0.5 / reference), forward=True)
    _, incompatible = _split(problem, transform, problem.gradient)
    sums = np.zeros((field.shape[1], 3))
    transform.planes(kernels.conduct, work, conductor, sums, backward=True, forward=True)
    ends = sums[[0, -1], 0] / (cells / len(sums))
    mean_flux = sums.sum(axis=0) / cells
    unbalanced, _ = _split(problem, transform, mean_flux, backward=False)
    equilibrium = math.sqrt(unbalanced) / float(np.linalg.norm(mean_flux))
    errors = {"residual": equilibrium, "equilibrium": equilibrium, "compatibility": math.sqrt(incompatible)}
    return mean_flux, ends, errors


def _split(problem, transform, mean, backward=True):
    """Replace a field's modes by its compatible part; returns the mean squares of that part and of the rest."""
    _, mx, my, mz = transform.modes.shape
    sums = np.zeros((mx + 1 if problem.walls else my * mz, 2))
    _, _, multiplicity = _waves(problem, transform)
    arguments = (multiplicity, problem.dtype(transform.scale), mean.astype(problem.dtype), sums)
    _on_modes(problem, transform, "split", *arguments, backward=backward)
    return sums.sum(axis=0)


def _state(problem, reference, mirror, conductor, field):
    """Temperature less its linear part, and the flux of its gradient, made when asked for."""
    with Team(problem.team.threads) as team:
        problem = problem._replace(team=team)
        transform, potential = _transform(problem, 3), _transform(problem, 1)
        work, wave = transform.real, _waves(problem, transform)[0]
        transform.planes(kernels.gradient, field, work, mirror, problem.dtype(0.5 / reference), forward=True)
        _split(problem, transform, problem.gradient, backward=False)
        integrate = kernels.integrate_waves if problem.walls else kernels.integrate_modes
        planes = transform.modes.shape[1] + (1 if problem.walls else 0)
        team.run(integrate, planes, transform.modes, potential.modes, wave)
        potential.backward()
        transform.columns(forward=False)
        transform.planes(kernels.conduct, work, conductor, np.zeros((field.shape[1], 3)), backward=True)
    depth = field.shape[3]
    return potential.real[0, ..., :depth], work[..., :depth]
