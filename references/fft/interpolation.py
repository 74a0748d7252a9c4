"""Temperatures and fluxes of a voxel solution at any point of the box.

By harmonic polynomials through the voxels around (`references.fft.harmonic`), and between voxels where these are too
few, or not known well enough.
"""

from collections.abc import Callable
from itertools import product
from typing import NamedTuple

import numpy as np

from demheat.field import Samples
from references.fft.grid import Grid
from references.fft.harmonic import Fit, fitted
from references.voxels.laminates import unpacked
from references.voxels.paint import centers

# Flux and slope jump at an interface: a voxel of another phase, and a cut one, counts only where nothing is better.
CUT, OTHER = 1e-2, 1e-6
# Of so many points fits are kept: 12 MiB.
KEPT = 100_000


class Asked(NamedTuple):
    """What temperatures and fluxes at points have in common."""

    points: np.ndarray  # In the order of the box
    phase: np.ndarray
    body: np.ndarray | None
    fit: Fit


def asker(grid: Callable[[], Grid]) -> Callable[[np.ndarray], Asked]:
    """What fits at points, and keeps those asked last: who asks for temperatures mostly asks for fluxes there, too."""
    last = []

    def asked(points):
        if not (last and np.array_equal(last[0], points)):
            # In this order, so that what is interrupted keeps nothing.
            found = ask(grid(), points)
            last[:] = [points.copy(), found] if len(points) <= KEPT else []
            return found
        return last[1]

    return asked


def ask(grid: Grid, points: np.ndarray) -> Asked:
    """What is asked of points, in the user's axes."""
    points = points[:, grid.order]
    phase = grid.scene.phase_at(points)
    body = _body_at(grid, points, phase)
    return Asked(points, phase, body, fitted(grid, points, phase, body))


def temperature_at(grid: Grid, asked: Asked) -> np.ndarray:
    """Fits to the temperatures of voxels, or between these; exact for linear fields."""
    value, rest = asked.fit.temperature.copy(), ~asked.fit.known
    value[rest] = temperature_between(grid, *_of(asked, rest))
    return value


def flux_at(grid: Grid, asked: Asked) -> np.ndarray:
    """By the slopes of fits to the temperatures of voxels, or between the voxels' fluxes."""
    own, rest = -grid.voxels.conductivity[asked.phase][:, None] * asked.fit.slope, ~asked.fit.known
    own[rest] = flux_between(grid, *_of(asked, rest))
    result = np.empty_like(own)
    result[:, grid.order] = own
    return result


def _of(asked, some):
    return asked.points[some], asked.phase[some], None if asked.body is None else asked.body[some]


def samples(grid: Grid) -> Samples:
    """The voxels, in the order of the user's axes."""
    spacing, shape = grid.voxels.spacing, grid.temperature.shape
    back = np.argsort(grid.order)
    x = np.meshgrid(*centers(shape, spacing), indexing="ij", sparse=True)
    temperature = np.full(shape, float(grid.level))
    for slope, coordinate in zip(grid.slope, x, strict=True):
        temperature += slope * coordinate
    temperature += grid.temperature
    # Column by column: whole fields of three components are not made twice.
    points, flux = np.empty((temperature.size, 3)), np.empty((temperature.size, 3))
    for column, axis in enumerate(back):
        points[:, column] = np.broadcast_to(x[axis], shape).transpose(back).ravel()
        flux[:, column] = grid.flux[axis].transpose(back).ravel()
    volumes = np.full(len(points), np.prod(spacing))
    phase = grid.voxels.phase.transpose(back).ravel().astype(np.int32)
    return Samples(points, volumes, temperature.transpose(back).ravel(), phase, flux)


def temperature_between(grid: Grid, points: np.ndarray, phase: np.ndarray, body: np.ndarray | None) -> np.ndarray:
    """Interpolation between the whole voxels of the point's own phase; exact for linear fields.

    Each voxel tells its temperature T and slope g.  With weights w, offsets d from the voxels to the point and means
    under w, the sum of w (T + g.d / 2) + mean(g).mean(d) / 2 is linear-exact for any weights, and the cubic Hermite
    polynomial along each axis where all eight voxels count.
    """
    value, weights = np.zeros(len(points)), np.zeros(len(points))
    slope, offset = np.zeros((3, len(points))), np.zeros((3, len(points)))
    for index, weight, away, mirrored in _neighbours(grid, points):
        good, cut = _preference(grid.voxels, index, phase, trusted=grid.sharp)
        joined = _joined(grid, index, body)
        weight = np.where(joined, weight * good, 0.0)
        conductivity = grid.voxels.conductivity[grid.voxels.phase[tuple(index)]]
        known = ~cut & (conductivity > 0)
        # What is less than linear vanishes on the isothermal walls, so it is mirrored there with its sign changed.
        sign = np.where(mirrored[0], -1.0, 1.0)
        value += weight * sign * np.where(joined, grid.temperature[tuple(index)], 0.0)
        weights += weight
        for axis in range(3):
            rise = np.where(known, _slope(grid, index, axis, np.where(known, conductivity, 1.0)) - grid.slope[axis], 0)
            rise *= _sign(axis, mirrored)
            value += 0.5 * weight * rise * away[axis]
            slope[axis] += weight * rise
            offset[axis] += weight * away[axis]
    mean = value / weights + 0.5 * np.sum(slope * offset, axis=0) / weights**2
    return grid.level + points @ grid.slope + mean


