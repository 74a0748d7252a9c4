"""Convex polyhedra that planes are cut off from, compiled.

Every vertex is the meeting of three planes, kept as an oriented triple of plane slots; cutting by a plane removes the
vertices beyond the plane and closes the hole by a fan of new ones.
"""

from numba import njit


@njit(cache=True)
def start_box(low, high, vertex, triple, owner):
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
def cut(count, slot, nx, ny, nz, h, eps, vertex, triple, owner, above, edge, follow):
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
def measure(count, normal, distance, vertex, triple, owner, area):
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
