"""Compiled cell cutter of the radical (Laguerre, power) tessellation.

A cell is a convex polyhedron whose every vertex is the meeting of three planes, kept as an oriented triple of plane
slots; cutting it by a plane removes the vertices beyond the plane and closes the hole by a fan of new ones. Slots 0
to 5 are the sides of the start box, the others the radical planes with neighbours, nearest first.
"""

import numpy as np
from numba import njit, prange

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
def _start_box(low, high, vertex, triple, owner):
    """Vertices of the box as oriented plane triples; slots 2k and 2k + 1 are the low and high side of axis k."""
    v = 0
    for a in range(2):
        for b in range(2):
            for c in range(2):
                vertex[v, 0] = high[0] if a else low[0]
                vertex[v, 1] = high[1] if b else low[1]
                vertex[v, 2] = high[2] if c else low[2]
                p, q, r = a, 2 + b, 4 + c
                if (a + b + c) % 2 == 0:  # keep every triple counter-clockwise seen from outside
                    q, r = r, q
                _put(v, p, q, r, triple, owner)
                v += 1
    return v


@njit(cache=True)
def _put(v, p, q, r, triple, owner):
    triple[v, 0], triple[v, 1], triple[v, 2] = p, q, r
    owner[p, q] = v
    owner[q, r] = v
    owner[r, p] = v


@njit(cache=True)
def _cut(count, slot, nx, ny, nz, h, eps, vertex, triple, owner, above, edge, follow):
    """Cut the cell by n.x <= h; the new vertex count, or the old one if the plane misses, or -1 where tangled."""
    removed = 0
    for v in range(count):
        above[v] = nx * vertex[v, 0] + ny * vertex[v, 1] + nz * vertex[v, 2] - h
        if above[v] > eps:
            removed += 1
    if removed == 0:
        return count
    if removed == count:
        return 0
    edges = 0
    for v in range(count):
        if above[v] > eps:
            for k in range(3):
                a, b = triple[v, k], triple[v, (k + 1) % 3]
                if above[owner[b, a]] <= eps:
                    edge[edges, 0], edge[edges, 1], edge[edges, 2], edge[edges, 3] = a, b, v, owner[b, a]
                    follow[a] = b
                    edges += 1
    # The hole must be bounded by one simple loop.
    a, steps = edge[0, 0], 0
    while True:
        a = follow[a]
        steps += 1
        if a == edge[0, 0] or steps > edges:
            break
    if steps != edges or count + edges > len(vertex):
        return -1
    total = count
    for e in range(edges):
        v, w = edge[e, 2], edge[e, 3]
        t = above[v] / (above[v] - min(above[w], 0.0))  # a vertex kept within eps above the plane stands for it
        for k in range(3):
            vertex[total, k] = vertex[v, k] + t * (vertex[w, k] - vertex[v, k])
        triple[total, 0], triple[total, 1], triple[total, 2] = edge[e, 0], edge[e, 1], slot
        above[total] = 0.0
        total += 1
    kept = 0
    for v in range(total):
        if above[v] <= eps:
            for k in range(3):
                vertex[kept, k] = vertex[v, k]
            _put(kept, triple[v, 0], triple[v, 1], triple[v, 2], triple, owner)
            kept += 1
    return kept


@njit(cache=True)
def _measure(count, normal, distance, vertex, triple, owner, area):
    """Facet areas by slot; the cell volume."""
    for v in range(count):
        for k in range(3):
            area[triple[v, k]] = 0.0
    for v in range(count):
        for k in range(3):
            f, b = triple[v, k], triple[v, (k + 2) % 3]
            w = owner[f, b]
            cx = vertex[v, 1] * vertex[w, 2] - vertex[v, 2] * vertex[w, 1]
            cy = vertex[v, 2] * vertex[w, 0] - vertex[v, 0] * vertex[w, 2]
            cz = vertex[v, 0] * vertex[w, 1] - vertex[v, 1] * vertex[w, 0]
            area[f] += 0.5 * (normal[f, 0] * cx + normal[f, 1] * cy + normal[f, 2] * cz)
    volume = 0.0
    for v in range(count):
        for k in range(3):
            f = triple[v, k]
            # Each facet is met once per vertex: count it at its lowest vertex only.
            first, w = True, owner[f, triple[v, (k + 2) % 3]]
            while w != v:
                if w < v:
                    first = False
                    break
                m = 0
                while triple[w, m] != f:
                    m += 1
                w = owner[f, triple[w, (m + 2) % 3]]
            if first:
                volume += distance[f] * area[f] / 3.0
    return volume


@njit(cache=True)
def _cell(i, reach, heaviest, eps, points, weights, size, periodic, counts, start, items, work):
    """Cut one cell; (status, vertex count, number of planes)."""
    cand, heap, vertex, triple, owner, above, edge, follow, normal, distance, source, area = work
    m = _gather(i, reach, points, weights, size, periodic, counts, start, items, cand)
    if m < 0:
        return OVERFLOW, 0, 0
    low, high = np.empty(3), np.empty(3)
    for k in range(3):
        low[k], high[k] = -reach, reach
        if not periodic[k]:
            low[k], high[k] = max(low[k], -points[i, k]), min(high[k], size[k] - points[i, k])
        for side in range(2):
            for axis in range(3):
                normal[2 * k + side, axis] = 0.0
            normal[2 * k + side, k] = 2 * side - 1
            distance[2 * k + side] = high[k] if side else -low[k]
    count = _start_box(low, high, vertex, triple, owner)
    planes, plane, offset = 6, cand[3], cand[2]
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
        count = _cut(count, planes, n[0], n[1], n[2], h, eps, vertex, triple, owner, above, edge, follow)
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
    return OK, count, planes


@njit(cache=True, parallel=True)
def cut_cells(rows, reach, room, most, eps, points, weights, size, periodic, counts, start, items, out):
    """Cut the cells of the given rows into out = (status, volume, number, neighbour, image, area, distance).

    A cell may meet `room` candidates and be cut by `most` planes. Neighbour -1 - s stands for side s of the box. Each
    thread writes its own rows only.
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
            state, count, planes = _cell(
                i, reach, heaviest, eps, points, weights, size, periodic, counts, start, items, work
            )
            status[row] = state
            if state != OK or count == 0:
                continue
            triple, owner, normal, distance, source, area = work[3], work[4], work[8], work[9], work[10], work[11]
            area[:planes] = 0.0
            volume[row] = _measure(count, normal, distance, work[2], triple, owner, area)
            for f in range(planes):
                if area[f] <= 0.0:
                    continue
                if number[row] == areas.shape[1]:
                    status[row] = OVERFLOW
                    break
                e = number[row]
                if f < 6:
                    neighbour[row, e], image[row, e] = -1 - f, 13
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