def flux_between(grid: Grid, points: np.ndarray, phase: np.ndarray, body: np.ndarray | None) -> np.ndarray:
    """Trilinear interpolation between the whole voxels of the point's own phase."""
    total, weights = np.zeros((len(points), 3)), np.zeros(len(points))
    for index, weight, _, mirrored in _neighbours(grid, points):
        weight = weight * _preference(grid.voxels, index, phase, trusted=False)[0] * _joined(grid, index, body)
        weights += weight
        for axis in range(3):
            total[:, axis] += weight * _sign(axis, mirrored) * grid.flux[(axis, *index)]
    return total / weights[:, None]


def _neighbours(grid, points):
    """The eight voxel centres around each point: index, trilinear weight, offset to the point, axes of mirroring."""
    shape, spacing = list(grid.temperature.shape), grid.voxels.spacing
    if grid.planes:
        held, shape[0] = grid.planes
    place = points / spacing - 0.5
    first = np.floor(place).astype(int)
    part = place - first
    for corner in product((0, 1), repeat=3):
        index, away, mirrored, weight = [], [], [], 1.0
        for axis, (n, side) in enumerate(zip(shape, corner, strict=True)):
            number = first[:, axis] + side
            index.append(number % n if grid.scene.periodic else np.clip(number, 0, n - 1))
            mirrored.append(np.zeros(len(points), bool) if grid.scene.periodic else index[-1] != number)
            away.append((part[:, axis] - side) * spacing[axis])
            weight = weight * (part[:, axis] if side else 1.0 - part[:, axis])
        if grid.planes:
            index[0] = (index[0] - held) % shape[0] if grid.scene.periodic else index[0] - held
        yield index, weight, away, mirrored


def _slope(grid, index, axis, conductivity):
    """A component of the temperature's gradient in voxels, by their flux."""
    if grid.voxels.tensors is None:
        return -grid.flux[(axis, *index)] / conductivity
    # Pores, which nobody asks for, have no inverse.
    tensors = unpacked(grid.voxels.tensors)
    solid = tensors.any(axis=(1, 2))
    tensors[solid] = np.linalg.inv(tensors[solid])
    row = tensors[grid.voxels.phase[tuple(index)], axis]
    return -np.einsum("pi,ip->p", row, grid.flux[(slice(None), *index)])


def _sign(component, mirrored):
    """Sign of a mirrored flux: along an isothermal wall, and across an insulated one, it changes."""
    flips = mirrored[0] ^ mirrored[component] if component else np.zeros_like(mirrored[0])
    return np.where(flips, -1.0, 1.0)


def _body_at(grid, points, phase):
    """The body of each point: that of the voxel that tells most about it; -1 if all around are pores, None without."""
    if grid.bodies is None:
        return None
    body, most = np.full(len(points), -1), np.zeros(len(points))
    for index, weight, _, _ in _neighbours(grid, points):
        weight = weight * _preference(grid.voxels, index, phase, trusted=grid.sharp)[0]
        here = grid.bodies.label[tuple(index)]
        better = (here >= 0) & (weight > most)
        body[better], most[better] = here[better], weight[better]
    return body


def _joined(grid, index, body):
    """Whether a voxel is of the body of the point: others, across pores, tell nothing about it."""
    return True if body is None else grid.bodies.label[tuple(index)] == body


def _preference(voxels, index, phase, *, trusted):
    """How much a voxel tells about a point of this phase, and whether it is cut and not trusted all the same."""
    same = voxels.phase[tuple(index)] == phase
    if trusted or not len(voxels.cut):
        return np.where(same, 1.0, OTHER), np.zeros(len(phase), bool)
    flat = np.ravel_multi_index(index, voxels.phase.shape)
    place = np.minimum(np.searchsorted(voxels.cut, flat), len(voxels.cut) - 1)
    cut = voxels.cut[place] == flat
    return np.where(same, np.where(cut, CUT, 1.0), OTHER), cut
