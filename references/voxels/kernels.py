"""Numba kernels of the voxelisation: which voxels a sphere fills, cuts or leaves."""

import math

import numba
import numpy as np

import demheat.runtime.compiled  # noqa: F401 (where compiled kernels are kept)

# A cut voxel is integrated exactly along one direction and by two-point Gauss on this many intervals along the others,
# which reach no further than a sphere that is smaller than the voxel.
INTERVALS = 4
GAUSS = 0.5 / math.sqrt(3.0)
# Fractions closer than this to 0 or 1 count as 0 or 1: far below the quadrature's error in one voxel.
FULL = 1e-9
# Directions closer than this tie.
TIE = 1e-9


@numba.njit(cache=True)
def count(phase, phases):
    """How often each phase number occurs; without the copy to 64 bits that bincount makes.

    phase : (n,) int array
    phases : int; numbers that there are
    Returns (phases,) int array
    """
    result = np.zeros(phases, np.int64)
    for i in range(len(phase)):
        result[phase[i]] += 1
    return result


@numba.njit(cache=True)
def _shell(radius, spacing):
    """Squared distances from a sphere's centre between which lie the centres of all voxels that its surface cuts."""
    reach = 0.5 * math.sqrt(spacing[0] ** 2 + spacing[1] ** 2 + spacing[2] ** 2)
    # Where half a voxel's diagonal exceeds the radius the surface may cut even the voxel that the sphere is centred in.
    return (radius - reach) ** 2 if radius > reach else -1.0, (radius + reach) ** 2


@numba.njit(cache=True)
def paint_sphere(grid, phase, center, radius, spacing, low, high):
    """Give every voxel whose centre lies in the sphere this phase; count the voxels that the surface may cut.

    grid : (nx, ny, nz) int array; changed in place
    phase : int
    center : (3,) float array, m
    radius : float, m
    spacing : (3,) float array, m
    low, high : (3,) int array; voxels to look at, low <= index < high
    Returns count : int
    """
    inner, outer = _shell(radius, spacing)
    count = 0
    for i in range(low[0], high[0]):
        x2 = ((i + 0.5) * spacing[0] - center[0]) ** 2
        for j in range(low[1], high[1]):
            xy2 = x2 + ((j + 0.5) * spacing[1] - center[1]) ** 2
            if xy2 >= outer:
                continue
            for k in range(low[2], high[2]):
                d2 = xy2 + ((k + 0.5) * spacing[2] - center[2]) ** 2
                if d2 <= radius * radius:
                    grid[i, j, k] = phase
                if inner < d2 < outer:
                    count += 1
    return count


@numba.njit(cache=True)
def paint_spheres(grid, windows, spacing):
    """`paint_sphere` for one window after the other.

    grid : (nx, ny, nz) int array; changed in place
    windows : Windows
    spacing : (3,) float array, m
    Returns count : int; of the voxels that the surfaces may cut
    """
    count = 0
    for n in range(len(windows.radius)):
        center, low, high = windows.center[n], windows.low[n], windows.high[n]
        count += paint_sphere(grid, windows.number[n], center, windows.radius[n], spacing, low, high)
    return count


@numba.njit(cache=True)
def cut_spheres(shape, windows, spacing, cuts):
    """`cut_sphere` for one window after the other.

    shape : (3,) int array; voxels of the whole grid, for the flat index
    windows : Windows
    spacing : (3,) float array, m
    cuts : Cuts; out: as many rows as `paint_spheres` counts, and one of `moment` more
    Returns found : int; rows filled
    """
    found = 0
    for n in range(len(windows.radius)):
        center, low, high = windows.center[n], windows.low[n], windows.high[n]
        index, fraction, moment = cuts.index[found:], cuts.fraction[found:], cuts.moment[found:]
        new = cut_sphere(shape, center, windows.radius[n], spacing, low, high, index, fraction, moment)
        cuts.phase[found : found + new] = windows.number[n]
        found += new
    return found


