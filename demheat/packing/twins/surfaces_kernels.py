"""Many spherical surfaces at once, compiled: patterns of points on them, gaps between them, facets of polyhedra.

Threads do spheres, points or normals from `first` to `last`.
"""

import math

import numpy as np
from numba import njit

# Options of what threads do pieces of, and of what makes no array: no references are counted, no division is checked.
IN_PIECES = {"cache": True, "error_model": "numpy", "nogil": True}
PLAIN = {"cache": True, "error_model": "numpy", "_nrt": False}
# Of what is called in one place: compiled once, not again at every level of its callers.
ONCE = {**PLAIN, "inline": "always"}

# Points of a pattern from one sine to the next.
CHUNK = 64
# Neighbours that a facet is cut by before all others are looked at.
AHEAD = 6
# Half a side of the square that a facet is cut from, in radii of the sphere: a corner of it that is left says that the
# normals do not enclose the sphere. Corners of a facet, at most.
WIDEST, MOST_CORNERS = 4.0, 96


@njit(**IN_PIECES)
def turned_patterns(first, last, start, turns, balls, points, normals):
    """Fibonacci points on spheres, each pattern turned.

    first, last : int; spheres
    start : (m + 1,) int array; where the points of each sphere begin
    turns : (m, 3, 3) float array; rotation matrices
    balls : (m, 4) float array, m; centres and radii
    points, normals : (start[m], 3) float arrays, m and outward unit vectors, out
    """
    golden = math.pi * (1.0 + math.sqrt(5.0))
    cos_step, sin_step = math.cos(golden), math.sin(golden)
    for g in range(first, last):
        count, cosine, sine = start[g + 1] - start[g], 1.0, 0.0
        for p in range(start[g], start[g + 1]):
            k = p - start[g]
            if k % CHUNK == 0:
                cosine, sine = math.cos(golden * (k + 0.5)), math.sin(golden * (k + 0.5))
            z = 1.0 - 2.0 * (k + 0.5) / count
            ring = math.sqrt(1.0 - z * z)
            x, y = ring * cosine, ring * sine
            for axis in range(3):
                along = turns[g, axis, 0] * x + turns[g, axis, 1] * y + turns[g, axis, 2] * z
                normals[p, axis] = along
                points[p, axis] = balls[g, axis] + balls[g, 3] * along
            # A step of the golden angle; a few of them keep all digits but one.
            cosine, sine = cosine * cos_step - sine * sin_step, sine * cos_step + cosine * sin_step


@njit(**PLAIN)
def _cell(part, count, periodic):
    """Cell of a coordinate over the side of the box; the outer ones serve what lies beyond a wall."""
    if periodic:
        part -= math.floor(part)
    return min(max(np.int64(math.floor(part * count)), 0), count - 1)


@njit(**PLAIN)
def _image(d, side, per_side):
    """Offset to the nearest image; per_side is 0 without any."""
    return d - side * np.rint(d * per_side)


@njit(**IN_PIECES)
def nearest_gaps(first, last, points, own, kin, balls, bins, reach, gaps):
    """Distance of points to the nearest spherical surface but their own, nearest image; infinite beyond a reach.

    first, last : int; points
    points : (n, 3) float array, m
    own : (n,) int array; the kin of spheres that each point belongs to, which do not count; any other number for none
    kin : (m,) int array; of each sphere
    balls : (m, 4) float array, m; centres and radii
    bins : BallBins; of the balls made larger by the reach
    reach : float, m
    gaps : (n,) float array, m, out
    Returns int: number of distances taken
    """
    x, y, z = bins.size
    ix, iy, iz = (1.0 / x, 1.0 / y, 1.0 / z) if bins.periodic else (0.0, 0.0, 0.0)
    dims, begin, start, looked = bins.dims, bins.first, bins.start, 0
    for p in range(first, last):
        px, py, pz = points[p, 0], points[p, 1], points[p, 2]
        nearest = np.inf
        for level in range(len(dims)):
            key = _cell(px / x, dims[level, 0], bins.periodic)
            key = key * dims[level, 1] + _cell(py / y, dims[level, 1], bins.periodic)
            key = key * dims[level, 2] + _cell(pz / z, dims[level, 2], bins.periodic) + begin[level]
            for entry in range(start[key], start[key + 1]):
                ball = bins.balls[entry]
                if kin[ball] == own[p]:
                    continue
                dx = _image(px - balls[ball, 0], x, ix)
                dy = _image(py - balls[ball, 1], y, iy)
                dz = _image(pz - balls[ball, 2], z, iz)
                nearest = min(nearest, abs(math.sqrt(dx * dx + dy * dy + dz * dz) - balls[ball, 3]))
            looked += start[key + 1] - start[key]
        gaps[p] = nearest if nearest <= reach else np.inf
    return looked


