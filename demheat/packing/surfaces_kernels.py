"""Many spherical surfaces at once, compiled: patterns of points on them, gaps between them, facets of polyhedra."""

import math

import numpy as np
from numba import njit, prange

# Facets per task: scratch memory is made once for each.
CHUNK = 64
# Half a side of the square that a facet is cut from, in radii of the sphere: a corner of it that is left says that the
# normals do not enclose the sphere. Corners of a facet, at most.
WIDEST, MOST_CORNERS = 4.0, 96


@njit(parallel=True, cache=True)
def turned_patterns(start, turns, balls, points, normals):
    """Fibonacci points on spheres, each pattern turned.

    Parameters
    ----------
    start : (m + 1,) int array
        Where the points of each sphere begin.
    turns : (m, 3, 3) float array
        Rotation matrices.
    balls : (m, 4) float array, m
        Centres and radii.
    points, normals : (start[m], 3) float arrays, m and outward unit vectors, out
    """
    for g in prange(len(balls)):
        count = start[g + 1] - start[g]
        for p in range(start[g], start[g + 1]):
            k = p - start[g] + 0.5
            z = 1.0 - 2.0 * k / count
            azimuth = math.pi * (1.0 + math.sqrt(5.0)) * k
            ring = math.sqrt(1.0 - z * z)
            x, y = ring * math.cos(azimuth), ring * math.sin(azimuth)
            for axis in range(3):
                normals[p, axis] = turns[g, axis, 0] * x + turns[g, axis, 1] * y + turns[g, axis, 2] * z
                points[p, axis] = balls[g, axis] + balls[g, 3] * normals[p, axis]


@njit(cache=True, inline="always")
def _cell(x, size, count, periodic):
    """Cell of a coordinate; the outer ones serve what lies beyond a wall."""
    part = x / size
    if periodic:
        part -= math.floor(part)
    return min(max(np.int64(math.floor(part * count)), 0), count - 1)


@njit(parallel=True, cache=True)
def nearest_gaps(points, own, balls, bins, reach, gaps):
    """Distance of points to the nearest spherical surface but their own, nearest image; infinite beyond a reach.

    Parameters
    ----------
    points : (n, 3) float array, m
    own : (n,) int array
        The sphere that each point belongs to, which does not count; -1 for none.
    balls : (m, 4) float array, m
        Centres and radii.
    bins : BallBins
        Of the balls made larger by the reach.
    reach : float, m
    gaps : (n,) float array, m, out

    Returns
    -------
    int
        Number of distances taken.
    """
    size, periodic, looked = bins.size, bins.periodic, 0
    for p in prange(len(points)):
        nearest = np.inf
        for level in range(len(bins.dims)):
            key = np.int64(0)
            for axis in range(3):
                count = bins.dims[level, axis]
                key = key * count + _cell(points[p, axis], size[axis], count, periodic)
            key += bins.first[level]
            for entry in range(bins.start[key], bins.start[key + 1]):
                ball, square = bins.balls[entry], 0.0
                if ball == own[p]:
                    continue
                for axis in range(3):
                    d = points[p, axis] - balls[ball, axis]
                    if periodic:
                        d -= size[axis] * np.rint(d / size[axis])
                    square += d * d
                nearest = min(nearest, abs(math.sqrt(square) - balls[ball, 3]))
            looked += bins.start[key + 1] - bins.start[key]
        gaps[p] = nearest if nearest <= reach else np.inf
    return looked


@njit(cache=True)
def _thin(points, least, taken, chosen):
    """Choose points of one surface; see `thinned`."""
    n = len(points)
    axis, widest = 0, -1.0
    for k in range(3):
        width = points[:, k].max() - points[:, k].min()
        if width > widest:
            axis, widest = k, width
    # Along this axis only points in a band are looked at.
    order = np.argsort(points[:, axis], kind="mergesort")
    place, along, free = np.empty(n, np.int64), np.empty(n), np.ones(n, np.bool_)
    for k in range(n):
        place[order[k]], along[k] = k, points[order[k], axis]
    widest = least.max()
    for t in range(len(taken)):
        for k in range(np.searchsorted(along, taken[t, axis] - widest), n):
            if along[k] > taken[t, axis] + widest:
                break
            q = order[k]
            square = (points[q, 0] - taken[t, 0]) ** 2 + (points[q, 1] - taken[t, 1]) ** 2
            if square + (points[q, 2] - taken[t, 2]) ** 2 < least[q] * least[q]:
                free[k] = False
    for p in np.argsort(least, kind="mergesort"):
        if not free[place[p]]:
            continue
        chosen[p] = True
        for way in (-1, 1):
            k = place[p]
            while 0 <= k < n and abs(along[k] - points[p, axis]) <= least[p]:
                q = order[k]
                square = (points[q, 0] - points[p, 0]) ** 2 + (points[q, 1] - points[p, 1]) ** 2
                if square + (points[q, 2] - points[p, 2]) ** 2 <= least[p] * least[p]:
                    free[k] = False
                k += way


