"""Compiled finest level of the multigrid preconditioner: aggregates, their Galerkin matrix, and Gauss-Seidel sweeps.

Sweeps run within fixed blocks of rows and take the rest as it was, so that bits do not depend on the number of threads.
"""

import numpy as np
from numba import njit, prange

# Rows swept one after the other. Neighbours in space are near in memory: less than a tenth of the links leave a block.
ROWS = 65536
# A neighbour joins an aggregate over a link of at least this part of the strongest link of both.
STRONG = 0.1


@njit(cache=True, parallel=True)
def strongest(indptr, conductance, top):
    """Write the largest conductance of each row to top."""
    for i in prange(len(top)):
        most = 0.0
        for e in range(indptr[i], indptr[i + 1]):
            most = max(most, conductance[e])
        top[i] = most


@njit(cache=True)
def _pick(i, indptr, indices, conductance, top, owner, found, key):
    """The strongest free neighbours of i, strongest first, into found; their number."""
    number, room = 0, len(found)
    for e in range(indptr[i], indptr[i + 1]):
        j, c = indices[e], conductance[e]
        if owner[j] >= 0 or c <= 0.0 or j == i or c < STRONG * max(top[i], top[j]):
            continue
        known = False
        for a in range(number):
            known |= found[a] == j
        if known or (number == room and c <= key[room - 1]):
            continue
        number = min(number + 1, room)
        a = number - 1
        while a > 0 and key[a - 1] < c:
            key[a], found[a] = key[a - 1], found[a - 1]
            a -= 1
        key[a], found[a] = c, j
    return number


@njit(cache=True)
def aggregate(indptr, indices, conductance, top, most, owner):
    """Write the aggregate of each row to owner, -1 for rows without links; returns the number of aggregates.

    In order of the rows each free one takes its strongest free neighbours, if they are a third of `most` or more;
    what is left over joins the aggregate of its strongest neighbour.
    """
    found, key = np.empty(most - 1, np.int64), np.empty(most - 1)
    owner[:] = -1
    count = 0
    for i in range(len(owner)):
        if owner[i] >= 0 or top[i] <= 0.0:
            continue
        number = _pick(i, indptr, indices, conductance, top, owner, found, key)
        if 3 * number >= most - 1:
            owner[i] = count
            for a in range(number):
                owner[found[a]] = count
            count += 1
    for i in range(len(owner)):
        if owner[i] >= 0 or top[i] <= 0.0:
            continue
        best, c = np.int64(-1), 0.0
        for e in range(indptr[i], indptr[i + 1]):
            j = indices[e]
            if owner[j] >= 0 and conductance[e] > max(c, STRONG * top[i]):
                best, c = owner[j], conductance[e]
        if best < 0:
            best = count
            count += 1
        owner[i] = best
    return count


@njit(cache=True)
def members(owner, count):
    """Rows of each aggregate: (start of each, row numbers)."""
    start = np.zeros(count + 1, np.int64)
    for i in range(len(owner)):
        if owner[i] >= 0:
            start[owner[i] + 1] += 1
    start = np.cumsum(start)
    fill, rows = start[:-1].copy(), np.empty(start[-1], np.uint32)
    for i in range(len(owner)):
        if owner[i] >= 0:
            rows[fill[owner[i]]] = i
            fill[owner[i]] += 1
    return start, rows