@numba.njit(cache=True)
def cut_sphere(shape, center, radius, spacing, low, high, index, fraction, moment):
    """Voxels that the surface of a sphere cuts: their fraction inside and the second moment of the surface normal.

    shape : (3,) int array; voxels of the whole grid, for the flat index
    center : (3,) float array, m
    radius : float, m
    spacing : (3,) float array, m
    low, high : (3,) int array; voxels to look at, low <= index < high
    index : (count,) int array; out: flat index of each cut voxel
    fraction : (count,) float array; out: part of the voxel inside the sphere
    moment : (count, 6) float array, m2; out: integral of n n over the surface inside the voxel, order xx, yy, zz, yz,
      xz, xy
    Returns found : int; rows filled; fewer than `count` of `paint_sphere`, which only bounds it
    """
    inner, outer = _shell(radius, spacing)
    corner = np.empty(3)
    found = 0
    for i in range(low[0], high[0]):
        corner[0] = i * spacing[0] - center[0]
        for j in range(low[1], high[1]):
            corner[1] = j * spacing[1] - center[1]
            for k in range(low[2], high[2]):
                corner[2] = k * spacing[2] - center[2]
                d2 = 0.0
                for a in range(3):
                    d2 += (corner[a] + 0.5 * spacing[a]) ** 2
                if d2 <= inner or d2 >= outer:
                    continue
                inside = _measure(corner, radius, spacing, moment[found])
                if FULL < inside < 1.0 - FULL:
                    index[found] = (i * shape[1] + j) * shape[2] + k
                    fraction[found] = inside
                    found += 1
    return found


@numba.njit(cache=True)
def _measure(corner, radius, spacing, moment):
    """Fraction of one voxel inside a sphere about the origin; the moment of the normal goes to `moment`."""
    normal = corner + 0.5 * spacing
    steepest = max(abs(normal[0]), abs(normal[1]), abs(normal[2]))
    moment[:] = 0.0
    inside, ways = 0.0, 0
    for c in range(3):
        # Where two axes tie both are taken, so that the voxels are as symmetric as the scene.
        if abs(normal[c]) >= (1.0 - TIE) * steepest:
            inside += _measure_along(c, corner, radius, spacing, moment)
            ways += 1
    moment /= ways
    if moment[0] + moment[1] + moment[2] == 0.0:
        # No column meets the surface, only a corner does: the normal is that at the voxel's centre, its weight small.
        weight = FULL * spacing[0] * spacing[1] / max(steepest * steepest, 1e-300)
        _add_normal(moment, 0, 1, 2, normal[0], normal[1], normal[2], weight)
    return inside / ways


@numba.njit(cache=True)
def _measure_along(c, corner, radius, spacing, moment):
    """The same, integrated exactly along axis c; adds to `moment`."""
    a, b = (c + 1) % 3, (c + 2) % 3
    start_a, width_a = _across(corner[a], spacing[a], radius)
    start_b, width_b = _across(corner[b], spacing[b], radius)
    area = width_a * width_b / (4 * INTERVALS * INTERVALS)
    floor, ceiling = corner[c], corner[c] + spacing[c]
    length = 0.0
    for i in range(2 * INTERVALS):
        u = start_a + _gauss(i) * width_a
        for j in range(2 * INTERVALS):
            v = start_b + _gauss(j) * width_b
            h2 = radius * radius - u * u - v * v
            if h2 <= 0.0:
                continue
            h = math.sqrt(h2)
            length += max(0.0, min(h, ceiling) - max(-h, floor))
            if floor < h < ceiling:
                _add_normal(moment, a, b, c, u, v, h, area / (h * radius))
            if floor < -h < ceiling:
                _add_normal(moment, a, b, c, u, v, -h, area / (h * radius))
    return length / (4 * INTERVALS * INTERVALS * spacing[c]) * (width_a * width_b / (spacing[a] * spacing[b]))


@numba.njit(cache=True)
def _across(corner, spacing, radius):
    """Where columns of quadrature begin across one axis, and how far they reach."""
    if 2.0 * radius >= spacing:
        return corner, spacing
    # The columns of a whole voxel would miss a sphere this small or, as few, make it many times too large.
    start = max(corner, -radius)
    return start, max(min(corner + spacing, radius) - start, 0.0)


