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

import math
from typing import NamedTuple

import numpy as np

from demheat.runtime.progress import stage
from references.fft import eyre_milton_kernels as kernels
from references.fft import projection_kernels
from references.fft.eyre_milton_kernels import Sums
from references.fft.problem import Clock, Problem, SolvedGrid, converged, total
from references.fft.projection_kernels import Parts, Waves
from references.fft.transforms import fourier, trigonometric
from references.threads import Team
from references.voxels.paint import Medium, Voxels, medium

# Iterations after which the pace is looked at, and then after twice as many; and the part of those that rate and pace
# ask for below which a limit is too low, and the most (of the rate's .56 to 1.5 were found at contrasts 1e-4 to 1e6).
FIRST_LOOK, LEAST_NEEDED, MOST_NEEDED = 40, 0.5, 1.5
# The same of the pace alone where two looks agree to so much: it slows down until it is that of the end, but after
# errors have grown. Of spheres, layers and half-spaces, contrasts 1e4 to 1e6, .94 of it and more were needed then.
SETTLED, PACED = 1.25, 0.9


class _Scheme(NamedTuple):
    """The reference conductivity c0; Z = (K - c0)/(K + c0) and K of every voxel; the wave numbers of all modes."""

    reference: float
    mirror: Medium
    conductor: Medium
    waves: Waves


def solve(problem: Problem, *, kept: dict | None = None) -> SolvedGrid:
    """Fluxes by Eyre and Milton's iteration."""
    low, high = _extremes(problem.voxels)
    kept = {} if kept is None else kept
    if not kept:
        kept |= {"scheme": _scheme(problem, math.sqrt(low * high)), "transform": _transform(problem, 3)}
    scheme, transform = kept["scheme"], kept["transform"]
    field = np.zeros((3, *problem.voxels.phase.shape), problem.dtype)
    iterations, error, cost = _iterate(problem, scheme, transform, field)
    # Not a number must fail too.
    if not error <= problem.tolerance:
        _fail(iterations, error, problem.tolerance)
    mean_flux, ends, errors = _measure(problem, scheme, transform, field)
    # The iterate's errors are below the tolerance; making g compatible moves q by at most K/c0 of it.
    if not errors["equilibrium"] <= (1 + high / scheme.reference) * problem.tolerance:
        _fail(iterations, errors["equilibrium"], problem.tolerance)

    def state():
        return _state(problem, scheme, field)

    return SolvedGrid(mean_flux, ends, state, field.size, iterations, errors, cost)


def _fail(iterations, error, tolerance):
    raise RuntimeError(
        f"fft.solve: scheme 'eyre-milton' did not converge: {iterations} iterations, relative residual {error:.2e}, "
        f"tolerance {tolerance:.1e}; allow more max_iterations, a larger tolerance, or use scheme 'cg'"
    )


def _extremes(voxels: Voxels):
    """Smallest and largest conductivity on the grid; a laminate's lies between those of its phases."""
    present = voxels.conductivity[voxels.fractions > 0]
    return float(present.min()), float(present.max())


def _scheme(problem, reference):
    voxels, dtype = problem.voxels, problem.dtype
    tensor = voxels.tensor.copy()
    kernels.mirror(tensor, reference)
    scalar = (voxels.conductivity - reference) / (voxels.conductivity + reference)
    mirror = medium(voxels, scalar, tensor, dtype)
    conductor = medium(voxels, voxels.conductivity, voxels.tensor, dtype)
    return _Scheme(reference, mirror, conductor, _waves(problem))


def _transform(problem, components):
    shape, make = problem.voxels.phase.shape, {"dtype": problem.dtype, "threads": problem.team.threads}
    if not problem.walls:
        return fourier(components, shape, **make)
    gradient = [("cos2", "cos2", "cos2"), ("sin2", "sin2", "cos2"), ("sin2", "cos2", "sin2")]
    return trigonometric(gradient if components == 3 else [("sin2", "cos2", "cos2")], shape, **make)


