"""Temperature and heat flux of a cubic array of spheres at any point, from the multipoles of `lattice.solve`.

Inside a sphere its own regular series converges. Outside, the spheres near the cell are summed one by one, each by its
own irregular series, and only the far rest is expanded about the origin: a single expansion about the origin would not
converge in the corners of the cell.
"""

import numpy as np

from references.exact.harmonics import CIRCUMRADIUS, SITES, lattice_sums, series
from references.exact.lattice import polarisability

# Terms below this, in units of gradient times edge, are left out.
NEGLIGIBLE = 1e-16
# Points handled at a time, so that intermediate arrays stay in the cache.
CHUNK = 4096


def temperature(solution, points, gradient=(0.0, 0.0, 1.0)):
    """Temperature of the array under a mean gradient, zero at the centre of the sphere at the origin."""
    points = np.asarray(points, dtype=float).reshape(-1, 3)
    offsets = points - nearest_site(solution.kind, points)
    total = (points - offsets) @ np.asarray(gradient, dtype=float)
    for axis in np.flatnonzero(gradient):
        # Cyclic permutation turns the axis of the load into z; it leaves the array as it is.
        total += gradient[axis] * _evaluate(solution, np.roll(offsets, 2 - axis, axis=1), gradients=False)[:, 0]
    return total


def flux(solution, points, gradient=(0.0, 0.0, 1.0)):
    """Heat flux of the array under a mean gradient, over the conductivity of the matrix."""
    points = np.asarray(points, dtype=float).reshape(-1, 3)
    offsets = points - nearest_site(solution.kind, points)
    total = np.zeros_like(points)
    for axis in np.flatnonzero(gradient):
        slope = _evaluate(solution, np.roll(offsets, 2 - axis, axis=1), gradients=True)
        total -= gradient[axis] * np.roll(slope, axis - 2, axis=1)
    return total


def nearest_site(kind, points):
    """The site of the array nearest to each point."""
    nearest = np.round(points)
    for site in np.array(SITES[kind][1:]).reshape(-1, 3):
        other = np.round(points - site) + site
        closer = np.sum((points - other) ** 2, axis=1) < np.sum((points - nearest) ** 2, axis=1)
        nearest[closer] = other[closer]
    return nearest


def _evaluate(solution, offsets, *, gradients):
    """Temperature, (n, 1), or its slope times conductivity, (n, 3), for a mean unit gradient along z."""
    result = np.empty((len(offsets), 3 if gradients else 1))
    inside = np.einsum("ij,ij->i", offsets, offsets) <= solution.radius**2
    result[inside] = _inside(solution, offsets[inside], gradients)
    outside = np.flatnonzero(~inside)
    for part in np.array_split(outside, len(outside) // CHUNK + 1):
        result[part] = _outside(solution, offsets[part], gradients)
    return result


def _inside(solution, offsets, gradients):
    degree, s, rho = np.arange(len(solution.inner)), solution.contrast, solution.resistance
    factor = 1 - polarisability(s, degree, rho)
    if rho > 0:
        # The temperature jumps by what is left of it outside; nothing is left in perfect conductors.
        factor = factor / (1 + s * rho * degree) if np.isfinite(s) else np.zeros(len(degree))
    if gradients:
        # s (2l+1)/(l s + (l + 1)(1 + s rho l)), finite also for perfectly conducting spheres.
        below = degree + (degree + 1) / s + (degree + 1) * rho * degree if s > 0 else np.inf
        factor = (2 * degree + 1) / np.maximum(below, 1)
        factor = factor / solution.radius
    table = factor[:, None] * solution.inner
    return _sum(_slopes(table) if gradients else [_doubled(table)], offsets / solution.radius)


def _outside(solution, offsets, gradients):
    scale = CIRCUMRADIUS[solution.kind]
    far = _slopes(solution.far / scale) if gradients else [_doubled(solution.far)]
    result = _sum(far, offsets / scale)
    near = lattice_sums(solution.kind, len(solution.source) - 1 + len(solution.far) - 1).near
    apart = (offsets[:, None, :] - near[None]).reshape(-1, 3)
    distance = np.linalg.norm(apart, axis=1)
    # I_l^m(y) = R_l^m(y / |y|^2) / |y|: an irregular series is a regular one at the inverted point.
    inverted = apart * (solution.radius / distance**2)[:, None]
    tables = _irregular_slopes(solution.source) if gradients else [_doubled(solution.source)]
    size = 1 / distance if gradients else solution.radius / distance
    parts = _sum(tables, inverted) * size[:, None]
    return result + parts.reshape(len(offsets), len(near), parts.shape[1]).sum(axis=1)


def _sum(tables, points):
    """Real sum over all m of one table of a temperature, (n, 1), or of the three of a gradient, (n, 3).

    Points are taken in order of their distance, with just the degrees that each chunk of them needs.
    """
    size = np.max(np.abs(tables), axis=(0, 2))
    distance = np.linalg.norm(points, axis=1)
    order = np.argsort(distance)
    result = np.empty((len(points), len(tables)))
    for part in np.array_split(order, len(order) // CHUNK + 1):
        if len(part):
            needed = size * distance[part[-1]] ** np.arange(len(size)) > NEGLIGIBLE
            top = np.flatnonzero(needed)[-1] + 1 if needed.any() else 1
            result[part] = _combine(series([table[:top, :top] for table in tables], points[part]))
    return result


def _combine(sums):
    if len(sums) == 1:
        return sums[0].real[:, None]
    across = sums[1] - np.conj(sums[2])
    return np.stack([across.real, across.imag, sums[0].real], axis=1)


def _doubled(table):
    """A table for m >= 0 that stands for both signs of m."""
    weight = np.full(table.shape[1], 2.0)
    weight[0] = 1.0
    return table * weight


def _slopes(table):
    """Tables of d/dz and of the two halves of d/dx + i d/dy of a regular series.

    d/dz R_l^m = sqrt((l-m)(l+m)) R_(l-1)^m, (d/dx + i d/dy) R_l^m = sqrt((l-m)(l-m-1)) R_(l-1)^(m+1); the second half
    is that of -m, by R_l^-m = (-1)^m conj(R_l^m).
    """
    n, m = np.arange(len(table))[:, None], np.arange(len(table))[None]
    rise = table * np.sqrt(np.maximum((n - m) * (n - m - 1.0), 0))
    fall = table * np.sqrt((n + m) * np.maximum(n + m - 1.0, 0)) * (m > 0)
    along = _doubled(table * np.sqrt(np.maximum(n**2.0 - m**2, 0)))
    return [_moved(along, -1, 0), _moved(rise, -1, 1), _moved(fall, -1, -1)]


def _irregular_slopes(table):
    """The same of an irregular series: degrees rise, d/dz I_l^m = -sqrt((l+1-m)(l+1+m)) I_(l+1)^m."""
    n, m = np.arange(len(table))[:, None], np.arange(len(table))[None]
    rise = table * np.sqrt((n + m + 1.0) * (n + m + 2))
    fall = table * np.sqrt(np.maximum((n - m + 1.0) * (n - m + 2), 0)) * (m > 0)
    along = _doubled(-table * np.sqrt(np.maximum((n + 1.0) ** 2 - m**2, 0)))
    return [_moved(along, 1, 0), _moved(rise, 1, 1), _moved(fall, 1, -1)]


def _moved(table, degrees, orders):
    """Table with entry [l, m] moved to [l + degrees, m + orders]."""
    padded = np.zeros((len(table) + 2, len(table) + 2))
    padded[1:-1, 1:-1] = table
    return np.roll(padded, (degrees, orders), axis=(0, 1))[1:, 1:]
