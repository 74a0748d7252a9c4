"""Compiled cell cutter of the radical (Laguerre, power) tessellation.

A cell is a convex polyhedron. Its plane slots 0 to 5 are the sides of the start box, the others the radical planes with
neighbours, nearest first, and planes of a round wall.
"""

import numpy as np
from numba import njit, prange

from demheat.network.polyhedron_kernels import cut, measure, start_box

OK, UNSECURED, OVERFLOW, TANGLED = 0, 1, 2, 3


@njit(cache=True)
def bin_points(points, size, counts):
    """Sort points into a grid of counts[0] x counts[1] x counts[2] cells: (start of each cell, point numbers)."""
    n = len(points)
    cell = np.empty(n, np.int64)
    start = np.zeros(counts[0] * counts[1] * counts[2] + 1, np.int64)
    for i in range(n):
        c = np.int64(0)
        for k in range(3):
            x = np.int64(points[i, k] / size[k] * counts[k])
            c = c * counts[k] + min(max(x, 0), counts[k] - 1)
        cell[i] = c
        start[c + 1] += 1
    start = np.cumsum(start)
    fill = start[:-1].copy()
    items = np.empty(n, np.uint32)
    for i in range(n):
        items[fill[cell[i]]] = i
        fill[cell[i]] += 1
    return start, items


@njit(cache=True)
def _gather(i, reach, points, weights, size, periodic, counts, start, items, cand):
    """Candidates within reach of point i into cand = (number, image code, offset, plane distance); their count."""
    number, code, offset, plane = cand
    lo = np.empty(3, np.int64)
    hi = np.empty(3, np.int64)
    for k in range(3):
        width = size[k] / counts[k]
        lo[k] = np.int64(np.floor((points[i, k] - reach) / width))
        hi[k] = np.int64(np.floor((points[i, k] + reach) / width))
        if not periodic[k]:
            lo[k] = max(lo[k], 0)
            hi[k] = min(hi[k], counts[k] - 1)
        else:  # one image to either side; the driver refuses a reach beyond the box
            lo[k] = max(lo[k], -counts[k])
            hi[k] = min(hi[k], 2 * counts[k] - 1)
    m = 0
    for cx in range(lo[0], hi[0] + 1):
        sx = cx // counts[0]
        for cy in range(lo[1], hi[1] + 1):
            sy = cy // counts[1]
            for cz in range(lo[2], hi[2] + 1):
                sz = cz // counts[2]
                c = ((cx - sx * counts[0]) * counts[1] + cy - sy * counts[1]) * counts[2] + cz - sz * counts[2]
                for slot in range(start[c], start[c + 1]):
                    j = items[slot]
                    x = points[j, 0] - points[i, 0] + sx * size[0]
                    y = points[j, 1] - points[i, 1] + sy * size[1]
                    z = points[j, 2] - points[i, 2] + sz * size[2]
                    d2 = x * x + y * y + z * z
                    image = np.uint8((sx + 1) * 9 + (sy + 1) * 3 + sz + 1)
                    if d2 > reach * reach or (j == i and image == 13):
                        continue
                    if m == len(number):
                        return -1
                    number[m] = j
                    code[m] = image
                    offset[m, 0], offset[m, 1], offset[m, 2] = x, y, z
                    # Coincident centres: the heavier hides the lighter, of equals the later number is hidden.
                    if d2 == 0.0:
                        hides = weights[j] > weights[i] or (weights[j] == weights[i] and j < i)
                        plane[m] = -np.inf if hides else np.inf
                    else:
                        plane[m] = (d2 + weights[i] - weights[j]) / (2.0 * np.sqrt(d2))
                    m += 1
    return m


@njit(cache=True)
def _sift(heap, key, root, count):
    """Restore the heap (least key first) below root."""
    item = heap[root]
    while True:
        child = 2 * root + 1
        if child >= count:
            break
        if child + 1 < count and key[heap[child + 1]] < key[heap[child]]:
            child += 1
        if key[heap[child]] >= key[item]:
            break
        heap[root] = heap[child]
        root = child
    heap[root] = item