@njit(**PLAIN, nogil=True)
def ascending(values, start, order):
    """Stable order of numbers that are spread out: first into as many parts of their range, then by insertion.

    values : (n,) float array
    start : (n + 1,) int64 array; scratch memory, 0 at first
    order : (n,) int64 array, out
    """
    n, low, high = len(values), np.inf, -np.inf
    for k in range(n):
        low, high = min(low, values[k]), max(high, values[k])
    scale = (n - 1) / (high - low) if high > low else 0.0
    for k in range(n):
        start[np.int64((values[k] - low) * scale) + 1] += 1
    for k in range(n):
        start[k + 1] += start[k]
    for k in range(n):
        part = np.int64((values[k] - low) * scale)
        order[start[part]] = k
        start[part] += 1
    for k in range(1, n):
        here, value, m = order[k], values[order[k]], k
        while m > 0 and values[order[m - 1]] > value:
            order[m] = order[m - 1]
            m -= 1
        order[m] = here


@njit(**PLAIN, nogil=True)
def thin(points, least, order, way_up, place, along, taken, there, below, free, chosen):
    """Choose points of a surface that keep their distance from each other and from those taken, closest-set first.

    points : (n, 3) float array, m
    least : (n,) float array, m; what each point keeps from the points chosen after it, and from those taken
    order : (n,) int64 array; of `least`, ascending
    way_up, place, along : (n,) int64 and float arrays; points in their order along an axis, the place of each in it,
      and coordinates along it, in that order
    taken : (t, 3) float array, m; points that are there already
    there, below : (t,) float and int64 arrays; their coordinates along the axis, and the first place that may be near
      to each
    free : (n,) bool array; scratch memory, True at first
    chosen : (n,) bool array, out; false at first
    """
    n, widest = len(points), least[order[len(points) - 1]]
    for t in range(len(taken)):
        for k in range(below[t], n):
            if along[k] > there[t] + widest:
                break
            q = way_up[k]
            dx, dy, dz = points[q, 0] - taken[t, 0], points[q, 1] - taken[t, 1], points[q, 2] - taken[t, 2]
            if dx * dx + dy * dy + dz * dz < least[q] * least[q]:
                free[q] = False
    for p in order:
        if not free[p]:
            continue
        chosen[p] = True
        x, y, z, square = points[p, 0], points[p, 1], points[p, 2], least[p] * least[p]
        for step in (-1, 1):
            k = place[p]
            while 0 <= k < n and abs(along[k] - along[place[p]]) <= least[p]:
                q = way_up[k]
                dx, dy, dz = points[q, 0] - x, points[q, 1] - y, points[q, 2] - z
                if dx * dx + dy * dy + dz * dz <= square:
                    free[q] = False
                k += step


@njit(**ONCE)
def _cut(corners, count, far, other, level, a, b):
    """Cut a convex polygon in place by level + a x + b y <= 0; its corners, and the farthest one's squared distance."""
    worst = -1.0
    for k in range(count):
        worst = max(worst, level + a * corners[k, 0] + b * corners[k, 1])
    if worst <= 0.0:
        return count, far
    kept, last = 0, count - 1
    before = level + a * corners[last, 0] + b * corners[last, 1]
    for k in range(count):
        here = level + a * corners[k, 0] + b * corners[k, 1]
        if (here <= 0.0) != (before <= 0.0):
            t = before / (before - here)
            other[kept, 0] = corners[last, 0] + t * (corners[k, 0] - corners[last, 0])
            other[kept, 1] = corners[last, 1] + t * (corners[k, 1] - corners[last, 1])
            kept += 1
        if here <= 0.0:
            other[kept, 0], other[kept, 1] = corners[k, 0], corners[k, 1]
            kept += 1
        last, before = k, here
    # One that is full would overflow at the next cut: what it has lost shows in its number.
    kept, far = min(kept, MOST_CORNERS - 2), 0.0
    for k in range(kept):
        x, y = other[k, 0], other[k, 1]
        corners[k, 0], corners[k, 1], far = x, y, max(far, x * x + y * y)
    return kept, far