def _waves(problem):
    """Wave numbers of all modes, those of x once."""
    shape = problem.voxels.phase.shape
    lengths = np.array(shape) * problem.voxels.spacing
    found = (_box_waves if problem.walls else _cell_waves)(shape, lengths)
    return Waves(*(tuple(axis.astype(problem.dtype) for axis in axes) for axes in found))


def _cell_waves(shape, lengths):
    numbers = [2 * np.pi / length * np.fft.fftfreq(n, 1 / n) for n, length in zip(shape, lengths, strict=True)]
    free = [np.arange(n) * 2 == n for n in shape]
    for number, nyquist in zip(numbers, free, strict=True):
        number[nyquist] = 0.0
    half = shape[2] // 2 + 1
    numbers[2], free[2] = np.abs(numbers[2][:half]), free[2][:half]
    # Of the last axis only half the modes are kept; the other half are their conjugates.
    multiplicity = [np.ones(shape[0]), np.ones(shape[1]), np.full(half, 2.0)]
    multiplicity[2][0] = 1.0
    if shape[2] % 2 == 0:
        multiplicity[2][-1] = 1.0
    return numbers, free, multiplicity


def _box_waves(shape, lengths):
    numbers = [np.pi * np.arange(n + 1) / length for n, length in zip(shape, lengths, strict=True)]
    free = [np.arange(n + 1) == n for n in shape]
    multiplicity = [np.full(n + 1, 2.0) for n in shape]
    for number, weight, sign in zip(numbers, multiplicity, (1, -1, -1), strict=True):
        number *= sign
        number[-1] = 0.0
        weight[[0, -1]] = 1.0
    return numbers, free, multiplicity


def _on_modes(problem, scheme, transform, kernel, *arguments, backward=True):
    """Transform along x, let the kernel change the modes, transform back; y and z are done before."""
    if not problem.walls:
        # Columns have real and imaginary parts in turn.
        waves = Waves(*((np.repeat(axes[0], 2), *axes[1:]) for axes in scheme.waves))
        transform.columns(kernel, waves, *arguments, backward=backward)
        return
    # Components of a box have modes of different wave numbers at the same place: they do not go column by column.
    transform.columns(backward=False)
    problem.team.run(kernel, transform.modes.shape[1] + 1, transform.modes, scheme.waves, *arguments)
    if backward:
        transform.columns(forward=False)


def _check_pace(iterations, before, error, problem, last=math.inf):
    """Raise NotImplementedError if at its present pace the iteration cannot end within its limit; what it asks for.

    The contrast alone does not tell: across layers, or where little flux meets what conducts well, it ends far sooner
    than as the root of the contrast. Nor does one look at the pace, as errors may grow at first: asked is where both
    say so, or where the pace is that of the last look.
    """
    low, high = _extremes(problem.voxels)
    # Each contracts by (root - 1) / (root + 1).
    rate = -math.log(problem.tolerance) * math.sqrt(high / low) / 2
    pace = 2 * math.log(before / error) / iterations if error < before else 0.0
    needed = iterations + (math.log(error / problem.tolerance) / pace if pace else math.inf)
    settled = last < SETTLED * needed < math.inf
    least = min(PACED * needed, MOST_NEEDED * rate) if settled else LEAST_NEEDED * min(rate, needed)
    if least > problem.max_iterations:
        raise NotImplementedError(
            f"fft.solve: scheme 'eyre-milton' at a contrast of {high / low:.1e} takes about "
            f"{needed if settled else rate:.1e} iterations, as the root of the contrast, and max_iterations = "
            f"{problem.max_iterations}: use scheme 'cg', or more iterations or a larger tolerance"
        )
    return needed