@numba.njit(cache=True)
def _gauss(i):
    """Place of Gauss point i in a unit length of INTERVALS intervals."""
    return (i // 2 + 0.5 + (2 * (i % 2) - 1) * GAUSS) / INTERVALS


@numba.njit(cache=True)
def _add_normal(moment, a, b, c, x, y, z, weight):
    """Add weight * r r^T for r = (x, y, z) along the axes (a, b, c); entry 3 + m holds the pair without axis m."""
    moment[a] += weight * x * x
    moment[b] += weight * y * y
    moment[c] += weight * z * z
    moment[3 + a] += weight * y * z
    moment[3 + b] += weight * x * z
    moment[3 + c] += weight * x * y


@numba.njit(cache=True)
def cut_links(resistance, change, center, radius, spacing):
    """Add a sphere's change of resistivity to the links along the last axis, by the part of each inside the sphere.

    resistance : (na, nb, n + 1) float array, m K/W; changed in place.  Link i reaches from (i - 1/2) to (i + 1/2)
      spacings, less what lies outside the box
    change : float, m K/W
    center : (3,) float array, m
    radius : float, m
    spacing : (3,) float array, m
    """
    na, nb, n = resistance.shape
    h = spacing[2]
    first_i, last_i = _reached(center[0], radius, spacing[0], na)
    first_j, last_j = _reached(center[1], radius, spacing[1], nb)
    for i in range(first_i, last_i):
        x2 = ((i + 0.5) * spacing[0] - center[0]) ** 2
        if x2 >= radius * radius:
            continue
        for j in range(first_j, last_j):
            s2 = radius * radius - x2 - ((j + 0.5) * spacing[1] - center[1]) ** 2
            if s2 <= 0.0:
                continue
            low = max(center[2] - math.sqrt(s2), 0.0) / h
            high = min(center[2] + math.sqrt(s2), (n - 1) * h) / h
            first, last = int(math.floor(low + 0.5)), int(math.floor(high + 0.5))
            for k in range(max(first, 0), min(last, n - 1) + 1):
                inside = min(high, k + 0.5) - max(low, k - 0.5)
                if inside > 0.0:
                    resistance[i, j, k] += change * inside


@numba.njit(cache=True)
def cut_links_by_spheres(resistance, change, center, radius, spacing):
    """`cut_links` by one sphere after the other.

    resistance : (na, nb, n + 1) float array, m K/W; changed in place
    change : (s,) float array, m K/W
    center : (s, 3) float array, m
    radius : (s,) float array, m
    spacing : (3,) float array, m
    """
    for sphere in range(len(radius)):
        cut_links(resistance, change[sphere], center[sphere], radius[sphere], spacing)


@numba.njit(cache=True)
def _reached(center, radius, spacing, count):
    """Rows first <= i < last that hold all whose middles, (i + 1/2) spacings, are nearer than the radius."""
    first, last = math.floor((center - radius) / spacing - 0.5), math.ceil((center + radius) / spacing + 0.5)
    return min(max(int(first), 0), count), min(max(int(last), 0), count)


@numba.njit(cache=True)
def keep_off(resistance, phase, least, periodic):
    """Keep surfaces off the nodes: a link between two phases resists at least a little like the poorer one.

    resistance : (na, nb, n + 1) float array, m K/W; changed in place; see `cut_links`
    phase : (na, nb, n) int array
    least : (phases,) float array, m K/W; of a link between two phases where theirs differ, the larger one
    periodic : bool; the first and the last link are one and the same, between the last voxel and the first
    """
    na, nb, n = phase.shape
    for i in range(na):
        # In this order memory is read in rows, or within one plane, whichever axis of the grid is the links'.
        for k in range(0 if periodic else 1, n):
            for j in range(nb):
                low, high = least[phase[i, j, k - 1]], least[phase[i, j, k]]
                if low != high:
                    resistance[i, j, k] = max(resistance[i, j, k], low, high)
        if periodic:
            for j in range(nb):
                resistance[i, j, n] = resistance[i, j, 0]
