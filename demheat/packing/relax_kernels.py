"""Compiled loops of the overlap relaxation: forces by gathering over symmetric rows, and the FIRE step."""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

# Particles per task and per partial sum. Fixed, so that sums are the same whatever the number of threads.
CHUNK = 256
# Column of the radius in rows (x, y, z, radius).
RADIUS = 3
# Columns of the sums over a chunk: power (force times velocity), squared force and velocity (both times mass), sum,
# count and maximum of the overlaps, each pair counted from both sides.
POWER, FORCES, VELOCITIES, OVERLAP, COUNT, WORST = range(6)
SUMS = 6


class Spheres(NamedTuple):
    """Spheres in motion. Lengths in mean radii, the stiffness and the mass of a mean sphere are 1."""

    points: np.ndarray  # (n, 4) float array: Centre and radius
    velocity: np.ndarray  # (n, 3) float array
    mobility: np.ndarray  # (n,) float array: Inverse mass; 0 holds a particle


class Box(NamedTuple):
    """The domain, in mean radii.

    Attributes
    ----------
    size : (3,) float array
    period : (3,) float array
        `size` on periodic axes, 0 on walled ones.
    across : (3,) float array
        1 on axes across which the wall is round (inscribed in the box), else 0.
    """

    size: np.ndarray
    period: np.ndarray
    across: np.ndarray


class Step(NamedTuple):
    """One step of FIRE: v = keep v + push a, then x += dt v, plain numbers."""

    keep: float
    push: float
    dt: float


@njit(cache=True)
def _push_of_neighbours(i, points, indptr, indices, period, overlaps):
    """Force of the other spheres on sphere i, and the sum, count and maximum of the overlaps gone on with."""
    total, count, worst = overlaps
    bx, by, bz = period[0], period[1], period[2]
    ix = 1.0 / bx if bx > 0.0 else 0.0
    iy = 1.0 / by if by > 0.0 else 0.0
    iz = 1.0 / bz if bz > 0.0 else 0.0
    x, y, z, r = points[i, 0], points[i, 1], points[i, 2], points[i, RADIUS]
    fx = fy = fz = 0.0
    for t in range(indptr[i], indptr[i + 1]):
        j = indices[t]
        dx = x - points[j, 0]
        dy = y - points[j, 1]
        dz = z - points[j, 2]
        dx -= bx * np.rint(dx * ix)
        dy -= by * np.rint(dy * iy)
        dz -= bz * np.rint(dz * iz)
        reach = r + points[j, RADIUS]
        d2 = dx * dx + dy * dy + dz * dz
        if d2 == 0.0:
            # Same place: any direction will do, if the two get opposite ones.
            dx = 1e-6 * reach if i > j else -1e-6 * reach
            d2 = dx * dx
        # No branch on the overlap: about half of the pairs overlap, no processor can guess which.
        d = np.sqrt(d2)
        overlap = max(0.0, reach - d)
        f = overlap / d
        fx += f * dx
        fy += f * dy
        fz += f * dz
        total += overlap
        count += overlap > 0.0
        worst = max(worst, overlap)
    return fx, fy, fz, (total, count, worst)


@njit(cache=True)
def _push_of_walls(i, points, box, push, overlaps):
    """The same with what flat and round walls add."""
    fx, fy, fz = push
    total, count, worst = overlaps
    r, square, bound = points[i, RADIUS], 0.0, np.inf
    for axis in range(3):
        if box.across[axis] > 0.0:
            bound = 0.5 * box.size[axis]
            square += (points[i, axis] - bound) ** 2
        elif box.period[axis] == 0.0:
            low = max(0.0, r - points[i, axis])
            high = max(0.0, points[i, axis] + r - box.size[axis])
            fx += (low - high) * (axis == 0)
            fy += (low - high) * (axis == 1)
            fz += (low - high) * (axis == 2)
            # A wall is no row of its own: count it from both sides here.
            total += 2.0 * (low + high)
            count += 2.0 * ((low > 0.0) + (high > 0.0))
            worst = max(worst, low, high)
    out = np.sqrt(square) + r - bound
    if out > 0.0:
        inward = out / max(np.sqrt(square), 1e-9)
        fx -= box.across[0] * inward * (points[i, 0] - bound)
        fy -= box.across[1] * inward * (points[i, 1] - bound)
        fz -= box.across[2] * inward * (points[i, 2] - bound)
        total += 2.0 * out
        count += 2.0
        worst = max(worst, out)
    return fx, fy, fz, (total, count, worst)


@njit(parallel=True, cache=True)
def forces(spheres, indptr, indices, box, force, sums):
    """Harmonic repulsion (stiffness 1) of overlapping spheres and of walls, times each particle's mobility.

    spheres : Spheres
    indptr : (n + 1,) int64 array
    indices : (nnz,) uint32 array; symmetric rows of candidates
    box : Box
    force : (n, 3) float array, out; acceleration: mobility times force
    sums : (chunks, SUMS) float array, out; columns POWER to WORST
    """
    points, velocity, mobility = spheres.points, spheres.velocity, spheres.mobility
    n = len(points)
    for chunk in prange(len(sums)):
        power = ff = vv = 0.0
        overlaps = (0.0, 0.0, 0.0)
        for i in range(chunk * CHUNK, min(n, (chunk + 1) * CHUNK)):
            fx, fy, fz, overlaps = _push_of_neighbours(i, points, indptr, indices, box.period, overlaps)
            fx, fy, fz, overlaps = _push_of_walls(i, points, box, (fx, fy, fz), overlaps)
            m = mobility[i]
            force[i, 0] = m * fx
            force[i, 1] = m * fy
            force[i, 2] = m * fz
            if m > 0.0:
                u, v, w = velocity[i, 0], velocity[i, 1], velocity[i, 2]
                power += fx * u + fy * v + fz * w
                ff += m * (fx * fx + fy * fy + fz * fz)
                vv += (u * u + v * v + w * w) / m
        sums[chunk, POWER] = power
        sums[chunk, FORCES] = ff
        sums[chunk, VELOCITIES] = vv
        sums[chunk, OVERLAP], sums[chunk, COUNT], sums[chunk, WORST] = overlaps


@njit(parallel=True, cache=True)
def move(spheres, start, force, step, farthest):
    """Update velocities and centres by one step.

    spheres : Spheres, in and out
    start : (n, 3) float array; where the centres were when their neighbours were listed
    force : (n, 3) float array; as `forces` gives it
    step : Step
    farthest : (chunks,) float array, out; largest squared distance of a centre from its start
    """
    points, velocity = spheres.points, spheres.velocity
    n = len(points)
    for chunk in prange(len(farthest)):
        most = 0.0
        for i in range(chunk * CHUNK, min(n, (chunk + 1) * CHUNK)):
            d2 = 0.0
            for axis in range(3):
                velocity[i, axis] = step.keep * velocity[i, axis] + step.push * force[i, axis]
                points[i, axis] += step.dt * velocity[i, axis]
                d = points[i, axis] - start[i, axis]
                d2 += d * d
            most = max(most, d2)
        farthest[chunk] = most
