"""Compiled loops of the overlap relaxation: forces by gathering over symmetric rows, and the FIRE step."""

import numpy as np
from numba import njit, prange

# Particles per task and per partial sum. Fixed, so that sums are the same whatever the number of threads.
CHUNK = 256


@njit(parallel=True, cache=True)
def forces(points, velocity, mobility, indptr, indices, size, period, across, force, sums):
    """Harmonic repulsion (stiffness 1) of overlapping spheres and of walls, times each particle's mobility.

    Parameters
    ----------
    points : (n, 4) float array
        Centre and radius.
    velocity : (n, 3) float array
    mobility : (n,) float array
        Inverse mass; 0 holds a particle.
    indptr, indices : arrays
        Symmetric rows of candidates.
    size : (3,) float array
    period : (3,) float array
        `size` on periodic axes, 0 on walled ones.
    across : (3,) float array
        1 on axes across which the wall is round (inscribed in the box), else 0.
    force : (n, 3) float array, out
        Acceleration: mobility times force.
    sums : (chunks, 6) float array, out
        Power (force times velocity), squared force and velocity (both times mass), sum, count and maximum of the
        overlaps, each pair counted from both sides.
    """
    n = len(points)
    bx, by, bz = period[0], period[1], period[2]
    ix = 1.0 / bx if bx > 0.0 else 0.0
    iy = 1.0 / by if by > 0.0 else 0.0
    iz = 1.0 / bz if bz > 0.0 else 0.0
    for chunk in prange(len(sums)):
        power = ff = vv = total = count = worst = 0.0
        for i in range(chunk * CHUNK, min(n, (chunk + 1) * CHUNK)):
            x, y, z, r = points[i, 0], points[i, 1], points[i, 2], points[i, 3]
            fx = fy = fz = 0.0
            for t in range(indptr[i], indptr[i + 1]):
                j = indices[t]
                dx = x - points[j, 0]
                dy = y - points[j, 1]
                dz = z - points[j, 2]
                dx -= bx * np.rint(dx * ix)
                dy -= by * np.rint(dy * iy)
                dz -= bz * np.rint(dz * iz)
                reach = r + points[j, 3]
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
            square = 0.0
            bound = np.inf
            for axis in range(3):
                if across[axis] > 0.0:
                    bound = 0.5 * size[axis]
                    square += (points[i, axis] - bound) ** 2
                elif period[axis] == 0.0:
                    low = max(0.0, r - points[i, axis])
                    high = max(0.0, points[i, axis] + r - size[axis])
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
                fx -= across[0] * inward * (points[i, 0] - bound)
                fy -= across[1] * inward * (points[i, 1] - bound)
                fz -= across[2] * inward * (points[i, 2] - bound)
                total += 2.0 * out
                count += 2.0
                worst = max(worst, out)
            m = mobility[i]
            force[i, 0] = m * fx
            force[i, 1] = m * fy
            force[i, 2] = m * fz
            if m > 0.0:
                u, v, w = velocity[i, 0], velocity[i, 1], velocity[i, 2]
                power += fx * u + fy * v + fz * w
                ff += m * (fx * fx + fy * fy + fz * fz)
                vv += (u * u + v * v + w * w) / m
        sums[chunk, 0] = power
        sums[chunk, 1] = ff
        sums[chunk, 2] = vv
        sums[chunk, 3] = total
        sums[chunk, 4] = count
        sums[chunk, 5] = worst


@njit(parallel=True, cache=True)
def move(points, start, velocity, force, keep, push, step, farthest):
    """Update v = keep v + push f, x += step v; `farthest` gets the largest squared distance from `start` by chunk."""
    n = len(points)
    for chunk in prange(len(farthest)):
        most = 0.0
        for i in range(chunk * CHUNK, min(n, (chunk + 1) * CHUNK)):
            d2 = 0.0
            for axis in range(3):
                velocity[i, axis] = keep * velocity[i, axis] + push * force[i, axis]
                points[i, axis] += step * velocity[i, axis]
                d = points[i, axis] - start[i, axis]
                d2 += d * d
            most = max(most, d2)
        farthest[chunk] = most