@njit(cache=True)
def galerkin(indptr, indices, conductance, diagonal, scale, owner, start, rows):
    """Sums over pairs of aggregates of scale (diag(diagonal) - conductance), as compressed rows."""
    count = len(start) - 1
    seen = np.full(count, -1, np.int64)
    pointers = np.zeros(count + 1, np.int32)
    for c in range(count):
        seen[c] = c
        number = 1
        for s in range(start[c], start[c + 1]):
            for e in range(indptr[rows[s]], indptr[rows[s] + 1]):
                d = owner[indices[e]]
                if d >= 0 and seen[d] != c:
                    seen[d] = c
                    number += 1
        pointers[c + 1] = pointers[c] + number
    columns, values = np.empty(pointers[-1], np.int32), np.zeros(pointers[-1])
    seen[:] = -1
    for c in range(count):
        here = np.int64(pointers[c])
        columns[here], seen[c], free = c, here, here + 1
        for s in range(start[c], start[c + 1]):
            values[here] += scale * diagonal[rows[s]]
            for e in range(indptr[rows[s]], indptr[rows[s] + 1]):
                d = owner[indices[e]]
                if d < 0:
                    continue
                if seen[d] < here:
                    columns[free], seen[d] = d, free
                    free += 1
                values[seen[d]] -= scale * conductance[e]
    return pointers, columns, values


@njit(cache=True, parallel=True)
def arranged(indptr, indices, conductance, scale, columns, values, ends):
    """Copy the links, those of each row to lower rows of its block first, those to higher ones of its block last.

    Their ends go to ends (n, 2): where the lower ones stop and where the higher ones begin.
    """
    n = len(ends)
    for block in prange((n + ROWS - 1) // ROWS):
        first, last = block * ROWS, min(n, (block + 1) * ROWS)
        for i in range(first, last):
            low, high = indptr[i], indptr[i + 1]
            for e in range(indptr[i], indptr[i + 1]):
                j = indices[e]
                if first <= j < i:
                    columns[low], values[low] = j, scale * conductance[e]
                    low += 1
                elif i < j < last:
                    high -= 1
                    columns[high], values[high] = j, scale * conductance[e]
            ends[i, 0], ends[i, 1] = low, high
            for e in range(indptr[i], indptr[i + 1]):
                j = indices[e]
                if not (first <= j < last) or j == i:
                    columns[low], values[low] = j, scale * conductance[e]
                    low += 1


@njit(cache=True, parallel=True)
def forward(indptr, ends, columns, values, inverse, r, x):
    """Write one forward sweep from zero to x."""
    n = len(x)
    for block in prange((n + ROWS - 1) // ROWS):
        for i in range(block * ROWS, min(n, (block + 1) * ROWS)):
            flow = r[i]
            for e in range(indptr[i], ends[i, 0]):
                flow += values[e] * x[columns[e]]
            x[i] = flow * inverse[i]


@njit(cache=True, parallel=True)
def defect(indptr, ends, columns, values, x, d):
    """Write r - A x after the forward sweep to d: what the links that it left out bring."""
    for i in prange(len(x)):
        flow = np.float32(0.0)
        for e in range(ends[i, 0], indptr[i + 1]):
            flow += values[e] * x[columns[e]]
        d[i] = flow


@njit(cache=True, parallel=True)
def restrict(start, rows, d, coarse):
    """Write the sums of d over the aggregates to coarse."""
    for c in prange(len(coarse)):
        total = 0.0
        for s in range(start[c], start[c + 1]):
            total += d[rows[s]]
        coarse[c] = total


@njit(cache=True, parallel=True)
def correct(owner, coarse, weight, x):
    """Add the aggregates' values times a weight to x."""
    for i in prange(len(x)):
        if owner[i] >= 0:
            x[i] += np.float32(weight * coarse[owner[i]])


@njit(cache=True, parallel=True)
def backward(indptr, ends, columns, values, inverse, r, x, y):
    """Write one backward sweep from x to y."""
    n = len(x)
    for block in prange((n + ROWS - 1) // ROWS):
        for i in range(min(n, (block + 1) * ROWS) - 1, block * ROWS - 1, -1):
            flow = r[i]
            for e in range(indptr[i], ends[i, 1]):
                flow += values[e] * x[columns[e]]
            for e in range(ends[i, 1], indptr[i + 1]):
                flow += values[e] * y[columns[e]]
            y[i] = flow * inverse[i]


@njit(cache=True, parallel=True)
def scaled(r, scale, out):
    """Write scale r to out, of another type."""
    for i in prange(len(r)):
        out[i] = scale * r[i]