@njit(**ONCE)
def _nearest_normals(i, begin, end, normals, found, cosines):
    """The normals nearest to one of them among those next to it in their order, nearest first; how many."""
    kept, most = 0, len(found)
    width = np.int64(2.0 * math.sqrt(end - begin)) + most
    for j in range(max(begin, i - width), min(end, i + width + 1)):
        if j == i:
            continue
        cosine = normals[i, 0] * normals[j, 0] + normals[i, 1] * normals[j, 1] + normals[i, 2] * normals[j, 2]
        if kept == most and cosine <= cosines[kept - 1]:
            continue
        k = kept if kept < most else most - 1
        while k > 0 and cosines[k - 1] < cosine:
            found[k], cosines[k] = found[k - 1], cosines[k - 1]
            k -= 1
        found[k], cosines[k] = j, cosine
        kept = min(kept + 1, most)
    return kept


@njit(**ONCE)
def _facet(i, begin, end, normals, corners, other, found, cosines):
    """Area of facet i of the polyhedron with the normals begin..end; NaN if it has no end."""
    x, y, z = normals[i, 0], normals[i, 1], normals[i, 2]
    # Two unit vectors across the normal; the first one level, or along x near the poles.
    ring = math.sqrt(x * x + y * y)
    ux, uy = (-y / ring, x / ring) if ring > 0.0 else (1.0, 0.0)
    vx, vy, vz = -z * uy, z * ux, x * uy - y * ux
    for k in range(4):
        corners[k, 0] = WIDEST * (1.0 if k in (0, 3) else -1.0)
        corners[k, 1] = WIDEST * (1.0 if k < 2 else -1.0)
    count, far = 4, 2.0 * WIDEST**2
    # First by those that are likely to bound it; then by all that may, in order of height, up and down: a plane at an
    # angle t to this one is met at tan(t/2), and beyond the farthest corner it cuts nothing.
    ahead = _nearest_normals(i, begin, end, normals, found, cosines)
    for way in (0, 1, -1):
        k = 0 if way == 0 else i + way
        chord = 2.0 * math.sqrt(far / (1.0 + far))
        while (k < ahead) if way == 0 else (begin <= k < end and abs(normals[k, 2] - z) <= chord):
            j = found[k] if way == 0 else k
            k += 1 if way == 0 else way
            cosine = x * normals[j, 0] + y * normals[j, 1] + z * normals[j, 2]
            if 1.0 - cosine > far * (1.0 + cosine):
                continue
            a = ux * normals[j, 0] + uy * normals[j, 1]
            b = vx * normals[j, 0] + vy * normals[j, 1] + vz * normals[j, 2]
            count, far = _cut(corners, count, far, other, cosine - 1.0, a, b)
            chord = 2.0 * math.sqrt(far / (1.0 + far))
    area = 0.0
    if count == MOST_CORNERS - 2:
        return np.nan
    for k in range(count):
        if max(abs(corners[k, 0]), abs(corners[k, 1])) >= WIDEST * (1.0 - 1e-9):
            return np.nan
        m = k + 1 if k + 1 < count else 0
        area += 0.5 * (corners[k, 0] * corners[m, 1] - corners[m, 0] * corners[k, 1])
    return area


@njit(**IN_PIECES)
def facet_areas(first, last, start, own, normals, areas):
    """Areas of the facets of the polyhedra {x : n.x <= 1 for all n}, one for each set of normals.

    first, last : int; normals
    start : (m + 1,) int array; where the normals of each polyhedron begin
    own : (k,) int array; the polyhedron of each normal, ascending
    normals : (k, 3) float array; unit vectors, by ascending z within each polyhedron
    areas : (k,) float array, out; NaN where a facet has no end, or so many corners or so far away (4 or more) that it
      is as good as without
    """
    corners, other = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
    found, cosines = np.empty(AHEAD, np.int64), np.empty(AHEAD)
    for i in range(first, last):
        areas[i] = _facet(i, start[own[i]], start[own[i] + 1], normals, corners, other, found, cosines)