@njit(cache=True)
def _cut_wall(count, planes, center, eps, tangents, only, skip, wall, work):
    """Cut by the planes of a round wall listed in tangents (by one of them if only >= 0, without one if skip >= 0).

    Returns (status, vertex count, number of planes); a plane q is noted as source -1 - q.
    """
    vertex, triple, owner, above, edge, follow, normal, distance, source = work[2:11]
    normals, radius, middle = wall[0], wall[1], wall[2]
    for q in tangents:
        if (only >= 0 and q != only) or q == skip:
            continue
        if planes == len(distance):
            return OVERFLOW, 0, 0
        x, y, z = normals[q]
        h = radius - x * (center[0] - middle[0]) - y * (center[1] - middle[1]) - z * (center[2] - middle[2])
        count = cut(count, planes, x, y, z, h, eps, vertex, triple, owner, above, edge, follow)
        if count < 0:
            return TANGLED, 0, 0
        if count == 0:
            return OK, 0, 0
        if triple[count - 1, 2] == planes:
            normal[planes, 0], normal[planes, 1], normal[planes, 2] = x, y, z
            distance[planes], source[planes] = h, -1 - q
            planes += 1
    return OK, count, planes


@njit(cache=True)
def _misses_tangents(count, reach, center, vertex, wall):
    """Whether a plane of a round wall farther than reach from the centre might still cut the cell.

    A plane beyond which a vertex lies touches the round body within sqrt(R_v^2 - R^2) of that vertex, R_v the vertex's
    distance from the body's middle or axis.
    """
    radius, middle, across = wall[1], wall[2], wall[3]
    for v in range(count):
        off, far = -(radius**2), 0.0
        for k in range(3):
            off += across[k] * (center[k] + vertex[v, k] - middle[k]) ** 2
            far += vertex[v, k] ** 2
        if off > 0.0 and np.sqrt(far) + np.sqrt(off) > reach:
            return True
    return False


@njit(cache=True)
def _nearest(center, tangents, wall):
    """The listed plane of a round wall that is nearest to the centre; -1 for an empty list."""
    normals, best, found = wall[0], -np.inf, -1
    for q in tangents:
        along = 0.0
        for k in range(3):
            along += normals[q, k] * (center[k] - wall[2][k])
        if along > best:
            best, found = along, q
    return found