def _iterate(problem, scheme, transform, field):
    """Reflect in turn until p no longer changes; returns the iterations, the error that the last change shows, cost."""
    cells, planes, work = problem.voxels.phase.size, field.shape[1], transform.real
    sums = Sums(np.zeros(planes), np.zeros((planes, 3)))
    scale = problem.dtype(transform.scale)
    mean = (2 * scheme.reference * problem.gradient).astype(problem.dtype)
    kernel = projection_kernels.reflect_waves if problem.walls else projection_kernels.reflect_modes
    for component, value in zip(work, mean, strict=True):
        component[:] = value
    transform.planes(kernels.reflect, field, work, scheme.mirror, sums, forward=True)
    iterations, error, first, clock = 0, math.inf, math.inf, Clock(transform)
    before, looked, needed = math.inf, FIRST_LOOK, math.inf
    with clock, stage("iterations") as done:
        while error > problem.tolerance and iterations < problem.max_iterations:
            _on_modes(problem, scheme, transform, kernel, scale, mean)
            transform.planes(kernels.reflect, field, work, scheme.mirror, sums, backward=True, forward=True)
            flux = 0.5 * np.linalg.norm(sums.flux.sum(axis=0)) / cells
            error = 0.5 * math.sqrt(total(sums.change) / cells) / flux if flux > 0 else math.inf
            iterations += 1
            first = error if iterations == 1 else first
            done(converged(first, error, problem.tolerance))
            if iterations == looked // 2:
                before = error
            elif iterations == looked and error > problem.tolerance:
                needed = _check_pace(iterations, before, error, problem, needed)
                before, looked = error, 2 * looked
    return iterations, error, clock.cost()


def _measure(problem, scheme, transform, field):
    """Mean flux, flux at both ends and errors of the compatible gradient and its own flux; the field stays."""
    cells, planes, work = problem.voxels.phase.size, field.shape[1], transform.real
    factor = problem.dtype(0.5 / scheme.reference)
    transform.planes(kernels.gradient, field, work, scheme.mirror, factor, forward=True)
    _, incompatible = _split(problem, scheme, transform, problem.gradient)
    flux = np.zeros((planes, 3))
    transform.planes(kernels.conduct, work, scheme.conductor, flux, backward=True, forward=True)
    ends = flux[[0, -1], 0] / (cells / planes)
    mean_flux = flux.sum(axis=0) / cells
    unbalanced, _ = _split(problem, scheme, transform, mean_flux, backward=False)
    equilibrium = math.sqrt(unbalanced) / float(np.linalg.norm(mean_flux))
    errors = {"residual": equilibrium, "equilibrium": equilibrium, "compatibility": math.sqrt(incompatible)}
    return mean_flux, ends, errors


def _split(problem, scheme, transform, mean, backward=True):
    """Replace a field's modes by its compatible part; returns the mean squares of that part and of the rest."""
    _, mx, my, mz = transform.modes.shape
    count = mx + 1 if problem.walls else my * mz
    parts = Parts(np.zeros(count), np.zeros(count))
    kernel = projection_kernels.split_waves if problem.walls else projection_kernels.split_modes
    arguments = (problem.dtype(transform.scale), mean.astype(problem.dtype), parts)
    _on_modes(problem, scheme, transform, kernel, *arguments, backward=backward)
    return total(parts.inside), total(parts.outside)


def _state(problem, scheme, field):
    """Temperature less its linear part, and the flux of its gradient, made when asked for."""
    with Team(problem.team.threads) as team:
        problem = problem._replace(team=team)
        transform, potential = _transform(problem, 3), _transform(problem, 1)
        work, factor = transform.real, problem.dtype(0.5 / scheme.reference)
        transform.planes(kernels.gradient, field, work, scheme.mirror, factor, forward=True)
        _split(problem, scheme, transform, problem.gradient, backward=False)
        integrate = projection_kernels.integrate_waves if problem.walls else projection_kernels.integrate_modes
        planes = transform.modes.shape[1] + (1 if problem.walls else 0)
        team.run(integrate, planes, transform.modes, potential.modes, scheme.waves)
        potential.backward()
        transform.columns(forward=False)
        transform.planes(kernels.conduct, work, scheme.conductor, np.zeros((field.shape[1], 3)), backward=True)
    depth = field.shape[3]
    return potential.real[0, ..., :depth], work[..., :depth]