@njit(parallel=True, cache=True)
def thinned(start, points, least, taken_start, taken, chosen):
    """Choose points that keep their least distance from each other and from those taken, closest-set first.

    Parameters
    ----------
    start : (m + 1,) int array
        Where the points of each surface begin.
    points : (n, 3) float array, m
    least : (n,) float array, m
        What each point keeps from the points chosen after it, and from those taken.
    taken_start : (m + 1,) int array
    taken : (t, 3) float array, m
        Points that are there already, surface by surface.
    chosen : (n,) bool array, out
    """
    for g in prange(len(start) - 1):
        begin, end = start[g], start[g + 1]
        chosen[begin:end] = False
        if end > begin:
            there = taken[taken_start[g] : taken_start[g + 1]]
            _thin(points[begin:end], least[begin:end], there, chosen[begin:end])


@njit(cache=True)
def _cut(corners, count, other, level, a, b):
    """Cut a convex polygon by level + a x + b y <= 0: number of corners left, in `other`; -1 if nothing is cut off."""
    worst = -1.0
    for k in range(count):
        worst = max(worst, level + a * corners[k, 0] + b * corners[k, 1])
    if worst <= 0.0:
        return -1
    kept, last = 0, count - 1
    before = level + a * corners[last, 0] + b * corners[last, 1]
    for k in range(count):
        here = level + a * corners[k, 0] + b * corners[k, 1]
        if (here <= 0.0) != (before <= 0.0):
            t = before / (before - here)
            for c in range(2):
                other[kept, c] = corners[last, c] + t * (corners[k, c] - corners[last, c])
            kept += 1
        if here <= 0.0:
            other[kept] = corners[k]
            kept += 1
        last, before = k, here
    return kept


@njit(cache=True)
def _facet(i, begin, end, normals, corners, other):
    """Area of facet i of the polyhedron with the normals begin..end; NaN if it has no end."""
    x, y, z = normals[i]
    # Two unit vectors across the normal; from the axis that it leans to least.
    least = 0 if abs(x) <= min(abs(y), abs(z)) else (1 if abs(y) <= abs(z) else 2)
    u = np.zeros(3)
    u[least] = 1.0
    u -= normals[i, least] * normals[i]
    u /= math.sqrt(u[0] ** 2 + u[1] ** 2 + u[2] ** 2)
    v = (y * u[2] - z * u[1], z * u[0] - x * u[2], x * u[1] - y * u[0])
    count = 4
    for k in range(4):
        corners[k, 0] = WIDEST * (1.0 if k in (0, 3) else -1.0)
        corners[k, 1] = WIDEST * (1.0 if k < 2 else -1.0)
    far, up, down = 2.0 * WIDEST**2, i + 1, i - 1
    while True:
        # A plane at angle t from this one is met at tan(t/2): beyond the farthest corner it cuts nothing.
        chord = 2.0 * math.sqrt(far / (1.0 + far))
        rise = normals[up, 2] - z if up < end else np.inf
        fall = z - normals[down, 2] if down >= begin else np.inf
        if min(rise, fall) > chord:
            break
        if rise <= fall:
            j, up = up, up + 1
        else:
            j, down = down, down - 1
        cosine = x * normals[j, 0] + y * normals[j, 1] + z * normals[j, 2]
        if 1.0 - cosine > far * (1.0 + cosine):
            continue
        a = u[0] * normals[j, 0] + u[1] * normals[j, 1] + u[2] * normals[j, 2]
        b = v[0] * normals[j, 0] + v[1] * normals[j, 1] + v[2] * normals[j, 2]
        kept = _cut(corners, count, other, cosine - 1.0, a, b)
        if kept < 0:
            continue
        corners, other, count = other, corners, kept
        if count >= MOST_CORNERS - 2:
            return np.nan
        far = 0.0
        for k in range(count):
            far = max(far, corners[k, 0] ** 2 + corners[k, 1] ** 2)
    area = 0.0
    for k in range(count):
        if max(abs(corners[k, 0]), abs(corners[k, 1])) >= WIDEST * (1.0 - 1e-9):
            return np.nan
        m = k + 1 if k + 1 < count else 0
        area += 0.5 * (corners[k, 0] * corners[m, 1] - corners[m, 0] * corners[k, 1])
    return area


@njit(parallel=True, cache=True)
def facet_areas(start, own, normals, areas):
    """Areas of the facets of the polyhedra {x : n.x <= 1 for all n}, one for each set of normals.

    Parameters
    ----------
    start : (m + 1,) int array
        Where the normals of each polyhedron begin.
    own : (k,) int array
        The polyhedron of each normal, ascending.
    normals : (k, 3) float array
        Unit vectors, by ascending z within each polyhedron.
    areas : (k,) float array, out
        NaN where a facet has no end, or so many corners or so far away (4 or more) that it is as good as without.
    """
    n = len(normals)
    for chunk in prange((n + CHUNK - 1) // CHUNK):
        corners, other = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
        for i in range(chunk * CHUNK, min(n, (chunk + 1) * CHUNK)):
            areas[i] = _facet(i, start[own[i]], start[own[i] + 1], normals, corners, other)