@njit(cache=True)
def _cell(i, reach, heaviest, eps, points, weights, size, periodic, counts, start, items, tangents, wall, work):
    """Cut one cell; (status, vertex count, number of planes)."""
    cand, heap, vertex, triple, owner, above, edge, follow, normal, distance, source, area = work
    m = _gather(i, reach, points, weights, size, periodic, counts, start, items, cand)
    if m < 0:
        return OVERFLOW, 0, 0
    low, high = np.empty(3), np.empty(3)
    for k in range(3):
        low[k], high[k] = -reach, reach
        # Tangent planes enclose as much as the round body: their corners stand out of its box.
        if not periodic[k] and wall[3][k] == 0.0:
            low[k], high[k] = max(low[k], -points[i, k]), min(high[k], size[k] - points[i, k])
        for side in range(2):
            for axis in range(3):
                normal[2 * k + side, axis] = 0.0
            normal[2 * k + side, k] = 2 * side - 1
            distance[2 * k + side] = high[k] if side else -low[k]
    count = start_box(low, high, vertex, triple, owner)
    planes, plane, offset = 6, cand[3], cand[2]
    # The wall plane in front of the centre bounds the cell early; the others of the wall mostly miss it in the end.
    first = _nearest(points[i], tangents, wall)
    if first >= 0:
        state, count, planes = _cut_wall(count, planes, points[i], eps, tangents, first, -1, wall, work)
        if state != OK or count == 0:
            return state, 0, 0
    for c in range(m):
        heap[c] = c
    for root in range(m // 2 - 1, -1, -1):
        _sift(heap, plane, root, m)
    farthest = np.inf
    while m > 0 and plane[heap[0]] < farthest:
        c, h = heap[0], plane[heap[0]]
        m -= 1
        heap[0] = heap[m]
        _sift(heap, plane, 0, m)
        if planes == len(distance):
            return OVERFLOW, 0, 0
        if h == -np.inf:
            return OK, 0, 0
        d = np.sqrt(offset[c, 0] ** 2 + offset[c, 1] ** 2 + offset[c, 2] ** 2)
        for k in range(3):
            normal[planes, k] = offset[c, k] / d
        n = normal[planes]
        count = cut(count, planes, n[0], n[1], n[2], h, eps, vertex, triple, owner, above, edge, follow)
        if count < 0:
            return TANGLED, 0, 0
        if count == 0:
            return OK, 0, 0
        if triple[count - 1, 2] == planes:  # the newest vertices stand last, so the plane did cut
            distance[planes], source[planes] = h, c
            planes += 1
            farthest = 0.0
            for v in range(count):
                farthest = max(farthest, vertex[v, 0] ** 2 + vertex[v, 1] ** 2 + vertex[v, 2] ** 2)
            farthest = np.sqrt(farthest)
    if (reach**2 + weights[i] - heaviest) / (2.0 * reach) < farthest:
        return UNSECURED, 0, 0
    if len(wall[0]) > 0:
        state, count, planes = _cut_wall(count, planes, points[i], eps, tangents, -1, first, wall, work)
        if state == OK and count > 0 and _misses_tangents(count, reach, points[i], vertex, wall):
            state = UNSECURED
        return state, count, planes
    return OK, count, planes


@njit(cache=True, parallel=True)
def cut_cells(rows, reach, room, most, eps, near, points, weights, size, periodic, counts, start, items, wall, out):
    """Cut the cells of the given rows into out = (status, volume, number, neighbour, image, area, distance).

    A cell may meet `room` candidates and be cut by `most` planes. A round wall = (normals (m, 3), radius, middle (3,),
    across (3,): 1 on its round axes) is tangent planes normal.(x - middle) <= radius; near = (pointers by row, plane
    numbers) lists those that touch the body within reach of each centre. Neighbour -1 - s stands for side s of the
    box, -7 - q for plane q of a round wall. Each thread writes its own rows only.
    """
    status, volume, number, neighbour, image, areas, distances = out
    heaviest = weights.max()
    chunk = 128
    for block in prange((len(rows) + chunk - 1) // chunk):
        cand = (np.empty(room, np.int64), np.empty(room, np.uint8), np.empty((room, 3)), np.empty(room))
        work = (
            cand,
            np.empty(room, np.int64),
            np.empty((4 * most, 3)),
            np.empty((4 * most, 3), np.int16),
            np.empty((most, most), np.int16),
            np.empty(4 * most),
            np.empty((4 * most, 4), np.int64),
            np.empty(most, np.int64),
            np.empty((most, 3)),
            np.empty(most),
            np.empty(most, np.int64),
            np.empty(most),
        )
        for row in range(block * chunk, min(len(rows), (block + 1) * chunk)):
            i = rows[row]
            number[row] = 0
            volume[row] = 0.0
            tangents = near[1][near[0][row] : near[0][row + 1]]
            state, count, planes = _cell(
                i, reach, heaviest, eps, points, weights, size, periodic, counts, start, items, tangents, wall, work
            )
            status[row] = state
            if state != OK or count == 0:
                continue
            triple, owner, normal, distance, source, area = work[3], work[4], work[8], work[9], work[10], work[11]
            area[:planes] = 0.0
            volume[row] = measure(count, normal, distance, work[2], triple, owner, area)
            for f in range(planes):
                if area[f] <= 0.0:
                    continue
                if number[row] == areas.shape[1]:
                    status[row] = OVERFLOW
                    break
                e = number[row]
                if f < 6:
                    neighbour[row, e], image[row, e] = -1 - f, 13
                elif source[f] < 0:
                    neighbour[row, e], image[row, e] = source[f] - 6, 13
                else:
                    neighbour[row, e], image[row, e] = cand[0][source[f]], cand[1][source[f]]
                areas[row, e], distances[row, e] = area[f], distance[f]
                number[row] = e + 1


@njit(cache=True, parallel=True)
def match_links(indptr, indices, image, area, matched):
    """Write to `matched` the mean of a facet's area seen from both cells, 0 where only one of them sees it."""
    for p in prange(len(indptr) - 1):
        for e in range(indptr[p], indptr[p + 1]):
            q, back = indices[e], 26 - image[e]
            matched[e] = 0.0
            for r in range(indptr[q], indptr[q + 1]):
                if indices[r] == p and image[r] == back:
                    matched[e] = 0.5 * (area[e] + area[r])
                    break
